"""A robot's table as a person gives it in code: each number plainly in SI or under a name that ends in its unit."""

import math
from collections.abc import Mapping
from typing import Any

import numpy as np

from robomill.arrays import BoolArray, FloatArray
from robomill.errors import RobotError
from robomill.provenance import Provenance
from robomill.quantities import Quantity
from robomill.spelled import one_of, refuse_slip
from robomill.units import to_si

COLUMNS = ("alpha", "a", "d", "theta_offset")
HERE = Provenance("user", "given in code")
ASSUMED_C = 1e-6  # rad/(N m), m/N: where nobody has given one
SOFTEST, STIFFEST = 1e-3, 1e-9  # rad/(N m): no joint of a machine gives more, or less without being called rigid
# How compliances may be given: by their names, in which unit, and whether the number is a stiffness.
GIVES = {
    "C_theta": ("1", False),
    "C_theta_1e_7_rad_per_Nm": ("1e-7 rad/(N m)", False),
    "k_theta_Nm_per_rad": ("1", True),
    "k_theta_kNm_per_rad": ("kN m/rad", True),
}
TURNS = 5  # beyond so many, a limit in rad was meant in degrees
FARTHEST = 200.0  # m: a limit of a sliding joint beyond it was meant in mm
FRAME = {
    part: Quantity(f"{part} frame", "mm", "array", name=f"{part}_xyz", key=f"{part}_xyz_mm", slip=20.0)
    for part in ("base", "tool")
}


def robot_fields(given: Mapping[str, Any], declared: Mapping[str, Quantity]) -> dict[str, Any]:
    """The fields of a Robot from what ``Robot.from_dh`` is given. Raises RobotError with one sentence.

    a, alpha, d, theta_offset   one number a joint, or one for all; what is left out is 0 (m, rad; or _mm, _deg)
    limits      [lower, upper] of each joint, or one pair for all: rad (m where it slides), limits_deg of joints that
                turn and limits_mm of those that slide (None for the others). Turning joints without: +-180 degrees,
                assumed
    C_theta     compliance in rad/(N m) (m/N where it slides), C_theta_1e_7_rad_per_Nm as papers print it, or the
                stiffness, k_theta_Nm_per_rad or k_theta_kNm_per_rad; one for all or one a joint, 0 (stiffness inf) is
                rigid. Without any: 1e-6 rad/(N m), assumed
    convention  "standard" or "modified" (Craig)       sign, prismatic  one a joint: +-1; True where it slides
    T_base, T_tool   (4, 4) frames of the base in {M} and of the tool in the last axis's; or only where it stands:
                base_xyz, tool_xyz (3,) m, base_xyz_mm, tool_xyz_mm
    """
    who = f"Robot {(given['title'] or given['name'])!r}"
    table: dict[str, Any] = {name: _column(given, declared[name], who) for name in COLUMNS}
    rows = _rows([*table.values(), *(given.get(key) for key in ("prismatic", "sign", *GIVES))], who)
    table = {name: np.array(np.broadcast_to(0.0 if value is None else value, (rows,))) for name, value in table.items()}
    slides = np.zeros(rows, dtype=bool)
    if given["prismatic"] is not None:
        slides = np.array(np.broadcast_to(np.asarray(given["prismatic"], dtype=bool), (rows,)))
    limits, limits_said = _limits(given, slides, who)
    C_theta, C_said = _compliances(given, slides, who)
    return {
        **table,
        "name": given["name"],
        "title": given["title"],
        "convention": given["convention"],
        "prismatic": slides,
        "sign": given["sign"],
        "limits_all": limits,
        "C_theta_all": C_theta,
        "T_base": _frame(given, "base", who),
        "T_tool": _frame(given, "tool", who),
        "provenance": {
            **dict.fromkeys(("geometry", "base", "tool"), HERE),
            "limits": limits_said,
            "compliance": C_said,
        },
    }


def _column(given: Mapping[str, Any], declared: Quantity, who: str) -> FloatArray | None:
    """A column of the table in SI, one number for all or one a joint; None where it is left out."""
    plain, in_unit = given[declared.name], given[declared.key]
    if plain is None and in_unit is None:
        return None
    return _numbers(one_of(declared, plain, in_unit, RobotError, who), declared.label, who)


def _numbers(value: Any, name: str, who: str) -> FloatArray:
    try:
        found = np.asarray(value, dtype=np.float64)
    except (TypeError, ValueError):
        raise RobotError(f"{who}: {name}: expected numbers, found {value!r:.40}.") from None
    if found.ndim > 1:
        raise RobotError(f"{who}: {name}: expected one number, or one a joint; found shape {found.shape}.")
    return found


def _rows(columns: list[Any], who: str) -> int:
    """How many joints there are; columns that disagree are refused."""
    lengths = {len(value) for value in map(np.asarray, (c for c in columns if c is not None)) if value.ndim == 1}
    if not lengths:
        raise RobotError(f"{who}: found no list of numbers; give at least one column with a number a joint, e.g. a_mm.")
    if len(lengths) > 1:
        found = " and ".join(map(str, sorted(lengths)))
        raise RobotError(f"{who}: columns of {found} numbers do not make a table; expected one number a joint in each.")
    return lengths.pop()


def _limits(given: Mapping[str, Any], slides: BoolArray, who: str) -> tuple[FloatArray, Provenance]:
    """(rows, 2) in SI, and where they come from."""
    by_unit = {"1": given["limits"], "deg": given["limits_deg"], "mm": given["limits_mm"]}
    found, said = np.full((len(slides), 2), np.nan), HERE
    for unit, value in by_unit.items():
        for i, pair in enumerate(_pairs(value, len(slides), who)):
            if pair is None or (unit == "deg" and slides[i]) or (unit == "mm" and not slides[i]):
                continue
            if not np.isnan(found[i]).all():
                raise RobotError(f"{who}: joint {i + 1}: its limits are given twice; keep one.")
            found[i] = to_si(np.array(pair, dtype=float), unit)
            if unit == "1":
                _check_plain_limit(found[i], bool(slides[i]), f"{who}: joint {i + 1}")
    missing = np.isnan(found).any(axis=1)
    if (missing & slides).any():
        joint = int(np.argmax(missing & slides)) + 1
        raise RobotError(f"{who}: joint {joint} slides and has no limits; give limits_mm=[..., [lower, upper], ...].")
    if missing.any():
        found[missing] = (-np.pi, np.pi)
        said = Provenance("assumed", "joints without limits turn by 180 degrees either way")
    return found, said


def _pairs(value: Any, rows: int, who: str) -> list[Any]:
    """One pair, or None, a joint."""
    if value is None:
        return [None] * rows
    items = list(value)
    if len(items) == 2 and all(np.ndim(item) == 0 and item is not None for item in items):
        return [items] * rows
    if len(items) != rows or any(item is not None and np.shape(item) != (2,) for item in items):
        raise RobotError(f"{who}: limits: expected [lower, upper] for each of {rows} joints, found {value!r:.60}.")
    return items


def _check_plain_limit(pair: FloatArray, slides: bool, who: str) -> None:
    most, unit, si = (FARTHEST, "mm", "m") if slides else (TURNS * math.tau, "deg", "rad")
    worst = float(np.abs(pair).max())
    if worst > most:
        raise RobotError(
            f"{who}: limit: found {worst:g} {si}, expected at most {most:.3g}: limits alone are in {si}. If {worst:g} "
            f"{unit} is meant, give them as limits_{unit}."
        )


def _compliances(given: Mapping[str, Any], slides: BoolArray, who: str) -> tuple[FloatArray, Provenance]:
    """(rows,) rad/(N m), m/N where it slides, and where they come from."""
    names = [name for name in GIVES if given[name] is not None]
    if len(names) > 1:
        raise RobotError(f"{who}: compliances are given twice, as {' and '.join(names)}; keep one.")
    if not names:
        words = f"nobody has given compliances; {ASSUMED_C:g} rad/(N m) (m/N) for every joint"
        return np.full(len(slides), ASSUMED_C), Provenance("assumed", words)
    unit, stiff = GIVES[names[0]]
    numbers = _numbers(given[names[0]], names[0], who)
    value = np.array(np.broadcast_to(to_si(numbers, unit), slides.shape))
    if stiff and not (value > 0.0).all():
        raise RobotError(f"{who}: {names[0]}: found {value.min():g}; a stiffness is above 0 (inf for a rigid joint).")
    C_theta = 1.0 / value if stiff else value
    out = (C_theta > SOFTEST) | ((C_theta > 0.0) & (C_theta < STIFFEST) & ~slides)
    if out.any():
        i, per = int(np.argmax(out)), "m" if slides[int(np.argmax(out))] else "rad"
        low, high = (f"{1.0 / bound:g}" for bound in (SOFTEST, STIFFEST))
        raise RobotError(
            f"{who}: joint {i + 1}: {names[0]}={np.broadcast_to(numbers, slides.shape)[i]:g} makes a stiffness of "
            f"{1.0 / C_theta[i]:.3g} N{' m' if per == 'rad' else ''}/{per}, expected {low} to {high}: was it meant in "
            f"another unit? Compliances go by C_theta (SI) or C_theta_1e_7_rad_per_Nm, stiffnesses by "
            f"k_theta_Nm_per_rad or k_theta_kNm_per_rad; a rigid joint has compliance 0, stiffness inf."
        )
    return C_theta, HERE


def _frame(given: Mapping[str, Any], part: str, who: str) -> Any:
    """T (4, 4) as given, or a shift alone; None where nothing is given."""
    T, plain, in_mm = (given[key] for key in (f"T_{part}", f"{part}_xyz", f"{part}_xyz_mm"))
    if plain is None and in_mm is None:
        if T is not None and np.shape(T) == (4, 4):
            refuse_slip(FRAME[part], np.asarray(T)[:3, 3], RobotError, who)
        return T
    if T is not None:
        raise RobotError(f"{who}: T_{part} and {part}_xyz are both given; keep one of them.")
    p = _numbers(one_of(FRAME[part], plain, in_mm, RobotError, who), f"{part}_xyz", who)
    if p.shape != (3,):
        raise RobotError(f"{who}: {part}_xyz: expected three numbers, found {p!r:.40}.")
    found = np.eye(4)
    found[:3, 3] = p
    return found
