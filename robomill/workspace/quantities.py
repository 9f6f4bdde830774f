"""The quantities of a map: each declared once, with name, title, unit, colours, formula, meaning and its law.

Fields, files, command line, pages, colour scales and hover texts find what they show by asking here: a new quantity is
one more ``MapQuantity`` in one of the lists below.
"""

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from difflib import get_close_matches
from typing import Literal

import numpy as np

from robomill.arguments import asked
from robomill.arrays import FloatArray, of_kind
from robomill.compliance.components import COMPONENTS, DIRECT
from robomill.errors import WorkspaceError
from robomill.kinematics import dexterity
from robomill.robot.model import Robot
from robomill.units import unit_label
from robomill.wording import listed
from robomill.workspace.cells import SolvedGrid

Colours = Literal["sequential", "diverging", "joints", "reach"]
Basis = Literal["geometry", "compliance"]


@dataclass(frozen=True)
class MapQuantity:
    """What a map shows, where to read it and how to find it.

    ``unit`` is a key of ``UNITS``; ``law`` gives the values (nx, ny, nz) of a solved grid in SI, NaN where not reached.
    ``colours``: "sequential" for sizes, "diverging" for signed values (symmetric about zero), "joints" for numbers of
    joints, "reach" for yes and no. ``able``: the more of it, by size, the better. ``rests_on``: "geometry" alone, or on
    the joints' "compliance", too.
    """

    name: str
    title: str
    unit: str
    formula: str
    meaning: str
    law: Callable[[SolvedGrid], FloatArray]
    colours: Colours = "sequential"
    rests_on: Basis = "geometry"
    able: bool = False

    @property
    def label(self) -> str:
        """Title and unit, as an axis or a colour bar says it."""
        unit = unit_label(self.unit)
        return f"{self.title}, {unit}" if unit else self.title

    @property
    def column(self) -> str:
        """The header of its column in a file, e.g. ``C_yy_um/N``."""
        unit = "percent" if self.unit == "%" else self.unit
        return self.name if unit == "1" else f"{self.name}_{unit}"


@asked
def map_quantities(robot: Robot, rests_on: Basis | None = None) -> dict[str, MapQuantity]:
    """Every quantity that a map of a robot can show.

    Parameters
    ----------
    robot : Robot
        Whose joints are counted.
    rests_on : str, optional
        Only those that rest on "geometry" alone, or on the joints' "compliance", too.

    Returns
    -------
    dict of str to MapQuantity
        By name, in the order they are listed: title, unit, formula and meaning of each.

    Examples
    --------
    >>> import robomill as rm
    >>> rm.map_quantities(rm.load_robot("slavkovic_5r"))["C_yy"].unit
    'um/N'
    """
    return {what.name: what for family in _families(robot) for what in family if rests_on in (None, what.rests_on)}


def map_quantity(robot: Robot, name: str) -> MapQuantity:
    """The quantity called ``name`` (C_zy is C_yz); joints count from 1 over the free joints. Raises WorkspaceError."""
    of_kind(name, str, "Quantity", 'the name of one, "C_yy"', WorkspaceError)
    known = map_quantities(robot).get(name.replace("zy", "yz").replace("zx", "xz").replace("yx", "xy"))
    if known is None:
        names = [f[0].name if len(f) == 1 else f"{f[0].name} ... {f[-1].name}" for f in _families(robot)]
        close = get_close_matches(name, map_quantities(robot), 1, 0.7)
        meant = f"; did you mean {close[0]!r}?" if close else "."
        raise WorkspaceError(f"Quantity {name!r}: expected {listed(names, 'or')}{meant}")
    return known


def _families(robot: Robot) -> list[list[MapQuantity]]:
    """Quantities that differ by component or joint only go together: a refusal names the first and the last."""
    return [
        *([what] for what in _of_the_geometry(robot)),
        [_component(c) for c in COMPONENTS],
        *([what] for what in _DIRECTIONS),
        [_dominant(c) for c in COMPONENTS],
        [_joint(robot, c, j) for c in COMPONENTS for j in range(robot.n)],
        [_share(robot, c, j) for c in COMPONENTS for j in range(robot.n)],
    ]


def _of_the_geometry(robot: Robot) -> Iterator[MapQuantity]:
    """Quantities that no compliance enters."""
    named, unit = ", ".join(dexterity.square_rows(robot)), dexterity.determinant_unit(robot)
    yield MapQuantity(
        "reach",
        "reach WS",
        "1",
        "WS = 1 where θ exists within the limits  (eq. 10)",
        "Where the tool can be brought at this tilt.",
        lambda field: field.reached.astype(np.float64),
        colours="reach",
    )
    yield MapQuantity(
        "det_J",
        "det(J)",
        unit,
        f"det of the rows {named}",
        "Zero is a singularity: a direction in which the tool cannot be moved.",
        lambda field: field.det_J,
        colours="diverging",
        able=True,
    )
    yield MapQuantity(
        "manipulability",
        "manipulability",
        unit,
        f"√det(J Jᵀ), rows {named}",
        "Yoshikawa's measure: the size of what unit joint speeds can do.",
        lambda field: np.abs(field.det_J),
        able=True,
    )
    yield MapQuantity(
        "inverse_condition",
        "inverse condition",
        "1",
        f"σ_min / σ_max, rows {named}",
        "1 is equally able in every direction, 0 is singular.",
        lambda field: field.where_reached(field.singular_values[:, -1] / field.singular_values[:, 0]),
        able=True,
    )
    yield MapQuantity(
        "smallest_singular_value",
        "smallest singular value",
        "1",
        f"σ_min(J), rows {named}",
        "How fast the tool moves in its worst direction at unit joint speed.",
        lambda field: field.where_reached(field.singular_values[:, -1]),
        able=True,
    )
    yield MapQuantity(
        "limit_distance",
        "distance to joint limits",
        "%",
        "min_i (distance to the nearer limit) / (half range)",
        "100 % is mid-range in every joint, 0 is at a limit.",
        lambda field: field.where_reached(dexterity.limit_distance(field.robot, field.theta[field.reached])),
        able=True,
    )


CANCEL = "Parts of different signs cancel: without this joint the cross-compliance may be larger."

_DIRECTIONS = (
    MapQuantity(
        "C_soft",
        "largest compliance",
        "um/N",
        "largest eigenvalue of C",
        "How far 1 N moves the tip in the direction in which it moves most.",
        lambda field: field.where_reached(field.principal[:, -1]),
        rests_on="compliance",
    ),
    MapQuantity(
        "C_stiff",
        "smallest compliance",
        "um/N",
        "smallest eigenvalue of C",
        "How far 1 N moves the tip in the direction in which it moves least.",
        lambda field: field.where_reached(field.principal[:, 0]),
        rests_on="compliance",
    ),
    MapQuantity(
        "dominant",
        "largest contributor",
        "1",
        "argmax_i trace C_i",
        "The joint with the largest part of C_xx + C_yy + C_zz.",
        lambda field: _largest(field, field.shares[..., :3].sum(axis=-1)),
        colours="joints",
        rests_on="compliance",
    ),
)


def _component(c: str) -> MapQuantity:
    k = COMPONENTS.index(c)
    return MapQuantity(
        f"C_{c}",
        f"{'direct' if c[0] == c[1] else 'cross'}-compliance C_{c}",
        "um/N",
        f"C_{c} = Σ_i C_θi J_i,{c[0]} J_i,{c[1]}  (eqs. 13, 14)",
        f"How far the tip moves in {c[0].upper()} under 1 N in {c[1].upper()}.",
        lambda field: field.total[..., k],
        colours=_signed_or_not(c),
        rests_on="compliance",
    )


def _dominant(c: str) -> MapQuantity:
    k = COMPONENTS.index(c)
    return MapQuantity(
        f"dominant_C_{c}",
        f"largest contributor to C_{c}",
        "1",
        f"argmax_i |C_i,{c}|",
        f"Where to stiffen first, if it is C_{c} that matters."
        if one_sign(c)
        else f"The largest part by size. {CANCEL}",
        lambda field: _largest(field, np.abs(field.shares[..., k])),
        colours="joints",
        rests_on="compliance",
    )


def _joint(robot: Robot, c: str, joint: int) -> MapQuantity:
    k, number = COMPONENTS.index(c), robot.joint_numbers[joint]
    return MapQuantity(
        f"C_{c}_{joint + 1}",
        f"joint {number} in C_{c}",
        "um/N",
        f"C_{number},{c} = C_θ{number} J_{c[0]} J_{c[1]}  (eq. 14)",
        f"What joint {number} alone adds to C_{c}.",
        lambda field: field.shares[..., joint, k],
        colours=_signed_or_not(c),
        rests_on="compliance",
    )


def _share(robot: Robot, c: str, joint: int) -> MapQuantity:
    k, number = COMPONENTS.index(c), robot.joint_numbers[joint]

    def law(field: SolvedGrid) -> FloatArray:
        whole = np.abs(field.shares[..., k]).sum(axis=-1)
        nothing = np.where(field.reached, 0.0, np.nan)
        return np.divide(field.shares[..., joint, k], whole, out=nothing, where=whole > 0)

    return MapQuantity(
        f"share_C_{c}_{joint + 1}",
        f"share of joint {number} in C_{c}",
        "%",
        f"C_{number},{c} / Σ_i |C_i,{c}|",
        f"The part of C_{c} that would vanish if joint {number} were rigid."
        if one_sign(c)
        else f"Joint {number}'s part of C_{c}, of the sum of all parts' sizes. {CANCEL}",
        law,
        colours=_signed_or_not(c),
        rests_on="compliance",
    )


def _signed_or_not(c: str) -> Colours:
    return "sequential" if one_sign(c) else "diverging"


def one_sign(c: str) -> bool:
    """Whether all joints add to a component with one sign: C_θ J_x J_x is never negative, C_θ J_x J_y may be."""
    return c in DIRECT


def _largest(field: SolvedGrid, size: FloatArray) -> FloatArray:
    """Number (as in the robot's table) of the joint with the largest ``size`` (nx, ny, nz, n)."""
    numbers = np.array(field.robot.joint_numbers, dtype=np.float64)
    return field.where_reached(numbers[np.argmax(size[field.reached], axis=-1)])
