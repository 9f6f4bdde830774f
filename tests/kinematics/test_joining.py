"""Solutions joined along a path: against every sequence there is, against Dijkstra on lines, one line that flipped."""

from __future__ import annotations

from itertools import product

import numpy as np
import pytest
from scipy.sparse import coo_matrix
from scipy.sparse.csgraph import dijkstra

import robomill as rm
from robomill.kinematics import joining_kernels
from robomill.kinematics.choice import every, overshoot
from robomill.kinematics.decoupled import decoupled
from robomill.kinematics.joining import join
from tests.kinematics.oracles import every_choice

ROBOT = rm.load_robot("slavkovic_5r")
ARM_ORDER = (0, 0, 1, 1, 2, 2, 3, 3)


def easy(T, S):
    """2 degrees a millimetre and twice the turn of the tool axis (5 axes) or of the whole tool (6), by arc cosines."""
    way = np.radians(2.0) / 1e-3 * np.linalg.norm(T[:3, 3] - S[:3, 3])
    axis = np.arctan2(np.linalg.norm(np.cross(T[:3, 2], S[:3, 2])), T[:3, 2] @ S[:3, 2])
    R = T[:3, :3].T @ S[:3, :3]
    sine = np.linalg.norm([R[2, 1] - R[1, 2], R[0, 2] - R[2, 0], R[1, 0] - R[0, 1]])
    return way + 2 * axis, way + 2 * np.arctan2(sine, np.trace(R) - 1)


def step_cost(theta, before, limit):
    turn = np.abs(theta - before)
    return (turn**2).sum() + 1e3 * np.maximum(turn - limit, 0).sum()


def start_cost(theta, k, home):
    return 1e-3 * ((theta - home) ** 2).sum() + 1e-3 * ARM_ORDER[k]


def best_of_all(theta, within, limits, home):
    """The cheapest sequence of solutions, -1 where a pose has none, by trying each; and its cost."""
    choices = [np.flatnonzero(row) if row.any() else [-1] for row in within]
    best, cheapest = None, np.inf
    for sequence in product(*choices):
        last, cost, limit = None, 0.0, 0.0
        for i, k in enumerate(sequence):
            limit += limits[i]
            if k < 0:
                continue
            cost += start_cost(theta[i, k], k, home) if last is None else step_cost(theta[i, k], last, limit)
            last, limit = theta[i, k], 0.0
        if cost < cheapest:
            best, cheapest = sequence, cost
    return list(best), cheapest


@pytest.mark.parametrize("gaps", [(), (0,), (2,), (0, 1, 4), (4,), (1, 2, 3, 4), (0, 1, 2, 3), (0, 1, 2, 3, 4)])
@pytest.mark.parametrize("seed", range(3))
def test_the_cheapest_sequence_of_all_is_taken(gaps, seed):
    rng = np.random.default_rng(seed)
    theta = rng.uniform(-1.0, 1.0, (5, 8, 5))
    possible = rng.random((5, 8)) < 0.5
    possible[list(gaps)] = False
    x_M = np.zeros((5, 5))
    x_M[:, :3] = rng.uniform(-0.02, 0.02, (5, 3))
    x_M[:, 3:] = rng.uniform(-0.2, 0.2, (5, 2))
    T_MT = rm.pose_from_world(x_M)
    limits = [0.0] + [easy(T_MT[i], T_MT[i - 1])[0] for i in range(1, 5)]
    home = rng.choice([-1.5, 1.5], 5)  # in the middle of limits that leave out zero
    robot, theta = ROBOT.replace(limits=np.stack([home - 1.2, home + 1.2], axis=1)), theta + home
    np.testing.assert_array_equal(robot.home, home)
    expected, cost = best_of_all(theta, possible, limits, robot.home)
    found = join(robot, theta.copy(), possible, T_MT, whole=False)
    assert found.branch.tolist() == expected
    assert found.missed == expected.count(-1)
    assert found.cost == pytest.approx(cost, rel=1e-9)
    for i, k in enumerate(expected):
        if k >= 0:
            np.testing.assert_array_equal(found.theta[i], theta[i, k])


def cheapest_way(robot, T_MT):
    """Cost of the shortest way through all solutions with all their turns, by Dijkstra from a point before the path."""
    solutions, sound = every(robot, decoupled(robot), T_MT)
    nodes = [
        [(b, t) for b, t in every_choice(robot, found) if good[b]] for found, good in zip(solutions, sound, strict=True)
    ]
    assert all(nodes), "a line that is reached all along"
    first = np.cumsum([1, *map(len, nodes)])
    rows, columns, costs = [], [], []
    for k, (branch, theta) in enumerate(nodes[0]):
        rows.append(0), columns.append(first[0] + k), costs.append(start_cost(theta, branch, robot.home))
    for i in range(1, len(nodes)):
        limit = easy(T_MT[i], T_MT[i - 1])[robot.n == 6]
        for (q, (_, before)), (k, (_, theta)) in product(enumerate(nodes[i - 1]), enumerate(nodes[i])):
            rows.append(first[i - 1] + q), columns.append(first[i] + k)
            costs.append(step_cost(theta, before, limit) + 1e-300)
    graph = coo_matrix((costs, (rows, columns)), shape=(first[-1], first[-1])).tocsr()
    return float(dijkstra(graph, indices=0)[first[-2] : first[-1]].min())


def cost_of(robot, result):
    theta, T_MT = result.theta, result.T_MT
    names = list(result.branch_names)
    cost = start_cost(theta[0], names.index(result.branch[0]), robot.home)
    for i in range(1, len(theta)):
        cost += step_cost(theta[i], theta[i - 1], easy(T_MT[i], T_MT[i - 1])[robot.n == 6])
    return cost


def random_line(robot, rng, points):
    """Poses of a line whose ends and middle are reached."""
    low, high = ([-1.2, -1.9, -1.0], [1.2, -0.3, 0.8]) if robot.n == 5 else ([0.8, -1.2, 0.0], [2.2, 1.2, 1.6])
    while True:
        ends = np.column_stack([rng.uniform(low, high, (2, 3)), rng.uniform(-0.5, 0.5, (2, 2)) * rng.integers(0, 2)])
        T_MT = rm.pose_from_world(ends[0] + np.linspace(0, 1, points)[:, None] * (ends[1] - ends[0]))
        result = rm.inverse_kinematics(robot, T_MT, near="path", spin="fixed")
        if result.reached.all():
            return result


@pytest.mark.parametrize(("name", "lines", "points"), [("slavkovic_5r", 40, 60), ("kuka_kr500", 8, 25)])
def test_no_way_through_all_branches_and_turns_is_cheaper(name, lines, points):
    robot = rm.load_robot(name)
    rng = np.random.default_rng(9)
    for _ in range(lines):
        result = random_line(robot, rng, points)
        assert cost_of(robot, result) == pytest.approx(cheapest_way(robot, result.T_MT), rel=1e-6, abs=1e-9)


def test_the_line_that_turned_joint_4_by_180_degrees_within_a_millimetre_is_followed_smoothly():
    ends = np.array([[-0.656, -0.339, -0.974, 0, 0], [-0.840, -1.094, -0.888, 0, 0]])
    T_MT = rm.pose_from_world(ends[0] + np.linspace(0, 1, 783)[:, None] * (ends[1] - ends[0]))
    result = rm.inverse_kinematics(ROBOT, T_MT, near="path")
    assert result.reached.all()
    assert np.degrees(np.abs(np.diff(result.theta, axis=0))).max() < 0.1
    # It goes from one wrist to the other where the arm is singular; either wrist alone turns joint 4 by half a turn.
    assert len(set(result.branch)) == 2
    for branch in set(result.branch):
        alone = rm.inverse_kinematics(ROBOT, T_MT, near="path", branch=branch)
        assert np.degrees(np.abs(np.diff(alone.theta, axis=0))).max() > 170


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


@pytest.mark.parametrize(
    ("name", "spin", "whole"),
    [
        *(("slavkovic_5r", spin, False) for spin in ("fixed", "least_motion")),
        *(("fanuc_r2000ic", spin, True) for spin in ("fixed", "least_motion", 0.3)),
        *(("kuka_kr500", spin, spin != "least_motion") for spin in ("fixed", "least_motion", 0.3)),
    ],
)
def test_a_turn_of_the_tool_about_itself_excuses_joints_that_have_to_make_it(name, spin, whole, monkeypatch):
    """Six joints follow the whole pose, at one spin for all of a path; but where the spindle is on the last axis and
    its spin is free that axis stays, and five axes leave the spin open."""
    said = set()

    def noted(robot, theta, possible, T_MT, of_all):
        said.add(of_all)
        return join(robot, theta, possible, T_MT, of_all)

    monkeypatch.setattr("robomill.kinematics.inverse.join", noted)
    robot = rm.load_robot(name)
    theta = robot.home + np.linspace(0.05, 0.1, 4)[:, None]
    assert rm.inverse_kinematics(robot, rm.tool_pose(robot, theta), near="path", spin=spin).reached.any()
    assert said == {whole}


def test_no_kernel_reaches_past_its_arrays(monkeypatch):
    """As the Python they are written in, kernels refuse what compiled code would do beside the arrays it was given."""
    robot = rm.load_robot("kuka_kr500")
    result = random_line(robot, np.random.default_rng(4), 6)
    theta, possible = every(robot, decoupled(robot), result.T_MT)
    compiled = join(robot, theta.copy(), possible, result.T_MT, whole=True)
    for name in ("most_nodes", "go_on", "come_back"):
        monkeypatch.setattr(joining_kernels, name, getattr(joining_kernels, name).plain)
    plain = join(robot, theta.copy(), possible, result.T_MT, whole=True)
    assert plain.branch.tolist() == compiled.branch.tolist()
    assert plain.cost == pytest.approx(compiled.cost, rel=1e-12)
    np.testing.assert_allclose(plain.theta, compiled.theta, rtol=1e-12)
