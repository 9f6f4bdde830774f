"""The closed form's structure: branches are named after the arm as it stands at home, whatever its signs."""

from __future__ import annotations

import numpy as np
import pytest

import robomill as rm
from robomill.kinematics.decoupled import decoupled
from robomill.kinematics.forward import joint_frames
from tests.robot.written_otherwise import with_blocked


@pytest.mark.parametrize("name", ["slavkovic_5r", "kuka_kr500", "fanuc_r2000ic"])
@pytest.mark.parametrize("sign", [1, -1])
@pytest.mark.parametrize("at", [0.7, -0.7, 0.0])
def test_the_arm_at_home_stands_in_front_with_its_wrist_plus(name, sign, at):
    robot = rm.load_robot(name)
    turned, limits = robot.sign.copy(), robot.limits.copy()
    turned[4], limits[4] = sign * turned[4], [at - 0.5, at + 0.5]  # without zero: home is the middle
    robot = robot.replace(sign=turned, limits=limits)
    assert robot.home[4] == pytest.approx(at)
    past = robot.home.copy()
    past[4] += 0.05 if at == 0.0 else 0.0  # a straight wrist is told by what lies a little past it
    there = rm.inverse_kinematics(robot, rm.tool_pose(robot, past), near=past, spin="fixed")
    np.testing.assert_allclose(there.theta, past, atol=1e-8)
    assert "front" in there.branch
    assert "wrist +" in there.branch


def test_structures_recognised_from_the_table():
    assert decoupled(rm.load_robot("slavkovic_5r")).n == 5
    assert decoupled(rm.load_robot("kuka_kr500")).spindle_on_last_axis
    assert not decoupled(rm.load_robot("fanuc_r2000ic")).spindle_on_last_axis
    assert decoupled(rm.load_robot("planar_3r")) is None
    # The paper's machine: a six-axis robot with axis 6 blocked.
    assert decoupled(with_blocked(rm.load_robot("kuka_kr500"), 6, 0.0)).n == 5


@pytest.mark.parametrize("name", ["slavkovic_5r", "kuka_kr500", "fanuc_r2000ic"])
def test_an_elbow_that_is_up_stands_higher_than_one_that_is_down(name):
    """At poses that an arm on the floor meets both ways, from the front."""
    robot = rm.load_robot(name)
    robot = robot.replace(limits=np.tile([-np.pi, np.pi], (robot.n, 1)))
    theta = rm.load_robot(name).home + np.random.default_rng(6).uniform(-0.3, 0.3, (40, robot.n))
    T_MT = rm.tool_pose(robot, theta)
    up, down = (rm.inverse_kinematics(robot, T_MT, branch=f"front, elbow {b}", spin="fixed") for b in ("up", "down"))
    both = up.reached & down.reached
    assert both.sum() > 20
    height = [joint_frames(robot, each.theta[both])[:, 2, 2, 3] for each in (up, down)]
    assert (height[0] > height[1]).all()


@pytest.mark.parametrize("gone", [("a", 1), ("d", 3)])
def test_without_an_upper_arm_or_a_forearm_there_is_no_closed_form(gone):
    """The elbow stands on the shoulder, or the wrist on the elbow: the arm is solved all the same."""
    robot, (name, row) = rm.load_robot("slavkovic_5r"), gone
    lengths = np.array(getattr(robot, name))
    assert abs(lengths[row]) > 1.0
    lengths[row] = 0.0
    folded = robot.replace(**{name: lengths})
    assert decoupled(folded) is None
    theta = folded.home + np.random.default_rng(1).uniform(-0.2, 0.2, (5, 5))
    found = rm.inverse_kinematics(folded, rm.tool_pose(folded, theta), near=theta)
    assert found.reached.all()
    np.testing.assert_allclose(rm.tool_pose(folded, found.theta), rm.tool_pose(folded, theta), atol=1e-8)


def test_the_spindle_is_on_the_last_axis_where_a_turn_about_it_leaves_axis_and_tip():
    """Six axes, the tool along the last one and its tip on it."""
    arm = rm.load_robot("kuka_kr500")
    aside, tilted = np.array(arm.T_tool), np.array(arm.T_tool)
    aside[:3, 3] += 0.01 * aside[:3, 0]
    c, s = np.cos(0.1), np.sin(0.1)
    tilted[:3, :3] = tilted[:3, :3] @ np.array([[1, 0, 0], [0, c, -s], [0, s, c]])
    for T_tool in (arm.T_tool, aside, tilted):
        robot = arm.replace(T_tool=T_tool)
        turned = robot.home + np.array([0, 0, 0, 0, 0, 0.4])
        before, after = rm.tool_pose(robot, np.array([robot.home, turned]))
        kept = np.allclose(before[:3, 2:], after[:3, 2:], atol=1e-9)
        found = decoupled(robot)
        assert found is not None
        assert found.spindle_on_last_axis == kept
    assert not decoupled(rm.load_robot("slavkovic_5r")).spindle_on_last_axis
