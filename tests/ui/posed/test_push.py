"""What pushes and what gives: shares that add up, the place of the verdict, and what the springs beside joints give."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest

import robomill as rm
from robomill.compliance.at_pose import at_pose
from robomill.ui.posed.push import Moved, Push, by_axis, decided, in_force
from robomill.ui.project import View, preset_setup

ROBOT = rm.load_robot("slavkovic_5r")


@pytest.fixture(scope="module")
def flute() -> rm.SimulationResult:
    return rm.simulate(preset_setup("paper_flute"))


def test_each_joint_alone_gives_its_share() -> None:
    """Rigid but for one joint, the arm is displaced by that joint's part: by a robot of its own each."""
    pose = at_pose(ROBOT, [0.2, -0.4, -0.3, 0.1, 0.8])
    push = Push(np.array([30.0, -120.0, 250.0]))
    moved = Moved.at(pose, push)
    alone = []
    for j in range(5):
        only = ROBOT.replace(C_theta=np.where(np.arange(5) == j, ROBOT.C_theta, 0.0))
        alone.append(at_pose(only, pose.theta).delta(push.F))
    np.testing.assert_allclose(moved.delta_joint, alone, atol=1e-15)
    np.testing.assert_allclose(moved.delta, pose.delta(push.F), rtol=1e-12)
    along = np.array(alone) @ moved.delta / (moved.delta @ moved.delta)
    np.testing.assert_allclose(moved.shares, along, atol=1e-12)
    assert moved.shares.sum() == pytest.approx(1.0)


def test_stiffer_joints_by_a_run_of_their_own(flute: rm.SimulationResult) -> None:
    cut = decided(flute)
    assert cut is not None
    factors = np.array([1.0, 1.0, 2.0, 1.0, 1.5])
    robot = ROBOT.replace(C_theta=ROBOT.C_theta / factors)
    after = decided(rm.simulate(flute.setup.replace(robot=robot)))
    assert after is not None
    np.testing.assert_allclose(cut.moved.stiffer(factors).delta, after.moved.delta, rtol=1e-9, atol=1e-12)


def test_the_place_is_that_of_the_verdict(flute: rm.SimulationResult) -> None:
    cut = decided(flute)
    assert cut is not None
    assert (cut.line, cut.in_hand().point) == (7, pytest.approx((cut.in_hand().point[0], -1.3, 0.0)))
    np.testing.assert_allclose(rm.tool_pose(ROBOT, cut.theta)[:3, 3], cut.in_hand().point, atol=1e-5)
    assert cut.moved.sentence("mm") == "100 N on the tool moves the tip by +0.230 mm along Y, −0.102 mm along Z."
    assert cut.moved.blame("mm") == "Of these 0.251 mm, 70 % come from joint 3 and 30 % from joint 5."
    along_y = np.outer([0.5, 0.15, 0.3, 0.05, 0.0], [0.0, 1.0, 0.0])
    three = dataclasses.replace(cut.moved, delta=along_y.sum(axis=0), delta_joint=along_y)
    assert three.blame("mm") == (
        "Of these 1000.000 mm, 50 % come from joint 1, 30 % from joint 3 and 15 % from joint 2."
    )
    assert decided(None) is None


def test_what_pushes_is_chosen(flute: rm.SimulationResult) -> None:
    cut = decided(flute)
    assert cut is not None
    np.testing.assert_array_equal(in_force(View(), cut).F, cut.moved.push.F)
    np.testing.assert_array_equal(in_force(dataclasses.replace(View(), push="z"), cut).F, [0.0, 0.0, 100.0])
    assert in_force(View(), None).words == "100 N along Y"


def test_a_displacement_is_told_by_its_axes() -> None:
    """What is less than a fiftieth of it along an axis is left out, unless every axis is asked for."""
    delta = np.array([-4e-6, 0.2295e-3, -0.1024e-3])
    assert by_axis(delta, "in") == [("Y", "+0.0090"), ("Z", "−0.0040")]
    assert [axis for axis, _ in by_axis(delta, "mm", every=True)] == ["X", "Y", "Z"]
    assert by_axis(np.zeros(3), "mm") == []


def test_a_rigid_arm_is_not_moved() -> None:
    rigid = at_pose(ROBOT.replace(C_theta=np.zeros(5)), ROBOT.home)
    moved = Moved.at(rigid, Push.along("x"))
    assert moved.sentence("mm") == "100 N along X does not move the tip."
    assert moved.blame("mm") == ""


def test_a_straight_arm_pushed_along_its_links_is_not_said_to_move() -> None:
    """Of what a sum rounds to nobody is to blame: 63 % of 0.000 mm came from joint 1."""
    arm = rm.load_robot("planar_2r")
    theta = np.array([0.1, 0.0])
    along = np.array([np.cos(0.1), np.sin(0.1), 0.0])
    moved = Moved.at(at_pose(arm, theta), Push(100.0 * along))
    assert moved.size < 1e-12
    assert not moved.moves
    assert moved.blame("mm") == ""
    assert (moved.shares == 0.0).all()
    assert Moved.at(at_pose(arm, theta), Push.along("y")).moves
