"""What inverse kinematics answers, and why a pose was not reached, in words."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Literal

import numpy as np

from robomill.arrays import BoolArray, FloatArray, IntArray
from robomill.kinematics.decoupled import decoupled, shortfall, solution_columns
from robomill.kinematics.forward import tool_pose
from robomill.kinematics.transforms import rotation_z, transform
from robomill.robot.model import Robot
from robomill.units import format_si

Mode = Literal["position", "axis", "pose"]
RESIDUAL = 1e-9  # m and rad: an answer further off than this is not an answer
LIMIT_SLACK = 1e-10  # rad or m past a limit that is still rounding


@dataclass(frozen=True, eq=False)
class IKResult:
    """Configurations for a batch of poses; every reached one has been checked by forward kinematics.

    theta (..., n) rad (m where prismatic), NaN where not reached; reached (...,); residual (...,) m and
    residual_angle (...,) rad of the answer or of the best attempt; branch_index (...,) into branch_names, -1 where not
    reached; spin (...,) rad is the turn about the tool axis that was chosen, None where the arm does not choose one.
    ``branch`` gives the names and ``reason(index)`` says why a pose is not reached.
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
    free_spin: bool = False
    spin: FloatArray | None = None

    @property
    def branch(self) -> Any:
        """Name of the solution taken, "" where not reached: a string for one pose, else an array of strings (...,)."""
        names = np.array([*self.branch_names, ""])[self.branch_index]
        return str(names) if names.ndim == 0 else names

    def reason(self, index: Any = ()) -> str:
        """Why the pose at ``index`` of the batch is not reached, in words; "" if it is."""
        if bool(self.reached[index]):
            return ""
        return explain(self, self.T_MT[index], float(self.residual[index]))


def explain(result: IKResult, T_MT: FloatArray, residual: float) -> str:
    """One clause on a pose (4, 4) that was not reached: the joint at fault, or how far beyond reach."""
    robot = result.robot
    arm = decoupled(robot)
    if arm is None:
        return f"no configuration within the limits found; the nearest attempt stays {format_si(residual, 'mm')} away"
    if result.free_spin:
        angles = np.radians(np.arange(0.0, 360.0, 10.0))
        spun = T_MT @ transform(rotation_z(angles), np.zeros(3))
        missing = [shortfall(arm, T) for T in spun]
        if all(missing):
            return missing[0]
    else:
        spun = T_MT[None]
        missing = [shortfall(arm, T_MT)]
        if missing[0]:
            return missing[0]
    every, possible = solution_columns(arm, spun)
    candidates = every.reshape(-1, robot.n)
    poses = np.repeat(spun, 8, axis=0)
    if result.free_spin and arm.spindle_on_last_axis:
        candidates[:, 5] = robot.home[5]
    sound = possible.ravel() & check(robot, candidates, poses, "axis" if result.free_spin else task_mode(robot))[0]
    if not sound.any():
        return "the wrist cannot bring the tool axis to the commanded direction"
    turned = wrap(candidates, robot.limits, robot.home)
    over = overshoot(robot, turned)
    total = np.where(sound, np.abs(over).max(axis=1), np.inf)
    best = int(np.argmin(total))
    if total[best] <= LIMIT_SLACK:
        return f"only another branch than {result.asked_branch!r} reaches it"
    return _past_limit(robot, turned[best], over[best])


def _past_limit(robot: Robot, theta: FloatArray, over: FloatArray) -> str:
    joint = int(np.argmax(np.abs(over)))
    limit = robot.limits[joint, 0 if over[joint] < 0 else 1]
    unit = "mm" if robot.chain.prismatic[joint] else "deg"
    return (
        f"joint {robot.joint_numbers[joint]} would need {format_si(theta[joint], unit, 1)}, "
        f"{format_si(abs(over[joint]), unit, 1)} past its limit of {format_si(limit, unit, 1)}"
    )


def task_mode(robot: Robot) -> Mode:
    """What of a pose counts for an arm: "position" up to four joints, "axis" for five, "pose" (all of it) from six."""
    return "position" if robot.n < 5 else "axis" if robot.n == 5 else "pose"


def check(robot: Robot, theta: FloatArray, T_MT: FloatArray, mode: Mode) -> tuple[BoolArray, FloatArray, FloatArray]:
    """(sound, residual m, residual_angle rad), each (...,): theta (..., n) by forward kinematics against T_MT.

    residual_angle is of the whole rotation ("pose") or of the tool axis; it does not count where only position does.
    """
    found = tool_pose(robot, theta)
    residual = np.linalg.norm(found[..., :3, 3] - T_MT[..., :3, 3], axis=-1)
    if mode == "pose":
        turned = found[..., :3, :3] - T_MT[..., :3, :3]
        angle = 2.0 * np.arcsin(np.minimum(np.sqrt((turned**2).sum(axis=(-1, -2)) / 8.0), 1.0))
    else:
        angle = 2.0 * np.arcsin(np.minimum(0.5 * np.linalg.norm(found[..., :3, 2] - T_MT[..., :3, 2], axis=-1), 1.0))
    return within_residual(residual, angle, mode), residual, angle


def within_residual(residual: FloatArray, angle: FloatArray, mode: Mode) -> BoolArray:
    """Whether an answer is near enough to be one, in what of the pose counts."""
    close: BoolArray = residual <= RESIDUAL
    return close if mode == "position" else close & (angle <= RESIDUAL)


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
