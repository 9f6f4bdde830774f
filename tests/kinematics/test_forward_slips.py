"""Angles that were meant in degrees, strokes in mm and places in mm are refused; what can be meant is not."""

from __future__ import annotations

import numpy as np
import pytest

import robomill as rm
from robomill.errors import KinematicsError

ARM = rm.load_robot("slavkovic_5r")
GANTRY = rm.Robot.from_dh(
    prismatic=[True, True, False],
    alpha_deg=[90, 90, 0],
    a_mm=[0, 0, 300],
    limits_mm=[(0, 60_000), (0, 8000), None],
    limits_deg=[None, None, (-180, 180)],
)


@pytest.mark.parametrize("theta", [[0, 45, 0, 0, 0], [0, -90, 30, 0, 0], [0, 0, 12, 0, 0], [0, 45.7, 3.1, 0, 0]])
@pytest.mark.parametrize("of", [rm.tool_pose, rm.geometric_jacobian, rm.cartesian_compliance, rm.joint_frames])
def test_degrees_are_no_radians(of, theta) -> None:
    with pytest.raises(KinematicsError, match=r"theta is in rad .*numpy.deg2rad"):
        of(ARM, [[0.0] * 5, theta])


@pytest.mark.parametrize("turns", [1, -1, 3, -5])
def test_an_angle_of_several_turns_is_one(turns: int) -> None:
    theta = np.array([0.1, -0.2, 0.3, 0.4, 0.5])
    found = rm.tool_pose(ARM, theta + 2 * np.pi * turns)
    np.testing.assert_allclose(found, rm.tool_pose(ARM, theta), atol=1e-12)


def test_whole_radians_near_the_limits_are_meant() -> None:
    assert rm.tool_pose(ARM, [3, 2, -1, 4, 0]).shape == (4, 4)


def test_a_stroke_is_in_metres() -> None:
    assert rm.tool_pose(GANTRY, [59.0, 7.5, 0.0])[:3, 3] @ [0, 0, 1] == pytest.approx(59.0)
    with pytest.raises(KinematicsError, match=r"joint 2 is at 7500 m, .*7500 mm are 7\.5\. "):
        rm.tool_pose(GANTRY, [1.0, 7500.0, 0.0])


def test_what_is_not_reached_stays_unknown() -> None:
    assert np.isnan(rm.tool_pose(ARM, [np.nan] * 5)[:3]).any()


def test_places_are_in_metres_and_tilts_in_radians() -> None:
    with pytest.raises(KinematicsError, match="1300 mm are 1.3"):
        rm.inverse_kinematics(ARM, rm.pose_from_world([0, -1300, 0, 0, 0]))
    with pytest.raises(KinematicsError, match="found 90 rad"):
        rm.pose_from_world([0, -1.3, 0, 0, 90])


def test_a_place_out_of_reach_is_not_reached_and_not_refused() -> None:
    far = rm.inverse_kinematics(ARM, rm.pose_from_world([0, -60.0, 0, 0, 0]))
    assert not far.reached
    assert rm.inverse_kinematics(GANTRY, rm.pose_from_world([0, 100.0, 0, 0, 0])).reached.shape == ()


@pytest.mark.parametrize(
    ("given", "said"),
    [
        ({"near": [10, -90, 100, 170, 60, 100]}, "joint 2 is at -90 rad, far beyond its limits"),
        ({"spin": 90}, "spin: found 90 rad, more than a turn; 90° are 1.5708"),
    ],
)
def test_degrees_are_refused_where_inverse_kinematics_is_asked_too(given: dict, said: str) -> None:
    robot = rm.load_robot("fanuc_r2000ic")
    pose = rm.tool_pose(robot, robot.home)
    with pytest.raises(KinematicsError, match=said):
        rm.inverse_kinematics(robot, pose, **given)
    assert rm.inverse_kinematics(robot, pose, near=robot.home, spin=-1.0).reached
    assert rm.inverse_kinematics(robot, pose[None], near="path").reached.all()


@pytest.mark.parametrize(
    ("limits", "known"),
    [
        (np.pi, False),  # also what joints without limits are given
        (-1.0, False),  # none are given
        (np.pi - 1e-3, True),
        (np.pi + 1e-3, True),
        (1.0, True),
        (6.0, True),
    ],
)
def test_a_long_angle_is_doubted_from_one_turn_beyond_limits_that_somebody_has_stated(limits: float, known) -> None:
    """Others are five turns beyond them before they are, unless they have one decimal."""
    given = {} if limits < 0 else {"limits": [(-0.5, 0.5), (-limits, limits)]}
    arm = rm.Robot.from_dh(a_mm=[500, 400], **given)
    end = abs(limits) if given else np.pi
    for side in (1.0, -1.0):
        for beyond, refused in ((2 * np.pi * 0.99, False), (2 * np.pi * 1.01, known), (2 * np.pi * 5.01, True)):
            theta = [0.1, side * (end + beyond + 1.2345e-4)]
            if refused:
                with pytest.raises(KinematicsError, match="joint 2 is at"):
                    rm.tool_pose(arm, theta)
            else:
                assert np.isfinite(rm.tool_pose(arm, theta)).all()
        with pytest.raises(KinematicsError, match="joint 2 is at"):
            rm.tool_pose(arm, [0.1, side * (np.ceil(10 * (end + 2 * np.pi)) + 1) / 10])


@pytest.mark.parametrize("far", [np.inf, -np.inf])
def test_a_joint_at_infinity_is_no_angle_in_degrees(far: float, recwarn: pytest.WarningsRecorder) -> None:
    with pytest.raises(KinematicsError, match=r"expected finite numbers, or NaN .* found inf"):
        rm.tool_pose(rm.load_robot("slavkovic_5r"), [0.0, 0.0, far, 0.0, 0.0])
    assert not recwarn.list
