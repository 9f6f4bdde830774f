"""What may be given of a set-up in other words: the part zero as point and turn, a path as it is, a spin in degrees."""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from types import NoneType
from typing import Any

import numpy as np

from robomill.arrays import FloatArray, as_floats, of_kind
from robomill.compliance.gravity import LinkMasses
from robomill.compliance.spring import Spring
from robomill.cutting.force import ForceModel
from robomill.cutting.tool import Cutter
from robomill.cutting.tool_table import ToolTable
from robomill.errors import SetupError
from robomill.identification.knowledge import Knowledge
from robomill.identification.measured_field import MeasuredField
from robomill.identification.result import IdentificationResult
from robomill.kinematics.asked import in_the_foot
from robomill.kinematics.transforms import rotation_z
from robomill.provenance import Provenance, stated_blocks
from robomill.quantities import Quantity
from robomill.rigid import transform
from robomill.robot.model import Robot, check_robot
from robomill.simulation.origin import sources
from robomill.simulation.origin.sources import AROUND, UNSTATED_TOLERANCE, unstated
from robomill.spelled import one_of, refuse_slip
from robomill.surface.stock import Stock
from robomill.toolpath.path import Toolpath
from robomill.toolpath.sketch import Sketch
from robomill.toolpath.source import PointsSource, SketchSource
from robomill.units import format_many

# What people type of T_MW, of a part that stands upright, and of the spin.
PART_ZERO = Quantity("Zero", "mm", "array", shape=(3,), axes=tuple("XYZ"), digits=2, key="zero_mm", slip=200.0)
PART_TURN = Quantity("Turn about Z", "deg", key="rotation_z_deg", slip=2.0 * np.pi)
SPIN = Quantity("Turn about z_T", "deg", name="spin", key="spin_deg", digits=1, slip=4.0 * np.pi)
PART = ("part_zero", "part_zero_mm", "part_rotation_z", "part_rotation_z_deg")
OTHERS = (*PART, "spin_deg")
"""The names beside those of the fields."""
_ZERO = replace(PART_ZERO, name="part_zero", key="part_zero_mm")
_FRAME = replace(PART_ZERO, label="place", name="T_MW", key="part_zero_mm")
_TURN = replace(PART_TURN, name="part_rotation_z", key="part_rotation_z_deg")


def part_frame(zero: Any, turn: float = 0.0) -> FloatArray:
    """T_MW from the part zero (3,) m in {M} and the part's turn about z_M in rad."""
    return transform(rotation_z(turn), zero)


def taken(given: Mapping[str, Any], T_MW: FloatArray | None = None, robot: Any = None) -> dict[str, Any]:
    """``given`` by the names of the fields; ``T_MW`` is the part's place so far, ``robot`` the one so far. Raises
    SetupError."""
    found = {name: value for name, value in given.items() if name not in OTHERS}
    if isinstance(found.get("source"), Toolpath):
        found["source"] = PointsSource(found["source"])
    elif isinstance(found.get("source"), Sketch):
        found["source"] = SketchSource(found["source"])
    if np.shape(found.get("T_MW", ())) == (4, 4):
        refuse_slip(_FRAME, np.asarray(found["T_MW"])[:3, 3], SetupError, "Part zero")
    if any(given.get(name) is not None for name in PART):
        if "T_MW" in found:
            raise SetupError("Part zero: T_MW and part_zero are both given; keep one of them.", where="T_MW")
        found["T_MW"] = _placed(given, T_MW)
        if given.get("part_zero_mm") is not None:
            _check_zero(found["T_MW"][:3, 3], given.get("robot", robot))
    if "spin" in given and isinstance(given["spin"], str) and "spin_deg" not in given:
        return found
    if "spin" in given or "spin_deg" in given:
        found["spin"] = one_of(SPIN, given.get("spin"), given.get("spin_deg"), SetupError, "Set-up")
    return found


def _placed(given: Mapping[str, Any], before: FloatArray | None) -> FloatArray:
    """T_MW of a part zero and a turn about Z; what of both is not given is as ``before``."""
    zero, zero_mm, turn, turn_deg = (given.get(name) for name in PART)
    T_MW = part_frame([0.0, 0.0, 0.0]) if before is None else np.array(before)
    if before is None or zero is not None or zero_mm is not None:
        p = one_of(_ZERO, zero, zero_mm, SetupError, "Part zero")
        T_MW[:3, 3] = as_floats(p, "Part zero", (3,), error=SetupError, one=True)
    if turn is not None or turn_deg is not None:
        angle = one_of(_TURN, turn, turn_deg, SetupError, "Part zero")
        T_MW = part_frame(T_MW[:3, 3], float(as_floats(angle, "Part zero, turn", (), error=SetupError, one=True)))
    return T_MW


def _check_zero(zero: FloatArray, robot: Any) -> None:
    """Refuse a part zero (3,) m that was given in mm and would lie in the middle of the robot's foot."""
    if isinstance(robot, Robot) and in_the_foot(robot, zero):
        found = format_many(zero, "mm", 3)
        raise SetupError(
            f"Part zero: {found} lies in the middle of the robot's foot: part_zero_mm is in mm. If m are meant, give "
            "part_zero; so you do where this place is meant.",
            where="T_MW",
        )


def check_kinds(setup: Any) -> None:
    """Refuse robots, paths, cutters, forces, stocks and springs that are none, each with what makes one. A spring alone
    is taken as one of several."""
    check_robot(setup.robot)
    of_kind(setup.cutter, Cutter, "cutter", 'rm.Cutter("flat", diameter_mm=8)', SetupError)
    if not hasattr(setup.source, "read"):
        give = 'rm.read_program("part.nc") or rm.Toolpath.from_points(p_mm=..., feed_mm_min=...)'
        of_kind(setup.source, Toolpath, "source", give, SetupError)
    of_kind(setup.force, ForceModel, "force", "rm.ConstantForce((0, 100, 0)), in N", SetupError)
    of_kind(setup.stock, (Stock, NoneType), "stock", "rm.Stock(lower_mm=..., upper_mm=...)", SetupError)
    of_kind(setup.tools, ToolTable, "tools", 'rm.read_tool_table("tools.csv")', SetupError)
    of_kind(setup.links, (LinkMasses, NoneType), "links", "rm.LinkMasses(mass=..., centre=...)", SetupError)
    of_kind(setup.measured_map, (MeasuredField, NoneType), "measured_map", "one that was read, or None", SetupError)
    for name in ("name", "description"):
        of_kind(getattr(setup, name), str, name, "a text", SetupError)
    stated_blocks(setup.provenance, SetupError)
    if isinstance(setup.springs, Spring):
        object.__setattr__(setup, "springs", (setup.springs,))
    of_kind(setup.springs, (tuple, list), "springs", "a list of rm.ToolBending and the like", SetupError)
    for spring in setup.springs:
        of_kind(spring, Spring, "springs", "rm.ToolBending, rm.SpindleSpring or rm.JointBending", SetupError)


def knowledge_of(given: Any, robot: Robot, springs: Sequence[Spring]) -> Knowledge | None:
    """How sure the compliances in force are, from what ``rm.identify`` returned; what is known already stays as it is.

    Raises SetupError where other compliances were found than are in force.
    """
    if not isinstance(given, IdentificationResult):
        of_kind(given, (Knowledge, NoneType), "knowledge", "what rm.identify returned, or known of another", SetupError)
        known: Knowledge | None = given
        return known
    if given.n != robot.n:
        raise SetupError(
            f"knowledge: it was identified on an arm of {given.n} joints, and this one has {robot.n}.",
            where="knowledge",
        )
    found = Knowledge.of(given, robot, "identified").held_by(given.applied_to(robot), springs)
    if not found.holds_for(robot, springs):
        raise SetupError(
            "knowledge: the robot has other compliances than were found; give robot=found.applied_to(robot) with it.",
            where="knowledge",
        )
    if {each.kind for each in given.springs(robot)} - {each.kind for each in springs}:
        raise SetupError(
            "knowledge: it is of springs beside the joints, too; give springs=found.springs(robot) with it.",
            where="knowledge",
        )
    return found


def stated(given: Mapping[str, Any]) -> dict[str, Any]:
    """A new set-up: where nobody has said a number that the result rests on, ``provenance`` says that it is assumed.

    Raises SetupError where nobody has said where the part lies.
    """
    found = taken(given)
    if found.get("T_MW") is None:
        raise SetupError(
            "Set-up: it is not said where the part zero lies in the robot's frame; give part_zero_mm=(X, Y, Z), with "
            "part_rotation_z_deg where the part is turned, or T_MW (4, 4).",
            where="T_MW",
        )
    said: dict[str, Provenance] = {}
    if "tolerance" not in found:
        said["tolerance"] = UNSTATED_TOLERANCE
    if found.get("stock") is None:
        said["stock"] = AROUND
    cutter = unstated(found.get("cutter"))
    if cutter is not None:
        said["cutter"] = cutter
    found["provenance"] = {**said, **sources.stated(found.get("provenance", {}))}
    return found
