"""Arms that cannot hold the tool's axis: what they mill is not judged, by their own forward kinematics."""

from __future__ import annotations

import numpy as np
import pytest

import robomill as rm

SLOT = rm.Toolpath.from_points(p_mm=[[0, 0, 5], [0, 0, -2], [40, 0, -2]], feed_mm_min=1800, spindle_1_min=12000)


def milled(robot: rm.Robot, zero_mm: tuple[float, float, float]) -> rm.SimulationResult:
    setup = rm.SimulationSetup(
        robot=robot,
        source=SLOT,
        cutter=rm.Cutter("flat", diameter_mm=6, flutes=2),
        force=rm.ConstantForce((0.0, 100.0, 0.0)),
        part_zero_mm=zero_mm,
    )
    return rm.simulate(setup)


def arm(alpha_deg: list[float], d_mm: list[float], a_mm: list[float], **more: object) -> rm.Robot:
    n = len(a_mm)
    given = {"limits_deg": [(-170, 170)] * n, "k_theta_kNm_per_rad": [2500.0] * n, **more}
    return rm.Robot.from_dh(a_mm=a_mm, alpha_deg=alpha_deg, d_mm=d_mm, **given)  # type: ignore[arg-type]


def test_an_elbow_of_three_joints_lays_its_tool_down_and_is_not_judged() -> None:
    robot = arm([90, 0, 0], [700, 0, 0], [300, 900, 800])
    found = milled(robot, (0.0, -1300.0, 0.0))
    k = rm.tool_pose(robot, found.theta[found.reached])[:, :3, 2]
    assert np.degrees(np.arccos(k[:, 2])).max() > 80.0
    assert found.verdict.level == "unjudged"
    (told,) = found.unjudged
    assert told.code == "leaning"
    np.testing.assert_array_equal(told.where, found.path.cutting)  # its rapids lean as far, and cut nothing
    assert np.isnan(found.delta[found.path.cutting]).all()
    assert "brings the tip to its place, but the tool then stands up to" in found.verdict.sentence


def test_a_scara_holds_its_tool_upright_and_is_judged() -> None:
    robot = arm(
        [0, 180, 0],
        [500, 0, 0],
        [600, 500, 0],
        prismatic=[False, False, True],
        limits_deg=[(-170, 170), (-170, 170), None],
        limits_mm=[None, None, (0, 600)],
        k_theta_kNm_per_rad=None,
        C_theta=[4e-7, 4e-7, 1e-8],
    )
    robot = robot.replace(T_tool=np.diag([1.0, -1.0, -1.0, 1.0]))
    found = milled(robot, (0.0, -800.0, 200.0))
    assert found.reached.all()
    assert np.abs(rm.tool_pose(robot, found.theta)[:, :3, 2] - [0, 0, 1]).max() < 1e-9
    assert found.unjudged == ()
    assert found.verdict.level in ("ok", "tight", "out")


def test_five_joints_hold_the_axis() -> None:
    assert milled(rm.load_robot("slavkovic_5r"), (0.0, -1300.0, 0.0)).unjudged == ()


@pytest.mark.parametrize("held", [3, 4])
def test_a_held_axis_takes_the_tools_axis_with_it(held: int) -> None:
    """The paper's arm with a wrist joint held at zero: four joints, and the tool leans where the arm reaches out."""
    robot = rm.load_robot("slavkovic_5r")
    robot = robot.replace(blocked=np.where(np.arange(5) == held, 0.1, np.nan))
    found = milled(robot, (100.0, -1300.0, 0.0))
    there = found.reached & found.path.cutting
    off = np.degrees(np.arccos(rm.tool_pose(robot, found.theta[there])[:, 2, 2])) > 0.1
    told = found.unjudged[0].where[there] if found.unjudged else np.zeros_like(off)
    np.testing.assert_array_equal(told, off)


@pytest.mark.parametrize("axis", [[0, 0, -1], [1, 0, 0], [0, 1, 0], [0.9, 0, 0.05]])
def test_a_tool_that_lies_or_points_upwards_is_not_judged(axis: list[float]) -> None:
    """No surface is left that could be read from above; where the axis runs along the feed even the force is lost."""
    paper = rm.load_setup("paper_flute")
    path = rm.Toolpath.from_points(p_mm=[[-50, 0, -2], [50, 0, -2]], feed_mm_min=1800, k=axis)
    found = rm.simulate(paper.replace(source=path))
    assert found.verdict.level == "unjudged"
    assert found.not_judged[path.cutting.argmax()]
    assert "the tool lies there, or comes from below" in found.verdict.sentence
    with pytest.raises(rm.RobomillError, match="upward part"):
        _ = found.machined


def test_a_tool_that_leans_far_but_stands_is_judged() -> None:
    path = rm.Toolpath.from_points(p_mm=[[-50, 0, -2], [50, 0, -2]], feed_mm_min=1800, k=[0.6, 0, 0.8])
    assert rm.simulate(rm.load_setup("paper_flute").replace(source=path)).unjudged == ()
