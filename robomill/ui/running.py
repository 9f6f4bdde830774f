"""A run on a page: at once where it is short; beside the page where it is long, with its progress and a way to stop it;
only when asked for where it takes minutes. Until it is there, the page shows the run before it, greyed."""

from __future__ import annotations

import streamlit as st

from robomill.arrays import digest
from robomill.simulation.estimate import run_seconds
from robomill.simulation.result import SimulationResult
from robomill.simulation.setup import SimulationSetup
from robomill.ui import cached, inputs, job, pieces, session
from robomill.ui.job import Job

SHORT_S = 0.3  # a run that takes about so long is waited for
ASK_S = 60.0  # and one that takes longer than this is asked for
FIRST_S = 0.3  # any other is waited for so long, lest the page changes twice
KEY, LAST, ASKED, STOPPED = "run", "run.last", "run.asked", "run.stopped"
GREYED = """<style>[data-testid="stMain"] :is(.rm-tiles, .rm-title, .rm-lead, .rm-facts, .rm-matrix,
[data-testid="stPlotlyChart"], [data-testid="stImage"], .st-key-milling-verdict) { opacity: .4; }</style>"""


def result(setup: SimulationSetup) -> SimulationResult | None:
    """The run of ``setup``. Where it is not there yet: its progress, or the button that begins it, and the run before
    it greyed; None where there was none. Raises the refusal of the run."""
    found = cached.held(setup)
    if found is None:
        found = cached.result(setup) if run_seconds(setup) <= SHORT_S else _beside(setup)
    if found is not None:
        job.give_up(KEY)
        session.keep(LAST, found)
        return found
    if session.kept(KEY) is not None:
        job.waiting(KEY, _words, _stop)
    else:
        _ask(setup)
    st.html(GREYED)
    return _before(setup)


def there(setup: SimulationSetup) -> bool:
    """Whether the run of ``setup`` is kept, or short: what only adds to a page asks before it needs it."""
    return cached.held(setup) is not None or run_seconds(setup) <= SHORT_S


def shown(setup: SimulationSetup) -> SimulationResult | None:
    """What ``result`` has answered, for a part of the page that is run by itself."""
    return cached.held(setup) or _before(setup)


def _before(setup: SimulationSetup) -> SimulationResult | None:
    """The run before, where it is of the same path and of an arm with as many joints."""
    last: SimulationResult | None = session.kept(LAST)
    if last is None or last.setup.robot.n != setup.robot.n or digest(last.setup.source) != digest(setup.source):
        return None
    return last


def _beside(setup: SimulationSetup) -> SimulationResult | None:
    """The run, if it is soon there; else it goes on beside the page, unless it has to be asked for."""
    name, now = setup.digest(), session.kept(KEY)
    if now is None or now.about.digest() != name:
        job.give_up(KEY)
        if session.kept(STOPPED) == name or (run_seconds(setup) > ASK_S and session.kept(ASKED) != name):
            return None
        job.begin(KEY, Job(lambda _: cached.result(setup), setup))
    ended = job.finished(KEY, FIRST_S)
    if ended is None:
        return None
    session.drop(KEY)
    if ended.error is not None:
        raise ended.error
    made: SimulationResult | None = ended.made
    return made


def _stop() -> None:
    now: Job | None = session.kept(KEY)
    if now is not None:
        session.keep(STOPPED, now.about.digest())
    session.drop(ASKED)
    job.give_up(KEY)


def _ask(setup: SimulationSetup) -> None:
    with st.container(horizontal=True, vertical_alignment="center", gap="small"):
        inputs.button("Run", "run.ask", "play_arrow", _begin, setup.digest(), type="primary")
        pieces.note(
            f"Not computed yet: this takes about {_long(run_seconds(setup))}. What is grey is the run before it."
        )


def _begin(name: str) -> None:
    session.drop(STOPPED)
    session.keep(ASKED, name)


def _words(now: Job) -> str:
    left = f", about {_long(now.left_s)} left" if now.left_s >= 1.0 else ""
    return f"{now.stage or 'Simulating'}: {100 * now.share:.0f} %{left}"


def _long(seconds: float) -> str:
    if seconds < 100.0:
        return f"{max(seconds, 1.0):.0f} s"
    return f"{seconds / 60.0:.0f} min" if seconds < 6000.0 else f"{seconds / 3600.0:.0f} h"
