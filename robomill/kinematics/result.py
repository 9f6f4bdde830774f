"""What inverse kinematics answers, and why a pose was not reached, in words."""

from dataclasses import dataclass
from typing import Any, Literal

import numpy as np

from robomill.arrays import BoolArray, FloatArray, IntArray
from robomill.kinematics.choice import every, overshoot, spun, turn
from robomill.kinematics.decoupled import LIMIT_SLACK, RESIDUAL, decoupled, shortfall
from robomill.kinematics.forward import rows
from robomill.progress import slices
from robomill.robot.model import Robot
from robomill.units import format_si, to_si

Mode = Literal["position", "axis", "pose"]


@dataclass(frozen=True, eq=False)
class IKResult:
    """Configurations for a batch of poses; every reached one has been checked by forward kinematics.

    theta (..., n) rad (m where prismatic), NaN where not reached; reached (...,); residual (...,) m of the answer or of
    the best attempt; branch_index (...,) into branch_names, -1 where not reached; spin (...,) rad is the turn about the
    tool axis that was asked for or chosen, None where there is none to choose or it came about by itself (numerically).
    ``branch`` gives the names and ``reason(index)`` says why a pose is not reached.
    """

    robot: Robot
    T_MT: FloatArray
    theta: FloatArray
    reached: BoolArray
    residual: FloatArray
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
    angles = to_si(np.arange(0.0, 360.0, 10.0), "deg") if result.free_spin else [0.0]
    poses = np.array([spun(T_MT, float(angle)) for angle in angles])
    missing = [shortfall(arm, T) for T in poses]
    if all(missing):
        return missing[0]
    theta, sound = every(robot, arm, poses)
    if result.free_spin and arm.spindle_on_last_axis:
        theta[..., 5] = robot.home[5]
    if not sound.any():
        return "the wrist cannot bring the tool axis to the commanded direction"
    turned = turn(robot, theta, robot.home)[sound]
    over = overshoot(robot, turned)
    total = np.abs(over).max(axis=1)
    best = int(np.argmin(total))
    if total[best] <= LIMIT_SLACK:
        return f"only another branch than {result.asked_branch!r} reaches it"
    return _past_limit(robot, turned[best], over[best])


def _past_limit(robot: Robot, theta: FloatArray, over: FloatArray) -> str:
    joint = int(np.argmax(np.abs(over)))
    limit = robot.limits[joint, 0 if over[joint] < 0 else 1]
    unit = robot.joint_units[joint]
    return (
        f"joint {robot.joint_numbers[joint]} would need {format_si(theta[joint], unit, 1)}, "
        f"{format_si(abs(over[joint]), unit, 1)} past its limit of {format_si(limit, unit, 1)}"
    )


def task_mode(robot: Robot) -> Mode:
    """What of a pose counts for an arm: "position" up to four joints, "axis" for five, "pose" (all of it) from six."""
    return "position" if robot.n < 5 else "axis" if robot.n == 5 else "pose"


def misfit(robot: Robot, theta: FloatArray, T_MT: FloatArray, mode: Mode) -> tuple[FloatArray, FloatArray]:
    """(residual m, angle rad), each (m,): theta (m, n) by forward kinematics against T_MT (m, 4, 4).

    The angle is of the whole rotation ("pose") or of the tool axis; it does not count where only position does.
    """
    from robomill.kinematics import kernels

    shift, angle = np.empty(len(theta)), np.empty(len(theta))
    theta, poses = rows(theta), np.ascontiguousarray(T_MT)
    for some in slices(len(theta), ""):
        kernels.misfit_of(theta[some], robot.chain, poses[some], mode == "pose", shift[some], angle[some])
    return shift, angle


def within_residual(residual: FloatArray, angle: FloatArray, mode: Mode) -> BoolArray:
    """Whether an answer is near enough to be one, in what of the pose counts."""
    close: BoolArray = residual <= RESIDUAL
    return close if mode == "position" else close & (angle <= RESIDUAL)
