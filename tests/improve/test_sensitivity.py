"""What a stiffer joint buys, against computing the stiffer robot."""

import numpy as np
import pytest

import robomill as rm
from robomill.errors import KinematicsError
from robomill.improve.sensitivity import compliance_sensitivity, deflection_sensitivity, scaled_shares, stiffened


@pytest.fixture(scope="module")
def point():
    robot = rm.load_robot("slavkovic_5r")
    theta = rm.inverse_kinematics(robot, rm.pose_from_world([0.3, -1.3, 0.1, 0.1, 0.2])).theta
    C_joint = rm.joint_contributions(rm.geometric_jacobian(robot, theta)[:3], robot.C_theta)
    return robot, theta, C_joint


def test_against_the_stiffer_robot(point):
    robot, theta, C_joint = point
    F = np.array([10.0, 100.0, -20.0])
    of_point = compliance_sensitivity(C_joint, "xy", 1.1)
    of_path = deflection_sensitivity(rm.deflection(C_joint, F), None, 1.1)
    along = deflection_sensitivity(rm.deflection(C_joint, F), [0, 2, 0], 1.1)
    for joint in range(5):
        factors = np.where(np.arange(5) == joint, 1.1, 1.0)
        C = rm.cartesian_compliance(stiffened(robot, factors), theta)
        assert of_point.before - of_point.gain[joint] == pytest.approx(abs(C[0, 1]), abs=1e-18)
        assert of_path.before - of_path.gain[joint] == pytest.approx(np.linalg.norm(C @ F), abs=1e-15)
        assert along.before - along.gain[joint] == pytest.approx(abs((C @ F)[1]), abs=1e-15)
        np.testing.assert_allclose(scaled_shares(C_joint, factors, 0).sum(axis=0), C, atol=1e-18)


def test_ranking_names_the_joints_to_blame_at_the_milling_test(point):
    robot, _, _ = point
    theta = rm.inverse_kinematics(robot, rm.pose_from_world([0, -1.3, 0, 0, 0])).theta
    C_joint = rm.joint_contributions(rm.geometric_jacobian(robot, theta)[:3], robot.C_theta)
    found = compliance_sensitivity(C_joint, "yy", 1.1, robot.joint_numbers)
    assert list(found.ranking[:2]) == [2, 4]
    # 10 % stiffer takes 1 - 1/1.1 of the joint's own share: 0.1473 and 0.0822 mm per 100 N.
    np.testing.assert_allclose(found.gain[[2, 4]] * 1e5, (1 - 1 / 1.1) * np.array([0.1473, 0.0822]), atol=1e-5)
    assert found.relative().sum() == pytest.approx(1 - 1 / 1.1)


def test_cells_that_are_not_reached_do_not_count(point):
    _, _, C_joint = point
    batch = np.stack([C_joint, np.full_like(C_joint, np.nan)])
    both, one = compliance_sensitivity(batch, "yy"), compliance_sensitivity(C_joint, "yy")
    np.testing.assert_array_equal(both.ranking, one.ranking)
    assert np.isnan(both.gain[1]).all()


def test_refusals(point):
    robot, _, C_joint = point
    for bad in (0.0, -1.0, np.nan):
        with pytest.raises(KinematicsError, match="above zero|finite"):
            stiffened(robot, bad)
    with pytest.raises(KinematicsError, match="component"):
        compliance_sensitivity(C_joint, "qq")
    with pytest.raises(KinematicsError, match="other than zero"):
        deflection_sensitivity(C_joint[:, 0], [0, 0, 0])
