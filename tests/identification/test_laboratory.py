"""The virtual laboratory: reproducible, budgeted, scored against a truth that stays hidden."""

from __future__ import annotations

import numpy as np
import pytest

import robomill as rm
from robomill.errors import LoadTestError
from robomill.identification.laboratory import Laboratory
from robomill.identification.plan import box_candidates, next_best

ROBOT = rm.load_robot("slavkovic_5r")
BOX = np.array([-0.6, -1.6, -0.4]), np.array([0.6, -1.0, 0.1])


def some(count, seed=1):
    candidates = box_candidates(ROBOT, *BOX, poses=count, tilt=np.pi / 4, seed=seed)
    return candidates.theta[::3], np.tile([0.0, 250.0, 0.0], (count, 1))


def test_measuring_costs_budget_and_repeats_itself():
    theta, F = some(4)
    one, two = (Laboratory(ROBOT, seed=7).measure(theta[:2], F[:2]).measure(theta[2:], F[2:]) for _ in range(2))
    assert one.budget == 8
    np.testing.assert_array_equal(one.tests.displacement, two.tests.displacement)
    other = Laboratory(ROBOT, seed=8).measure(theta, F)
    assert not np.array_equal(one.tests.displacement, other.tests.displacement)
    assert Laboratory(ROBOT, seed=7).measure_at([0, -1.3, 0, 0, 0], [0, 250.0, 0]).budget == 11


def test_good_poses_score_better_than_poor_ones():
    lab = Laboratory(ROBOT, seed=3, budget=12)
    theta, F = some(8)
    poor = lab.measure(theta[:1] + np.linspace(0, 0.02, 8)[:, None], F)
    good = lab.measure(theta, F)
    plan = next_best(ROBOT, good.tests, good.fit(), box_candidates(ROBOT, *BOX), count=4)
    planned = good.measure(plan.theta, plan.F)
    assert planned.score(planned.fit()).points > good.score(good.fit()).points - 1.0
    assert planned.score(planned.fit()).points > poor.score(poor.fit()).points + 10
    assert planned.budget == 0
    assert lab.score(lab.reveal()).points == pytest.approx(100.0)


def test_a_single_gauge_sees_one_direction():
    theta, F = some(6)
    lab = Laboratory(ROBOT, seed=3).measure(theta, F, gauges="y")
    assert np.isnan(lab.tests.displacement[:, [0, 2]]).all()
    assert lab.fit().equations == 6
    with pytest.raises(LoadTestError, match="no displacement"):
        Laboratory(ROBOT).measure(theta, F, gauges="")


def test_the_truth_is_covered_and_not_the_known_robot():
    hits = []
    for seed in range(12):
        lab = Laboratory(ROBOT, seed=seed, budget=30).measure(*some(30))
        assert not np.allclose(lab.reveal(), ROBOT.C_theta)
        hits.append(lab.score(lab.fit()).covered)
    assert np.nanmean(hits) > 0.85
    assert "_truth" not in repr(lab)


def test_refusals():
    lab = Laboratory(ROBOT, budget=1)
    theta, F = some(2)
    with pytest.raises(LoadTestError, match="1 left in the budget"):
        lab.measure(theta, F)
    with pytest.raises(LoadTestError, match="hung on"):
        lab.measure(theta[0], [0, 900.0, 0])
    with pytest.raises(LoadTestError, match="not reached"):
        lab.measure_at([0, -9.0, 0, 0, 0], [0, 100.0, 0])
    with pytest.raises(LoadTestError, match="nothing measured"):
        lab.fit()
    with pytest.raises(LoadTestError, match="limits"):
        lab.measure(np.full(5, 3.1), [0, 100.0, 0])
    with pytest.raises(LoadTestError, match="negative"):
        Laboratory(ROBOT, noise=-1.0)
