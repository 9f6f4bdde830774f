"""The force along the cut: one line and one band, components on demand."""

from __future__ import annotations

import numpy as np
import pytest

import robomill as rm
from robomill.cutting.force import COMPONENTS
from robomill.io.samples import samples_dir
from robomill.simulation.origin.spread import alloy_spread, peak_force
from robomill.viz.engagement import force_figure


@pytest.fixture(scope="module")
def run() -> rm.SimulationResult:
    return rm.simulate(rm.load_setup(samples_dir() / "paper_flute" / "setup_process.toml").replace(cell=4e-4))


def test_the_mean_force_and_one_band_are_shown_and_components_come_with_a_click(run):
    fig = force_figure(run, alloy_spread(run), peak_force(run), "mm", dark=False)
    shown = [trace["name"] for trace in fig.traces if trace.get("visible", True) is True]
    assert set(shown) == {"mean force", "range over published coefficients"}
    assert [t["name"] for t in fig.traces if t.get("visible") == "legendonly"] == list(COMPONENTS.values())
    assert fig.layout["height"] == 320
    mean = next(trace for trace in fig.traces if trace["name"] == "mean force")
    cut = np.isfinite(mean["y"])
    np.testing.assert_allclose(np.asarray(mean["y"])[cut], np.linalg.norm(run.F, axis=1)[run.path.cutting])


def test_without_other_rows_the_band_reaches_to_the_peak_of_a_turn_and_a_stated_force_has_none(run):
    peak = peak_force(run)
    fig = force_figure(run, None, peak, "mm", dark=True)
    band = next(trace for trace in fig.traces if trace["name"] == "to the peak of a turn")
    assert max(band["y"]) == pytest.approx(np.nanmax(np.linalg.norm(peak.at_peak, axis=1)[run.judged]), rel=1e-6)
    assert next(t["name"] for t in force_figure(run, None, None, "mm", dark=True).traces) == "mean force"
