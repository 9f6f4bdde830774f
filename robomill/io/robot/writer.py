"""A robot as TOML text that reads back equal, to the last bit."""

from collections.abc import Mapping
from typing import Any

import numpy as np

from robomill.arrays import FloatArray
from robomill.io.robot.reader import C_THETA, FORMAT, LENGTH, SLIDES, TURNS, VERSION, written
from robomill.io.tables import exactly, toml_value
from robomill.robot.model import Robot


def robot_to_toml(robot: Robot) -> str:
    """The robot as TOML; ``robot_from_toml`` gives back an equal robot, to the last bit."""
    lines = [
        f'format = "{FORMAT}"',
        f"version = {VERSION}",
        f"name = {toml_value(robot.name)}",
        f"title = {toml_value(robot.title)}",
        f'convention = "{robot.convention}"',
    ]
    for i in range(robot.rows):
        slides = bool(robot.prismatic[i])
        lines += ["", "[[joint]]", f'type = "{SLIDES if slides else TURNS}"', f"sign = {int(robot.sign[i])}"]
        for name, stem, spelled in written(slides):
            value = getattr(robot, name)[i]
            lines += [] if name == "blocked" and robot.free[i] else [_entry(stem, value, spelled)]
    for name, T in (("base", robot.T_base), ("tool", robot.T_tool)):
        lines += ["", f"[{name}]", _entry("xyz", T[:3, 3], LENGTH), f"rotation = {toml_value(T[:3, :3].tolist())}"]
    lines += ["", "[compliance]", f"use = {toml_value(robot.compliance_set)}"]
    if not _in_force_is_its_set(robot):
        lines.append(_compliance_entry(robot.C_theta_all))
    for key, values in robot.compliance_sets.items():
        lines += ["", f"[compliance.{_key(key)}]", _compliance_entry(values)]
    lines += ["", "[provenance]"]
    for block, entry in robot.provenance.items():
        lines.append(f'{_key(block)} = {{ kind = "{entry.kind}", source = {toml_value(entry.source)} }}')
    return "\n".join(lines) + "\n"


def _in_force_is_its_set(robot: Robot) -> bool:
    values = robot.compliance_sets.get(robot.compliance_set)
    return values is not None and np.array_equal(values, robot.C_theta_all)


def _key(text: str) -> str:
    return text if text and all(c.isascii() and (c.isalnum() or c in "_-") for c in text) else toml_value(text)


def _entry(stem: str, value: Any, units: Mapping[str, str]) -> str:
    """``stem_<suffix> = value``, in the first unit that gives every number back to the last bit."""
    array = np.asarray(value, dtype=np.float64)
    for suffix, unit in units.items():
        written = [exactly(number, unit) for number in array.ravel()]
        if None not in written:
            return f"{stem}_{suffix} = {toml_value(written if array.ndim else written[0])}"
    raise AssertionError("the SI unit is always exact")


def _compliance_entry(values: FloatArray) -> str:
    return _entry("C_theta", values, C_THETA)
