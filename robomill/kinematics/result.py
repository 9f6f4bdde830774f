"""What inverse kinematics answers, and why a pose was not reached, in words."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from robomill.arrays import BoolArray, FloatArray, IntArray
from robomill.kinematics.decoupled import decoupled, shortfall, solutions
from robomill.robot.model import Robot
from robomill.units import format_si

RESIDUAL = 1e-9  # m and rad: an answer further off than this is not an answer
LIMIT_SLACK = 1e-10  # rad or m past a limit that is still rounding


@dataclass(frozen=True, eq=False)
class IKResult:
    """Configurations for a batch of poses; every reached one has been checked by forward kinematics.

    theta (..., n) rad (m where prismatic), NaN where not reached; reached (...,); residual (...,) m and
    residual_angle (...,) rad of the answer or of the best attempt; branch_index (...,) into branch_names, -1 where not
    reached. ``branch`` gives the names and ``reason(index)`` says why a pose is not reached.
    """

    robot: Robot
    T_MT: FloatArray
    theta: FloatArray
    reached: BoolArray
    residual: FloatArray
    residual_angle: FloatArray
    branch_index: IntArray
    branch_names: tuple[str, ...]
    asked_branch: str | None = None

    @property
    def branch(self) -> Any:
        """Name of the solution taken, "" where not reached: a string for one pose, else an array of strings (...,)."""
        names = np.array([*self.branch_names, ""])[self.branch_index]
        return str(names) if names.ndim == 0 else names

    def reason(self, index: Any = ()) -> str:
        """Why the pose at ``index`` of the batch is not reached, in words; "" if it is."""
        if bool(self.reached[index]):
            return ""
        return explain(self.robot, self.T_MT[index], self.asked_branch, float(self.residual[index]))


def explain(robot: Robot, T_MT: FloatArray, branch: str | None, residual: float) -> str:
    """One clause on a pose (4, 4) that was not reached: the joint at fault, or how far beyond reach."""
    arm = decoupled(robot)
    if arm is None:
        if residual < RESIDUAL:
            return "the tool axis cannot be brought to the commanded direction"
        return f"no configuration found; the nearest attempt stays {format_si(residual, 'mm')} away"
    missing = shortfall(arm, T_MT)
    if missing:
        return missing
    candidates = solutions(arm, T_MT[None])[:, :, 0]
    over = overshoot(robot, wrap(candidates, robot.limits, robot.home))
    from robomill.kinematics.inverse import check  # the check needs forward kinematics only; avoids a cycle

    sound = check(robot, candidates, np.broadcast_to(T_MT, (8, 4, 4)))[0]
    if not sound.any():
        return "the wrist cannot bring the tool axis to the commanded direction"
    total = np.where(sound, np.abs(over).max(axis=1), np.inf)
    best = int(np.argmin(total))
    if total[best] <= LIMIT_SLACK:
        return f"only another branch than {branch!r} reaches it" if branch else ""
    joint = int(np.argmax(np.abs(over[best])))
    value = wrap(candidates[best], robot.limits, robot.home)[joint]
    limit = robot.limits[joint, 0 if over[best, joint] < 0 else 1]
    unit = "mm" if robot.chain.prismatic[joint] else "deg"
    digits = 1
    return (
        f"joint {robot.joint_numbers[joint]} would need {format_si(value, unit, digits)}, "
        f"{format_si(abs(over[best, joint]), unit, digits)} past its limit of {format_si(limit, unit, digits)}"
    )


def overshoot(robot: Robot, theta: FloatArray) -> FloatArray:
    """How far each coordinate (..., n) is past its limits: negative below, positive above, 0 inside."""
    low, high = robot.limits[:, 0], robot.limits[:, 1]
    return np.maximum(theta - high, 0.0) + np.minimum(theta - low, 0.0)


def wrap(theta: FloatArray, limits: FloatArray, near: FloatArray) -> FloatArray:
    """Angles (..., n) moved by whole turns: to the turn nearest ``near``, else to the one nearest mid-range."""
    turn = 2 * np.pi
    low, high = limits[:, 0], limits[:, 1]
    nearest = theta + turn * np.round((near - theta) / turn)
    middle = 0.5 * (low + high)
    central = theta + turn * np.round((middle - theta) / turn)
    inside = (nearest >= low - LIMIT_SLACK) & (nearest <= high + LIMIT_SLACK)
    return np.where(inside, nearest, central)
