"""Haste and singular passages along a path: against the axes of the arm and joints moved by hand."""

from dataclasses import replace

import numpy as np
import pytest
from random_arms import seven
from scipy.spatial.transform import Rotation

import robomill as rm
from robomill.kinematics.dexterity import determinant, near_singular
from robomill.kinematics.forward import joint_frames
from robomill.kinematics.steadiness import Passage, hasty_turns, passages
from robomill.units import format_si

ROBOT = rm.load_robot("slavkovic_5r")


def line(start, end, points, **asked):
    x_M = np.array(start) + np.linspace(0, 1, points)[:, None] * (np.array(end) - start)
    return rm.inverse_kinematics(ROBOT, rm.pose_from_world(x_M), near="path", **asked)


FLIP = ([-0.656, -0.339, -0.974, 0, 0], [-0.840, -1.094, -0.888, 0, 0], 783)


def test_a_wrist_that_flips_is_one_haste_with_its_joint_place_and_rate():
    result = line(*FLIP, branch="wrist -")
    turn = np.abs(np.diff(result.theta, axis=0))
    step, joint = np.unravel_index(turn.argmax(), turn.shape)
    way = np.linalg.norm(result.T_MT[step + 1, :3, 3] - result.T_MT[step, :3, 3])
    (haste,) = hasty_turns(result)
    assert (haste.first, haste.last, haste.worst, haste.joint) == (step + 1, step + 1, step + 1, joint + 1)
    assert haste.turn == pytest.approx(np.pi, abs=1e-6)
    assert haste.way == pytest.approx(way)
    assert haste.rate == pytest.approx(turn[step, joint] / way)


def test_the_speed_of_a_joint_is_said_where_the_feed_is_known():
    (haste,) = hasty_turns(line(*FLIP, branch="wrist -"))
    assert haste.sentence() == haste.sentence(0.0) == haste.sentence(float("nan"))
    assert format_si(haste.rate * 0.02, "deg/s") in haste.sentence(0.02)
    assert haste.sentence(0.02).replace(f" ({format_si(haste.rate * 0.02, 'deg/s')} at the feed there)", "") == (
        haste.sentence()
    )


def test_the_smooth_way_has_no_haste_but_says_that_it_passes_a_singular_wrist():
    result = line(*FLIP)
    assert hasty_turns(result) == []
    # Axis 4 stands along the tool there: the sine of the angle between them changes its sign.
    axis_4 = joint_frames(ROBOT, result.theta)[:, 3, :3, 2]
    lean = axis_4[:, :2] @ (result.T_MT[-1, :2, 3] - result.T_MT[0, :2, 3])
    (expected,) = np.flatnonzero(lean[1:] * lean[:-1] < 0) + 1
    (passage,) = passages(result)
    assert passage.at == expected
    assert {passage.before, passage.after} == {"front, elbow up, wrist +", "front, elbow up, wrist -"}


def test_a_way_through_the_papers_box_says_nothing():
    result = line([-0.6, -1.6, -0.4, 0, 0], [0.6, -1.0, 0.1, 0.2, -0.2], 200)
    assert hasty_turns(result) == []
    assert passages(result) == []


def test_a_tool_turned_on_the_spot_may_turn_the_joints():
    """Without any length only what goes beyond twice the tool's own turn is haste."""
    result = line([0.1, -1.3, 0, -0.3, 0.2], [0.1, -1.3, 0, 0.3, 0.2], 50)
    assert hasty_turns(result) == []
    # A tilt swept past a wrist that is nearly straight.
    near = rm.tool_pose(ROBOT, np.array([0.0, -0.3, 0.2, 0.02, 0.1]))
    centre = rm.world_from_pose(near)
    swing = np.array([0, 0, 0, 0.3, 0])
    sweep = line(centre - swing, centre + swing, 400)
    turn, tool = np.abs(np.diff(sweep.theta, axis=0)), 0.6 / 399
    fast = (turn > 2 * tool + 1e-6).any(axis=0)
    assert {haste.joint for haste in hasty_turns(sweep)} == set(np.flatnonzero(fast) + 1)
    assert all(np.isinf(haste.rate) for haste in hasty_turns(sweep))


def test_an_arm_of_seven_joints_that_turns_the_tool_about_itself_as_told_has_no_haste():
    """Every joint turns by less than twice what the tool does; nothing is singular there."""
    robot = seven()
    T_MT = rm.pose_from_world([0.45, 0.1, 0.25, 0, 0])
    spun = np.tile(T_MT, (11, 1, 1))
    spun[:, :3, :3] = T_MT[:3, :3] @ Rotation.from_rotvec(np.linspace(0, 0.5, 11)[:, None] * [0, 0, 1.0]).as_matrix()
    result = rm.inverse_kinematics(robot, spun, near="path", spin="fixed")
    assert result.reached.all()
    assert np.abs(np.diff(result.theta, axis=0)).max() < 2 * 0.05
    assert hasty_turns(result) == []


def test_nothing_is_said_across_a_gap():
    result = line([0, -1.5, 0, 0, 0], [0, -3.0, 0, 0, 0], 300)
    assert not result.reached.all()
    assert hasty_turns(result) == []


def test_joints_of_a_planar_arm_near_its_stretch_run_away():
    """Two links nearly in line: theta_2 = acos((r^2 - l1^2 - l2^2) / (2 l1 l2)) turns without bound at r = l1 + l2."""
    robot = rm.load_robot("planar_2r")
    r = np.linspace(0.85, 0.9 - 1e-7, 51)
    T_MT = rm.pose_from_world(np.column_stack([r, np.zeros((51, 4))]))
    found = hasty_turns(rm.inverse_kinematics(robot, T_MT, near="path"))
    theta_2 = np.arccos((r**2 - 0.41) / 0.4)
    fast = np.abs(np.diff(theta_2)) > np.radians(2.0) * np.diff(r) / 1e-3
    assert fast.any()
    assert [haste for haste in found if haste.joint == 2]
    (haste,) = [haste for haste in found if haste.joint == 2]
    assert haste.first == np.flatnonzero(fast)[0] + 1
    assert haste.last == 50
    assert haste.turn == pytest.approx(np.abs(np.diff(theta_2))[fast].sum(), rel=1e-6)


def test_an_arm_that_nowhere_can_do_its_task_passes_nothing_by_rounding():
    """Three slides and two turns, the second about the tool itself: its sixth part of a motion is nobody's."""
    h = np.pi / 2
    robot = rm.Robot(
        name="gantry",
        convention="modified",
        alpha=np.array([0, -h, -h, 0, -h]),
        a=np.zeros(5),
        d=np.zeros(5),
        theta_offset=np.array([0, -h, -h, 0, 0]),
        prismatic=np.array([True, True, True, False, False]),
        limits_all=np.array([[-2, 2], [-2, 2], [-2, 2], [-3.1, 3.1], [-3.1, 3.1]], dtype=float),
        C_theta_all=np.full(5, 1e-7),
    )
    theta = np.random.default_rng(0).uniform(-1, 1, (60, 5))
    for q in theta[:5]:
        moved = [rm.tool_pose(robot, q + side * step)[:3, 2:] for step in 1e-6 * np.eye(5) for side in (1, -1)]
        slopes = np.reshape(moved, (5, 2, 6)) / 2e-6
        assert np.linalg.matrix_rank(slopes[:, 0] - slopes[:, 1], tol=1e-6) == 4, (
            "one motion of tip and axis is missing"
        )
    assert passages(rm.inverse_kinematics(robot, rm.tool_pose(robot, theta), near="path")) == []
    assert near_singular(robot, determinant(robot, theta)).all()


def test_standing_still_is_no_haste():
    """The same pose again and again, alone or at the ends of a way: nothing turns, and nothing is said of it."""
    here, there = [0.1, -1.3, 0, -0.3, 0.2], [0.2, -1.3, 0, -0.3, 0.2]
    assert hasty_turns(line(here, here, 5)) == []
    x_M = np.vstack([np.tile(here, (3, 1)), np.linspace(here, there, 20), np.tile(there, (3, 1))])
    assert hasty_turns(rm.inverse_kinematics(ROBOT, rm.pose_from_world(x_M), near="path")) == []


def test_a_passage_is_told_with_the_branches_it_leads_between():
    assert "from 'front' to 'back'" in Passage(3, "front", "back").sentence()
    assert " from " not in Passage(3, "front", "front").sentence()


@pytest.mark.parametrize(
    ("robot", "free_spin"),
    [
        (rm.load_robot("kuka_kr500"), False),
        (rm.load_robot("kuka_kr500"), True),
        (ROBOT, False),
        (seven(), False),
        (seven(), True),
    ],
    ids=["six", "six, free", "five", "seven", "seven, free"],
)
@pytest.mark.parametrize("seed", range(3))
def test_runs_of_haste_are_those_of_a_loop_over_steps_and_joints(robot, free_spin, seed):
    """Poses and joints drawn apart from each other. A turn of the tool about itself is asked of the joints where six
    axes or seven follow the whole pose; it explains nothing where its spin is free, nor with five axes."""
    m = 40
    rng = np.random.default_rng(seed)
    T_MT = np.tile(np.eye(4), (m, 1, 1))
    way = rng.choice([0.0, 0.5e-3, 1e-3], m)
    T_MT[:, :3, 3] = np.outer(np.cumsum(way), [0.6, 0.0, -0.8])
    spin, lean = np.cumsum(np.radians(rng.choice([0.0, 1.5], m))), np.cumsum(np.radians(rng.choice([0.0, 0.5], m)))
    T_MT[:, :3, :3] = (
        Rotation.from_rotvec(np.outer(lean, [1.0, 0, 0])) * Rotation.from_rotvec(np.outer(spin, [0, 0, 1.0]))
    ).as_matrix()
    steps = rng.choice([0.1, 0.9, 2.5, 4.0], (m, robot.n), p=[0.5, 0.2, 0.2, 0.1]) + rng.uniform(
        0.0, 0.05, (m, robot.n)
    )
    theta = robot.home + np.cumsum(np.radians(steps), axis=0)
    theta[25] = np.nan
    result = rm.inverse_kinematics(robot, rm.tool_pose(robot, np.tile(robot.home, (m, 1))))
    result = replace(result, theta=theta, T_MT=T_MT, free_spin=free_spin)
    expected = []
    for j in range(robot.n):
        run = []
        for i in range(1, m + 1):
            fast = False
            if i < m and np.isfinite(theta[[i - 1, i]]).all():
                if robot.n >= 6 and not free_spin:
                    turned = Rotation.from_matrix(T_MT[i, :3, :3].T @ T_MT[i - 1, :3, :3]).magnitude()
                else:
                    turned = np.arccos(np.clip(T_MT[i, :3, 2] @ T_MT[i - 1, :3, 2], -1.0, 1.0))
                fast = abs(theta[i, j] - theta[i - 1, j]) > np.radians(2.0) * way[i] / 1e-3 + 2.0 * turned + 1e-6
            if fast:
                run.append(i)
            elif run:
                turns = [abs(theta[k, j] - theta[k - 1, j]) for k in run]
                rates = [turn / way[k] if way[k] else np.inf for turn, k in zip(turns, run, strict=True)]
                k = int(np.argmax(rates))
                expected.append((run[0], run[-1], j + 1, sum(turns), sum(way[run]), run[k], rates[k]))
                run = []
    expected.sort(key=lambda each: (each[0], each[2]))
    found = [(h.first, h.last, h.joint, h.turn, h.way, h.worst, h.rate) for h in hasty_turns(result)]
    assert len(found) > 10
    np.testing.assert_allclose(found, expected, rtol=1e-6, atol=1e-12)
