"""Two runs that the figures draw."""

from __future__ import annotations

import pytest
from plotly_checks import checked_figure

from robomill.io.samples import samples_dir
from robomill.io.setups.projects import load_setup
from robomill.simulation.result import SimulationResult
from robomill.simulation.run import simulate
from robomill.viz.chart import Chart


@pytest.fixture(autouse=True)
def checked(monkeypatch: pytest.MonkeyPatch) -> None:
    """Figures are made without plotly's own checks, for speed; here each is checked."""
    monkeypatch.setattr(Chart, "figure", property(checked_figure))


@pytest.fixture(scope="session")
def result() -> SimulationResult:
    """The paper's slot under the paper's force."""
    return simulate(load_setup(samples_dir() / "paper_flute" / "setup.toml"))


@pytest.fixture(scope="session")
def process_result() -> SimulationResult:
    """The paper's slot from process data."""
    return simulate(load_setup(samples_dir() / "paper_flute" / "setup_process.toml"))
