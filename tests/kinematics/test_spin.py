"""What a path costs at each turn about the tool axis: against poses turned one by one."""

import numpy as np
import pytest
from random_arms import seven

import robomill as rm
from robomill.kinematics.spin import OverSpin, over_spins, spin_matters
from robomill.kinematics.transforms import rotation_z, transform


def test_each_spin_is_the_path_with_every_pose_turned_by_it():
    robot = rm.load_robot("fanuc_r2000ic")
    x_M = np.array([1.5, -0.3, 0.4, 0.2, 0.1]) + np.linspace(0, 1, 6)[:, None] * [0.2, 0.5, 0.2, 0.1, -0.1]
    T_MT = rm.pose_from_world(x_M)

    def farthest(theta):
        return float(np.abs(theta - robot.home).max())

    found = over_spins(robot, T_MT, farthest, count=7)
    np.testing.assert_allclose(found.angle, [2 * np.pi * k / 7 for k in range(7)])
    for angle, missed, value in zip(found.angle, found.missed, found.value, strict=True):
        turned = T_MT @ transform(rotation_z(angle), np.zeros(3))
        alone = rm.inverse_kinematics(robot, turned, near="path", spin="fixed")
        assert missed == (~alone.reached).sum()
        assert value == pytest.approx(farthest(alone.theta), nan_ok=True)
    assert sorted(found.missed) == [0] * 5 + [6] * 2
    assert len(set(np.round(found.value[found.missed == 0], 6))) == 5


def test_five_axes_have_no_spin():
    robot = rm.load_robot("slavkovic_5r")
    found = over_spins(robot, rm.tool_pose(robot, robot.home + np.zeros((2, 5))), lambda theta: 3.0)
    np.testing.assert_array_equal([found.angle, found.missed, found.value], [[0.0], [0], [3.0]])


@pytest.mark.parametrize(
    ("missed", "value", "best", "span"),
    [
        ([2, 0, 0, 1], [1.0, 5.0, 4.0, 0.5], 2, (4.0, 5.0)),
        ([1, 1, 3], [np.nan, 7.0, 2.0], 1, (7.0, 7.0)),
        ([1, 1], [np.nan, np.nan], 0, (np.nan, np.nan)),
    ],
)
def test_the_best_spin_misses_least_and_costs_least_of_these(missed, value, best, span):
    found = OverSpin(np.arange(len(missed)) * 0.1, np.array(missed), np.array(value))
    assert found.best == best
    np.testing.assert_array_equal(found.range, span)


def test_a_spin_matters_where_the_turn_about_the_tool_is_free_and_not_one_joint_s_alone():
    """Six axes or more whose last one is not the tool's: a turn about the tool by that joint alone moves the tip."""
    kuka = rm.load_robot("kuka_kr500")
    aside = np.array(kuka.T_tool)
    aside[:3, 3] += 0.1 * aside[:3, 0]
    arms = [kuka, kuka.replace(T_tool=aside), rm.load_robot("fanuc_r2000ic"), seven()]
    arms += [rm.load_robot(name) for name in ("slavkovic_5r", "planar_3r", "planar_2r")]
    assert [spin_matters(arm) for arm in arms] == [False, True, True, True, False, False, False]
