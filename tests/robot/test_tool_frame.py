"""A tool along an axis of the last frame: seen at the tip, wherever the arm stands."""

from __future__ import annotations

import numpy as np
import pytest

import robomill as rm
from robomill.kinematics.transforms import rotation_x
from robomill.provenance import Provenance
from robomill.robot.tool_frame import TOOL_AXES, tool_axis, with_tool_axis

SAID = Provenance("user", "typed")


@pytest.mark.parametrize("axis", TOOL_AXES)
@pytest.mark.parametrize("name", ["slavkovic_5r", "fanuc_r2000ic"])
def test_the_spindle_stands_along_that_axis_and_the_tip_stays(name: str, axis: str) -> None:
    robot = rm.load_robot(name)
    turned = with_tool_axis(robot, axis, SAID)
    theta = np.linspace(-0.4, 0.5, robot.n)
    before, after = rm.tool_pose(robot, theta), rm.tool_pose(turned, theta)
    np.testing.assert_allclose(after[:3, 3], before[:3, 3], atol=1e-12)
    way = (1.0 if axis[0] == "+" else -1.0) * np.eye(3)["xyz".index(axis[1])]
    last = before[:3, :3] @ robot.T_tool[:3, :3].T  # the frame that the tool stands in
    np.testing.assert_allclose(last.T @ after[:3, 2], way, atol=1e-12)
    if turned is not robot:
        following = np.eye(3)[{"x": 1, "y": 2, "z": 0}[axis[1]]]
        np.testing.assert_allclose(last.T @ after[:3, 0], following, atol=1e-12)
    np.testing.assert_allclose(after[:3, :3].T @ after[:3, :3], np.eye(3), atol=1e-12)
    assert np.linalg.det(after[:3, :3]) == pytest.approx(1.0)
    assert tool_axis(turned) == axis
    assert (turned is robot) == (tool_axis(robot) == axis)
    assert turned is robot or turned.provenance["tool"] == SAID


def test_a_tool_that_leans_lies_along_no_axis() -> None:
    robot = rm.load_robot("slavkovic_5r")
    T_tool = np.array(robot.T_tool)
    T_tool[:3, :3] = T_tool[:3, :3] @ rotation_x(0.01)[:3, :3]
    leaning = robot.replace(T_tool=T_tool)
    assert tool_axis(leaning) == ""
    assert with_tool_axis(leaning, "askew", SAID) is leaning
