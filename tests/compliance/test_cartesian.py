"""C against its definition by matrices, springs against twisting each joint by hand, energy and reciprocity."""

import numpy as np
import pytest

import robomill as rm
from robomill.compliance.cartesian import full_compliance, pose_jacobian_compliance
from robomill.compliance.deflection import deflection, soft_direction
from robomill.errors import KinematicsError
from tests.kinematics.oracles import numeric_jacobian, pose

NAMES = ("slavkovic_5r", "kuka_kr500", "planar_3r")


@pytest.mark.parametrize("name", NAMES)
def test_blocks_of_j_c_j_transposed(name):
    robot = rm.load_robot(name)
    theta = np.random.default_rng(0).uniform(-1, 1, (2, 3, robot.n))
    C_X, C = full_compliance(robot, theta), rm.cartesian_compliance(robot, theta)
    T_MT, J, again = pose_jacobian_compliance(robot, theta)
    np.testing.assert_array_equal(again, C)
    for index in np.ndindex(2, 3):
        expected = numeric_jacobian(robot, theta[index])
        whole = sum(c * np.outer(column, column) for c, column in zip(robot.C_theta, expected.T, strict=True))
        np.testing.assert_allclose(C_X[index], whole, atol=1e-12)
        np.testing.assert_allclose(C[index], whole[:3, :3], atol=1e-12)
        np.testing.assert_allclose(T_MT[index], pose(robot, theta[index]), atol=1e-13)
        np.testing.assert_allclose(J[index], expected, atol=2e-8)


@pytest.mark.parametrize("name", NAMES)
def test_a_force_twists_each_joint_by_its_torque_and_the_arm_follows(name):
    robot = rm.load_robot(name)
    rng = np.random.default_rng(1)
    theta, F = rng.uniform(-1, 1, robot.n), rng.normal(size=3)
    J_v = rm.geometric_jacobian(robot, theta)[:3]
    shares = deflection(rm.joint_contributions(J_v, robot.C_theta), F)
    torques = J_v.T @ F
    for i in range(robot.n):
        # The torque is the work of the force in a small turn of the joint.
        step = 1e-6 * np.eye(robot.n)[i]
        slope = (pose(robot, theta + step) - pose(robot, theta - step))[:3, 3] / 2e-6
        assert torques[i] == pytest.approx(slope @ F, abs=1e-8)
        # Each joint turned by C tau (enlarged, for the digits), forward kinematics again.
        turn = 1e-3 * robot.C_theta[i] * torques[i] / max(robot.C_theta.max(), 1e-12)
        moved = (pose(robot, theta + turn * np.eye(robot.n)[i]) - pose(robot, theta - turn * np.eye(robot.n)[i]))[:3, 3]
        np.testing.assert_allclose(shares[i] * 1e-3 / robot.C_theta.max(), 0.5 * moved, atol=1e-8)
    # Energy: the work of the force is what the springs take up; and reciprocity.
    C = rm.cartesian_compliance(robot, theta)
    assert F @ shares.sum(axis=0) == pytest.approx((robot.C_theta * torques**2).sum())
    np.testing.assert_allclose(shares.sum(axis=0), C @ F, atol=1e-18)
    G = rng.normal(size=3)
    assert G @ C @ F == pytest.approx(F @ C @ G)


def test_contributions_of_many_at_once():
    rng = np.random.default_rng(2)
    J_v, C_theta, F = rng.normal(size=(4, 2, 3, 5)), rng.random(5), rng.normal(size=(2, 3))
    C_joint = rm.joint_contributions(J_v, C_theta)
    for shape in ((4, 2, 5), (2, 5), (4, 1, 5), (1, 5)):
        each = rm.joint_contributions(J_v, np.broadcast_to(C_theta, shape))
        np.testing.assert_array_equal(each, C_joint)
    np.testing.assert_array_equal(
        rm.joint_contributions(J_v[0, 0], np.broadcast_to(C_theta, (4, 2, 5)))[3, 1], C_joint[0, 0]
    )
    assert C_joint.shape == (4, 2, 5, 3, 3)
    delta = deflection(C_joint, F)
    for index in np.ndindex(4, 2):
        for i in range(5):
            column = J_v[index][:, i]
            np.testing.assert_allclose(C_joint[index][i], C_theta[i] * np.outer(column, column))
            np.testing.assert_allclose(delta[index][i], C_theta[i] * column * (column @ F[index[1]]))


def test_the_softest_direction_is_the_last():
    C = np.array([[4.0, 1.0, 0.0], [1.0, 3.0, 0.5], [0.0, 0.5, 2.0]])
    skew = np.array([[0, 1.0, 2.0], [-1.0, 0, 3.0], [-2.0, -3.0, 0]])
    values, axes = soft_direction(C + 1e-9 * skew)  # what is not symmetric is rounding and counts for nothing
    np.testing.assert_allclose(values, np.sort(np.roots(np.poly(C))), atol=1e-9)
    assert values[2] == values.max()
    np.testing.assert_allclose(C @ axes, axes * values, atol=1e-9)
    for each in soft_direction([C + 0.1 * skew, C.T - skew])[0]:
        np.testing.assert_allclose(each, values, atol=1e-8)


@pytest.mark.parametrize(
    ("law", "arguments", "sentence"),
    [
        (rm.joint_contributions, (np.zeros((6, 5)), np.zeros(5)), "J_v: expected shape"),
        (rm.joint_contributions, (np.zeros((3, 5)), np.zeros(4)), "C_theta: expected shape"),
        (rm.joint_contributions, (np.zeros((3, 5)), np.full(5, np.nan)), "C_theta: expected finite numbers"),
        (deflection, (np.zeros((5, 3, 2)), np.zeros(3)), "C_joint: expected shape"),
        (deflection, (np.zeros((5, 3, 3)), np.zeros(2)), "F: expected shape"),
        (soft_direction, (np.zeros((2, 2)),), "C: expected shape"),
    ],
)
def test_refusals(law, arguments, sentence):
    with pytest.raises(KinematicsError, match=sentence):
        law(*arguments)


def test_what_is_not_reached_stays_nan():
    nan = np.full((2, 3, 5), np.nan)
    assert np.isnan(rm.joint_contributions(nan, np.ones(5))).all()
    assert np.isnan(deflection(np.full((5, 3, 3), np.nan), np.ones(3))).all()
    assert np.isnan(deflection(np.ones((5, 3, 3)), np.full(3, np.nan))).all(), "nor is a force that is not known"
