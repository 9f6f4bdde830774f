"""What inverse kinematics answers as a table, row by row, and how it says whether and why."""

from __future__ import annotations

import numpy as np
import pytest

import robomill as rm

POSES = np.array(
    [[[0.0, -1.3, 0.0, 0.0, 0.0], [0.3, -1.2, 0.05, 0.1, -0.2]], [[9.0, 0, 0, 0, 0], [-0.2, -1.4, 0, 0, 0.3]]]
)
FAR = [False, False, True, False]


def test_a_row_is_a_pose_in_the_order_of_the_batch():
    """Where it lies in mm and degrees, then joints that by forward kinematics lead there again; NaN where none do."""
    robot = rm.load_robot("slavkovic_5r")
    table = rm.inverse_kinematics(robot, rm.pose_from_world(POSES)).columns()
    asked = POSES.reshape(4, 5)
    np.testing.assert_allclose(np.transpose([table[f"{a}_mm"] for a in "XYZ"]), asked[:, :3] * 1e3, atol=1e-9)
    np.testing.assert_allclose(np.transpose([table[f"{a}_deg"] for a in "AB"]), np.rad2deg(asked[:, 3:]), atol=1e-9)
    theta = np.deg2rad(np.transpose([table[f"theta{j}_deg"] for j in range(1, 6)]))
    np.testing.assert_array_equal(np.isnan(theta), np.array(FAR)[:, None] & np.ones(5, dtype=bool))
    np.testing.assert_array_equal(table["reached"], ~np.array(FAR))
    met = rm.world_from_pose(rm.tool_pose(robot, theta[table["reached"]]))
    np.testing.assert_allclose(met, asked[table["reached"]], atol=1e-9)
    assert table["residual_mm"][table["reached"]].max() < 1e-6
    assert (table["branch"] == "").tolist() == FAR
    assert "spin_deg" not in table


@pytest.mark.parametrize("near", ["path", None])
@pytest.mark.parametrize("name", ["kuka_kr500", "fanuc_r2000ic"])
@pytest.mark.parametrize("spin", ["least_motion", "fixed", 0.7])
def test_the_turn_that_is_told_is_the_turn_that_the_joints_make(name, near, spin):
    """The spindle of one arm is its axis 6, which stays at home: no turn is chosen there, and none is told."""
    robot = rm.load_robot(name)
    T_MT = rm.pose_from_world([[1.6, 0.2, 0.6, 0.1, 0.0], [1.8, -0.3, 0.5, 0.0, 0.2]])
    found = rm.inverse_kinematics(robot, T_MT, near=near, spin=spin)
    assert found.reached[0]
    turn = (np.swapaxes(T_MT[:, :3, :3], 1, 2) @ rm.tool_pose(robot, found.theta)[:, :3, :3])[found.reached]
    np.testing.assert_allclose(turn[:, 2, 2], 1.0, atol=1e-12)
    if name == "kuka_kr500" and spin == "least_motion":
        assert found.spin is None
        assert "spin_deg" not in found.columns()
        np.testing.assert_array_equal(found.theta[:, 5], robot.home[5])
        return
    told = np.deg2rad(found.columns()["spin_deg"])[found.reached]
    np.testing.assert_allclose(turn[:, :2, 0], np.stack([np.cos(told), np.sin(told)], axis=1), atol=1e-9)


def test_one_pose_says_how_it_was_reached_and_many_how_often():
    robot = rm.load_robot("slavkovic_5r")
    found = [rm.inverse_kinematics(robot, rm.pose_from_world(pose)) for pose in POSES.reshape(4, 5)[[0, 2]]]
    assert f"reached, branch {found[0].branch!r}" in repr(found[0])
    assert "not reached" in repr(found[1])
    assert found[0].branch != ""
    many = rm.inverse_kinematics(robot, rm.pose_from_world(POSES))
    assert "3 of 4 poses reached" in repr(many)
    assert many.branch.shape == (2, 2)
    assert many.reason((0, 1)) == ""
    assert many.reason((1, 0)) != ""


@pytest.mark.parametrize(
    ("A", "B", "doubted"), [(0.3, 0.2, True), (0.0, -0.4, True), (0.0, 0.0, False), (0.123, 0.4, False)]
)
def test_round_tilts_of_a_pose_that_is_not_reached_are_doubted(A, B, doubted):
    robot = rm.load_robot("slavkovic_5r")
    said = rm.inverse_kinematics(robot, rm.pose_from_world([9.0, 0.0, 0.0, A, B])).reason()
    assert ("were they given in degrees" in said) == doubted
    if doubted:
        assert f"{np.rad2deg(A):.1f}" in said.replace("−", "-")
        assert f"{np.rad2deg(B):.1f}" in said.replace("−", "-")
