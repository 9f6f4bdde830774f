"""The virtual laboratory: reproducible, budgeted, scored against a truth that stays hidden."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import robomill as rm
from robomill.errors import LoadTestError
from robomill.identification.laboratory import MAX_LOAD, Laboratory
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


def test_points_are_earned_joint_by_joint():
    """All of a joint's hundred n-th at no error, half at 10 %, none from 40 %, straight lines between."""
    lab = Laboratory(ROBOT)
    error = np.array([0.0, 0.05, 0.10, 0.25, 0.40])
    score = lab.score(lab.reveal() * (1 + error * [1, 1, -1, -1, 1]))
    np.testing.assert_allclose(score.error, error, atol=1e-12)
    assert score.points == pytest.approx(20 * (1.0 + 0.75 + 0.5 + 0.25 + 0.0))
    assert score.grade == "fair"
    assert lab.score(lab.reveal()).grade == "good"
    assert lab.score(lab.reveal() * 2.0).grade == "poor"
    assert score.sentence == "50 of 100 points: joint 5 is 40 % off."
    assert np.isnan(score.covered).all()
    unseen = lab.reveal() * 1.0
    unseen[1] = np.nan
    score = lab.score(unseen)
    assert score.points == pytest.approx(80.0)
    assert score.sentence == "80 of 100 points: joint 2 was not seen."


def test_coverage_is_whether_the_interval_holds_the_truth():
    lab = Laboratory(ROBOT, seed=2, budget=20).measure(*some(20))
    result, truth = lab.fit(), lab.reveal()
    low, high = result.ci95.T
    np.testing.assert_array_equal(lab.score(result).covered, (low <= truth) & (truth <= high))
    for ci, covered in (([truth[0] * 1.01, 1.0], 0.0), ([0.0, truth[0] * 0.99], 0.0), ([truth[0], truth[0]], 1.0)):
        assert lab.score(replace(result, parameter_ci95=np.vstack([ci, result.ci95[1:]]))).covered[0] == covered
    blind = replace(result, parameter_stderr=np.where(np.arange(5) == 3, np.inf, result.parameter_stderr))
    np.testing.assert_array_equal(np.isnan(lab.score(blind).covered), np.arange(5) == 3)


def test_hidden_compliances_scatter_about_a_third_in_logarithm():
    logs = [np.log(Laboratory(ROBOT, seed=k).reveal() / ROBOT.C_theta) for k in range(200)]
    assert np.std(logs) == pytest.approx(0.35, rel=0.08)
    assert np.mean(logs) == pytest.approx(0.0, abs=0.05)
    np.testing.assert_array_equal(Laboratory(ROBOT).reveal(), Laboratory(ROBOT, seed=0).reveal())


def test_readings_are_those_of_the_hidden_robot_by_its_gauge():
    theta, F = some(12)
    lab = Laboratory(ROBOT, seed=4, noise=2e-5, resolution=0.0).measure(theta, F)
    hidden = ROBOT.replace(C_theta=lab.reveal())
    exact = np.einsum("mij,mj->mi", rm.cartesian_compliance(hidden, theta), F)
    off = lab.tests.displacement[:, :3] - exact
    assert off.std() == pytest.approx(2e-5, rel=0.3)
    steps = Laboratory(ROBOT, noise=0.0, resolution=1e-5).measure(theta, F).tests.displacement[:, :3] / 1e-5
    np.testing.assert_allclose(steps, np.round(steps), atol=1e-6)
    default = Laboratory(ROBOT)
    assert (default.noise, default.resolution, default.budget) == (5e-6, 1e-6, 12)
    again = lab.measure(theta[0], [0, 250.0, 0]) if lab.budget else lab
    assert again is lab, "twelve tests use up the budget"


def test_each_measurement_has_noise_of_its_own():
    theta, F = some(1)
    lab = Laboratory(ROBOT, seed=4, budget=2, resolution=0.0).measure(theta, F).measure(theta, F)
    assert len(lab.tests) == 2
    assert lab.budget == 0
    assert not np.array_equal(lab.tests.displacement[0, :3], lab.tests.displacement[1, :3])
    one = Laboratory(ROBOT, seed=4).measure(theta[0], np.tile([0, 250.0, 0], (3, 1)))
    assert one.budget == 9


def test_the_edges_of_what_is_allowed():
    theta, _ = some(1)
    Laboratory(ROBOT).measure(theta[0], [0, 400.0, 0])
    with pytest.raises(LoadTestError, match="hung on"):
        Laboratory(ROBOT).measure(theta[0], [0, 400.001, 0])
    Laboratory(ROBOT, budget=0, noise=0.0, resolution=0.0)
    for bad in ({"budget": -1}, {"noise": -1e-9}, {"resolution": -1e-9}):
        with pytest.raises(LoadTestError, match="negative"):
            Laboratory(ROBOT, **bad)
    both = Laboratory(ROBOT, seed=7).measure_at([[0, -1.3, 0, 0, 0], [0.1, -1.2, 0, 0, 0]], [0, 250.0, 0])
    p = rm.tool_pose(ROBOT, both.tests.theta)[:, :3, 3]
    np.testing.assert_allclose(p, [[0, -1.3, 0], [0.1, -1.2, 0]], atol=1e-9)


def test_the_greatest_load_may_be_hung_on():
    theta, F = some(1)
    assert Laboratory(ROBOT).measure(theta, F * MAX_LOAD / 250.0).budget == 11
    with pytest.raises(LoadTestError, match="more than"):
        Laboratory(ROBOT).measure(theta, F * (MAX_LOAD + 1.0) / 250.0)
