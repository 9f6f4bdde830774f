"""Ranges of the verdict's numbers against runs of their own with what varies put in force."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest

from robomill.compliance.springs.tool_bending import ToolBending
from robomill.identification.fit.models import Model
from robomill.identification.knowledge import Knowledge
from robomill.io.samples import samples_dir
from robomill.io.setups.projects import load_setup
from robomill.report.ranges import out_over, ranges
from robomill.simulation.origin.spread import peak_force
from robomill.simulation.run import simulate
from robomill.simulation.setup import SimulationSetup


@pytest.fixture(scope="module")
def setup() -> SimulationSetup:
    return load_setup(samples_dir() / "paper_flute")


def test_assumed_lengths_leave_the_wall_and_move_the_floor(setup: SimulationSetup) -> None:
    (found,) = ranges(simulate(setup), None)
    assert found.kind == "assumed"
    assert found.wall == pytest.approx((0.225e-3, 0.235e-3), abs=1e-6)  # C_yy is what the lengths were chosen by
    assert found.floor[0] < -0.186e-3 < -0.1024e-3 < -0.067e-3 < found.floor[1]
    assert found.share == pytest.approx((found.wall[0] / 0.3e-3, found.wall[1] / 0.3e-3))


@pytest.mark.parametrize(("tolerance", "level", "doubtful"), [(0.3, "ok", 0), (0.232, "tight", 1), (0.2, "out", 0)])
def test_only_of_a_cut_within_tolerance_it_is_told_over_what_it_could_be_out(
    setup: SimulationSetup, tolerance: float, level: str, doubtful: int
) -> None:
    """The wall is 0.230 mm off, and 0.235 mm with the longest arm that the paper allows."""
    result = simulate(setup.replace(tolerance=tolerance * 1e-3))
    assert result.verdict.level == level
    assert [each.over for each in out_over(result.verdict, ranges(result, None))] == ["assumed lengths"] * doubtful


def test_each_row_of_the_alloy_in_force_stays_within_the_range() -> None:
    setup = load_setup(samples_dir() / "paper_flute" / "setup_process.toml").replace(coupling=False)
    result = simulate(setup)
    found = next(r for r in ranges(result, None) if "coefficients" in r.over)
    i, walls = result.verdict.wall.worst, []
    for material in (setup.force.material, *setup.force.alternatives):  # type: ignore[attr-defined]
        own = setup.force.material  # type: ignore[attr-defined]
        filled = material.replace(**{name: getattr(own, name) for name in material.missing})  # unknown is not zero
        other = simulate(setup.replace(force=dataclasses.replace(setup.force, material=filled, alternatives=())))  # type: ignore[type-var]
        walls.append(float(result.verdict.wall.value + other.delta_in_cut[i, 1] - result.delta_in_cut[i, 1]))
    assert len(walls) > 2
    assert found.wall == pytest.approx((min(walls), max(walls)), abs=1e-9)


def test_a_tooth_bends_the_tool_by_its_own_force() -> None:
    """Bending across the axis is the same every way: the tool's part of the wall grows as the force across it does."""
    setup = load_setup(samples_dir() / "paper_flute" / "setup_process.toml")
    cutter = setup.cutter.replace(stick_out=0.04)
    setup = setup.replace(cutter=cutter, springs=(ToolBending.first(cutter),), coupling=False)
    result = simulate(setup)
    i, peak = result.verdict.wall.worst, peak_force(result)
    assert peak is not None
    left = np.cross([0.0, 0.0, 1.0], [1.0, 0.0, 0.0])  # of a feed along X
    mean = float(result.F[i] @ left)
    bend = float(result.delta_spring[i, 0] @ left)
    more = [bend * (float(force[i, 1]) / mean - 1.0) for force in (peak.low, peak.high)]
    found = next(r for r in ranges(result, None) if r.kind == "computed")
    value = result.verdict.wall.value
    assert max(more) > 1e-6
    assert found.wall == pytest.approx((value + min(more), value + max(more)), abs=1e-9)


def test_a_band_of_one_joint_is_where_that_joint_leads(setup: SimulationSetup) -> None:
    robot, sigma = setup.robot, 0.05
    variance = np.zeros((5, 5))
    variance[2, 2] = (sigma * robot.C_theta[2]) ** 2
    known = Knowledge(Model("joints"), np.array(robot.C_theta), variance, source="tests")
    result = simulate(setup)
    found = next(r for r in ranges(result, known) if r.kind == "measured")
    ends = []
    for side in (-1.0, 1.0):
        C_theta = np.array(robot.C_theta)
        C_theta[2] *= 1.0 + side * 1.959964 * sigma
        verdict = simulate(setup.replace(robot=robot.replace(C_theta=C_theta))).verdict
        ends.append((verdict.wall.value, verdict.floor.value))
    assert found.wall == pytest.approx(sorted(wall for wall, _ in ends), abs=1e-7)
    assert found.floor == pytest.approx(sorted(floor for _, floor in ends), abs=1e-7)
