"""The robot's tables as they are edited on the screen, to the model and back: pure functions, in display units."""

import re
from typing import Any

import numpy as np
import pandas as pd

from robomill.errors import RobotError
from robomill.provenance import Provenance
from robomill.quantities import quantities
from robomill.robot.model import Robot
from robomill.robot.stiffness import is_stiffness, meant, of_joint, shown
from robomill.ui.cells import Cells
from robomill.ui.inputs import empty
from robomill.units import parse_number, unit_label

TOOL_AXES = ("-z", "+z", "-y", "+y", "-x", "+x")
DECLARED = quantities(Robot)
GEOMETRY = {name: DECLARED[name] for name in ("alpha", "a", "d", "theta_offset", "sign")}
HEADINGS = {name: ", ".join(filter(None, (said.label, unit_label(said.unit)))) for name, said in GEOMETRY.items()}
LENGTHS = Cells(tuple(HEADINGS.values()), [said.unit for said in GEOMETRY.values()], RobotError)
LIMIT = DECLARED["limits_all"]
RIGID = "∞"
SI_BELOW = 1e-3
_NUMBER = re.compile(r"[+\-−]?(\d+[.,]?\d*|[.,]\d+)([eE][+\-−]?\d+)?")


def tool_axis(robot: Robot) -> str:
    """Along which axis of the last frame z_T lies, one of ``TOOL_AXES``; "" where along none."""
    k = robot.T_tool[:3, 2]
    i = int(np.argmax(np.abs(k)))
    return f"{'+' if k[i] > 0 else '-'}{'xyz'[i]}" if abs(abs(k[i]) - 1.0) < 1e-9 else ""


def with_tool_axis(robot: Robot, axis: str) -> Robot:
    """``robot`` with z_T along one of ``TOOL_AXES``, the tip where it was; x_T along the axis after it."""
    if axis == tool_axis(robot) or axis not in TOOL_AXES:
        return robot
    i, R = "xyz".index(axis[1]), np.zeros((3, 3))
    R[i, 2], R[(i + 1) % 3, 0] = 1.0 if axis[0] == "+" else -1.0, 1.0
    R[:, 1] = np.cross(R[:, 2], R[:, 0])
    T_tool = np.array(robot.T_tool)
    T_tool[:3, :3] = R
    said = Provenance("user", "direction of the tool chosen in the app")
    return robot.replace(T_tool=T_tool, provenance={**robot.provenance, "tool": said})


def compliance_frame(robot: Robot, unit: str) -> pd.DataFrame:
    """One row a joint: its compliance in ``unit`` as text (or stiffness; ∞ where a joint does not give at all).

    Text, since a column of numbers lets nobody type an exponent.
    """
    values = []
    for C, u in zip(robot.C_theta_all, _joint_units(robot, unit), strict=True):
        value = shown(C, u)
        values.append(f"{value:.10g}" if np.isfinite(value) else RIGID)
    return pd.DataFrame({"joint": _names(robot), "value": pd.Series(values, dtype=object)})


def with_compliance(robot: Robot, frame: pd.DataFrame, unit: str) -> Robot:
    """``robot`` with the table's compliances. Raises RobotError naming the joint that cannot be."""
    units = _joint_units(robot, unit)
    C = np.array([compliance_from_text(frame["value"].iloc[i], u, f"Joint {i + 1}") for i, u in enumerate(units)])
    same = [k for k, known in robot.compliance_sets.items() if np.allclose(known, C, rtol=1e-9, atol=0.0)]
    if same:
        return robot.with_compliance_set(same[0])
    return robot.replace(C_theta_all=C)


def compliance_from_text(typed: Any, unit: str, where: str) -> float:
    """The compliance (rad/(N m), or m/N) that a cell in ``unit`` means; raises RobotError opening with ``where``.

    Decimal point or comma. A compliance written with an exponent and below 1e-3 is in SI whatever the column's unit:
    "7.14e-7" is what the column calls 7.14.
    """
    word = "stiffness" if is_stiffness(unit) else "compliance"
    text = "" if empty(typed) else str(typed).strip()
    if not text:
        raise RobotError(f"{where}: the {word} is missing; type a number in {unit_label(unit)}.")
    if is_stiffness(unit) and text == RIGID:
        return 0.0
    if not _NUMBER.fullmatch(text):
        raise RobotError(
            f"{where}: the {word} {text[:40]!r} is not a number; type one in {unit_label(unit)}, like 7.14."
        )
    value = parse_number(text)
    if value < 0 or not np.isfinite(value) or (is_stiffness(unit) and value == 0):
        least = "a finite number greater than 0" if is_stiffness(unit) else "a finite number, 0 or more"
        raise RobotError(f"{where}: the {word} is {text[:40]}; expected {least} {unit_label(unit)}.")
    return value if is_si_text(text) and not is_stiffness(unit) else meant(value, unit)


def is_si_text(typed: Any) -> bool:
    """Whether a compliance is written as a small number with an exponent, so that it is in SI."""
    text = "" if empty(typed) else str(typed).strip()
    if not _NUMBER.fullmatch(text) or "e" not in text.lower():
        return False
    return abs(parse_number(text)) < SI_BELOW


def geometry_frame(robot: Robot) -> pd.DataFrame:
    """The D-H table in mm and degrees, one row a joint."""
    return LENGTHS.frame(np.column_stack([getattr(robot, name) for name in GEOMETRY]), joint=_names(robot))


def with_geometry(robot: Robot, frame: pd.DataFrame) -> Robot:
    """``robot`` with the table's D-H constants. Raises RobotError naming joint and column."""
    return robot.replace(**dict(zip(GEOMETRY, LENGTHS.read(frame, _joint).T, strict=True)))


def limits_frame(robot: Robot) -> pd.DataFrame:
    """Joint limits in degrees (mm where prismatic)."""
    return _limits(robot).frame(robot.limits_all, joint=_names(robot))


def with_limits(robot: Robot, frame: pd.DataFrame) -> Robot:
    """``robot`` with the table's limits. Raises RobotError naming the joint."""
    return robot.replace(limits_all=_limits(robot).read(frame, _joint))


def _limits(robot: Robot) -> Cells:
    return Cells(LIMIT.axes, [[LIMIT.of_joint(bool(slides)).unit] for slides in robot.prismatic], RobotError)


def _joint(row: int) -> str:
    return f"Joint {row + 1}"


def _names(robot: Robot) -> list[str]:
    return [f"{i + 1}" + (" (slides)" if robot.prismatic[i] else "") for i in range(robot.rows)]


def _joint_units(robot: Robot, unit: str) -> list[str]:
    return [of_joint(unit, bool(slides)) for slides in robot.prismatic]
