"""A robot as TOML text that reads back equal, to the last bit."""

from __future__ import annotations

from typing import Any

import numpy as np

from robomill.arrays import FloatArray
from robomill.io.robot_reader import ANGLE, FORMAT, LENGTH, VERSION
from robomill.robot.model import Robot
from robomill.units import from_si, to_si


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
    """Numbers in ``unit`` that convert back to ``value`` bit by bit, round ones first; None where there are none."""
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
