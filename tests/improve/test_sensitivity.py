"""What a stiffer joint buys, against computing the stiffer robot."""

import numpy as np
import pytest

import robomill as rm
from robomill.errors import KinematicsError
from robomill.improve.sensitivity import gain, scaled_shares, stiffened


@pytest.fixture(scope="module")
def point():
    robot = rm.load_robot("slavkovic_5r")
    theta = rm.inverse_kinematics(robot, rm.pose_from_world([0.3, -1.3, 0.1, 0.1, 0.2])).theta
    C_joint = rm.joint_contributions(rm.geometric_jacobian(robot, theta)[:3], robot.C_theta)
    return robot, theta, C_joint


def test_against_the_stiffer_robot(point):
    robot, theta, C_joint = point
    F = np.array([10.0, 100.0, -20.0])
    parts = rm.deflection(C_joint, F)
    saved = gain(parts)
    for joint in range(5):
        factors = np.where(np.arange(5) == joint, 1.1, 1.0)
        C = rm.cartesian_compliance(stiffened(robot, factors), theta)
        left = np.linalg.norm(parts.sum(axis=0)) - saved[joint]
        assert left == pytest.approx(np.linalg.norm(C @ F), abs=1e-15)
        np.testing.assert_allclose(scaled_shares(C_joint, factors, 0).sum(axis=0), C, atol=1e-18)


def test_ranking_names_the_joints_to_blame_at_the_milling_test(point):
    robot, _, _ = point
    theta = rm.inverse_kinematics(robot, rm.pose_from_world([0, -1.3, 0, 0, 0])).theta
    C_joint = rm.joint_contributions(rm.geometric_jacobian(robot, theta)[:3], robot.C_theta)
    parts = rm.deflection(C_joint, [0.0, 100.0, 0.0])[:, 1:2] * [0.0, 1.0, 0.0]
    saved = gain(parts)
    assert list(np.argsort(-saved)[:2]) == [2, 4]
    # Of what goes along Y, 10 % stiffer takes 1 - 1/1.1 of the joint's own share: 0.1473 and 0.0822 mm.
    np.testing.assert_allclose(saved[[2, 4]] * 1e3, (1 - 1 / 1.1) * np.array([0.1473, 0.0822]), atol=1e-5)
    assert saved.sum() / np.linalg.norm(parts.sum(axis=0)) == pytest.approx(1 - 1 / 1.1)


def test_a_place_that_is_not_reached_changes_no_other(point):
    shares = rm.deflection(point[2], [0.0, 100.0, 0.0])
    both = gain(np.stack([shares, np.full_like(shares, np.nan)]))
    np.testing.assert_array_equal(both[0], gain(shares))
    assert np.isnan(both[1]).all()


def test_refusals(point):
    for bad in (0.0, -1.0, np.nan):
        with pytest.raises(KinematicsError, match="above zero|finite"):
            stiffened(point[0], bad)


def test_over_a_path_the_gain_is_that_of_brute_force(point):
    """Each joint stiffened alone, the whole path computed anew; a point that is not reached has no number."""
    robot = point[0]
    x_M = [[x, -1.3 + x / 2, 0.05, 0.1, 0.0] for x in (-0.4, -0.1, 0.2, 0.5)]
    theta = rm.inverse_kinematics(robot, rm.pose_from_world(x_M)).theta
    F = np.array([[100.0, 0, 0], [0, 100.0, 0], [0, 50.0, 50.0], [30.0, 0, -80.0]])

    def sizes(arm):
        return np.linalg.norm(np.einsum("mij,mj->mi", rm.cartesian_compliance(arm, theta), F), axis=1)

    shares = rm.deflection(rm.joint_contributions(rm.geometric_jacobian(robot, theta)[:, :3], robot.C_theta), F)
    with_hole = np.concatenate([shares, np.full((1, 5, 3), np.nan)])
    brute = np.stack(
        [sizes(robot) - sizes(stiffened(robot, np.where(np.arange(5) == j, 1.1, 1.0))) for j in range(5)], axis=1
    )
    found = gain(with_hole)
    np.testing.assert_allclose(found[:4], brute, atol=1e-15)
    assert np.isnan(found[4]).all()


def test_one_number_serves_all_joints_and_a_bad_one_is_refused(point):
    robot, theta, C_joint = point
    np.testing.assert_allclose(stiffened(robot, 2.0).C_theta, robot.C_theta / 2)
    along_joints = np.moveaxis(C_joint, 0, 2)
    np.testing.assert_allclose(
        scaled_shares(along_joints, [1, 2, 4, 5, 10], 2).sum(axis=2),
        rm.cartesian_compliance(stiffened(robot, [1, 2, 4, 5, 10]), theta),
        atol=1e-18,
    )
    for bad in (0.0, -2.0):
        with pytest.raises(KinematicsError, match="above zero"):
            scaled_shares(C_joint, [1, 1, bad, 1, 1], 0)
    for bad in (float("inf"), float("nan")):
        with pytest.raises(KinematicsError, match="finite"):
            scaled_shares(C_joint, [1, 1, bad, 1, 1], 0)
