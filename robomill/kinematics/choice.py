"""Which of the closed form's solutions to take: the nearest within limits, or those that join along a path."""

from __future__ import annotations

import numpy as np

from robomill.arrays import BoolArray, FloatArray, IntArray, frozen
from robomill.kinematics.decoupled import LIMIT_SLACK, Answer, Decoupled, Rules
from robomill.kinematics.forward import rows
from robomill.kinematics.transforms import rotation_z, transform
from robomill.robot.model import Robot

# Order in which shoulder and elbow are tried: as at home, other elbow, other shoulder, both.
ARM_ORDER = np.array([0, 0, 1, 1, 2, 2, 3, 3])
SPIN_STEPS = 24


def rules(robot: Robot, arm: Decoupled, wanted: BoolArray, arm_first: bool, free_spin: bool) -> Rules:
    """Take of the ``wanted`` (8,) solutions within limits the one with the least sum of squared joint motions.

    With ``arm_first`` the order of shoulder and elbow goes before it, with ``free_spin`` the turn about the tool axis
    is the one with the least motion: searched in steps of 15 degrees, refined by halving the step to about 0.1
    degrees; where the tool axis is axis 6, that stays as it is.
    """
    held = free_spin and arm.spindle_on_last_axis
    spins = SPIN_STEPS if free_spin and not held else 0
    whole = robot.n == 6 and not free_spin
    return Rules(robot.limits, frozen(wanted, bool), arm_first, spins, held, whole)


def nearest(robot: Robot, arm: Decoupled, T_MT: FloatArray, goal: FloatArray, rules: Rules) -> Answer:
    """Of the solutions of poses T_MT (m, 4, 4) the one to take, by ``rules``, nearest to ``goal`` (1 or m, n)."""
    from robomill.kinematics import inverse_kernels

    m = len(T_MT)
    answer = Answer(np.empty((m, robot.n)), np.empty(m, dtype=np.int64), np.empty((m, 3)))
    poses, goals = np.ascontiguousarray(T_MT), np.ascontiguousarray(goal)
    inverse_kernels.nearest_of(poses, arm, robot.chain, rules, goals, answer)
    return answer


def every(robot: Robot, arm: Decoupled, T_MT: FloatArray) -> tuple[FloatArray, BoolArray]:
    """(theta (m, 8, n), sound (m, 8)) of poses T_MT (m, 4, 4), without limits, in the order of ``branch_names``."""
    from robomill.kinematics import inverse_kernels

    theta, sound = np.empty((len(T_MT), 8, robot.n)), np.empty((len(T_MT), 8), dtype=bool)
    inverse_kernels.every_of(np.ascontiguousarray(T_MT), arm, robot.chain, theta, sound)
    return theta, sound


def spun(T_MT: FloatArray, angle: float) -> FloatArray:
    """Poses (..., 4, 4) turned about their own z axis by ``angle`` rad."""
    return T_MT @ transform(rotation_z(angle), np.zeros(3))


def turn(robot: Robot, theta: FloatArray, near: FloatArray) -> FloatArray:
    """Angles (..., n) moved by whole turns: to the turn nearest ``near`` (n,) within limits, else nearest mid-range."""
    from robomill.kinematics import inverse_kernels

    result = np.empty(theta.shape)
    inverse_kernels.turned_of(rows(theta), robot.limits, near, result.reshape(-1, robot.n))
    return result


def overshoot(robot: Robot, theta: FloatArray) -> FloatArray:
    """How far each coordinate (..., n) is past its limits: negative below, positive above, 0 inside."""
    low, high = robot.limits[:, 0], robot.limits[:, 1]
    return np.maximum(theta - high, 0.0) + np.minimum(theta - low, 0.0)


def settle(robot: Robot, theta: FloatArray, near: FloatArray) -> tuple[FloatArray, BoolArray]:
    """(theta (..., n), within (...,)): angles turned towards ``near`` and, within rounding, put inside the limits."""
    turned = turn(robot, theta, near)
    within: BoolArray = np.all(np.abs(overshoot(robot, turned)) <= LIMIT_SLACK, axis=-1)
    clipped = np.clip(turned, robot.limits[:, 0], robot.limits[:, 1])
    return np.where(np.expand_dims(within, -1), clipped, turned), within


Score = tuple[int, int, float]


def path_score(robot: Robot, every: FloatArray, possible: BoolArray, start: FloatArray) -> Score:
    """How well the solutions every (m, 8, n) serve a path, less is better: poses none reaches, poses the best single
    branch misses, and that branch's sum of squared joint motions.
    """
    turned, within = settle(robot, every, start)
    return _score(_unwrapped(robot, turned), within & possible, start)[0]


def _score(turned: FloatArray, within: BoolArray, start: FloatArray) -> tuple[Score, int]:
    missed = (~within).sum(axis=0)
    motion = (np.diff(turned, axis=0) ** 2).sum(axis=(0, 2)) + _first_cost(turned[0], start)
    branch = min(range(len(missed)), key=lambda k: (missed[k], motion[k]))
    return (int((~within.any(axis=1)).sum()), int(missed[branch]), float(motion[branch])), branch


def _first_cost(theta: FloatArray, start: FloatArray) -> FloatArray:
    """(8,) what the first pose of a path adds: a little for its distance from home, shoulder and elbow included."""
    return 1e-3 * ((theta - start) ** 2).sum(axis=-1) + 1e-3 * ARM_ORDER


def join_path(robot: Robot, every: FloatArray, possible: BoolArray, start: FloatArray) -> tuple[FloatArray, IntArray]:
    """(theta (m, n), index (m,)): one solution a pose, so that the sum of squared joint motions is least.

    every (m, 8, n). A single branch that reaches all there is to reach serves the whole path; otherwise dynamic
    programming over the solutions. Poses with none keep index -1 and are bridged.
    """
    turned, within = settle(robot, every, start)
    turned, within = _unwrapped(robot, turned), within & possible
    m = len(within)
    (nowhere, missed, _), branch = _score(turned, within, start)
    index = np.where(within[:, branch], branch, -1) if missed == nowhere else _least_motion(turned, within, start)
    return turned[np.arange(m), np.maximum(index, 0)], index


def _least_motion(turned: FloatArray, within: BoolArray, start: FloatArray) -> IntArray:
    """index (m,) of the solutions turned (m, 8, n) by dynamic programming; -1 where none is within limits."""
    m, k = within.shape
    total = np.where(within[0], _first_cost(turned[0], start), np.inf)
    came = np.zeros((m, k), dtype=np.int64)
    last = turned[0]
    for i in range(1, m):
        came[i] = np.arange(k)
        if not within[i].any():
            continue
        if not np.isfinite(total).any():
            total = np.where(within[i], _first_cost(turned[i], start), np.inf)
        else:
            step = ((turned[i][:, None] - last[None]) ** 2).sum(axis=-1) + total
            came[i] = np.argmin(step, axis=1)
            total = np.where(within[i], step[np.arange(k), came[i]], np.inf)
        last = turned[i]
    index = np.full(m, -1)
    current = int(np.argmin(total))
    for i in range(m - 1, -1, -1):
        if within[i, current]:
            index[i] = current
        current = int(came[i, current])
    return index


def _unwrapped(robot: Robot, turned: FloatArray) -> FloatArray:
    """Each solution's angles along the path (m, 8, n) without jumps of a turn, where the limits leave room for it."""
    wide = (robot.limits[:, 1] - robot.limits[:, 0] > 2 * np.pi) & ~robot.chain.prismatic
    result = turned.copy()
    for j in np.flatnonzero(wide):
        smooth = np.unwrap(turned[..., j], axis=0)
        inside = (smooth >= robot.limits[j, 0]) & (smooth <= robot.limits[j, 1])
        result[..., j] = np.where(inside.all(axis=0), smooth, turned[..., j])
    return result
