"""Postures of a redundant arm: each holds the tool where it is; the range is that of a walk through the null space."""

import numpy as np
import pytest
from random_arms import seven

import robomill as rm
from robomill.compliance.posture import over_posture, posture_notes


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


@pytest.mark.parametrize(("name", "free"), [("fanuc_r2000ic", True), ("kuka_kr270", False), ("slavkovic_5r", False)])
def test_a_map_says_where_it_shows_one_turn_about_the_tool_of_many(name, free):
    """C_yy at one place with the tool turned all round, each configuration by its own inverse kinematics: where it
    changes, the cell of a map is one of its values, and that is said."""
    robot = rm.load_robot(name)
    p = [0.0, -1.3, 0.0] if robot.n == 5 else [1.4, 0.4, 0.8]
    shown = rm.compliance_map(robot, rm.Grid(x=p[0], y=p[1], z=p[2])).values("C_yy").item()
    turns = np.radians(np.arange(0.0, 360.0, 15.0))
    upright = rm.pose_from_world([*p, 0.0, 0.0])
    found = [rm.inverse_kinematics(robot, upright, spin=float(turn)) for turn in turns]
    C_yy = [rm.cartesian_compliance(robot, each.theta)[1, 1] for each in found if each.reached]
    assert len(C_yy) > 5
    assert (np.ptp(C_yy) > 0.1 * shown) == free
    assert min(C_yy) * 0.999 <= shown <= max(C_yy) * 1.001
    assert bool(posture_notes(robot)) == free
    assert "has 7 axes and holds a place in many postures" in posture_notes(seven())[0].message
