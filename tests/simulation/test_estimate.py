"""The time that a run is said to take: its samples and their neighbours counted one by one."""

from __future__ import annotations

import numpy as np
import pytest

import robomill as rm
from robomill.io.samples import samples_dir
from robomill.simulation.estimate import A_COUPLED_STEP, A_NEIGHBOUR, A_RUN, A_SAMPLE, A_STEP, run_seconds
from robomill.toolpath.source import GCodeSource

PROCESS = rm.load_setup(samples_dir() / "paper_flute" / "setup_process.toml")
STATED = rm.load_setup(samples_dir() / "paper_flute" / "setup.toml")


@pytest.mark.parametrize(("length", "step"), [(80, 1e-3), (80, 0.2e-3), (5, 0.1e-3)])
def test_time_grows_with_samples_and_with_those_within_the_width_of_the_tool(length, step):
    setup = STATED.replace(step=step, source=GCodeSource(f"G21 S9000 M3\nG1 Z-1 F900\nX{length}\nM2\n"))
    setup = setup.replace(engagement=False)
    s = rm.simulate(setup).path.s
    beside = (np.abs(s[:, None] - s) <= 0.5 * setup.cutter.diameter).sum()
    expected = A_RUN + len(s) * A_SAMPLE + beside * A_NEIGHBOUR
    assert run_seconds(setup) == pytest.approx(expected, rel=0.05)


@pytest.mark.parametrize(
    ("engagement", "coupling", "each"), [(False, False, 0.0), (True, False, A_STEP), (True, True, A_COUPLED_STEP)]
)
def test_a_step_that_is_marched_takes_longer_and_one_that_is_settled_longer_still(engagement, coupling, each):
    plain = PROCESS.replace(engagement=False, coupling=False)
    count = len(rm.simulate(plain.replace(cell=1e-3)).path)
    more = run_seconds(PROCESS.replace(engagement=engagement, coupling=coupling)) - run_seconds(plain)
    assert more == pytest.approx(count * each, rel=0.05)
