"""The band along a run: it lies around what the simulation computed, and holds 95 % of what is drawn at random."""

from __future__ import annotations

import numpy as np
import pytest

import robomill as rm
from robomill.identification.knowledge import Knowledge
from robomill.io.samples import samples_dir
from robomill.simulation.band import deviation_band, size_band, worst_half
from tests.identification.oracles import monte_carlo

SETUP = rm.load_setup(samples_dir() / "paper_flute" / "setup.toml")


def fitted(name, model="joints"):
    """The paper's cut by the compliances that load tests gave, and what is known of them."""
    robot = SETUP.robot
    fit = rm.identify(robot, rm.read_load_tests(samples_dir() / "load_tests" / f"{name}.csv", robot), model)
    arm, springs = fit.applied_to(robot), fit.springs(robot)
    known = Knowledge.of(fit, robot).held_by(arm, springs)
    return rm.simulate(SETUP.replace(robot=arm, springs=springs)), known


@pytest.mark.parametrize("model", ["joints", "joints+bending+tool"])
def test_the_band_belongs_to_what_the_simulation_computes(model):
    """The propagated deflection is the simulated one, so the band lies around the curve that is shown."""
    result, known = fitted("tilted_bending_tool", model)
    band = deviation_band(result, known)
    judged = result.judged
    np.testing.assert_allclose(band.delta[judged], result.delta[judged], atol=1e-12)
    assert np.nanmin(size_band(result, band)[judged]) > 0
    one = deviation_band(result, known, result.worst)
    np.testing.assert_allclose(one.covariance, band.covariance[result.worst], rtol=1e-12)
    assert worst_half(result, known) == pytest.approx(float(size_band(result, band)[result.worst]), rel=1e-12)


def test_the_band_agrees_with_monte_carlo():
    result, known = fitted("grid_45x6")
    known = known.widened(SETUP.robot, force=5.0)
    i = result.worst
    drawn = monte_carlo(result.setup.robot, result.theta[i], result.F[i], known, draws=6000, seed=3)
    size = np.linalg.norm(drawn, axis=-1)
    inside = np.mean(np.abs(size - result.max_deviation) <= worst_half(result, known))
    assert inside == pytest.approx(0.95, abs=0.012)


def test_nothing_is_known_of_compliances_that_are_taken_as_certain():
    result, known = fitted("nine_points")
    assert np.isnan(worst_half(result, None))
    far = rm.simulate(result.setup.replace(T_MW=result.setup.T_MW + np.array([[0, 0, 0, 9.0]] + 3 * [[0] * 4])))
    assert far.worst < 0
    assert np.isnan(worst_half(far, known))


def test_under_a_measured_map_the_band_is_the_maps_own():
    """Drawn at random: maps whose entries scatter by their standard errors, around the map in force."""
    mapped = rm.load_setup(samples_dir() / "paper_flute" / "setup_measured_map.toml")
    result = rm.simulate(mapped)
    _, known = fitted("nine_points")
    band = deviation_band(result, known)
    judged = result.judged
    np.testing.assert_allclose(band.delta[judged], result.delta[judged], atol=1e-12)
    half = worst_half(result, known)
    joints = deviation_band(rm.simulate(mapped.replace(measured_map=None)), known, result.worst)
    assert half > 0
    assert half == pytest.approx(worst_half(result, None), rel=1e-12)
    assert abs(half - float(size_band(result, joints, result.worst))) > 1e-9


def test_with_a_longer_tool_the_band_lies_around_its_own_deflection():
    from robomill.cutting.tool_table import TableTool, ToolTable
    from robomill.toolpath.source import GCodeSource

    result, known = fitted("grid_45x6")
    cutter = SETUP.cutter
    text = "G21 G90 S9000 M3\nT1 M6\nG0 X-40 Y0 Z5\nG1 Z-1 F900\nG1 X0\nT2 M6\nG1 X40\nM2\n"
    table = ToolTable((TableTool(1, cutter, 0.05), TableTool(2, cutter, 0.12)))
    run = rm.simulate(result.setup.replace(source=GCodeSource(text), tools=table, step=8e-3))
    band = deviation_band(run, known)
    np.testing.assert_allclose(band.delta[run.judged], run.delta[run.judged], atol=1e-12)
    last = int(np.flatnonzero(run.judged)[-1])
    np.testing.assert_allclose(deviation_band(run, known, last).covariance, band.covariance[last], rtol=1e-9)
