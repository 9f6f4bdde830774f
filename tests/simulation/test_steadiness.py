"""What a run says of its joints: the line of the program, the joint, its turn a millimetre, its speed at the feed."""

import numpy as np

import robomill as rm
from robomill.kinematics.inverse import inverse_kinematics
from robomill.simulation.steadiness import HASTE, SINGULAR, steadiness
from robomill.toolpath.path import toolpath_from_lines
from robomill.toolpath.sampling import resample

ROBOT = rm.load_robot("slavkovic_5r")
# Two lines; the second passes the singular wrist.
POINTS = np.array([[-0.6, -0.1, -1.0], [-0.656, -0.339, -0.974], [-0.840, -1.094, -0.888]])
PATH = resample(toolpath_from_lines(POINTS[:-1], POINTS[1:], 0.03), 1e-3)


def findings(**asked):
    x_M = np.column_stack([PATH.p, np.zeros((len(PATH), 2))])
    return steadiness(PATH, inverse_kinematics(ROBOT, rm.pose_from_world(x_M), near="path", **asked))


def test_the_smooth_way_names_the_line_of_the_singular_wrist():
    (found,) = findings()
    assert (found.code, found.level, found.line, found.count) == (SINGULAR, "warning", PATH.block[-1], 1)


def test_a_flipping_wrist_names_line_joint_turn_and_speed():
    """180 degrees within one step of about a millimetre at 30 mm/s."""
    (haste,) = [f for f in findings(branch="wrist -") if f.code == HASTE]
    step = PATH.step_length[-1] * 1e3
    assert haste.line == PATH.block[-1]
    assert "joint 4 turns 180.0°" in haste.message
    assert f"{180 / step:.1f} °/mm" in haste.message
    assert f"{180 / step * 30:.0f} °/s" in haste.message
