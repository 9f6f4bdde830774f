"""The best course of a spin, against every course there is."""

from __future__ import annotations

import itertools

import numpy as np
import pytest

from robomill.improve.spin_course import best_course


def exhaustive(cost: np.ndarray, most: np.ndarray) -> tuple[float, float]:
    """Largest cost and sum of squares of the best of all courses."""
    m, a, b = cost.shape
    best = (np.inf, np.inf)
    for branch in range(b):
        for way in itertools.product(range(a), repeat=m):
            steps = [min((q - p) % a, (p - q) % a) for p, q in itertools.pairwise(way)]
            if any(step > limit for step, limit in zip(steps, most, strict=True)):
                continue
            costs = [cost[i, angle, branch] for i, angle in enumerate(way)]
            best = min(best, (max(costs), sum(c * c for c in costs) + sum((k / a) ** 2 for k in steps)))
    return best


@pytest.mark.parametrize("seed", range(12))
def test_no_other_course_is_better(seed: int) -> None:
    rng = np.random.default_rng(seed)
    m, a, b = 5, 6, 2
    cost = rng.uniform(0.1, 2.0, (m, a, b))
    cost[rng.uniform(size=cost.shape) < 0.2] = np.inf
    most = rng.integers(0, 4, m - 1)
    angle, branch = best_course(cost, most)
    largest, total = exhaustive(cost, most)
    if not np.isfinite(largest):
        assert (angle == -1).all()
        return
    steps = np.minimum((np.diff(angle)) % a, (-np.diff(angle)) % a)
    assert (steps <= most).all()
    assert len({*branch.tolist()}) == 1
    taken = cost[np.arange(m), angle, branch]
    assert taken.max() == largest
    assert (taken**2).sum() + ((steps / a) ** 2).sum() == pytest.approx(total, rel=1e-12)


def test_a_course_that_may_not_turn_is_one_angle() -> None:
    cost = np.random.default_rng(0).uniform(1.0, 2.0, (7, 9, 1))
    angle, _ = best_course(cost, np.zeros(6, dtype=np.int64))
    assert (angle == cost[..., 0].max(axis=0).argmin()).all()


def test_where_no_course_leads_through_there_is_none() -> None:
    """Each stage can be stood at, on one branch or the other, but not one after the other."""
    cost = np.ones((3, 4, 2))
    cost[0, :, 0] = cost[2, :, 1] = np.inf
    for each in best_course(cost, np.full(2, 4)):
        assert each.tolist() == [-1, -1, -1]
