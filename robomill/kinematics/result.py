"""What inverse kinematics answers, and why a pose was not reached, in words."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Literal

import numpy as np

from robomill.arguments import asked, made_by
from robomill.arrays import BoolArray, FloatArray, IntArray
from robomill.frames import Columns
from robomill.kinematics.choice import every, overshoot, spins, spun, turn
from robomill.kinematics.decoupled import LIMIT_SLACK, RESIDUAL, decoupled, shortfall
from robomill.kinematics.forward import rows
from robomill.kinematics.transforms import world_from_pose
from robomill.lazy import cached_property
from robomill.progress import slices
from robomill.robot.model import Robot
from robomill.spelled import beside
from robomill.units import format_count, format_many, format_si, from_si
from robomill.values import Tabled

LOOKED = 36  # spins at which the reason is looked for why a pose is not reached

Mode = Literal["position", "axis", "pose"]


@made_by("rm.inverse_kinematics(robot, T_MT)")
@dataclass(frozen=True, eq=False, repr=False)
class IKResult(Tabled):
    """Configurations for a batch of poses; every reached one has been checked by forward kinematics.

    theta (..., n) rad (m where prismatic), NaN where not reached; reached (...,); residual (...,) m of the answer or of
    the best attempt; branch_index (...,) into branch_names, -1 where not reached; spin (...,) rad is the turn about the
    tool axis that was asked for or chosen, None where there is none to choose or it came about by itself (numerically,
    or with axis 6 at home where that is the tool axis). ``branch`` gives the names, ``reason(index)`` says why a
    pose is not reached.

    Examples
    --------
    >>> import robomill as rm
    >>> robot = rm.load_robot("slavkovic_5r")
    >>> T_MT = rm.pose_from_world([[0.0, -1.3, 0.0, 0.0, 0.0], [9.0, 0.0, 0.0, 0.0, 0.0]])
    >>> rm.inverse_kinematics(robot, T_MT)
    <IKResult 1 of 2 poses reached>
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

    @cached_property
    def branch(self) -> Any:
        """Name of the solution taken, "" where not reached: a string for one pose, else an array of strings (...,)."""
        names = np.array([*self.branch_names, ""])[self.branch_index]
        return str(names) if names.ndim == 0 else names

    def columns(self) -> Columns:
        """One row a pose, in the batch's order: where it lies in {M}, the joints as load tests have them, what came of
        it; NaN where it is not reached."""
        x_M = world_from_pose(self.T_MT).reshape(-1, 5)
        theta, number = self.theta.reshape(-1, self.robot.n), range(1, self.robot.n + 1)
        found: Columns = {f"{axis}_mm": from_si(x_M[:, i], "mm") for i, axis in enumerate("XYZ")}
        found |= {f"{axis}_deg": from_si(x_M[:, 3 + i], "deg") for i, axis in enumerate("AB")}
        units = self.robot.joint_units
        found |= {f"theta{j}_{unit}": from_si(q, unit) for j, unit, q in zip(number, units, theta.T, strict=True)}
        found["reached"] = self.reached.ravel()
        found["residual_mm"] = from_si(self.residual.ravel(), "mm")
        found["branch"] = np.ravel(self.branch)
        if self.spin is not None:
            found["spin_deg"] = from_si(self.spin.ravel(), "deg")
        return found

    def _said(self) -> str:
        count = self.reached.size
        if count == 1:
            return f"reached, branch {str(np.ravel(self.branch)[0])!r}" if self.reached.all() else "not reached"
        return f"{format_count(int(self.reached.sum()))} of {format_count(count, 'pose')} reached"

    @asked
    def reason(self, index: Any = ()) -> str:
        """Why the pose at ``index`` of the batch is not reached, in words; "" if it is."""
        if bool(self.reached[index]):
            return ""
        return explain(self, self.T_MT[index], float(self.residual[index])) + _in_degrees(self.T_MT[index])


def _in_degrees(T_MT: FloatArray) -> str:
    """What to ask of a pose (4, 4) that is not reached where its tilts are round numbers of radians; else ""."""
    tilts = world_from_pose(T_MT)[3:]
    if beside() or not tilts.any() or not np.allclose(np.round(tilts, 1), tilts, rtol=0.0, atol=1e-9):
        return ""
    return f"; A and B are {format_many(tilts, 'deg', 1, ' and ')} here: were they given in degrees, not in rad?"


def explain(result: IKResult, T_MT: FloatArray, residual: float) -> str:
    """One clause on a pose (4, 4) that was not reached: the joint at fault, or how far beyond reach."""
    robot = result.robot
    arm = decoupled(robot)
    if arm is None:
        return f"no configuration within the limits found; the nearest attempt stays {format_si(residual, 'mm')} away"
    angles = spins(LOOKED) if result.free_spin else [0.0]
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


def beyond_limits(robot: Robot, theta: FloatArray) -> list[str]:
    """A sentence for each joint of theta (n,) that is past its limits."""
    over, (low, high) = overshoot(robot, theta), robot.limits.T
    return [
        f"joint {robot.joint_numbers[i]} is at {format_si(theta[i], unit, 1)}, beyond its limits of "
        f"{format_si(low[i], unit, 1)} to {format_si(high[i], unit, 1)}"
        for i, unit in enumerate(robot.joint_units)
        if abs(over[i]) > LIMIT_SLACK
    ]


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
