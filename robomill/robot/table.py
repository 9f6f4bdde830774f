"""A robot's table as a person gives it in code: each number plainly in SI or under a name that ends in its unit."""

import math
from collections.abc import Mapping
from dataclasses import replace
from typing import Any

import numpy as np

from robomill.arrays import NO_NUMBERS, BoolArray, FloatArray, as_floats, brief
from robomill.errors import RobotError
from robomill.provenance import GIVEN, Provenance
from robomill.quantities import Quantity
from robomill.rigid import transform
from robomill.robot import checks
from robomill.robot.arm import Arm
from robomill.spelled import one_of, refuse_slip
from robomill.units import format_plain, from_si, to_si

COLUMN_UNITS = {"alpha": "_deg", "a": "_mm", "d": "_mm", "theta_offset": "_deg"}
COLUMNS = tuple(COLUMN_UNITS)
ASSUMED_COMPLIANCE = 1e-6
"""rad/(N m), m/N where a joint slides: 1 um/N at a metre, until somebody gives a better one."""
SOFTEST, STIFFEST = 1e-3, 1e-9  # rad/(N m): no joint of a machine gives more, or less without being called rigid
# How compliances may be given: by their names, in which unit, and whether the number is a stiffness.
GIVES = {
    "C_theta": ("1", False),
    "C_theta_1e_7_rad_per_Nm": ("1e-7 rad/(N m)", False),
    "k_theta_Nm_per_rad": ("1", True),
    "k_theta_kNm_per_rad": ("kN m/rad", True),
}
TURNS = 5  # beyond so many, a limit in rad was meant in degrees
ALIKE = 3e-3  # of a right angle: so near to it in radians is a twist that was given as degrees
SHORTEST, SLIGHTEST = 0.05, 0.01  # m: no arm has links that are as short together, or stands on such with its tool
FARTHEST = 200.0  # m: a limit of a sliding joint beyond it was meant in mm
FRAME = {
    part: Quantity(f"{part} frame", "mm", "array", name=f"{part}_xyz", key=f"{part}_xyz_mm", slip=20.0, tiny=1e-3)
    for part in ("base", "tool")
}


OTHERS = (
    "limits_deg",
    "limits_mm",
    *(name for name in GIVES if name != "C_theta"),
    *(f"{part}_xyz{unit}" for part in FRAME for unit in ("", "_mm")),
)
"""Names that ``Robot.replace`` takes beside those of the fields."""


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
    keys = {name: name if given[declared[name].key] is None else declared[name].key for name in COLUMNS}
    columns = {keys[name]: value for name, value in table.items()}
    rows = _rows(columns | {key: given[key] for key in ("prismatic", "sign", *GIVES)}, who)
    table = {name: np.array(np.broadcast_to(0.0 if value is None else value, (rows,))) for name, value in table.items()}
    slides = checks.flags(False if given["prismatic"] is None else given["prismatic"], rows, who)
    limits, limits_said = _limits(given, slides, who)
    C_theta, C_said = _compliances(given, slides, who)
    frames = {part: _frame(given, part, who) for part in FRAME}
    _check_links(given, table, slides, list(frames.values()), who)
    return {
        **table,
        "name": given["name"],
        "title": given["title"],
        "convention": given["convention"],
        "prismatic": slides,
        "sign": given["sign"],
        "limits_all": limits,
        "C_theta_all": C_theta,
        "T_base": frames["base"],
        "T_tool": frames["tool"],
        "provenance": {
            **dict.fromkeys(("geometry", "base", "tool"), GIVEN),
            "limits": limits_said,
            "compliance": C_said,
        },
    }


def changed_fields(robot: Arm, changes: Mapping[str, Any]) -> dict[str, Any]:
    """``changes`` of a robot by the names of its fields, where they go by another one that ``robot_fields`` takes.

    Limits and compliances have an entry for each free joint, or for every row.
    """
    who, given = f"Robot {(robot.title or robot.name)!r}", {"limits": None, **dict.fromkeys(OTHERS), **changes}
    found = {name: value for name, value in changes.items() if name not in OTHERS}
    if given["limits_deg"] is not None or given["limits_mm"] is not None:
        value = given["limits_mm"] if given["limits_deg"] is None else given["limits_deg"]
        rows = _rows_of(robot, value)
        limits = np.array(robot.limits_all)
        limits[rows] = _limits(given, robot.prismatic[rows], who, limits[rows])[0]
        found["limits_all"] = limits
    names = [name for name in GIVES if name in OTHERS and changes.get(name) is not None]
    if names:
        rows = _rows_of(robot, changes[names[0]])
        C_theta = np.array(robot.C_theta_all)
        C_theta[rows] = _compliances({**dict.fromkeys(GIVES), **changes}, robot.prismatic[rows], who)[0]
        found["C_theta_all"] = C_theta
        found.pop("C_theta", None)
    for part in FRAME:
        if given[f"{part}_xyz"] is not None or given[f"{part}_xyz_mm"] is not None:
            T = np.array(getattr(robot, f"T_{part}"))
            T[:3, 3] = _frame({f"T_{part}": None, **given}, part, who)[:3, 3]
            found[f"T_{part}"] = T
    return found


def refuse_printed(declared: Quantity, C_theta: Any, name: str) -> None:
    """Refuse compliances as papers print them, without their power of ten; the joint is named."""
    found = as_floats(C_theta, f"Robot {name!r}, C_theta", (), error=RobotError, finite=False)
    for i, each in enumerate(np.ravel(found)):
        who = f"Robot {name!r}" + (f", joint {i + 1}" if found.ndim else "")
        refuse_slip(replace(declared, name="C_theta", key="C_theta_1e_7_rad_per_Nm"), each, RobotError, who)


def _rows_of(robot: Arm, value: Any) -> Any:
    """The rows of the table that ``value`` is of: all where it has an entry for each, else the free ones."""
    return (
        np.arange(robot.rows) if hasattr(value, "__len__") and len(value) == robot.rows else np.flatnonzero(robot.free)
    )


def _column(given: Mapping[str, Any], declared: Quantity, who: str) -> FloatArray | None:
    """A column of the table in SI, one number for all or one a joint; None where it is left out."""
    plain, in_unit = given[declared.name], given[declared.key]
    if plain is None and in_unit is None:
        return None
    found = _numbers(one_of(declared, plain, in_unit, RobotError, who), declared.label, who)
    if in_unit is not None and declared.name == "alpha":
        _check_twists(from_si(found, "deg"), who)
    return found


def _check_twists(alpha: FloatArray, who: str) -> None:
    """Refuse twists in degrees whose largest is a right angle, or two, in radians: no arm is twisted by 1.57 degrees
    and nowhere more."""
    turns = float(np.abs(alpha).max(initial=0.0)) / (0.5 * math.pi)
    if turns < 2.5 and abs(turns - round(turns)) < ALIKE * round(turns):
        largest = f"{turns * 0.5 * math.pi:.6g}"
        raise RobotError(
            f"{who}: alpha_deg: the largest twist is {largest}°, in radians that is {90 * round(turns)}°: alpha_deg is "
            f"in degrees. If radians are meant, give alpha; so you do where {largest}° is meant."
        )


def _check_links(
    given: Mapping[str, Any], table: Mapping[str, Any], slides: BoolArray, frames: list[Any], who: str
) -> None:
    """Refuse links in mm that make an arm as short as none is: they were meant in m."""
    keys = [key for key in ("a_mm", "d_mm") if given[key] is not None]
    links = float(np.abs(table["a"]).sum() + np.abs(table["d"]).sum())
    beside = max((float(np.linalg.norm(np.asarray(T)[:3, 3])) for T in frames if np.shape(T) == (4, 4)), default=0.0)
    most = SHORTEST if beside < SHORTEST else SLIGHTEST
    if keys and not slides.any() and 0.0 < links < most:
        raise RobotError(
            f"{who}: {' and '.join(keys)}: all links together are {format_plain(from_si(links, 'mm'), 4)} mm long, "
            f"expected at least {format_plain(from_si(most, 'mm'), 3)}: was it meant in m? Then give "
            f"{' and '.join(key[0] for key in keys)}; so you do where an arm as small is meant."
        )


def _numbers(value: Any, name: str, who: str) -> FloatArray:
    try:
        found = np.asarray(value, dtype=np.float64)
    except NO_NUMBERS:
        raise RobotError(f"{who}: {name}: expected a list of numbers, one a joint; found {brief(value, 40)}.") from None
    if found.ndim > 1:
        raise RobotError(f"{who}: {name}: expected one number, or one a joint; found shape {found.shape}.")
    return found


def _rows(columns: Mapping[str, Any], who: str) -> int:
    """How many joints there are; columns that disagree are refused."""
    lengths = {name: len(value) for name, value in columns.items() if value is not None and np.ndim(value) == 1}
    if not lengths:
        raise RobotError(f"{who}: found no list of numbers; give at least one column with a number a joint, e.g. a_mm.")
    if len({*lengths.values()}) > 1:
        alike = {rows: [name for name, k in lengths.items() if k == rows] for rows in sorted({*lengths.values()})}
        told = ", ".join(f"{' and '.join(names)} {rows}" for rows, names in alike.items())
        raise RobotError(f"{who}: the columns differ in length ({told}); expected one number a joint in each.")
    return next(iter(lengths.values()))


def _limits(
    given: Mapping[str, Any], slides: BoolArray, who: str, before: FloatArray | None = None
) -> tuple[FloatArray, Provenance]:
    """(rows, 2) in SI, and where they come from; what is left out is as ``before``."""
    by_unit = {"1": given["limits"], "deg": given["limits_deg"], "mm": given["limits_mm"]}
    found, said = np.full((len(slides), 2), np.nan), GIVEN
    for unit, value in by_unit.items():
        for i, pair in enumerate(_pairs(value, len(slides), who)):
            if pair is None or (unit == "deg" and slides[i]) or (unit == "mm" and not slides[i]):
                continue
            if not np.isnan(found[i]).all():
                raise RobotError(f"{who}: joint {i + 1}: its limits are given twice; keep one.")
            found[i] = to_si(_pair(pair, f"{who}: joint {i + 1}"), unit)
            if unit == "1":
                _check_plain_limit(found[i], bool(slides[i]), f"{who}: joint {i + 1}")
    if given["limits_deg"] is not None:
        _check_limits_in_degrees(found[~slides], who)
    missing = np.isnan(found).any(axis=1)
    if before is not None:
        return np.where(missing[:, None], before, found), said
    if (missing & slides).any():
        joint = int(np.argmax(missing & slides)) + 1
        mine = ", ".join("[lower, upper]" if slide else "None" for slide in slides)
        beside = "" if slides.all() else ", and limits_deg of those that turn"
        raise RobotError(f"{who}: joint {joint} slides and has no limits in mm; give limits_mm=[{mine}]{beside}.")
    if missing.any():
        found[missing] = (-np.pi, np.pi)
        said = Provenance("assumed", "joints without limits turn by 180 degrees either way")
    return found, said


def _pairs(value: Any, rows: int, who: str) -> list[Any]:
    """One pair, or None, a joint."""
    if value is None:
        return [None] * rows
    if isinstance(value, str) or not hasattr(value, "__iter__"):
        raise RobotError(f"{who}: limits: expected [lower, upper] for each of {rows} joints, found {brief(value)}.")
    items = list(np.asarray(value) if hasattr(value, "__array__") else value)  # of a table its rows, not its names
    if len(items) == 2 and all(np.ndim(item) == 0 and item is not None for item in items):
        return [items] * rows
    if len(items) != rows or any(item is not None and np.shape(item) != (2,) for item in items):
        raise RobotError(f"{who}: limits: expected [lower, upper] for each of {rows} joints, found {brief(value)}.")
    return items


def _pair(value: Any, who: str) -> FloatArray:
    try:
        return np.array(value, dtype=float)
    except NO_NUMBERS:
        raise RobotError(f"{who}: limits: expected two numbers, [lower, upper], found {brief(value, 40)}.") from None


def _check_limits_in_degrees(limits: FloatArray, who: str) -> None:
    """Refuse limits (k, 2) rad that were given in degrees and would hold every turning joint within a few of them."""
    widest = float(from_si(np.abs(limits).max(initial=0.0), "deg"))
    if len(limits) > 1 and 0.0 < widest <= 2.0 * math.pi + 1e-3:
        raise RobotError(
            f"{who}: limits_deg: no joint could turn beyond {widest:.4g}°: limits_deg is in degrees. If radians are "
            "meant, give limits; so you do where limits as narrow are meant."
        )


def _check_plain_limit(pair: FloatArray, slides: bool, who: str) -> None:
    doubt = doubtful_limit(pair, slides)
    if doubt:
        unit = "mm" if slides else "deg"
        raise RobotError(f"{who}: limit: {doubt}; limits alone are in SI: give them as limits_{unit}.")


def doubtful_limit(pair: FloatArray, slides: bool) -> str:
    """What to say of limits (2,) in rad (m where the joint ``slides``) that were meant in degrees or mm; "" else."""
    most, unit, si = (FARTHEST, "mm", "m") if slides else (TURNS * math.tau, "°", "rad")
    worst = float(np.abs(pair).max())
    if worst <= most:
        return ""
    return f"found {worst:g} {si}, expected at most {most:.3g}; was {worst:g} {unit} meant?"


def _compliances(given: Mapping[str, Any], slides: BoolArray, who: str) -> tuple[FloatArray, Provenance]:
    """(rows,) rad/(N m), m/N where it slides, and where they come from."""
    names = [name for name in GIVES if given[name] is not None]
    if len(names) > 1:
        raise RobotError(f"{who}: compliances are given twice, as {' and '.join(names)}; keep one.")
    if not names:
        words = f"nobody has given compliances; {ASSUMED_COMPLIANCE:g} rad/(N m) (m/N) for every joint"
        return np.full(len(slides), ASSUMED_COMPLIANCE), Provenance("assumed", words)
    unit, stiff = GIVES[names[0]]
    numbers = _numbers(given[names[0]], names[0], who)
    if numbers.ndim and len(numbers) != len(slides):
        raise RobotError(f"{who}: {names[0]}: found {len(numbers)} numbers, expected {len(slides)}, one a joint.")
    value = np.array(np.broadcast_to(to_si(numbers, unit), slides.shape))
    if stiff and not (value > 0.0).all():
        i, each = int(np.argmin(value > 0.0)), np.broadcast_to(numbers, slides.shape)
        raise RobotError(
            f"{who}: joint {i + 1}: {names[0]}: found {each[i]:g}; a stiffness is above 0 (inf for a rigid joint)."
        )
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
    return C_theta, GIVEN


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
        raise RobotError(f"{who}: {part}_xyz: expected three numbers, found {np.size(p)}.")
    return transform(np.eye(3), p)
