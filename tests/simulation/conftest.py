"""Two runs that are looked into."""

from __future__ import annotations

import pytest

from robomill.io.samples import samples_dir
from robomill.io.setups.projects import load_setup
from robomill.simulation.result import SimulationResult
from robomill.simulation.run import simulate


@pytest.fixture(scope="session")
def result() -> SimulationResult:
    """The paper's slot under the paper's force."""
    return simulate(load_setup(samples_dir() / "paper_flute" / "setup.toml"))


@pytest.fixture(scope="session")
def slot() -> SimulationResult:
    """The paper's slot from process data."""
    return simulate(load_setup(samples_dir() / "paper_flute" / "setup_process.toml"))
