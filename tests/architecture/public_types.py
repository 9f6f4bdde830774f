"""What a user's type checker is told of robomill: mypy reads this file with the package (see pyproject.toml).

``assert_type`` does nothing when it runs; mypy refuses a line whose type is another, or not known.
"""

from typing import assert_type

import numpy as np
from numpy.typing import NDArray

import robomill as rm

Floats = NDArray[np.float64]


def from_nothing() -> rm.SimulationSetup:
    """A set-up made in code, each value with its own type."""
    arm = rm.Robot.from_dh(a_mm=[500, 400], limits_deg=(-170, 170), k_theta_kNm_per_rad=[800, 500])
    assert_type(arm, rm.Robot)
    cutter = rm.Cutter("flat", diameter_mm=8, flutes=3).replace(diameter_mm=10)
    assert_type(cutter, rm.Cutter)
    path = rm.Toolpath.from_points(p_mm=[[0, 0, -2], [100, 0, -2]], feed_mm_min=1800)
    assert_type(path, rm.Toolpath)
    setup = rm.SimulationSetup(
        robot=arm, source=path, cutter=cutter, force=rm.PathForce(feed_normal=100), part_zero_mm=(0, -1300, 0)
    )
    assert_type(setup.replace(cell_mm=0.2), rm.SimulationSetup)
    assert_type(setup.source, rm.GCodeSource | rm.LinesSource | rm.SketchSource | rm.PointsSource)
    return setup


def of_nested_lists() -> None:
    """Whole numbers beside others, in lists of lists, as the documents write them."""
    arm = rm.Robot.from_dh(
        a_mm=[500, 400.5],
        limits_deg=[[-170, 170], [-60.5, 140]],
        T_tool=[[1, 0, 0, 0], [0, -1, 0, 0], [0, 0, -1, 0.16], [0, 0, 0, 1]],
    )
    assert_type(arm, rm.Robot)
    path = rm.Toolpath.from_points(p_mm=[[0, 0, -2], [1.5, 0, -2]], feed_mm_min=1800)
    assert_type(path, rm.Toolpath)
    assert_type(rm.Element("line", points_mm=[[0, 0], [50.5, 0]], depth_mm=2, feed_mm_min=1800), rm.Element)


def of_a_run(setup: rm.SimulationSetup) -> None:
    """What a run answers."""
    result = rm.simulate(setup)
    assert_type(result, rm.SimulationResult)
    assert_type(result.delta, Floats)
    assert_type(result.max_deviation, float)
    assert_type(result.verdict, rm.Verdict)
    assert_type(result.machined, rm.ZMap)
    assert_type(result.groove(0.05), rm.GrooveSection)


def of_an_arm(robot: rm.Robot) -> None:
    """Kinematics, compliance, maps and experiments."""
    ik = rm.inverse_kinematics(robot, rm.pose_from_world([0.0, -1.3, 0.0, 0.0, 0.0]))
    assert_type(ik, rm.IKResult)
    assert_type(ik.theta, Floats)
    assert_type(rm.tool_pose(robot, ik.theta), Floats)
    assert_type(rm.cartesian_compliance(robot, ik.theta), Floats)
    found = rm.compliance_map(robot, rm.Grid(x_mm=[0, 50], y_mm=[-1300], z_mm=0))
    assert_type(found, rm.ComplianceMap)
    assert_type(found.values("C_yy"), Floats)
    tests = rm.read_load_tests("tests.csv", robot)
    assert_type(tests, rm.LoadTests | rm.JointTests)
    assert_type(rm.identify(robot, tests).C_theta, Floats)
