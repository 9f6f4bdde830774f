"""Forward kinematics and the Jacobian against products of matrices off the table and their differences."""

import numpy as np
import pytest

import robomill as rm
from robomill.errors import KinematicsError
from robomill.kinematics.forward import joint_frames
from robomill.kinematics.jacobian import pose_and_jacobian
from tests.kinematics.oracles import joint_and_tool_frames, numeric_jacobian, pose


def frame(rng):
    Q, _ = np.linalg.qr(rng.normal(size=(3, 3)))
    T = np.eye(4)
    T[:3, :3], T[:3, 3] = Q * np.sign(np.linalg.det(Q)), rng.normal(size=3)
    return T


def arms():
    """Random tables of both conventions with slides, signs, offsets, base, tool and blocked joints."""
    rng = np.random.default_rng(8)
    for k in range(12):
        rows = 2 + k % 6
        blocked = np.full(rows, np.nan)
        if rows > 3:
            blocked[[0, rows - 1] if k % 2 else [1, 2]] = rng.uniform(-0.5, 0.5, 2)
        yield rm.Robot(
            name=f"arm {k}",
            convention=("standard", "modified")[k % 2],
            alpha=rng.uniform(-2, 2, rows),
            a=rng.uniform(-1, 1, rows),
            d=rng.uniform(-1, 1, rows),
            theta_offset=rng.uniform(-2, 2, rows),
            sign=rng.choice([-1.0, 1.0], rows),
            prismatic=rng.random(rows) < 0.4,
            limits_all=np.tile([-3.0, 3.0], (rows, 1)),
            C_theta_all=rng.uniform(1e-7, 1e-6, rows),
            T_base=frame(rng),
            T_tool=frame(rng),
            blocked=blocked,
        )


@pytest.mark.parametrize("robot", [*arms(), *map(rm.load_robot, ("slavkovic_5r", "kuka_kr500", "planar_2r"))], ids=str)
def test_frames_jacobian_and_compliance_of_any_arm(robot):
    theta = np.random.default_rng(1).uniform(-2, 2, (2, 3, robot.n))
    T_MT, J = pose_and_jacobian(robot, theta)
    frames = joint_frames(robot, theta)
    C = rm.cartesian_compliance(robot, theta)
    assert frames.shape == (2, 3, robot.n + 1, 4, 4)
    for index in np.ndindex(2, 3):
        joints, tool = joint_and_tool_frames(robot, theta[index])
        np.testing.assert_allclose(T_MT[index], tool, atol=1e-13)
        np.testing.assert_allclose(rm.tool_pose(robot, theta)[index], tool, atol=1e-13)
        np.testing.assert_allclose(rm.tool_pose(robot, theta[index]), tool, atol=1e-13)
        np.testing.assert_allclose(frames[index][-1], tool, atol=1e-13)
        for i, joint in enumerate(joints):
            # Where along and about its axis a joint's frame is drawn is free; its axis is not.
            np.testing.assert_allclose(frames[index][i][:3, 2], joint[:3, 2], atol=1e-13)
            between = frames[index][i][:3, 3] - joint[:3, 3]
            np.testing.assert_allclose(np.cross(between, joint[:3, 2]), 0.0, atol=1e-13)
            np.testing.assert_array_equal(frames[index][i][3], [0, 0, 0, 1])
        expected = numeric_jacobian(robot, theta[index])
        np.testing.assert_allclose(J[index], expected, atol=2e-8)
        np.testing.assert_allclose(rm.geometric_jacobian(robot, theta[index]), J[index], atol=1e-15)
        J_v = expected[:3]
        np.testing.assert_allclose(C[index], J_v @ np.diag(robot.C_theta) @ J_v.T, atol=1e-12)


def test_what_is_not_a_configuration_is_refused_and_nan_goes_through():
    robot = rm.load_robot("slavkovic_5r")
    for law in (rm.tool_pose, rm.geometric_jacobian, rm.cartesian_compliance):
        with pytest.raises(KinematicsError, match=r"theta of 'slavkovic_5r'.*\(\.\.\., 5\).*\(6,\)"):
            law(robot, np.zeros(6))
        assert law(robot, np.empty((0, 5))).shape[0] == 0
    assert np.isnan(rm.tool_pose(robot, np.full(5, np.nan))[:3]).any()


def test_every_other_row_of_a_table_may_be_asked():
    """A batch that is not in order in memory."""
    robot = rm.load_robot("slavkovic_5r")
    theta = np.random.default_rng(0).uniform(-1, 1, (5, 40)).T[::2]
    for one, T in zip(theta, rm.tool_pose(robot, theta), strict=True):
        np.testing.assert_allclose(T, pose(robot, one), atol=1e-13)
