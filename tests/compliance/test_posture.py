"""Postures of a redundant arm: each holds the tool where it is; the range is that of a walk through the null space."""

import numpy as np
import pytest
from random_arms import seven

import robomill as rm
from robomill.compliance.posture import over_posture


def walked(robot, theta, steps=4000):
    """C_yy along the self-motions from theta: steps in the null space of tip and tool axis, pulled back by Newton."""
    T, rng, found = rm.tool_pose(robot, theta), np.random.default_rng(1), []
    direction = rng.normal(size=robot.n)
    for _ in range(steps):
        pose, J = rm.tool_pose(robot, theta), rm.geometric_jacobian(robot, theta)
        task = np.vstack([J[:3], pose[:3, :2].T @ J[3:]])
        error = np.concatenate([T[:3, 3] - pose[:3, 3], pose[:3, :2].T @ np.cross(pose[:3, 2], T[:3, 2])])
        back = np.linalg.pinv(task)
        direction = direction + 0.3 * rng.normal(size=robot.n)
        along = direction - back @ (task @ direction)
        trial = theta + back @ error + 0.03 * along / np.linalg.norm(along)
        if (trial < robot.limits[:, 0]).any() or (trial > robot.limits[:, 1]).any():
            direction = -direction
            theta = np.clip(theta + back @ error, *robot.limits.T)
            continue
        theta = trial
        if np.linalg.norm(error) < 1e-3:
            found.append(rm.cartesian_compliance(robot, theta)[1, 1])
    return np.array(found)


def test_the_range_over_postures_covers_a_walk_through_them():
    robot = seven()
    T_MT = rm.pose_from_world([0.45, 0.1, 0.25, 0, 0])
    C_yy = over_posture(robot, T_MT)[:, 1, 1]
    assert len(C_yy) > 40
    start = rm.inverse_kinematics(robot, T_MT).theta
    walk = walked(robot, start)
    spread = walk.max() - walk.min()
    assert spread > 0.1 * walk.min()
    assert C_yy.min() < walk.min() + 0.15 * spread
    assert C_yy.max() > walk.max() - 0.15 * spread


@pytest.mark.parametrize("name", ["slavkovic_5r", "kuka_kr500"])
def test_arms_without_a_free_posture_have_no_range(name):
    robot = rm.load_robot(name)
    assert over_posture(robot, rm.tool_pose(robot, robot.limits.mean(axis=1) + 0.2)).shape == (0, 3, 3)
