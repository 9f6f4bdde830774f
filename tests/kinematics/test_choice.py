"""Solutions joined along a path: against every sequence there is, and across the whole turn of a wide joint."""

from __future__ import annotations

from itertools import product

import numpy as np
import pytest

import robomill as rm
from robomill.kinematics.choice import join_path, overshoot, path_score, settle

ROBOT = rm.load_robot("slavkovic_5r")
ARM_ORDER = (0, 0, 1, 1, 2, 2, 3, 3)


def start_cost(theta, k, home):
    return 1e-3 * ((theta - home) ** 2).sum() + 1e-3 * ARM_ORDER[k]


def best_of_all(theta, within, home):
    """The cheapest sequence of solutions, -1 where a pose has none, by trying each; and its cost."""
    choices = [np.flatnonzero(row) if row.any() else [-1] for row in within]
    best, cheapest = None, np.inf
    for sequence in product(*choices):
        last, cost = None, 0.0
        for i, k in enumerate(sequence):
            if k < 0:
                continue
            cost += start_cost(theta[i, k], k, home) if last is None else ((theta[i, k] - last) ** 2).sum()
            last = theta[i, k]
        if cost < cheapest:
            best, cheapest = sequence, cost
    return list(best), cheapest


@pytest.mark.parametrize("gaps", [(), (0,), (2,), (0, 1, 4), (4,)])
@pytest.mark.parametrize("seed", range(3))
def test_the_cheapest_sequence_of_all_is_taken(gaps, seed):
    rng = np.random.default_rng(seed)
    theta = rng.uniform(-1.0, 1.0, (5, 8, 5))
    possible = rng.random((5, 8)) < 0.5
    for k in range(8):  # no branch serves the whole path
        possible[rng.choice([i for i in range(5) if i not in gaps]), k] = False
    possible[list(gaps)] = False
    expected, _ = best_of_all(theta, possible, ROBOT.home)
    found, index = join_path(ROBOT, theta, possible, ROBOT.home)
    assert index.tolist() == expected
    for i, k in enumerate(expected):
        if k >= 0:
            np.testing.assert_array_equal(found[i], theta[i, k])


@pytest.mark.parametrize("seed", range(5))
def test_a_branch_that_serves_the_whole_path_is_kept_and_of_several_the_one_that_moves_least(seed):
    rng = np.random.default_rng(seed)
    theta = rng.uniform(-1.0, 1.0, (6, 8, 5))
    possible = rng.random((6, 8)) < 0.6
    possible[:, [2, 5, 7]] = True
    possible[3] = False
    cost = {
        k: start_cost(theta[0, k], k, ROBOT.home)
        + sum(((theta[i, k] - theta[i - 1, k]) ** 2).sum() for i in range(1, 6))
        for k in range(8)
        if possible[[0, 1, 2, 4, 5], k].all()
    }
    best = min(cost, key=cost.get)
    _, index = join_path(ROBOT, theta, possible, ROBOT.home)
    assert index.tolist() == [best, best, best, -1, best, best]
    nowhere, missed, motion = path_score(ROBOT, theta, possible, ROBOT.home)
    assert (nowhere, missed) == (1, 1)
    assert motion == pytest.approx(cost[best])


@pytest.mark.parametrize(("joint", "turns"), [(3, 1), (5, 1), (5, -1)])
def test_a_joint_with_more_than_a_turn_goes_on_through_half_a_turn(joint, turns):
    robot = rm.load_robot("kuka_kr500")
    s = np.linspace(0.0, 1.0, 60)[:, None]
    theta = robot.home + s * np.array([0.3, -0.2, 0.2, 0.0, 0.1, 0.0])
    theta[:, 4] = 0.8 + 0.1 * s[:, 0]
    theta[:, joint] = turns * np.radians(150.0 + 100.0 * s[:, 0])
    result = rm.inverse_kinematics(robot, rm.tool_pose(robot, theta), near="path", spin="fixed")
    assert result.reached.all()
    assert np.abs(np.diff(result.theta, axis=0)).max() < 0.1
    moved = result.theta - theta
    np.testing.assert_allclose(moved, np.round(moved / (2 * np.pi)) * 2 * np.pi, atol=1e-6)
    assert (result.theta >= robot.limits[:, 0]).all()
    assert (result.theta <= robot.limits[:, 1]).all()


@pytest.mark.parametrize("branch", ["wrist -", "wrist +", "elbow down", "front, elbow up, wrist -"])
def test_a_path_keeps_to_the_branch_that_is_asked_for(branch):
    robot = rm.load_robot("kuka_kr500").replace(limits=np.tile([-6.0, 6.0], (6, 1)))
    x_M = np.array([1.6, -0.4, 0.6, 0.3, 0.2]) + np.linspace(0, 1, 30)[:, None] * [0.2, 0.3, 0.1, 0.2, 0.1]
    result = rm.inverse_kinematics(robot, rm.pose_from_world(x_M), near="path", branch=branch, spin="fixed")
    assert result.reached.all()
    for name, theta, x in zip(result.branch, result.theta, x_M, strict=True):
        assert set(branch.split(", ")) <= set(name.split(", "))
        np.testing.assert_allclose(rm.tool_pose(robot, theta)[:3, 3], x[:3], atol=1e-9)


def test_a_joint_without_a_whole_turn_stays_within_its_limits():
    robot = rm.load_robot("slavkovic_5r")
    theta = np.tile(robot.home, (40, 1))
    theta[:, 4] = 0.7
    theta[:, 3] = np.linspace(
        np.radians(150.0), np.radians(210.0), 40
    )  # limits at 180 degrees: another wrist or a turn
    result = rm.inverse_kinematics(robot, rm.tool_pose(robot, theta), near="path")
    assert (np.abs(overshoot(robot, result.theta[result.reached])) == 0).all()


def test_past_a_limit_by_how_much_and_on_which_side():
    low, high = ROBOT.limits.T
    np.testing.assert_array_equal(overshoot(ROBOT, 0.5 * (low + high)), 0.0)
    np.testing.assert_allclose(overshoot(ROBOT, high + 0.1), 0.1)
    np.testing.assert_allclose(overshoot(ROBOT, low - 0.2), -0.2)
    corner = np.array([high[0], high[1], low[2], 1.0, low[4]])  # joint 4 turns as far as its turn is long
    slightly, within = settle(ROBOT, corner + np.array([1, 1, -1, 0, -1]) * 1e-13, ROBOT.home)
    assert within
    np.testing.assert_array_equal(slightly, corner)
    beyond, within = settle(ROBOT, ROBOT.home + (high - ROBOT.home) * np.array([0, 1.5, 0, 0, 0]), ROBOT.home)
    assert not within
    assert beyond[1] > high[1]
