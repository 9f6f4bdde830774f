"""Which solution is taken: spin, continuity along a path, home, arms with fewer axes."""

import numpy as np
import pytest
from random_arms import seven

import robomill as rm
from robomill.errors import KinematicsError
from robomill.kinematics.choice import SPIN_STEPS
from robomill.kinematics.decoupled import branch_names
from robomill.kinematics.transforms import rotation_z, transform
from tests.identification.cables import as_robot, ur_like


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


@pytest.mark.parametrize("spin", [0.5, -1.0, 0.0])
def test_a_given_spin_turns_the_tool_of_seven_joints_and_is_nothing_to_five(spin):
    robot = seven()
    T_MT = rm.pose_from_world([0.45, 0.1, 0.25, 0, 0])
    found = rm.inverse_kinematics(robot, T_MT, spin=spin)
    expected = T_MT @ transform(rotation_z(spin), np.zeros(3))
    np.testing.assert_allclose(rm.tool_pose(robot, found.theta), expected, atol=1e-9)
    np.testing.assert_allclose(found.T_MT, expected, atol=1e-15)
    assert found.spin == spin
    five = rm.load_robot("slavkovic_5r")
    there = rm.pose_from_world([0.1, -1.3, 0.0, 0.1, 0.2])
    asked = rm.inverse_kinematics(five, there, spin=spin)
    np.testing.assert_array_equal(asked.T_MT, there)
    np.testing.assert_array_equal(asked.theta, rm.inverse_kinematics(five, there).theta)
    assert asked.spin is None


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


@pytest.mark.parametrize("pieces", [1, 3, 7, 20])
def test_poses_in_pieces_are_as_one_by_one(monkeypatch, pieces):
    """Whatever pieces the work is done in, each pose has its own goal, or the one that is for all."""
    robot = rm.load_robot("kuka_kr500")
    theta = robot.home + np.random.default_rng(3).uniform(-0.5, 0.5, (20, 6))
    T_MT, near = rm.tool_pose(robot, theta), theta[::-1] + 0.1
    alone = [rm.inverse_kinematics(robot, T, near=goal, spin="fixed") for T, goal in zip(T_MT, near, strict=True)]
    home = [rm.inverse_kinematics(robot, T, spin="fixed") for T in T_MT]
    walked = rm.inverse_kinematics(robot, T_MT, near="path", spin="fixed")

    def cut(count, stage, most=None):
        yield from (slice(at, min(at + pieces, count)) for at in range(0, count, pieces))

    for module in ("choice", "joining", "result"):
        monkeypatch.setattr(f"robomill.kinematics.{module}.slices", cut)
    for found, expected in (
        (rm.inverse_kinematics(robot, T_MT, near=near, spin="fixed"), alone),
        (rm.inverse_kinematics(robot, T_MT, spin="fixed"), home),
    ):
        np.testing.assert_array_equal(found.theta, [each.theta for each in expected])
        np.testing.assert_array_equal(found.residual, [each.residual for each in expected])
        assert list(found.branch) == [each.branch for each in expected]
    again = rm.inverse_kinematics(robot, T_MT, near="path", spin="fixed")
    np.testing.assert_array_equal(again.theta, walked.theta)
    np.testing.assert_array_equal(again.residual, walked.residual)


@pytest.mark.parametrize("way", [[0.4, 1.0, 0.4, 0.2, -0.2], [0.3, 1.8, -0.2, 0.3, 0.3], [0.9, 0.3, 0.1, 0.6, 0.4]])
def test_a_long_path_is_turned_as_its_whole_way_asks_and_not_its_beginning(way):
    """Every spin walked by itself: the one that is taken misses no pose and has the least joint motion between the 205
    poses that are compared, with a thousandth of the squared way from home to the first."""
    robot = rm.load_robot("fanuc_r2000ic")
    x_M = np.array([1.5, -0.9, 0.4, 0.2, 0.1]) + np.linspace(0, 1, 410)[:, None] * way
    T_MT = rm.pose_from_world(x_M)
    cost = {}
    for angle in 2.0 * np.pi / SPIN_STEPS * np.arange(SPIN_STEPS):
        walked = rm.inverse_kinematics(robot, T_MT, near="path", spin=float(angle))
        if walked.reached.all():
            steps = np.diff(walked.theta[::2], axis=0)
            cost[float(angle)] = (steps**2).sum() + 1e-3 * ((walked.theta[0] - robot.home) ** 2).sum()
    assert len(cost) < SPIN_STEPS
    taken = rm.inverse_kinematics(robot, T_MT, near="path").spin
    assert np.ptp(taken) == 0.0
    assert cost[float(taken[0])] <= 1.01 * min(cost.values())
    assert max(cost.values()) > 1.2 * min(cost.values())


@pytest.mark.parametrize("arm", [seven(), as_robot(ur_like(), "ur_like")])
def test_an_arm_without_closed_form_keeps_one_turn_about_the_tool_on_a_whole_path(arm):
    """Round a square: how far the tool's x axis is turned from that of each pose, by forward kinematics."""
    start = rm.tool_pose(arm, np.array([0.3, -0.7, 0.6, -1.1, 0.8, 0.9, 0.2])[: arm.n])
    square = 0.03 * np.array([[0, 0, 0], [1, 0, 0], [2, 0, 0], [2, 1, 0], [2, 2, 0], [1, 2, 0], [0, 2, 0], [0, 1, 0]])
    T_MT = np.array([start @ transform(np.eye(3), p) for p in square])
    found = rm.inverse_kinematics(arm, T_MT, near="path")
    assert found.reached.all()
    stands = rm.tool_pose(arm, found.theta)
    np.testing.assert_allclose(stands[:, :3, [2, 3]], T_MT[:, :3, [2, 3]], atol=1e-8)
    x = np.einsum("mji,mj->mi", T_MT[:, :3, :3], stands[:, :3, 0])
    turned = np.arctan2(x[:, 1], x[:, 0])
    np.testing.assert_allclose(np.exp(1j * turned), np.exp(1j * turned[0]), atol=1e-8)
    np.testing.assert_allclose(np.exp(1j * found.spin), np.exp(1j * turned), atol=1e-8)
