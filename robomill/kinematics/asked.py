"""Inverse kinematics as people ask it: places meant in mm are refused; those of a program or a map are not."""

from __future__ import annotations

from collections.abc import Callable
from functools import wraps
from typing import Any, Concatenate, ParamSpec

import numpy as np
from numpy.typing import ArrayLike

from robomill.arguments import asked
from robomill.arrays import FloatArray
from robomill.errors import KinematicsError
from robomill.kinematics import inverse
from robomill.kinematics.extent import stretch
from robomill.kinematics.forward import joint_angles
from robomill.kinematics.result import IKResult
from robomill.kinematics.transforms import poses
from robomill.robot.model import Robot, check_robot
from robomill.units import to_si

P = ParamSpec("P")
FOOT = 0.01  # m: where nothing can be milled
SLIPPED = 30.0  # times as far as an arm reaches: such a place was meant in mm


def _in_metres(
    solve: Callable[Concatenate[Robot, ArrayLike, P], IKResult],
) -> Callable[Concatenate[Robot, ArrayLike, P], IKResult]:
    @asked
    @wraps(solve)
    def in_metres(robot: Robot, T_MT: ArrayLike, *args: P.args, **choices: P.kwargs) -> IKResult:
        check_robot(robot)
        found = poses(T_MT)
        _check_places(robot, found[..., :3, 3])
        _check_angles(robot, choices.get("near"), choices.get("spin"))
        return solve(robot, found, *args, **choices)

    return in_metres


def _check_angles(robot: Robot, near: Any, spin: Any) -> None:
    """Refuse a configuration or a turn that was meant in degrees."""
    if near is not None and not isinstance(near, str):
        joint_angles(robot, near)
    if isinstance(spin, (int, float)) and abs(spin) > 2.0 * np.pi:
        raise KinematicsError(f"spin: found {spin:g} rad, more than a turn; {spin:g}° are {to_si(spin, 'deg'):.5g}.")


def longest_reach(robot: Robot) -> float:
    """m: no tip lies farther from the zero of {M}."""
    return float(np.linalg.norm(robot.chain.T_0[:3, 3])) + stretch(robot)


def in_the_foot(robot: Robot, p: FloatArray) -> bool:
    """Whether places (..., 3) m in {M} all lie within a few millimetres of the middle of the robot's foot, where
    nothing can be milled: such places were meant in m. Its zero itself is nobody's slip."""
    if robot.chain.prismatic[0] or not np.array_equal(robot.T_base, np.eye(4)):
        return False
    return bool(0.0 < np.abs(p).max(initial=0.0) < FOOT)


def _check_places(robot: Robot, p: FloatArray) -> None:
    """Refuse places (..., 3) m so many arms' lengths away that they were meant in mm."""
    span = longest_reach(robot)
    farthest = float(np.abs(p).max(initial=0.0))
    if farthest > SLIPPED * span:
        raise KinematicsError(
            f"T_MT: a place lies {farthest:g} m off, {robot.name!r} reaches {span:.3g} m at most: places are in "
            f"m; {farthest:g} mm are {to_si(farthest, 'mm'):g}."
        )


inverse_kinematics = _in_metres(inverse.inverse_kinematics)
