"""What a person asks of inverse kinematics: how far a place, a turn or a foot is taken for what it says."""

from __future__ import annotations

import numpy as np
import pytest

import robomill as rm
from robomill.errors import KinematicsError
from robomill.kinematics.asked import in_the_foot, longest_reach
from robomill.kinematics.transforms import transform

PLANAR = rm.load_robot("planar_2r")  # links of 0.5 and 0.4 m


@pytest.mark.parametrize("base", [(0.0, 0.0, 0.0), (3.0, -4.0, 0.0), (0.0, 0.0, 2.0)])
def test_no_tip_lies_farther_from_the_zero_than_the_base_and_all_links_together(base) -> None:
    arm = PLANAR.replace(base_xyz=base)
    assert longest_reach(arm) == pytest.approx(np.linalg.norm(base) + 0.9)
    kuka = rm.load_robot("kuka_kr500").replace(base_xyz=base)
    theta = np.random.default_rng(0).uniform(*kuka.limits.T, (2000, 6))
    farthest = np.linalg.norm(rm.tool_pose(kuka, theta)[:, :3, 3], axis=1).max()
    assert farthest <= longest_reach(kuka) < 2.5 * farthest


@pytest.mark.parametrize("axis", [0, 1, 2])
@pytest.mark.parametrize("side", [1.0, -1.0])
def test_a_place_thirty_arms_away_was_meant_in_mm(axis: int, side: float) -> None:
    """Of an arm of 0.9 m: 27 m along any axis."""
    for far, meant in ((26.9, True), (27.1, False)):
        place = side * far * np.eye(3)[axis]
        poses = rm.pose_from_world([[0.5, 0.3, 0.0, 0.0, 0.0], [*place, 0.0, 0.0]])
        if meant:
            np.testing.assert_array_equal(rm.inverse_kinematics(PLANAR, poses).reached, [True, False])
        else:
            with pytest.raises(KinematicsError, match="27.1 mm are 0.0271"):
                rm.inverse_kinematics(PLANAR, poses)


@pytest.mark.parametrize(("spin", "meant"), [(6.28, True), (-6.28, True), (6, True), (6.29, False), (-6.29, False)])
def test_a_spin_of_more_than_a_turn_was_meant_in_degrees(spin: float, meant: bool) -> None:
    robot = rm.load_robot("fanuc_r2000ic")
    pose = rm.tool_pose(robot, robot.home)
    if meant:
        assert rm.inverse_kinematics(robot, pose, spin=spin).spin == pytest.approx(spin)
    else:
        with pytest.raises(KinematicsError, match="more than a turn"):
            rm.inverse_kinematics(robot, pose, spin=spin)


def test_places_within_a_hundredth_of_the_middle_of_the_foot_were_meant_in_m() -> None:
    """All of them, along every axis, of an arm that stands on the zero of {M} and turns there; zero itself is none."""
    for i, side in ((0, 1.0), (1, -1.0), (2, 1.0)):
        for far, near in ((9.9e-3, True), (10.1e-3, False), (1e-5, True), (0.0, False)):
            place = side * far * np.eye(3)[i]
            assert in_the_foot(PLANAR, place) == near
            assert in_the_foot(PLANAR, np.array([[0.001, 0.0, -0.002], place])) == (far < 0.01)
    near = np.array([0.0, -1.3e-3, 0.0])
    assert in_the_foot(rm.load_robot("slavkovic_5r"), near)
    for moved in (transform(np.eye(3), [0.0, 0.0, 1e-3]), np.diag([-1.0, -1.0, 1.0, 1.0])):
        assert not in_the_foot(PLANAR.replace(T_base=moved), near)
    rail = rm.Robot.from_dh(a_mm=[0, 500], prismatic=[True, False], limits_mm=[(0, 3000), None])
    assert not in_the_foot(rail, near)
    assert not in_the_foot(PLANAR, np.empty((0, 3)))
