"""A robot from TOML text: units in the keys, a provenance for every block, one sentence for whatever is wrong."""

from __future__ import annotations

import tomllib
from pathlib import Path
from typing import Any

import numpy as np

from robomill.arrays import FloatArray
from robomill.errors import RobotError
from robomill.provenance import KINDS, Provenance
from robomill.robot.model import USER_SET, Robot
from robomill.units import to_si

FORMAT, VERSION = "robomill robot", 1
# Accepted suffixes of a key and the unit each names. The writer takes the first that gives the number back exactly.
LENGTH = {"mm": "mm", "m": "m"}
ANGLE = {"deg": "deg", "rad": "rad"}
JOINT_KEYS = (
    {"type", "sign", "name"}
    | {f"{stem}_{u}" for stem in ("alpha", "theta_offset", "limits", "blocked_at") for u in ANGLE}
    | {f"{stem}_{u}" for stem in ("a", "d", "limits", "blocked_at") for u in LENGTH}
)
TOP_KEYS = {
    "format",
    "version",
    "name",
    "title",
    "convention",
    "joint",
    "base",
    "tool",
    "compliance",
    "provenance",
}
COMPLIANCE_KEYS = {
    "C_theta_1e-7_rad_per_Nm": lambda v: to_si(v, "1e-7 rad/(N m)"),
    "C_theta_SI": lambda v: v,
    "k_theta_Nm_per_rad": lambda v: 1.0 / v,
}


def robot_from_toml(text: str, where: str = "robot") -> Robot:
    """The robot written in ``text``; ``where`` names it in refusals. Raises RobotError with one sentence."""
    try:
        data = tomllib.loads(text)
    except tomllib.TOMLDecodeError as exc:
        raise RobotError(f"{where}: this is not valid TOML: {exc}.", where=where) from None
    _known_keys(data, TOP_KEYS, where)
    if data.get("format", FORMAT) != FORMAT or data.get("version", VERSION) != VERSION:
        raise RobotError(
            f"{where}: expected format = {FORMAT!r}, version = {VERSION}; "
            f"found {data.get('format')!r}, {data.get('version')!r}."
        )
    joints = data.get("joint", [])
    if not isinstance(joints, list) or not all(isinstance(row, dict) for row in joints):
        raise RobotError(f"{where}: the joints must be written as [[joint]] tables.")
    if not joints:
        raise RobotError(f"{where}: found no joints; write one [[joint]] table for each of 2 to 7 joints.")
    columns = _joint_columns(joints, where)
    sets, current, C_theta = _compliance(data.get("compliance", {}), len(joints), where)
    provenance = _provenance(data.get("provenance", {}), where)
    try:
        return Robot(
            name=_string(data, "name", Path(where).stem, where),
            title=_string(data, "title", "", where),
            convention=data.get("convention", "standard"),
            T_base=_frame(data.get("base", {}), "base", where),
            T_tool=_frame(data.get("tool", {}), "tool", where),
            compliance_sets=sets,
            compliance_set=current,
            C_theta_all=C_theta,
            provenance=provenance,
            **columns,
        )
    except RobotError as exc:
        raise RobotError(f"{where}: {exc}", where=where) from None


def _known_keys(table: dict[str, Any], known: set[str], where: str) -> None:
    unknown = sorted(set(table) - known)
    if unknown:
        raise RobotError(f"{where}: does not know {unknown[0]!r}; expected {', '.join(sorted(known))}.", where=where)


def _string(data: dict[str, Any], key: str, default: str, where: str) -> str:
    value = data.get(key, default)
    if not isinstance(value, str):
        raise RobotError(f"{where}: {key}: expected text in quotes, found {value!r:.40}.")
    return value


def _number(value: Any, key: str, where: str) -> float:
    if isinstance(value, bool) or not isinstance(value, int | float):
        raise RobotError(f"{where}: {key}: expected a number, found {value!r:.40}.", where=where)
    if not np.isfinite(value):
        raise RobotError(f"{where}: {key} is {value}; give a finite number.", where=where)
    return float(value)


def _quantity(row: dict[str, Any], stem: str, units: dict[str, str], where: str, default: float | None) -> float:
    """The value of ``stem_<unit>`` in SI, whichever unit the key names."""
    keys = [f"{stem}_{suffix}" for suffix in units if f"{stem}_{suffix}" in row]
    if len(keys) > 1:
        raise RobotError(f"{where}: {stem} is given twice, as {' and '.join(keys)}; keep one.", where=where)
    if not keys:
        if default is None:
            raise RobotError(f"{where}: {stem} is missing; give {' or '.join(f'{stem}_{s}' for s in units)}.")
        return default
    return to_si(_number(row[keys[0]], keys[0], where), units[keys[0].rsplit("_", 1)[1]])


def _joint_columns(joints: list[dict[str, Any]], where: str) -> dict[str, Any]:
    names = ("alpha", "a", "d", "theta_offset", "sign", "prismatic", "limits_all", "blocked")
    columns: dict[str, list[Any]] = {name: [] for name in names}
    for i, row in enumerate(joints, start=1):
        place = f"{where}: joint {i}"
        _known_keys(row, JOINT_KEYS, place)
        kind = row.get("type", "revolute")
        if kind not in ("revolute", "prismatic"):
            raise RobotError(f"{place}: type is {kind!r:.40}; expected 'revolute' or 'prismatic'.", where=place)
        units = LENGTH if kind == "prismatic" else ANGLE
        columns["prismatic"].append(kind == "prismatic")
        for stem, unit in (("alpha", ANGLE), ("a", LENGTH), ("d", LENGTH), ("theta_offset", ANGLE)):
            columns[stem].append(_quantity(row, stem, unit, place, None))
        columns["sign"].append(_number(row.get("sign", 1), "sign", place))
        columns["limits_all"].append(_limits(row, units, place))
        columns["blocked"].append(_quantity(row, "blocked_at", units, place, np.nan))
    return columns


def _limits(row: dict[str, Any], units: dict[str, str], place: str) -> list[float]:
    keys = [f"limits_{s}" for s in units if f"limits_{s}" in row]
    if len(keys) != 1:
        raise RobotError(
            f"{place}: give the limits once, as {' or '.join(f'limits_{s}' for s in units)} = [lower, upper]."
        )
    pair = row[keys[0]]
    if not isinstance(pair, list) or len(pair) != 2:
        raise RobotError(f"{place}: {keys[0]}: expected [lower, upper], found {pair!r:.40}.")
    return [to_si(_number(v, keys[0], place), units[keys[0].rsplit("_", 1)[1]]) for v in pair]


def _compliance(table: Any, rows: int, where: str) -> tuple[dict[str, FloatArray], str, FloatArray]:
    """(sets, name in force, C_theta_all). ``use`` names the set; numbers beside it are the user's own."""
    place = f"{where}: compliance"
    if not isinstance(table, dict) or not table:
        raise RobotError(f"{place}: is missing; give [compliance] with use = '<set>' and [compliance.<set>].")
    sets = {
        key: _compliance_column(value, rows, f"{place} set {key!r}")
        for key, value in table.items()
        if isinstance(value, dict)
    }
    unknown = [k for k, v in table.items() if k != "use" and not isinstance(v, dict) and k not in COMPLIANCE_KEYS]
    if unknown:
        raise RobotError(f"{place}: does not know {unknown[0]!r}; expected {', '.join(COMPLIANCE_KEYS)}.")
    own = {k: v for k, v in table.items() if k in COMPLIANCE_KEYS}
    current = table.get("use", USER_SET if own or not sets else next(iter(sets)))
    if own:
        return sets, current, _compliance_column(own, rows, place)
    if current not in sets:
        raise RobotError(f"{place}: use = {current!r} is not among its sets ({', '.join(sets) or 'none'}).")
    return sets, current, sets[current]


def _compliance_column(table: dict[str, Any], rows: int, place: str) -> FloatArray:
    keys = [k for k in table if k in COMPLIANCE_KEYS]
    if len(keys) != 1 or len(table) != 1:
        raise RobotError(f"{place}: give exactly one of {', '.join(COMPLIANCE_KEYS)}.")
    values = table[keys[0]]
    if not isinstance(values, list) or len(values) != rows:
        found = f"{len(values)}" if isinstance(values, list) else f"{values!r:.40}"
        raise RobotError(f"{place}: {keys[0]}: expected {rows} numbers, one a joint, found {found}.")
    array = np.array([_number(v, f"{keys[0]}[{i}]", place) for i, v in enumerate(values, start=1)])
    if keys[0].startswith("k_") and (array <= 0).any():
        joint = int(np.flatnonzero(array <= 0)[0])
        raise RobotError(f"{place}: joint {joint + 1}: the stiffness is {array[joint]:g}; it must be above zero.")
    if (array < 0).any():
        joint = int(np.flatnonzero(array < 0)[0])
        raise RobotError(
            f"{place}: joint {joint + 1}: the compliance is {array[joint]:g}; a compliance cannot be negative."
        )
    return COMPLIANCE_KEYS[keys[0]](array)


def _frame(table: Any, name: str, where: str) -> FloatArray:
    """(4, 4) from ``xyz_mm``/``xyz_m`` and three rows ``rotation``."""
    place = f"{where}: {name}"
    if not isinstance(table, dict):
        raise RobotError(f"{place}: expected a table [{name}].")
    _known_keys(table, {"xyz_mm", "xyz_m", "rotation"}, place)
    T = np.eye(4)
    for suffix, unit in LENGTH.items():
        key = f"xyz_{suffix}"
        if key in table:
            value = table[key]
            if not isinstance(value, list) or len(value) != 3:
                raise RobotError(f"{place}: {key}: expected three numbers, found {value!r:.40}.")
            T[:3, 3] = [to_si(_number(v, key, place), unit) for v in value]
    rotation = table.get("rotation")
    if rotation is not None:
        square = isinstance(rotation, list) and len(rotation) == 3
        if not square or any(not isinstance(row, list) or len(row) != 3 for row in rotation):
            raise RobotError(f"{place}: rotation: expected three rows of three numbers, found {rotation!r:.60}.")
        T[:3, :3] = [[_number(v, "rotation", place) for v in row] for row in rotation]
    return T


def _provenance(table: Any, where: str) -> dict[str, Provenance]:
    found: dict[str, Provenance] = {}
    for block, entry in table.items() if isinstance(table, dict) else ():
        if not isinstance(entry, dict) or set(entry) != {"kind", "source"}:
            raise RobotError(f"{where}: provenance {block!r}: expected {{ kind = ..., source = ... }}.")
        if not isinstance(entry["source"], str):
            raise RobotError(f"{where}: provenance {block!r}: the source must be text.")
        if entry["kind"] not in KINDS:
            raise RobotError(
                f"{where}: provenance {block!r}: kind is {entry['kind']!r:.40}; expected one of {', '.join(KINDS)}."
            )
        found[block] = Provenance(entry["kind"], entry["source"])
    return found
