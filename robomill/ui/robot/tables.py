"""The robot's tables as they are edited on the screen, to the model and back: pure functions."""

from dataclasses import replace

import numpy as np
import pandas as pd

from robomill.errors import RobotError
from robomill.quantities import quantities
from robomill.robot.model import Robot
from robomill.robot.stiffness import COMPLIANCE, is_stiffness, meant, of_joint, shown
from robomill.ui.entry.box import NumberBox
from robomill.ui.entry.cells import Cells
from robomill.units import in_lengths, unit_label

DECLARED = quantities(Robot)
GEOMETRY = {name: DECLARED[name] for name in ("alpha", "a", "d", "theta_offset", "sign")}
LIMIT = DECLARED["limits_all"]
FILED = (*GEOMETRY, "title", "convention", "prismatic", "blocked", "limits_all", "T_base", "T_tool")
SPOKEN = {"compliance": COMPLIANCE.unit, "stiffness": "kN m/rad"}
SOFTEST = 1.0  # rad/(N m), m/N: no joint that gives more carries an arm


def same_arm(robot: Robot, known: Robot) -> bool:
    """Whether two robots are the same whatever their joints give."""
    return all(
        np.array_equal(getattr(robot, name), getattr(known, name), equal_nan=name == "blocked") for name in FILED
    )


def compliance_frame(robot: Robot) -> pd.DataFrame:
    """One row a joint: how much it gives, to be said as a compliance and as a stiffness."""
    return pd.DataFrame({"joint": _names(robot)} | dict.fromkeys(SPOKEN, robot.C_theta_all))


def compliance_boxes(robot: Robot, unit: str) -> list[NumberBox]:
    """How the compliance of each joint is typed in ``unit``, or as a stiffness, ∞ where the joint does not give."""
    stiff = is_stiffness(unit)
    box = NumberBox("stiffness" if stiff else "compliance", low=0.0, said=shown, meant=meant)
    units = [of_joint(unit, bool(slides)) for slides in robot.prismatic]
    ends = [float(shown(SOFTEST, each)) for each in units]
    if stiff:
        return [replace(box, unit=each, low=end) for each, end in zip(units, ends, strict=True)]
    return [replace(box, unit=each, high=end) for each, end in zip(units, ends, strict=True)]


def with_compliance(robot: Robot, frame: pd.DataFrame) -> Robot:
    """``robot`` with what was typed into either column of the table. Raises RobotError naming the joint."""
    told, other = (frame[name].to_numpy(dtype=float) for name in SPOKEN)
    C = np.where(told != robot.C_theta_all, told, other)
    same = [k for k, known in robot.compliance_sets.items() if np.allclose(known, C, rtol=1e-9, atol=0.0)]
    if same:
        return robot.with_compliance_set(same[0])
    return robot.replace(C_theta_all=C)


def geometry(length: str = "mm") -> Cells:
    """The cells of the D-H table, with lengths in ``length``."""
    units = [in_lengths(said.unit, length) for said in GEOMETRY.values()]
    named = zip(GEOMETRY.values(), units, strict=True)
    heads = [", ".join(filter(None, (said.label, unit_label(unit)))) for said, unit in named]
    return Cells(heads, units, RobotError)


def geometry_frame(robot: Robot, length: str = "mm") -> pd.DataFrame:
    """The D-H table, one row a joint."""
    return geometry(length).frame(np.column_stack([getattr(robot, name) for name in GEOMETRY]), joint=_names(robot))


def with_geometry(robot: Robot, frame: pd.DataFrame, length: str = "mm") -> Robot:
    """``robot`` with the table's D-H constants. Raises RobotError naming joint and column."""
    return robot.replace(**dict(zip(GEOMETRY, geometry(length).read(frame, joint).T, strict=True)))


def limits_frame(robot: Robot) -> pd.DataFrame:
    """The joint limits, one row a joint."""
    return limits(robot).frame(robot.limits_all, joint=_names(robot))


def with_limits(robot: Robot, frame: pd.DataFrame) -> Robot:
    """``robot`` with the table's limits. Raises RobotError naming the joint."""
    return robot.replace(limits_all=limits(robot).read(frame, joint))


def limits(robot: Robot, length: str = "mm") -> Cells:
    """The cells of the joint limits: degrees, a length where a joint slides."""
    units = [in_lengths(LIMIT.of_joint(bool(slides)).unit, length) for slides in robot.prismatic]
    return Cells(LIMIT.axes, [[unit] for unit in units], RobotError)


def joint(row: int) -> str:
    """How a row is named in a refusal."""
    return f"Joint {row + 1}"


def _names(robot: Robot) -> list[str]:
    return [", ".join([f"{i + 1}", *_remarks(robot, i)]) for i in range(robot.rows)]


def _remarks(robot: Robot, i: int) -> list[str]:
    said = {"slides": robot.prismatic[i], "held": not robot.free[i], "rigid": robot.C_theta_all[i] == 0.0}
    return [word for word, holds in said.items() if holds]
