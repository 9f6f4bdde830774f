"""Closed-form inverse kinematics of the paper's arm."""

import numpy as np
import pytest

import robomill as rm
from robomill.errors import KinematicsError
from robomill.kinematics.result import misfit, task_mode, within_residual


@pytest.fixture(scope="module")
def robot():
    return rm.load_robot("slavkovic_5r")


def test_ik_after_fk_is_the_identity_on_10000_configurations(robot):
    theta = np.random.default_rng(1).uniform(robot.limits[:, 0], robot.limits[:, 1], (10_000, 5))
    T_MT = rm.tool_pose(robot, theta)
    result = rm.inverse_kinematics(robot, T_MT, near=theta)
    assert result.reached.all()
    assert np.abs(result.theta - theta).max() < 1e-7
    assert result.residual.max() <= 1e-9
    assert np.linalg.norm(rm.tool_pose(robot, result.theta)[:, :3, 2] - T_MT[:, :3, 2], axis=1).max() <= 1e-9


def test_batch_equals_loop(robot):
    x_M = np.array([[[0, -1.3, 0, 0, 0], [0.2, -1.1, 0.1, 0.3, -0.2]], [[9, 9, 9, 0, 0], [-0.3, -1.5, -0.3, 0, 0.5]]])
    batch = rm.inverse_kinematics(robot, rm.pose_from_world(x_M))
    for index in np.ndindex(2, 2):
        one = rm.inverse_kinematics(robot, rm.pose_from_world(x_M[index]))
        np.testing.assert_array_equal(one.theta, batch.theta[index])
        assert one.branch == batch.branch[index]
        assert one.reason() == batch.reason(index)


def test_reasons_in_words(robot):
    def reason(*x_M):
        result = rm.inverse_kinematics(robot, rm.pose_from_world(x_M))
        assert not result.reached
        assert np.isnan(result.theta).all()
        return result.reason()

    assert reason(0, -3, 0, 0, 0) == "0.69 m beyond reach"
    assert reason(0, 1.3, 0, 0, 0) == "joint 3 would need −160.0°, 50.0° past its limit of −110.0°"
    assert "too close to the shoulder" in reason(0, 0, -0.3, 0, 0)


def test_branch_by_name_or_part(robot):
    wide = robot.replace(limits=np.tile([-3.2, 3.2], (5, 1)))
    T_MT = rm.pose_from_world([0.1, -1.3, 0.0, 0.1, 0.2])
    up = rm.inverse_kinematics(wide, T_MT)
    down = rm.inverse_kinematics(wide, T_MT, branch="elbow down")
    assert up.branch == "front, elbow up, wrist +"
    assert down.branch.startswith("front, elbow down")
    np.testing.assert_allclose(rm.tool_pose(wide, down.theta)[:3, 3], T_MT[:3, 3], atol=1e-12)
    with pytest.raises(KinematicsError, match="elbow sideways"):
        rm.inverse_kinematics(wide, T_MT, branch="elbow sideways")


def test_poses_that_are_not_numbers_are_refused(robot):
    with pytest.raises(KinematicsError, match="NaN"):
        rm.inverse_kinematics(robot, np.full((4, 4), np.nan))


def test_the_tool_axis_counts_for_five_axes_whatever_the_closed_form_says(robot):
    """A tip at its place under an axis 0.1 mrad off is no answer; a turn about the axis is one."""
    theta = np.deg2rad([[10.0, -20.0, 15.0, 5.0, 30.0]])
    T_MT = rm.tool_pose(robot, theta)
    mode = task_mode(robot)

    def near_enough(T):
        return bool(within_residual(*misfit(robot, theta, T, mode), mode)[0])

    c, s = np.cos(1e-4), np.sin(1e-4)
    leaned, spun = T_MT.copy(), T_MT.copy()
    leaned[0, :3, :3] = T_MT[0, :3, :3] @ np.array([[1, 0, 0], [0, c, -s], [0, s, c]])
    spun[0, :3, :3] = T_MT[0, :3, :3] @ np.array([[c, -s, 0], [s, c, 0], [0, 0, 1]])
    assert (near_enough(T_MT), near_enough(leaned), near_enough(spun)) == (True, False, True)


@pytest.mark.parametrize("aside", [0.3, -0.2])
@pytest.mark.parametrize("share", [0.3, 0.8])
def test_an_arm_that_stands_aside_does_not_reach_what_lies_nearer_to_its_first_axis(robot, aside, share):
    """A vertical tool's wrist centre is 0.3 m above its tip, and no nearer to the axis than the arm stands aside."""
    d = np.array(robot.d)
    d[1] = aside
    T_MT = rm.pose_from_world([0.0, -share * abs(aside), -0.3, 0, 0])
    found = rm.inverse_kinematics(robot.replace(d=d), T_MT)
    missing = (1.0 - share) * abs(aside)
    assert found.reason() == f"{missing:.2f} m inside the arm's lateral offset, too close to axis 1"


def test_a_pose_that_only_another_branch_reaches_says_so(robot):
    there = robot.home + np.array([0.1, 0.2, -0.1, 0.1, 0.2])
    narrow = robot.replace(limits=np.column_stack([there - 0.05, there + 0.05]))
    T_MT = rm.tool_pose(narrow, there)
    assert rm.inverse_kinematics(narrow, T_MT, branch="elbow up").reached
    for branch in ("back", "elbow down", "wrist -"):
        other = rm.inverse_kinematics(narrow, T_MT, branch=branch)
        assert other.reason() == f"only another branch than '{branch}' reaches it"
