"""The best course of a spin along a path: dynamic programming over angles and branches, with a bound on its rate."""

import numpy as np

from robomill.arrays import FloatArray, IntArray


def best_course(cost: FloatArray, most: IntArray) -> tuple[IntArray, IntArray]:
    """Angle and branch (m,) by stage: of all courses the one whose largest cost is least, and of these the one with the
    least sum of squared costs and steps.

    cost (m, a, b) of m stages at a angles round the circle and b branches, infinite where there is no standing. From
    one stage to the next the branch stays and the angle changes by at most ``most`` (m - 1,) steps. Both are -1 where
    no course leads through.
    """
    limit = _least_largest(cost, most)
    if not np.isfinite(limit):
        return np.full(len(cost), -1), np.full(len(cost), -1)
    return _least_sum(np.where(cost <= limit * (1.0 + 1e-12), cost, np.inf) ** 2, most)


def _steps(count: int, most: int) -> range:
    """Steps round a circle of ``count`` angles, the smallest first."""
    return range(-min(most, (count - 1) // 2), min(most, count // 2) + 1)


def _least_largest(cost: FloatArray, most: IntArray) -> float:
    """The largest cost on the way of which it is least."""
    value = cost[0]
    for i in range(1, len(cost)):
        before = np.minimum.reduce([np.roll(value, k, axis=0) for k in _steps(cost.shape[1], int(most[i - 1]))])
        value = np.maximum(cost[i], before)
    return float(value.min())


def _least_sum(cost: FloatArray, most: IntArray) -> tuple[IntArray, IntArray]:
    """The way of the least sum of costs, and of squared steps as shares of a turn."""
    m, a, b = cost.shape
    value, came = cost[0], np.zeros((m, a, b), dtype=np.int64)
    for i in range(1, m):
        steps = np.array(_steps(a, int(most[i - 1])))
        every = np.stack([np.roll(value, k, axis=0) + (k / a) ** 2 for k in steps])
        came[i] = steps[every.argmin(axis=0)]
        value = cost[i] + every.min(axis=0)
    angle, branch = np.zeros(m, dtype=np.int64), np.zeros(m, dtype=np.int64)
    angle[-1], branch[:] = np.unravel_index(int(value.argmin()), (a, b))
    for i in range(m - 1, 0, -1):
        angle[i - 1] = (angle[i] - came[i, angle[i], branch[i]]) % a
    return angle, branch
