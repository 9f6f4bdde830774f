"""Kinematics of random arms: the Jacobian is the derivative, inverse undoes forward, an independent library agrees."""

import numpy as np
import pytest
from hypothesis import given, settings, strategies as st
from random_arms import any_arm, configurations, five_axis_arm, spherical_wrist_arm

import robomill as rm
from robomill.kinematics.choice import every
from robomill.kinematics.decoupled import decoupled
from tests.robot.written_otherwise import with_convention

POSES = 10_000
# The numeric solver: share of reachable poses of general arms that it must find.
GENERAL_FOUND = 0.995


@settings(max_examples=60, deadline=None)
@given(st.integers(0, 2**32 - 1))
def test_jacobian_is_the_derivative_of_forward_kinematics(seed):
    rng = np.random.default_rng(seed)
    robot = any_arm(rng)
    theta = configurations(rng, robot, 5)
    J = rm.geometric_jacobian(robot, theta)
    R = rm.tool_pose(robot, theta)[:, :3, :3]
    h = 2e-3
    # Central differences of fourth, sixth order: (45 (f1 - f-1) - 9 (f2 - f-2) + (f3 - f-3)) / 60 h.
    for i in range(robot.n):
        derivative = np.zeros((5, 4, 4))
        for step, weight in ((1, 45), (2, -9), (3, 1)):
            move = step * h * np.eye(robot.n)[i]
            derivative += weight * (rm.tool_pose(robot, theta + move) - rm.tool_pose(robot, theta - move)) / (60 * h)
        omega = derivative[:, :3, :3] @ np.swapaxes(R, 1, 2)
        np.testing.assert_allclose(J[:, :3, i], derivative[:, :3, 3], atol=1e-8)
        np.testing.assert_allclose(J[:, 3:, i], omega[:, [2, 0, 1], [1, 2, 0]], atol=1e-8)


@pytest.mark.parametrize("seed", range(8))
def test_forward_kinematics_and_jacobian_agree_with_pinocchio(seed):
    pin = pytest.importorskip("pinocchio")
    rng = np.random.default_rng(seed)
    robot = any_arm(rng)
    chain = robot.chain
    model, parent, placement = pin.Model(), 0, pin.SE3(np.array(chain.T_0))
    for i in range(robot.n):
        joint = pin.JointModelPZ() if chain.prismatic[i] else pin.JointModelRZ()
        parent = model.addJoint(parent, joint, placement, f"joint {i}")
        placement = pin.SE3(np.array(chain.E[i]))
    tool = model.addFrame(pin.Frame("tool", parent, placement, pin.FrameType.OP_FRAME))
    data = model.createData()
    for theta in configurations(rng, robot, 20):
        q = chain.sign * theta + chain.offset
        J = pin.computeFrameJacobian(model, data, q, tool, pin.ReferenceFrame.LOCAL_WORLD_ALIGNED) * chain.sign
        pin.updateFramePlacements(model, data)
        np.testing.assert_allclose(rm.tool_pose(robot, theta), data.oMf[tool].homogeneous, atol=1e-12)
        np.testing.assert_allclose(rm.geometric_jacobian(robot, theta), J, atol=1e-12)


@settings(max_examples=30, deadline=None)
@given(st.integers(0, 2**32 - 1))
def test_batches_equal_loops(seed):
    rng = np.random.default_rng(seed)
    robot = any_arm(rng)
    theta = configurations(rng, robot, 6).reshape(2, 3, robot.n)
    for law in (rm.tool_pose, rm.geometric_jacobian, rm.task_jacobian, rm.cartesian_compliance):
        batch = law(robot, theta)
        for index in np.ndindex(2, 3):
            np.testing.assert_allclose(batch[index], law(robot, theta[index]), rtol=1e-12, atol=1e-13)


@settings(max_examples=30, deadline=None)
@given(st.integers(0, 2**32 - 1))
def test_conversion_of_conventions_keeps_poses(seed):
    rng = np.random.default_rng(seed)
    robot = any_arm(rng)
    theta = configurations(rng, robot, 10)
    for convention in ("standard", "modified"):
        other = with_convention(robot, convention)
        np.testing.assert_allclose(rm.tool_pose(other, theta), rm.tool_pose(robot, theta), atol=1e-12)


STRUCTURES = [(s, lateral, e) for s in (False, True) for lateral in (False, True) for e in (False, True)]


@pytest.mark.parametrize(("shoulder", "lateral", "elbow"), STRUCTURES)
def test_every_reachable_pose_of_spherical_wrist_arms_is_found(shoulder, lateral, elbow):
    rng = np.random.default_rng(100 + 4 * shoulder + 2 * lateral + elbow)
    robot = spherical_wrist_arm(rng, shoulder, lateral, elbow, "modified" if elbow else "standard")
    assert decoupled(robot) is not None
    theta = configurations(rng, robot, POSES)
    T_MT = rm.tool_pose(robot, theta)
    result = rm.inverse_kinematics(robot, T_MT, spin="fixed")
    assert result.reached.all()
    assert result.residual.max() <= 1e-9
    assert np.abs(rm.tool_pose(robot, result.theta) - T_MT).max() <= 1e-9
    again = rm.inverse_kinematics(robot, T_MT, spin="fixed", near=theta)
    # Near a singular wrist the angles are ill determined, the pose is not.
    assert np.median(np.abs(again.theta - theta)) < 1e-12
    branches, sound = every(robot, decoupled(robot), T_MT[:1000])
    turned = (branches - theta[:1000, None] + np.pi) % (2 * np.pi) - np.pi
    assert np.abs(turned).max(axis=-1).min(axis=-1).max() < 1e-6
    assert sound.any(axis=-1).all()


@pytest.mark.parametrize("seed", range(6))
def test_every_reachable_pose_of_five_axis_arms_is_found(seed):
    rng = np.random.default_rng(seed)
    robot = five_axis_arm(rng)
    assert decoupled(robot) is not None
    theta = configurations(rng, robot, POSES)
    result = rm.inverse_kinematics(robot, rm.tool_pose(robot, theta), near=theta)
    assert result.reached.all()
    assert np.median(np.abs(result.theta - theta)) < 1e-12


@pytest.mark.parametrize("n", [5, 6, 7])
def test_general_arms_are_found_or_reported_never_wrong(n):
    check_general_arm(n, n, 1000)


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(20, 30))
@pytest.mark.parametrize("n", [5, 6])
def test_general_arms_at_length(n, seed):
    check_general_arm(n, seed, POSES)


def check_general_arm(n, seed, count):
    rng = np.random.default_rng(seed)
    robot = any_arm(rng, n, prismatic=0.0)
    assert decoupled(robot) is None
    T_MT = rm.tool_pose(robot, configurations(rng, robot, count))
    result = rm.inverse_kinematics(robot, T_MT, spin="fixed")
    assert result.reached.mean() >= GENERAL_FOUND
    found = rm.tool_pose(robot, result.theta[result.reached])
    assert np.abs(found[:, :3, 3] - T_MT[result.reached, :3, 3]).max() <= 1e-9
    columns = slice(0, 3) if n > 5 else slice(2, 3)
    assert np.abs(found[:, :3, columns] - T_MT[result.reached, :3, columns]).max() <= 1e-9
    low, high = robot.limits[:, 0], robot.limits[:, 1]
    assert ((result.theta[result.reached] >= low) & (result.theta[result.reached] <= high)).all()
    assert np.isnan(result.theta[~result.reached]).all()
    for row in np.flatnonzero(~result.reached)[:3]:
        assert result.reason(row)
