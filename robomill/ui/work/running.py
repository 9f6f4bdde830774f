"""A run on a page: at once where it is short; beside the page where it is long, with its progress and a way to stop it;
only when asked for where it takes minutes. Until it is there, the page shows the run before it, greyed."""

from collections.abc import Callable
from typing import Any, TypeVar

import streamlit as st

from robomill.arrays import digest
from robomill.errors import RobomillError, ToolpathError
from robomill.simulation.estimate import run_seconds
from robomill.simulation.result import SimulationResult
from robomill.simulation.setup import SimulationSetup
from robomill.toolpath.path import Toolpath
from robomill.ui import session
from robomill.ui.work import beside, cached, job
from robomill.ui.work.job import Underway

Value = TypeVar("Value")
SHORT_S = 0.3  # a run that takes about so long is waited for
PLACE, LAST, READING = "run", "run.last", "run.path"
GREYED = """<style>[data-testid="stMain"] :is(.rm-tiles, .rm-title, .rm-lead, .rm-facts, .rm-matrix,
[data-testid="stPlotlyChart"], [data-testid="stImage"]) { opacity: .4; }</style>"""


def result(setup: SimulationSetup) -> SimulationResult | None:
    """The run of ``setup``. Where it is not there yet: its progress, or the button that begins it, and the run before
    it greyed; None where there was none. Raises the refusal of the run."""
    found = cached.held(setup)
    if found is None:
        try:
            found = computed(setup)
        except Underway as now:
            now.show()
            st.html(GREYED)
            return before(setup)
    take(found)
    return found


def take(found: SimulationResult) -> None:
    """``found`` is the run that the page shows: nothing else is under way for it, and it is the one before the next."""
    job.give_up(PLACE)
    session.hold(LAST, found)


def computed(setup: SimulationSetup, place: str = PLACE) -> SimulationResult:
    """The run of ``setup``, kept or made. Raises its refusal, and ``Underway`` where it goes on beside the page."""
    path_of(setup)

    def made() -> SimulationResult:
        if there(setup):
            return cached.result(setup)
        seconds = run_seconds(setup)
        found: SimulationResult = beside.made(
            place, cached.by_setup(setup), lambda: cached.result(setup), "Simulating", seconds
        )
        return found

    return cached.held(setup) or _refused_once(place, cached.by_setup(setup), made)


def path_of(setup: SimulationSetup) -> Toolpath:
    """The path, which a program that goes round in loops lets wait for: raises its refusal, and ``Underway``."""
    if "toolpath" in vars(setup):
        return setup.toolpath

    def made() -> Toolpath:
        path: Toolpath = beside.made(READING, _named(setup), lambda: setup.toolpath, "Reading the program")
        return path

    return _refused_once(READING, _named(setup), made)


def _refused_once(place: str, name: Any, make: Callable[[], Value]) -> Value:
    """What ``make`` answers. A refusal is not kept: without this, the bar and the page would have it worked out twice,
    and where that goes on beside the page, without end."""
    asked = session.store().runs, digest(name)
    told = session.kept(f"{place}.refused")
    if told is not None and told[0] == asked:
        raise told[1]
    try:
        return make()
    except RobomillError as exc:
        session.keep(f"{place}.refused", (asked, exc))
        raise


def wait_for_path(setup: SimulationSetup) -> None:
    """For what is decided at once: raises ToolpathError while the program is read beside the page, or once that was
    cancelled."""
    if "toolpath" not in vars(setup) and (session.kept(READING) or session.kept(f"{READING}.stopped") == _named(setup)):
        raise ToolpathError("The program is not read yet: wait until it is, or open another one.")


def _named(setup: SimulationSetup) -> tuple[str, str]:
    return digest(setup.source), digest(setup.tools)


def there(setup: SimulationSetup) -> bool:
    """Whether the run of ``setup`` is kept, or short: what only adds to a page asks before it needs it."""
    return cached.held(setup) is not None or run_seconds(setup) <= SHORT_S


def quiet(setup: SimulationSetup) -> SimulationResult | None:
    """The run of ``setup``, or None where it is refused or not there yet: for what works without one."""
    try:
        path_of(setup)
        return cached.result(setup) if there(setup) else None
    except (RobomillError, Underway):
        return None


def shown(setup: SimulationSetup) -> SimulationResult | None:
    """What ``result`` has answered, for a part of the page that is run by itself."""
    return cached.held(setup) or before(setup)


def before(setup: SimulationSetup) -> SimulationResult | None:
    """The run before ``setup``'s, where it is of the same path and of an arm with as many joints."""
    last: SimulationResult | None = session.kept(LAST)
    if last is None or last.setup.robot.n != setup.robot.n or digest(last.setup.source) != digest(setup.source):
        return None
    return last
