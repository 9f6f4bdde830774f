"""A run can be given up in each of its stages, soon after it is asked to; watched or not it is the same run."""

from __future__ import annotations

import dataclasses
import threading
import time
from contextlib import suppress

import numpy as np
import pytest

import robomill as rm
from robomill.progress import Cancelled, Progress, watched
from robomill.simulation.origin.spread import alloy_spread, peak_force
from robomill.simulation.setup import SimulationSetup
from robomill.surface.mesh import to_mesh
from tests.telling import told

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
    assert {"Trying arm positions", "Compliance", "Walls", "Floors"} <= set(names)
    assert ("Force and deflection, step by step" in names) == setup.coupling
    assert ("What each step meets" in names) == setup.engagement
    for name in names:
        assert given_up_at(setup, name) == [name]


@pytest.mark.parametrize("case", CASES)
def test_shares_of_a_run_and_of_what_a_page_asks_of_it_rise(setups: dict[str, SimulationSetup], case: str) -> None:
    heard = told(lambda: _everything(setups[case]))
    assert len(heard) > 10
    # Pieces that take long are told one by one.
    assert len(heard["Sections"]) == 5
    steps = heard.get("Force and deflection, step by step", [0.0])
    np.testing.assert_allclose(steps, np.arange(len(steps)) / len(steps), atol=1e-12)


def given_up_at(setup: SimulationSetup, name: str) -> list[str]:
    """Run until the stage called ``name`` begins; what was said from there on."""
    said: list[str] = []
    now = Progress(lambda: name in said, lambda now: said.append(now.stage))
    with watched(now), pytest.raises(Cancelled):
        _ = rm.simulate(setup).verdict
    return said[said.index(name) :]


@pytest.fixture(scope="module")
def fine(setups: dict[str, SimulationSetup]) -> dict[str, SimulationSetup]:
    """Some seconds of work each, whose every stage is longer than anybody waits; all that is compiled at first is."""
    steps = {"full slot": 1.5e-6, "engagement": 4e-6, "coupling": 1e-4, "tilted": 2e-4}
    for setup in setups.values():
        _everything(setup)
    return {name: setups[name].replace(step=step) for name, step in steps.items()}


def _everything(setup: SimulationSetup) -> None:
    """A run, and what a page asks of it."""
    result = rm.simulate(setup)
    _ = result.notes, result.error
    result.grooves(np.linspace(0.1, 0.9, 5) * float(result.path.s[-1]))
    alloy_spread(result)
    peak_force(result)
    to_mesh(result.machined)
    if len(result.path) < 20_000:  # the gauge takes by the square of the samples
        _ = result.verdict, result.surface_notes


@pytest.mark.slow
@pytest.mark.parametrize("case", CASES)
def test_between_two_checkpoints_lies_little_time(fine: dict[str, SimulationSetup], case: str) -> None:
    """The longest that anybody waits for the end of what is given up. A loaded machine is slow, so that no more than a
    share of the run is asked for."""
    times, stages = [time.process_time()], ["begin"]

    def say(now: Progress) -> None:
        times.append(time.process_time())
        stages.append(now.stage)

    with watched(Progress(say=say)):
        _everything(fine[case])
    times.append(time.process_time())
    gaps = np.diff(times)
    worst = int(np.argmax(gaps))
    assert gaps[worst] < max(0.08 * (times[-1] - times[0]), 0.3), stages[worst]


@pytest.mark.slow
@pytest.mark.parametrize("case", CASES)
def test_whenever_it_is_given_up_it_ends_soon(fine: dict[str, SimulationSetup], case: str) -> None:
    began = time.process_time()
    with watched(Progress()):
        _everything(fine[case])
    whole, rng = time.process_time() - began, np.random.default_rng(5)
    for _ in range(3):
        unwanted, at = threading.Event(), [0.0]

        def give_up(unwanted: threading.Event = unwanted, at: list[float] = at) -> None:
            at[0] = time.process_time()
            unwanted.set()

        timer = threading.Timer(rng.uniform(0.0, 0.8) * whole, give_up)
        timer.start()
        with watched(Progress(unwanted.is_set)), suppress(Cancelled):
            _everything(fine[case])
            timer.cancel()
            continue
        assert time.process_time() - at[0] < max(0.08 * whole, 0.3)
