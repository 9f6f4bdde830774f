"""Which of the solutions to take: limits, nearness, continuity along a path, spin about the tool axis."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from robomill.arrays import BoolArray, FloatArray, IntArray
from robomill.kinematics.result import LIMIT_SLACK, overshoot, wrap
from robomill.robot.model import Robot

# Order in which shoulder and elbow are tried: as at home, other elbow, other shoulder, both.
ARM_ORDER = np.array([0, 0, 1, 1, 2, 2, 3, 3])
ARM_WEIGHT = 1e6  # rad^2: far above any joint motion
SPIN_STEPS = 24
SPIN_HALVINGS = 7

Solver = Callable[[FloatArray], tuple[FloatArray, BoolArray]]


def choose(
    robot: Robot, every: FloatArray, possible: BoolArray, goal: FloatArray, arm_first: bool
) -> tuple[FloatArray, IntArray, FloatArray]:
    """(theta (m, n), index (m,), cost (m,)): of the solutions every (m, 8, n) within limits, the nearest to ``goal``.

    Nearness is the sum of squared joint motions. With ``arm_first`` the order of shoulder and elbow goes before it.
    index -1 and infinite cost where none is within limits.
    """
    turned, within = settle(robot, every, goal)
    cost = ((turned - goal) ** 2).sum(axis=-1)
    if arm_first:
        cost = cost + ARM_WEIGHT * ARM_ORDER
    cost = np.where(within & possible, cost, np.inf)
    index = np.argmin(cost, axis=-1)
    best = np.take_along_axis(turned, index[:, None, None], axis=1)[:, 0]
    least = np.take_along_axis(cost, index[:, None], axis=1)[:, 0]
    return best, np.where(np.isfinite(least), index, -1), least


def settle(robot: Robot, theta: FloatArray, near: FloatArray) -> tuple[FloatArray, BoolArray]:
    """(theta (..., n), within (...,)): angles turned towards ``near`` and, within rounding, put inside the limits."""
    turned = wrap(theta, robot.limits, near)
    within: BoolArray = np.all(np.abs(overshoot(robot, turned)) <= LIMIT_SLACK, axis=-1)
    clipped = np.clip(turned, robot.limits[:, 0], robot.limits[:, 1])
    return np.where(np.expand_dims(within, -1), clipped, turned), within


def choose_spin(
    robot: Robot, solve: Solver, T_MT: FloatArray, goal: FloatArray, wanted: BoolArray, arm_first: bool
) -> tuple[FloatArray, IntArray, FloatArray]:
    """(theta (m, n), index (m,), spin (m,)): of all spins about the tool axis, the one with the least joint motion.

    Searched in steps of 15 degrees, then refined by halving the step to about 0.1 degrees.
    """
    m = len(T_MT)
    theta, index = np.zeros((m, robot.n)), np.full(m, -1)
    cost, spin = np.full(m, np.inf), np.zeros(m)

    def attempt(angle: FloatArray) -> None:
        every, possible = solve(spun(T_MT, angle))
        found, which, price = choose(robot, every, possible & wanted, goal, arm_first)
        better = price < cost
        theta[better], index[better], cost[better], spin[better] = (
            found[better],
            which[better],
            price[better],
            angle[better],
        )

    step = 2 * np.pi / SPIN_STEPS
    for i in range(SPIN_STEPS):
        attempt(np.full(m, i * step))
    for _ in range(SPIN_HALVINGS):
        step /= 2
        centre = spin.copy()
        attempt(centre + step)
        attempt(centre - step)
    return theta, index, spin


def spun(T_MT: FloatArray, angle: FloatArray | float) -> FloatArray:
    """Poses (m, 4, 4) turned about their own z axis by ``angle`` (m,) rad."""
    c, s = np.cos(angle), np.sin(angle)
    if np.ndim(c):
        c, s = np.asarray(c)[:, None], np.asarray(s)[:, None]
    result = np.array(T_MT)
    result[..., 0] = c * T_MT[..., 0] + s * T_MT[..., 1]
    result[..., 1] = c * T_MT[..., 1] - s * T_MT[..., 0]
    return result


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
