"""C F against the arm itself: twist every joint by C_i tau_i, run forward kinematics, and watch the remainder."""

import numpy as np
import pytest

import robomill as rm
from robomill.compliance.cartesian import full_compliance
from robomill.compliance.deflection import soft_direction
from robomill.kinematics.transforms import rotation_z, transform


@pytest.mark.parametrize("name", ["slavkovic_5r", "kuka_kr500", "fanuc_r2000ic", "planar_3r"])
def test_remainder_of_brute_force_elastostatics_falls_as_force_squared(name):
    robot = rm.load_robot(name)
    rng = np.random.default_rng(3)
    theta = rng.uniform(robot.limits[:, 0], robot.limits[:, 1], (50, robot.n)) * 0.8
    direction = rng.normal(size=(50, 3))
    C = rm.cartesian_compliance(robot, theta)
    J_v = rm.geometric_jacobian(robot, theta)[:, :3]
    sizes = np.array([1e3, 2e3, 4e3, 8e3])
    remainders = []
    for size in sizes:
        F = size * direction
        twisted = theta + robot.C_theta * np.einsum("min,mi->mn", J_v, F)
        moved = rm.tool_pose(robot, twisted)[:, :3, 3] - rm.tool_pose(robot, theta)[:, :3, 3]
        remainders.append(np.abs(moved - np.einsum("mij,mj->mi", C, F)).max())
    order = np.polyfit(np.log(sizes), np.log(remainders), 1)[0]
    assert order == pytest.approx(2.0, abs=0.05)


def test_energy_reciprocity_and_sum_of_shares():
    robot = rm.load_robot("slavkovic_5r")
    rng = np.random.default_rng(4)
    theta = rng.uniform(robot.limits[:, 0], robot.limits[:, 1], (100, 5))
    F, G = rng.normal(size=(2, 100, 3)) * 100
    J_v = rm.geometric_jacobian(robot, theta)[:, :3]
    C_joint = rm.joint_contributions(J_v, robot.C_theta)
    C = rm.cartesian_compliance(robot, theta)
    np.testing.assert_allclose(C_joint.sum(axis=1), C, rtol=1e-12, atol=1e-18)
    delta = rm.deflection(C_joint, F).sum(axis=1)
    # The work of the force is the energy in the joints.
    tau = np.einsum("min,mi->mn", J_v, F)
    np.testing.assert_allclose((F * delta).sum(axis=1), (robot.C_theta * tau**2).sum(axis=1), rtol=1e-12)
    # Maxwell: what G feels of F is what F feels of G.
    np.testing.assert_allclose((G * delta).sum(axis=1), (F * np.einsum("mij,mj->mi", C, G)).sum(axis=1), rtol=1e-9)
    values, axes = soft_direction(C)
    assert (values >= -1e-20).all()
    np.testing.assert_allclose(axes @ (values[..., None] * np.swapaxes(axes, 1, 2)), C, atol=1e-18)


def test_rotating_joint_1_rotates_the_compliance():
    robot = rm.load_robot("slavkovic_5r")
    theta = np.array([0.1, -0.4, -0.3, 0.2, 0.7])
    turned = theta + 0.6 * np.eye(5)[0]
    R = rotation_z(0.6)
    np.testing.assert_allclose(
        rm.tool_pose(robot, turned), transform(R, np.zeros(3)) @ rm.tool_pose(robot, theta), atol=1e-14
    )
    np.testing.assert_allclose(
        rm.cartesian_compliance(robot, turned), R @ rm.cartesian_compliance(robot, theta) @ R.T, atol=1e-18
    )


def test_full_compliance_holds_the_translational_block_and_is_symmetric():
    robot = rm.load_robot("slavkovic_5r")
    theta = np.array([0.1, -0.4, -0.3, 0.2, 0.7])
    C_X = full_compliance(robot, theta)
    np.testing.assert_allclose(C_X, C_X.T, atol=1e-20)
    np.testing.assert_allclose(C_X[:3, :3], rm.cartesian_compliance(robot, theta), atol=1e-18)
    # Rotational block: each joint turns the tool about its own axis.
    axes = rm.geometric_jacobian(robot, theta)[3:]
    np.testing.assert_allclose(C_X[3:, 3:], (axes * robot.C_theta) @ axes.T, atol=1e-20)
