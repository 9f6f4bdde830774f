"""Robots as TOML files: units in the keys, a provenance for every block, exact round trip."""

from __future__ import annotations

import tomllib
from pathlib import Path
from typing import Any

import numpy as np

from robomill.arrays import FloatArray
from robomill.errors import RobotError
from robomill.io.samples import samples_dir
from robomill.robot.model import USER_SET, Provenance, Robot
from robomill.units import from_si, to_si

FORMAT, VERSION = "robomill robot", 1
UNSTATED = Provenance("user", "not stated")
# Accepted suffixes of a key and the unit each names. The writer takes the first that gives the number back exactly.
LENGTH = {"mm": "mm", "m": "m"}
ANGLE = {"deg": "deg", "rad": "rad"}
JOINT_KEYS = {"type", "sign", "name"} | {
    f"{stem}_{u}" for stem in ("alpha", "theta_offset", "limits", "blocked_at") for u in ANGLE
} | {f"{stem}_{u}" for stem in ("a", "d", "limits", "blocked_at") for u in LENGTH}  # fmt: skip
TOP_KEYS = {
    "format", "version", "name", "title", "convention", "joint", "base", "tool", "compliance", "provenance",
}  # fmt: skip
COMPLIANCE_KEYS = {
    "C_theta_1e-7_rad_per_Nm": lambda v: to_si(v, "1e-7 rad/(N m)"),
    "C_theta_SI": lambda v: v,
    "k_theta_Nm_per_rad": lambda v: 1.0 / v,
}


def robot_folder() -> Path:
    """Folder of the robots that come with robomill."""
    return samples_dir() / "robots"


def robot_names() -> list[str]:
    """Names of the robots that come with robomill, as ``load_robot`` takes them."""
    return sorted(path.stem for path in robot_folder().glob("*.toml"))


def load_robot(name_or_path: str | Path) -> Robot:
    """A robot by the name of a preset, or from a ``.toml`` or ``.urdf`` file. Raises RobotError."""
    text = str(name_or_path)
    if text in robot_names():
        path = robot_folder() / f"{text}.toml"
    else:
        path = Path(name_or_path)
        if not path.is_file():
            raise RobotError(
                f"Robot {text!r}: no such preset or file; the presets are {', '.join(robot_names())}.", where=text
            )
    if path.suffix.lower() in (".urdf", ".xml"):
        from robomill.io.urdf import read_urdf

        return read_urdf(path)
    try:
        content = path.read_text(encoding="utf-8")
    except UnicodeDecodeError:
        raise RobotError(f"{path.name}: this is not a text file; a robot is a TOML file.", where=str(path)) from None
    return robot_from_toml(content, path.name)


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
    for block in ["geometry", "limits", "base", "tool", *(f"compliance.{key}" for key in sets)]:
        provenance.setdefault(block, UNSTATED)
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
        found[block] = Provenance(entry["kind"], entry["source"])
    return found


# ---- writing ------------------------------------------------------------------------------------------------------


def robot_to_toml(robot: Robot) -> str:
    """The robot as TOML; ``robot_from_toml`` gives back an equal robot, to the last bit."""
    lines = [
        f'format = "{FORMAT}"',
        f"version = {VERSION}",
        f"name = {_quoted(robot.name)}",
        f"title = {_quoted(robot.title)}",
        f'convention = "{robot.convention}"',
    ]
    for i in range(robot.rows):
        prismatic = bool(robot.prismatic[i])
        units = LENGTH if prismatic else ANGLE
        lines += [
            "",
            "[[joint]]",
            f'type = "{"prismatic" if prismatic else "revolute"}"',
            _entry("alpha", robot.alpha[i], ANGLE),
            _entry("a", robot.a[i], LENGTH),
            _entry("d", robot.d[i], LENGTH),
            _entry("theta_offset", robot.theta_offset[i], ANGLE),
            f"sign = {int(robot.sign[i])}",
            _entry("limits", robot.limits_all[i], units),
        ]
        if not robot.free[i]:
            lines.append(_entry("blocked_at", robot.blocked[i], units))
    for name, T in (("base", robot.T_base), ("tool", robot.T_tool)):
        lines += ["", f"[{name}]", _entry("xyz", T[:3, 3], LENGTH), f"rotation = {T[:3, :3].tolist()}"]
    lines += ["", "[compliance]", f"use = {_quoted(robot.compliance_set)}"]
    if not _in_force_is_its_set(robot):
        lines.append(_compliance_entry(robot.C_theta_all))
    for key, values in robot.compliance_sets.items():
        lines += ["", f"[compliance.{_key(key)}]", _compliance_entry(values)]
    lines += ["", "[provenance]"]
    for block, entry in robot.provenance.items():
        lines.append(f'{_key(block)} = {{ kind = "{entry.kind}", source = {_quoted(entry.source)} }}')
    return "\n".join(lines) + "\n"


def _in_force_is_its_set(robot: Robot) -> bool:
    values = robot.compliance_sets.get(robot.compliance_set)
    return values is not None and np.array_equal(values, robot.C_theta_all)


def _quoted(text: str) -> str:
    """A TOML basic string."""
    escaped = text.replace("\\", "\\\\").replace('"', '\\"')
    return '"' + "".join(c if c >= " " and c != "\x7f" else f"\\u{ord(c):04X}" for c in escaped) + '"'


def _key(text: str) -> str:
    return text if text and all(c.isascii() and (c.isalnum() or c in "_-") for c in text) else _quoted(text)


def _exact(value: FloatArray, unit: str) -> FloatArray | None:
    """Numbers in ``unit`` that convert back to ``value`` bit by bit; round ones preferred; None where there are none."""
    rough = np.atleast_1d(from_si(value, unit))
    target = np.atleast_1d(value)
    result = np.empty_like(rough)
    for i, (r, t) in enumerate(zip(rough, target, strict=True)):
        near = [float(f"{r:.12g}"), float(r), float(np.nextafter(r, np.inf)), float(np.nextafter(r, -np.inf))]
        hits = [c for c in near if to_si(c, unit) == t]
        if not hits:
            return None
        result[i] = hits[0]
    return result


def _entry(stem: str, value: Any, units: dict[str, str]) -> str:
    array = np.asarray(value, dtype=np.float64)
    for suffix, unit in units.items():
        exact = _exact(array, unit)
        if exact is not None:
            number = exact.tolist() if array.ndim else float(exact[0])
            return f"{stem}_{suffix} = {number!r}"
    raise AssertionError("the SI unit is always exact")


def _compliance_entry(values: FloatArray) -> str:
    exact = _exact(values, "1e-7 rad/(N m)")
    if exact is None:
        return f"C_theta_SI = {values.tolist()!r}"
    return f"C_theta_1e-7_rad_per_Nm = {exact.tolist()!r}"
