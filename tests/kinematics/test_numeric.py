"""Numerical inverse kinematics: its errors and Jacobians against the rotation vector and finite differences, limits."""

from itertools import pairwise

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

import robomill as rm
from robomill.kinematics import numeric
from robomill.kinematics.jacobian import pose_and_jacobian
from tests.telling import told


def twisted_arm(limits):
    """Six joints whose last three axes do not meet: no closed form."""
    return rm.Robot(
        name="twisted",
        convention="standard",
        alpha=np.array([1.3, 0.2, 1.1, -1.4, 1.2, 0.3]),
        a=np.array([0.15, 0.6, 0.1, 0.08, 0.12, 0.05]),
        d=np.array([0.5, 0.1, 0.15, 0.55, 0.1, 0.2]),
        theta_offset=np.zeros(6),
        sign=np.array([1.0, -1.0, 1.0, 1.0, -1.0, 1.0]),
        prismatic=np.zeros(6, dtype=bool),
        limits_all=np.tile(limits, (6, 1)),
        C_theta_all=np.full(6, 1e-6),
        T_base=np.eye(4),
        T_tool=np.eye(4),
        blocked=np.full(6, np.nan),
    )


@pytest.fixture(scope="module")
def arm():
    return twisted_arm([-2.8, 2.8])


def configurations(arm, m, seed=4):
    return np.random.default_rng(seed).uniform(*(0.8 * arm.limits.T), (m, arm.n))


def test_the_error_of_a_pose_is_the_rotation_vector_of_the_turn_left(arm):
    theta, goal = configurations(arm, 40), configurations(arm, 40, 5)
    pose, J = pose_and_jacobian(arm, theta)
    T_MT = rm.tool_pose(arm, goal)
    e, jacobian = numeric._task(pose, J, T_MT, "pose")
    turn = Rotation.from_matrix(T_MT[:, :3, :3] @ pose[:, :3, :3].transpose(0, 2, 1)).as_rotvec()
    np.testing.assert_allclose(e[:, :3], T_MT[:, :3, 3] - pose[:, :3, 3], atol=1e-15)
    np.testing.assert_allclose(e[:, 3:], turn, atol=1e-9)
    np.testing.assert_array_equal(jacobian, J)


def test_the_error_of_an_axis_is_the_turn_that_brings_it_home(arm):
    theta, goal = configurations(arm, 40), configurations(arm, 40, 5)
    pose, J = pose_and_jacobian(arm, theta)
    T_MT = rm.tool_pose(arm, goal)
    e, _ = numeric._task(pose, J, T_MT, "axis")
    for i in range(len(theta)):
        R, z, wanted = pose[i, :3, :3], pose[i, :3, 2], T_MT[i, :3, 2]
        turn = Rotation.from_rotvec(R[:, :2] @ e[i, 3:])
        np.testing.assert_allclose(turn.apply(z), wanted, atol=1e-9)
        assert np.linalg.norm(e[i, 3:]) == pytest.approx(np.arccos(np.clip(z @ wanted, -1, 1)), abs=1e-7)


@pytest.mark.parametrize("mode", ["position", "axis", "pose"])
def test_the_jacobian_of_a_task_is_how_its_error_falls(arm, mode):
    theta = configurations(arm, 12)
    pose, J = pose_and_jacobian(arm, theta)
    e, jacobian = numeric._task(pose, J, pose, mode)
    np.testing.assert_allclose(e, 0.0, atol=1e-12)
    step = 1e-6
    for j in range(arm.n):
        moved = theta.copy()
        moved[:, j] += step
        after, _ = numeric._task(rm.tool_pose(arm, moved), J, pose, mode)
        np.testing.assert_allclose(-after / step, jacobian[:, :, j], atol=5e-6)


@pytest.mark.parametrize("spin", ["fixed", "least_motion"])
def test_poses_of_an_arm_without_a_closed_form_are_found_and_met(arm, spin):
    theta = configurations(arm, 60)
    T_MT = rm.tool_pose(arm, theta)
    found = rm.inverse_kinematics(arm, T_MT, spin=spin)
    assert found.reached.mean() > 0.95
    met = rm.tool_pose(arm, found.theta[found.reached])
    wanted = T_MT[found.reached]
    np.testing.assert_allclose(met[:, :3, 2:], wanted[:, :3, 2:], atol=2e-9)
    turned = np.abs(met[:, :3, 0] - wanted[:, :3, 0]).max(axis=1)
    assert (turned < 2e-9).all() if spin == "fixed" else (turned > 1e-3).mean() > 0.5
    assert (found.theta[found.reached] >= arm.limits[:, 0]).all()
    assert (found.theta[found.reached] <= arm.limits[:, 1]).all()


def test_a_joint_pressed_against_its_limit_lets_the_others_do_the_work():
    """Started with joints on their limits and told to leave them no further, the descent still arrives."""
    narrow = twisted_arm([-0.9, 0.9])
    rng = np.random.default_rng(8)
    goal = rng.uniform(-0.85, 0.85, (200, 6))
    for side in (-0.9, 0.9):
        start = np.clip(goal + rng.normal(0.0, 0.25, goal.shape), -0.9, 0.9)
        pressed = rng.integers(0, 6, len(goal))
        start[np.arange(len(goal)), pressed] = side
        theta, error = numeric.descend(narrow, rm.tool_pose(narrow, goal), start, "pose")
        assert (error <= numeric.TIGHT).mean() > 0.75
        assert (np.abs(theta) <= 0.9).all()
    # A goal that needs a joint past its limit, unless the other joints get there another way: no joint leaves its
    # limits, and what is left is never further than it was at the start.
    beyond = goal[:40].copy()
    beyond[:, 0] = 1.4
    T_MT, start = rm.tool_pose(narrow, beyond), np.clip(beyond, -0.9, 0.9)
    theta, error = numeric.descend(narrow, T_MT, start, "position")
    miss, missed = (T_MT[:, :3, 3] - rm.tool_pose(narrow, t)[:, :3, 3] for t in (theta, start))
    np.testing.assert_allclose(error, np.abs(miss).max(axis=1), atol=1e-12)
    assert (np.linalg.norm(miss, axis=1) <= np.linalg.norm(missed, axis=1) + 1e-12).all()
    assert (np.abs(theta) <= 0.9).all()
    assert (error > 0.01).any()
    assert (error < numeric.TIGHT).any()


def test_a_small_arm_takes_the_solution_nearest_to_where_it_stood():
    """A planar arm of two links: elbow up and elbow down both reach; the side it stood on is kept."""
    planar = rm.Robot(
        name="planar",
        convention="standard",
        alpha=np.zeros(2),
        a=np.array([0.6, 0.5]),
        d=np.zeros(2),
        theta_offset=np.zeros(2),
        sign=np.ones(2),
        prismatic=np.zeros(2, dtype=bool),
        limits_all=np.tile([-3.0, 3.0], (2, 1)),
        C_theta_all=np.full(2, 1e-6),
        T_base=np.eye(4),
        T_tool=np.eye(4),
        blocked=np.full(2, np.nan),
    )
    for bend in (0.9, -0.9):
        theta = np.array([[0.3, bend], [0.8, bend / 2], [-0.4, 1.5 * bend]])
        found = rm.inverse_kinematics(planar, rm.tool_pose(planar, theta), near=theta + 0.1 * np.sign(bend))
        np.testing.assert_allclose(found.theta, theta, atol=1e-8)


@pytest.mark.parametrize("block", [1, 3, 4, 64])
def test_poses_in_blocks_are_solved_as_they_are_at_once(monkeypatch, block):
    """Ten poses, each from a start of its own or all from one."""
    robot = rm.load_robot("planar_3r")
    rng = np.random.default_rng(6)
    theta = rng.uniform([-0.8, -0.3, -0.3], [0.8, 1.3, 1.3], (10, 3))
    T_MT, starts = rm.tool_pose(robot, theta), theta + rng.uniform(-0.3, 0.3, (10, 3))
    for near in (starts, starts[:1]):
        monkeypatch.setattr(numeric, "BLOCK", 512)
        known, found = numeric.solve_numerically(robot, T_MT, near, "position")
        assert found.all()
        np.testing.assert_allclose(rm.tool_pose(robot, known)[:, :3, 3], T_MT[:, :3, 3], atol=1e-7)
        monkeypatch.setattr(numeric, "BLOCK", block)
        parts, met = numeric.solve_numerically(robot, T_MT, near, "position")
        np.testing.assert_allclose(parts, known, atol=1e-9)
        assert met.all()


def test_a_straight_arm_starts_bent_in_every_joint_but_the_first():
    """By as much, to the side that counts +, as far as the limits let it."""
    free = twisted_arm([-2.8, 2.8])
    bend = np.array([0.0, *[numeric.BEND] * 5])
    np.testing.assert_allclose(numeric.bent_home(free), free.home + bend)
    tight = twisted_arm([-2.8, 0.25])
    np.testing.assert_allclose(numeric.bent_home(tight), np.minimum(tight.home + bend, 0.25))


@pytest.mark.parametrize("reached", [True, False])
def test_a_descent_ends_where_it_has_arrived_or_is_stuck(arm, monkeypatch, reached):
    """How often each pose was looked at: no more after it was met, and no more once six steps have not halved what is
    left, as when a joint stands at its limit."""
    theta = configurations(arm, 30)
    T_MT = rm.tool_pose(arm, theta)
    if not reached:
        T_MT[:, :3, 3] *= 3.0  # beyond what the arm can stretch to
    looked = []

    def look(pose, J, goal, mode):
        e, jacobian = task(pose, J, goal, mode)
        looked.append((goal[:, 0, 3].copy(), np.abs(e).max(axis=1)))
        return e, jacobian

    task = numeric._task
    monkeypatch.setattr(numeric, "_task", look)
    _, error = numeric.descend(arm, T_MT, theta + 0.15, "position")
    assert (error <= numeric.TIGHT).all() == reached
    for x in T_MT[:, 0, 3]:
        left = [float(size[row == x][0]) for row, size in looked if (row == x).any()]
        assert all(size > numeric.TIGHT for size in left[:-1])
        checks = left[:: numeric.PATIENCE]
        assert all(b < 0.5 * a for a, b in pairwise(checks[:-1]))
        assert len(left) <= numeric.STEPS if not reached else left[-1] <= numeric.TIGHT


@pytest.mark.parametrize("height", [0.0, 0.35])
def test_no_place_that_an_arm_reaches_is_ruled_out_beforehand(height):
    """Arms of three joints that turn or slide, at every mixture of their limits; what lies beyond all links in a line,
    or off the plane of an arm that cannot leave it, is ruled out."""
    rng, base = np.random.default_rng(9), np.eye(4)
    base[2, 3] = height
    for slides in ([0, 0, 0], [0, 1, 0], [1, 1, 1], [0, 0, 1]):
        planar = not any(slides)
        mixed = rm.Robot(
            name="mixed",
            convention="standard",
            alpha=np.array([0.0, 0.0, 0.0] if planar else [1.2, -0.7, 0.4]),
            a=np.array([0.5, 0.4, 0.2]),
            d=np.zeros(3) if planar else np.array([0.3, 1.5, 0.8]),
            theta_offset=np.array([0.2, -0.4, 0.1]),
            sign=np.array([1.0, -1.0, 1.0]),
            prismatic=np.array(slides, dtype=bool),
            limits_all=np.array([[-1.0, 2.0], [-2.0, 1.1], [-0.6, 0.9]]),
            C_theta_all=np.full(3, 1e-6),
            T_base=base,
            T_tool=np.eye(4),
            blocked=np.full(3, np.nan),
        )
        corners = np.stack(np.meshgrid(*mixed.limits), axis=-1).reshape(-1, 3)
        T_MT = rm.tool_pose(mixed, np.vstack([corners, rng.uniform(*mixed.limits.T, (100, 3))]))
        assert numeric._within_stretch(mixed, T_MT).all()
        beyond = T_MT.copy()
        beyond[:, 0, 3] += 20.0
        assert not numeric._within_stretch(mixed, beyond).any()
        above = T_MT.copy()
        above[:, 2, 3] += 1e-3
        assert numeric._within_stretch(mixed, above)[8:].any() != planar


def test_a_path_that_is_solved_pose_by_pose_tells_how_far_it_is(arm):
    theta = configurations(arm, 1) + np.linspace(0.0, 0.1, 9)[:, None]
    T_MT = rm.tool_pose(arm, theta)
    (shares,) = told(lambda: rm.inverse_kinematics(arm, T_MT, near="path", spin="fixed")).values()
    np.testing.assert_allclose(shares, np.array([0, 1, 2, 4, 8]) / 9)  # twice as many at once, as far as that leads


@pytest.mark.parametrize("mode", ["pose", "axis"])
def test_a_pose_that_is_met_or_cannot_be_is_given_no_further_start(arm, monkeypatch, mode):
    """Every further start is one of a pose that no descent before has met and that lies within the arm's stretch."""
    T_MT, calls = rm.tool_pose(arm, configurations(arm, 12)), []
    T_MT[:3, :3, 3] += 20.0

    def descend(robot, goal, start, mode):
        theta, error = descended(robot, goal, start, mode)
        calls.append((goal[:, 0, 3].copy(), error.copy()))
        return theta, error

    descended = numeric.descend
    monkeypatch.setattr(numeric, "descend", descend)
    _, found = numeric.solve_numerically(arm, T_MT, numeric.bent_home(arm)[None], mode)
    np.testing.assert_array_equal(found, np.arange(12) > 2)
    left = dict(zip(*calls[0], strict=True))
    for x, error in calls[1:]:
        open_ = [place for place in T_MT[3:, 0, 3] if left[place] > numeric.TIGHT]
        np.testing.assert_array_equal(x, open_)
        left |= {place: min(left[place], now) for place, now in zip(x, error, strict=True)}
    assert len(calls) > 1


@pytest.mark.parametrize("mode", ["position", "axis", "pose"])
def test_starts_are_those_that_miss_a_pose_by_least_in_what_counts_of_it(arm, mode):
    """Against measuring every configuration that is known: a metre counts as much as directions 2 apart."""
    T_MT = rm.tool_pose(arm, configurations(arm, 4))
    _, known = numeric._library(arm, mode)
    there = rm.tool_pose(arm, known)
    columns = {"position": [], "axis": [2], "pose": [0, 1, 2]}[mode]
    for T, starts in zip(T_MT, numeric._starts(arm, T_MT, mode), strict=True):
        miss = ((there[:, :3, 3] - T[:3, 3]) ** 2).sum(axis=1)
        for c in columns:
            miss += ((there[:, :3, c] - T[:3, c]) ** 2).sum(axis=1) / 4
        least = known[np.argsort(miss)[: len(starts)]]
        np.testing.assert_array_equal(starts, least)


@pytest.mark.parametrize("missed", [(), (0, 1, 2), (4,), (5, 6, 7, 8, 9, 10), range(6, 24), range(24)])
def test_a_walk_past_poses_that_are_not_reached_goes_on_from_the_last_one_that_was(arm, missed):
    """Pose by pose, each from the last one that was found: so it is however many are tried at once behind a gap."""
    way = numeric.bent_home(arm) + np.linspace(0.0, 1.0, 24)[:, None] * [0.5, -0.4, 0.3, 0.2, -0.3, 0.4]
    T_MT, missed = rm.tool_pose(arm, way), list(missed)
    T_MT[missed, :3, 3] *= 1.15 * numeric.stretch(arm) / np.linalg.norm(T_MT[missed, :3, 3], axis=1, keepdims=True)
    T_MT[missed[::2], :3, 3] *= 0.85  # within the arm's length, if hardly so
    near, alone, found = numeric.bent_home(arm)[None], np.empty((24, 6)), np.empty(24, dtype=bool)
    for i in range(24):
        alone[i], found[i] = (each[0] for each in numeric.solve_numerically(arm, T_MT[[i]], near, "pose"))
        near = alone[[i]] if found[i] else near
    walked = rm.inverse_kinematics(arm, T_MT, near="path", spin="fixed")
    np.testing.assert_array_equal(walked.reached, found)
    assert not found[missed].all() or not missed
    assert found[np.setdiff1d(np.arange(24), missed)].all()
    np.testing.assert_allclose(walked.theta[found], alone[found], atol=1e-9)


def test_starts_that_are_tried_together_are_taken_in_their_order(arm, monkeypatch):
    """The first that arrives is taken, not one behind it: as if they were tried one after the other."""
    T_MT = rm.tool_pose(arm, configurations(arm, 12, 8))
    near = np.full((1, 6), 2.2)
    together = numeric.solve_numerically(arm, T_MT, near, "axis")
    monkeypatch.setattr(numeric, "TOGETHER", 1)
    alone = numeric.solve_numerically(arm, T_MT, near, "axis")
    assert alone[1].any()
    np.testing.assert_array_equal(together[1], alone[1])
    np.testing.assert_allclose(together[0][alone[1]], alone[0][alone[1]], atol=1e-9)


def test_a_pose_that_is_not_reached_is_given_up_in_few_descents(arm, monkeypatch):
    T_MT = rm.tool_pose(arm, configurations(arm, 1))
    T_MT[:, :3, 3] *= 0.97 * numeric.stretch(arm) / np.linalg.norm(T_MT[:, :3, 3])
    sizes, descend = [], numeric.descend
    monkeypatch.setattr(numeric, "descend", lambda *given: sizes.append(len(given[1])) or descend(*given))
    _, found = numeric.solve_numerically(arm, T_MT, numeric.bent_home(arm)[None], "pose")
    assert not found.any()
    assert sizes == [1, 1, numeric.STARTS - 1]


@pytest.mark.parametrize("jump", [None, 7, 12])
def test_poses_that_are_sought_at_once_are_those_found_one_after_the_other(arm, jump):
    """Also where a path leaps, and the solution that is near to one end of it is not near to the other."""
    way = 0.3 * configurations(arm, 1) + np.linspace(0.0, 1.0, 20)[:, None] * [0.6, 0.5, -0.7, 0.9, -0.8, 0.6]
    if jump is not None:
        way[jump:] += [0.9, -0.7, 0.8, -1.0, 0.9, 1.2]
    T_MT, near = rm.tool_pose(arm, way), way[:1] + 0.01
    alone = []
    for T in T_MT:
        theta, error = numeric.descend(arm, T[None], alone[-1] if alone else near, "pose")
        if error[0] > numeric.TIGHT:
            break
        alone.append(theta)
    found = numeric.followed(arm, T_MT, near, "pose")
    assert len(found) == 20 if jump is None else 0 < len(found) <= len(alone)
    np.testing.assert_allclose(found, np.concatenate(alone)[: len(found)], atol=1e-7)


def test_an_arm_with_a_joint_to_spare_is_led_pose_by_pose(arm):
    """What it does with that hangs on where it comes from."""
    way = numeric.bent_home(arm) + np.linspace(0.0, 0.4, 6)[:, None]
    assert len(numeric.followed(arm, rm.tool_pose(arm, way), way[:1], "axis")) == 1
