"""What a stiffer joint buys, against computing the stiffer robot."""

import numpy as np
import pytest

import robomill as rm
from robomill.errors import KinematicsError
from robomill.improve.sensitivity import (
    deflection_sensitivity,
    mean_known,
    scaled_shares,
    stiffened,
)


@pytest.fixture(scope="module")
def point():
    robot = rm.load_robot("slavkovic_5r")
    theta = rm.inverse_kinematics(robot, rm.pose_from_world([0.3, -1.3, 0.1, 0.1, 0.2])).theta
    C_joint = rm.joint_contributions(rm.geometric_jacobian(robot, theta)[:3], robot.C_theta)
    return robot, theta, C_joint


def test_against_the_stiffer_robot(point):
    robot, theta, C_joint = point
    F = np.array([10.0, 100.0, -20.0])
    of_path = deflection_sensitivity(rm.deflection(C_joint, F))
    for joint in range(5):
        factors = np.where(np.arange(5) == joint, 1.1, 1.0)
        C = rm.cartesian_compliance(stiffened(robot, factors), theta)
        assert of_path.before - of_path.gain[joint] == pytest.approx(np.linalg.norm(C @ F), abs=1e-15)
        np.testing.assert_allclose(scaled_shares(C_joint, factors, 0).sum(axis=0), C, atol=1e-18)


def test_ranking_names_the_joints_to_blame_at_the_milling_test(point):
    robot, _, _ = point
    theta = rm.inverse_kinematics(robot, rm.pose_from_world([0, -1.3, 0, 0, 0])).theta
    C_joint = rm.joint_contributions(rm.geometric_jacobian(robot, theta)[:3], robot.C_theta)
    found = deflection_sensitivity(rm.deflection(C_joint, [0.0, 100.0, 0.0])[:, 1:2] * [0.0, 1.0, 0.0])
    assert list(found.ranking[:2]) == [2, 4]
    # Of what goes along Y, 10 % stiffer takes 1 - 1/1.1 of the joint's own share: 0.1473 and 0.0822 mm.
    np.testing.assert_allclose(found.gain[[2, 4]] * 1e3, (1 - 1 / 1.1) * np.array([0.1473, 0.0822]), atol=1e-5)
    assert found.mean.sum() / found.before == pytest.approx(1 - 1 / 1.1)


def test_cells_that_are_not_reached_do_not_count(point):
    shares = rm.deflection(point[2], [0.0, 100.0, 0.0])
    both, one = deflection_sensitivity(np.stack([shares, np.full_like(shares, np.nan)])), deflection_sensitivity(shares)
    np.testing.assert_array_equal(both.ranking, one.ranking)
    assert np.isnan(both.gain[1]).all()


def test_refusals(point):
    for bad in (0.0, -1.0, np.nan):
        with pytest.raises(KinematicsError, match="above zero|finite"):
            stiffened(point[0], bad)


def test_over_a_path_the_ranking_is_by_the_mean_of_brute_force(point):
    """Each joint stiffened alone, the whole path computed anew; unreached points are left out of means and ranking."""
    robot = point[0]
    x_M = [[x, -1.3 + x / 2, 0.05, 0.1, 0.0] for x in (-0.4, -0.1, 0.2, 0.5)]
    theta = rm.inverse_kinematics(robot, rm.pose_from_world(x_M)).theta
    F = np.array([[100.0, 0, 0], [0, 100.0, 0], [0, 50.0, 50.0], [30.0, 0, -80.0]])

    def sizes(arm):
        return np.linalg.norm(np.einsum("mij,mj->mi", rm.cartesian_compliance(arm, theta), F), axis=1)

    shares = rm.deflection(rm.joint_contributions(rm.geometric_jacobian(robot, theta)[:, :3], robot.C_theta), F)
    with_hole = np.concatenate([shares, np.full((1, 5, 3), np.nan)])
    gain = np.stack(
        [sizes(robot) - sizes(stiffened(robot, np.where(np.arange(5) == j, 1.1, 1.0))) for j in range(5)], axis=1
    )
    found = deflection_sensitivity(with_hole)
    np.testing.assert_allclose(found.gain[:4], gain, atol=1e-15)
    np.testing.assert_allclose(found.before[:4], sizes(robot))
    np.testing.assert_array_equal(found.ranking, np.argsort(-gain.mean(axis=0)))
    np.testing.assert_allclose(found.mean, gain.mean(axis=0))
    assert found.joint_numbers == (1, 2, 3, 4, 5)
    nothing = deflection_sensitivity(np.full((3, 5, 3), np.nan))
    np.testing.assert_array_equal(nothing.ranking, range(5))
    assert np.isnan(nothing.mean).all()
    assert deflection_sensitivity(shares, joint_numbers=(2, 3, 4, 5, 6)).joint_numbers == (2, 3, 4, 5, 6)


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


def test_a_mean_is_over_places_where_every_joint_is_known():
    grid = np.array([[[1.0, 2.0, 3.0], [np.nan, 7.0, 7.0]], [[3.0, 4.0, 11.0], [8.0, 8.0, np.nan]]])
    np.testing.assert_array_equal(mean_known(grid), [2.0, 3.0, 7.0])
    np.testing.assert_array_equal(mean_known(grid[0, 0]), grid[0, 0])
    for shape in ((3,), (4, 3), (2, 4, 3)):
        np.testing.assert_array_equal(mean_known(np.full(shape, np.nan)), [np.nan] * 3)
