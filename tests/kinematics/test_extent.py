"""How far an arm goes, against the tips it is drawn at and the one where all its links lie in a row."""

import numpy as np
import pytest

import robomill as rm
from robomill.kinematics.extent import drawn, stretch

SLIDING = rm.Robot.from_dh(
    a_mm=[0, 300], d_mm=[50, 0], prismatic=[True, False], limits_mm=[[0, 400], None], limits_deg=[None, [-180, 180]]
)
ARMS = [rm.load_robot(name) for name in ("slavkovic_5r", "kuka_kr270", "planar_3r")] + [SLIDING]


@pytest.mark.parametrize("robot", ARMS, ids=lambda robot: robot.name)
def test_no_tip_lies_farther_than_the_links_in_a_row(robot: rm.Robot) -> None:
    tips = rm.tool_pose(robot, drawn(robot, 2000))[:, :3, 3] - robot.chain.T_0[:3, 3]
    assert 0.6 * stretch(robot) < np.linalg.norm(tips, axis=1).max() <= stretch(robot)


def test_a_planar_arm_lies_in_a_row_at_zero() -> None:
    robot = rm.load_robot("planar_3r")
    assert np.linalg.norm(rm.tool_pose(robot, np.zeros(3))[:3, 3]) == pytest.approx(stretch(robot), rel=1e-12)


@pytest.mark.parametrize("robot", ARMS, ids=lambda robot: robot.name)
def test_configurations_are_drawn_over_the_limits_and_of_one_seed_the_same(robot: rm.Robot) -> None:
    theta, (low, high) = drawn(robot, 4000, seed=3), robot.limits.T
    assert (low <= theta).all()
    assert (theta <= high).all()
    np.testing.assert_allclose(theta.min(axis=0), low, atol=0.01 * (high - low).max())
    np.testing.assert_allclose(theta.max(axis=0), high, atol=0.01 * (high - low).max())
    np.testing.assert_array_equal(drawn(robot, 4000, seed=3), theta)
    assert (drawn(robot, 4000) != theta).any()
