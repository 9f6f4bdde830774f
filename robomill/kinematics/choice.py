"""Which of the closed form's solutions of a pose to take: the nearest within limits."""

import numpy as np

from robomill.arrays import BoolArray, FloatArray, frozen
from robomill.kinematics.decoupled import Answer, Decoupled, Rules
from robomill.kinematics.forward import rows
from robomill.kinematics.transforms import rotation_z, transform
from robomill.progress import slices
from robomill.robot.model import Robot

SPIN_STEPS = 24  # all round the tool axis


def rules(robot: Robot, arm: Decoupled, wanted: BoolArray, arm_first: bool, free_spin: bool) -> Rules:
    """Take of the ``wanted`` (8,) solutions within limits the one with the least sum of squared joint motions.

    With ``arm_first`` the order of shoulder and elbow goes before it, with ``free_spin`` the turn about the tool axis
    is the one with the least motion: searched in steps of 15 degrees, refined by halving the step to about 0.1
    degrees; where the tool axis is axis 6, that stays as it is.
    """
    held = free_spin and arm.spindle_on_last_axis
    tried = SPIN_STEPS if free_spin and not held else 0
    whole = robot.n == 6 and not free_spin
    return Rules(robot.limits, frozen(wanted, bool), arm_first, tried, held, whole)


def nearest(robot: Robot, arm: Decoupled, T_MT: FloatArray, goal: FloatArray, rules: Rules) -> Answer:
    """Of the solutions of poses T_MT (m, 4, 4) the one to take, by ``rules``, nearest to ``goal`` (1 or m, n)."""
    from robomill.kinematics import inverse_kernels

    m = len(T_MT)
    answer = Answer(np.empty((m, robot.n)), np.empty(m, dtype=np.int64), np.empty((m, 3)))
    poses, goals = np.ascontiguousarray(T_MT), np.ascontiguousarray(goal)
    for some in slices(m, ""):
        of = goals if len(goals) == 1 else goals[some]
        into = Answer(answer.theta[some], answer.branch[some], answer.fit[some])
        inverse_kernels.nearest_of(poses[some], arm, robot.chain, rules, of, into)
    return answer


def spins(count: int = SPIN_STEPS) -> FloatArray:
    """(count,) rad: turns about the tool axis in even steps all round, the first none."""
    return np.asarray(2 * np.pi / count * np.arange(count), dtype=np.float64)


def every(robot: Robot, arm: Decoupled, T_MT: FloatArray) -> tuple[FloatArray, BoolArray]:
    """(theta (m, 8, n), sound (m, 8)) of poses T_MT (m, 4, 4), without limits, in the order of ``branch_names``."""
    from robomill.kinematics import inverse_kernels

    theta, sound = np.empty((len(T_MT), 8, robot.n)), np.empty((len(T_MT), 8), dtype=bool)
    poses = np.ascontiguousarray(T_MT)
    for some in slices(len(poses), "Finding arm positions"):
        inverse_kernels.every_of(poses[some], arm, robot.chain, theta[some], sound[some])
    return theta, sound


def spun(T_MT: FloatArray, angle: float) -> FloatArray:
    """Poses (..., 4, 4) turned about their own z axis by ``angle`` rad."""
    if angle == 0.0:
        return T_MT
    return T_MT @ transform(rotation_z(angle), np.zeros(3))


def turn(robot: Robot, theta: FloatArray, near: FloatArray) -> FloatArray:
    """Angles (..., n) moved by whole turns: nearest ``near`` (n,) or (..., n) within limits; where no turn is within
    them, nearest mid-range. What slides has no turns."""
    from robomill.kinematics import inverse_kernels

    result = np.empty(theta.shape)
    goals = near[None] if near.ndim == 1 else rows(np.broadcast_to(near, theta.shape))
    inverse_kernels.turned_of(rows(theta), robot.limits, goals, result.reshape(-1, robot.n))
    return np.where(robot.chain.prismatic, theta, result)


def overshoot(robot: Robot, theta: FloatArray) -> FloatArray:
    """How far each coordinate (..., n) is past its limits: negative below, positive above, 0 inside."""
    low, high = robot.limits[:, 0], robot.limits[:, 1]
    return np.maximum(theta - high, 0.0) + np.minimum(theta - low, 0.0)
