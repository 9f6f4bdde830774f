"""Which solution is taken: spin, continuity along a path, home, arms with fewer axes."""

import numpy as np
import pytest

import robomill as rm
from robomill.errors import KinematicsError
from robomill.kinematics.choice import SPIN_STEPS
from robomill.kinematics.decoupled import branch_names
from robomill.kinematics.transforms import rotation_z, transform


def _box(robot, count=200):
    rng = np.random.default_rng(0)
    x_M = rng.uniform([1.4, -0.5, 0.2, -0.3, -0.3], [2.0, 0.5, 1.0, 0.3, 0.3], (count, 5))
    return rm.pose_from_world(x_M)


@pytest.mark.parametrize("name", ["kuka_kr500", "fanuc_r2000ic"])
def test_free_spin_keeps_tip_and_axis_and_moves_least(name):
    robot = rm.load_robot(name)
    T_MT = _box(robot)
    free = rm.inverse_kinematics(robot, T_MT)
    assert free.reached.all()
    found = rm.tool_pose(robot, free.theta)
    np.testing.assert_allclose(found[:, :3, 2:], T_MT[:, :3, 2:], atol=1e-9)
    motion = ((free.theta - robot.home) ** 2).sum(axis=1)
    for angle in np.radians([0, 40, 123, 250]):
        fixed = rm.inverse_kinematics(robot, T_MT, spin=angle)
        both = fixed.reached & [a[:8] == b[:8] for a, b in zip(fixed.branch, free.branch, strict=True)]
        assert (((fixed.theta[both] - robot.home) ** 2).sum(axis=1) >= motion[both] - 1e-3).all()


def test_fixed_and_given_spin_are_whole_poses():
    robot = rm.load_robot("fanuc_r2000ic")
    T_MT = _box(robot, 50)
    fixed = rm.inverse_kinematics(robot, T_MT, spin="fixed")
    np.testing.assert_allclose(rm.tool_pose(robot, fixed.theta[fixed.reached]), T_MT[fixed.reached], atol=1e-9)
    turned = rm.inverse_kinematics(robot, T_MT, spin=0.5)
    expected = T_MT @ transform(rotation_z(0.5), np.zeros(3))
    np.testing.assert_allclose(rm.tool_pose(robot, turned.theta[turned.reached]), expected[turned.reached], atol=1e-9)


@pytest.mark.parametrize("name", ["slavkovic_5r", "kuka_kr500", "fanuc_r2000ic"])
def test_a_path_is_followed_without_jumps(name):
    robot = rm.load_robot(name)
    s = np.linspace(0, 1, 200)
    start = [-0.4, -1.3, 0.0, 0.0, 0.0] if name == "slavkovic_5r" else [1.6, -0.4, 0.6, 0.0, 0.0]
    x_M = np.array(start) + s[:, None] * [0.8, 0.1, 0, 0.2, 0.1] + np.sin(7 * s)[:, None] * [0, 0.05, 0.05, 0.2, 0.2]
    result = rm.inverse_kinematics(robot, rm.pose_from_world(x_M), near="path")
    assert result.reached.all()
    assert np.abs(np.diff(result.theta, axis=0)).max() < 0.1
    assert len(set(result.branch)) == 1
    if result.spin is not None:
        assert np.ptp(result.spin) == 0


def test_a_path_with_a_gap_goes_on_after_it():
    robot = rm.load_robot("slavkovic_5r")
    x_M = np.zeros((60, 5))
    x_M[:, 1] = np.linspace(-1.3, -3.5, 60)
    x_M = np.concatenate([x_M, x_M[::-1]])
    result = rm.inverse_kinematics(robot, rm.pose_from_world(x_M), near="path")
    assert result.reached[0]
    assert result.reached[-1]
    assert 0 < (~result.reached).sum() < 120
    np.testing.assert_allclose(result.theta[0], result.theta[-1], atol=1e-9)


def test_near_takes_the_solution_asked_for():
    robot = rm.load_robot("kuka_kr500")
    theta = np.random.default_rng(2).uniform(robot.limits[:, 0], robot.limits[:, 1], (300, 6))
    result = rm.inverse_kinematics(robot, rm.tool_pose(robot, theta), near=theta, spin="fixed")
    assert result.reached.all()
    assert np.abs(result.theta - theta).max() < 1e-6


@pytest.mark.parametrize("name", ["planar_2r", "planar_3r"])
def test_planar_arms_reach_points_of_their_plane(name):
    robot = rm.load_robot(name)
    x_M = np.zeros((40, 5))
    x_M[:, :2] = np.random.default_rng(0).uniform([0.3, 0.1], [0.5, 0.6], (40, 2))
    result = rm.inverse_kinematics(robot, rm.pose_from_world(x_M))
    assert result.reached.all()
    np.testing.assert_allclose(rm.tool_pose(robot, result.theta)[:, :3, 3], x_M[:, :3], atol=1e-9)
    x_M[:, 2] = 0.05
    above = rm.inverse_kinematics(robot, rm.pose_from_world(x_M))
    assert not above.reached.any()
    assert "50.000 mm" in above.reason(0)


def test_six_axis_reasons():
    robot = rm.load_robot("kuka_kr500")
    far = rm.inverse_kinematics(robot, rm.pose_from_world([5.0, 0, 0.5, 0, 0]))
    assert "beyond reach" in far.reason()
    behind = rm.inverse_kinematics(
        robot.replace(limits=np.tile([-0.4, 0.4], (6, 1))), rm.pose_from_world([-2, 0, 1, 0, 0])
    )
    assert "past its limit" in behind.reason()


def test_refusals():
    robot = rm.load_robot("slavkovic_5r")
    T_MT = rm.pose_from_world([0, -1.3, 0, 0, 0])
    with pytest.raises(KinematicsError, match="spin"):
        rm.inverse_kinematics(robot, T_MT, spin="any")
    with pytest.raises(KinematicsError, match="'path'"):
        rm.inverse_kinematics(robot, T_MT, near="path")
    with pytest.raises(KinematicsError, match="named branches"):
        rm.inverse_kinematics(rm.load_robot("planar_2r"), T_MT, branch="elbow up")
    with pytest.raises(KinematicsError, match="one entry a free joint"):
        rm.tool_pose(robot, np.zeros(6))


@pytest.mark.parametrize("steps", [0, 1, 7, -5])
def test_along_a_path_the_tool_is_turned_back_to_where_the_joints_need_not_move(steps):
    """Poses around home, told as if the tool had been turned about its axis by some of the steps that are tried."""
    robot = rm.load_robot("fanuc_r2000ic")
    theta = robot.home + np.linspace(0.0, 0.02, 9)[:, None] * [1.0, -0.5, 0.5, 0.3, 0.7, -0.4]
    turned = steps * 2.0 * np.pi / SPIN_STEPS
    T_MT = rm.tool_pose(robot, theta) @ transform(rotation_z(-turned), np.zeros(3))
    result = rm.inverse_kinematics(robot, T_MT, near="path")
    np.testing.assert_allclose(result.theta, theta, atol=1e-8)
    np.testing.assert_allclose(np.exp(1j * result.spin), np.exp(1j * turned), atol=1e-12)


@pytest.mark.parametrize(("name", "held"), [("slavkovic_5r", False), ("kuka_kr500", True), ("fanuc_r2000ic", False)])
def test_the_joint_that_hinders_is_told_by_the_stand_that_is_least_past_its_limits(name, held):
    """Of every branch (and of every spin, 10 degrees apart): whichever joint is furthest past its limits there."""
    wide, narrow = (
        robot.replace(limits=np.column_stack([robot.home - reach, robot.home + reach]))
        for robot in [rm.load_robot(name)]
        for reach in (np.pi, 0.25)
    )
    rng = np.random.default_rng(7)
    theta = wide.home + rng.uniform(-0.6, 0.6, (12, wide.n)) + 0.1
    poses = rm.tool_pose(wide, theta)
    for T_MT in poses:
        result = rm.inverse_kinematics(narrow, T_MT)
        if bool(result.reached):
            continue
        spins = np.radians(np.arange(0.0, 360.0, 10.0)) if wide.n == 6 else [0.0]
        turned = np.array([T_MT @ transform(rotation_z(angle), np.zeros(3)) for angle in spins])
        least, needed = np.inf, None
        for branch in branch_names():
            every = np.array(rm.inverse_kinematics(wide, turned, branch=branch, spin="fixed").theta)
            if held:
                every[:, 5] = wide.home[5]
            past = np.abs(every - wide.home) - 0.25
            for stand, over in zip(every, past, strict=True):
                if over.max() < least:
                    least, needed = over.max(), (int(np.argmax(over)), stand)
        joint, stand = needed
        limit = narrow.limits[joint, int(stand[joint] > wide.home[joint])]
        shown = [f"{np.degrees(value):.1f}".replace("-", "\N{MINUS SIGN}") for value in (stand[joint], least, limit)]
        unit = "\N{DEGREE SIGN}"
        assert result.reason() == (
            f"joint {joint + 1} would need {shown[0]}{unit}, {shown[1]}{unit} past its limit of {shown[2]}{unit}"
        )
