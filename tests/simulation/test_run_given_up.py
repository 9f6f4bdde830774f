"""A run can be given up in each of its stages, soon after it is asked to; watched or not it is the same run."""

from __future__ import annotations

import dataclasses
import time

import numpy as np
import pytest

import robomill as rm
from robomill.progress import Cancelled, Progress, watched
from robomill.simulation.setup import SimulationSetup

CASES = {
    "full slot": {},
    "engagement": {"engagement": True},
    "coupling": {"engagement": True, "coupling": True},
    "tilted": {},
}


@pytest.fixture(scope="module")
def setups() -> dict[str, SimulationSetup]:
    given = rm.load_setup("samples/paper_flute/setup_process.toml").replace(engagement=False)
    path = given.toolpath
    k = np.tile([0.0, -np.sin(0.1), np.cos(0.1)], (len(path), 1))
    made = {name: given.replace(**changes) for name, changes in CASES.items()}

    @dataclasses.dataclass(frozen=True)
    class Tilted:
        kind: str = "lines"
        name: str = "tilted"

        def read(self, tools: object = None) -> object:
            return dataclasses.replace(path, k=k)

    return {**made, "tilted": given.replace(source=Tilted(), engagement=True)}


@pytest.mark.parametrize("case", CASES)
def test_it_stops_at_every_stage_and_a_watched_run_is_the_same(setups: dict[str, SimulationSetup], case: str) -> None:
    setup = setups[case]
    stages: list[str] = []
    with watched(Progress(say=lambda now: stages.append(now.stage))):
        seen = rm.simulate(setup)
        sentence = seen.verdict.sentence
    plain = rm.simulate(setup)
    np.testing.assert_array_equal(seen.delta, plain.delta)
    np.testing.assert_array_equal(seen.machined.z, plain.machined.z)
    assert sentence == plain.verdict.sentence
    names = list(dict.fromkeys(stages))
    assert {"How the arm stands", "Compliance", "Walls", "Floors"} <= set(names)
    assert ("Force and deflection, step by step" in names) == setup.coupling
    assert ("What each step meets" in names) == setup.engagement
    for name in names:
        assert given_up_at(setup, name) == [name]


def given_up_at(setup: SimulationSetup, name: str) -> list[str]:
    """Run until the stage called ``name`` begins; what was said from there on."""
    said: list[str] = []
    now = Progress(lambda: name in said, lambda now: said.append(now.stage))
    with watched(now), pytest.raises(Cancelled):
        _ = rm.simulate(setup).verdict
    return said[said.index(name) :]


@pytest.mark.slow
@pytest.mark.parametrize("case", CASES)
def test_between_two_checkpoints_lies_little_time(setups: dict[str, SimulationSetup], case: str) -> None:
    """Fine steps and cells: the longest that anybody waits for the end of what is given up. A loaded machine is slow,
    so that no more than a share of the run is asked for."""
    setup = setups[case].replace(step=1e-4 if case == "coupling" else 2e-5)
    _ = rm.simulate(setups[case]).verdict  # what is compiled or imported at first
    times = [time.process_time()]
    with watched(Progress(say=lambda now: times.append(time.process_time()))):
        _ = rm.simulate(setup).verdict
    times.append(time.process_time())
    whole, longest = times[-1] - times[0], max(np.diff(times))
    assert longest < max(0.15 * whole, 0.3)
