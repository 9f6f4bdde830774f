"""Long work of a page, made beside it: waited for where it is short; else its progress stands where its answer will,
with a way to stop it, and a button that begins it again."""

from collections.abc import Callable
from functools import partial
from typing import Any

import streamlit as st
from streamlit.runtime.scriptrunner import get_script_run_ctx

from robomill.ui import session
from robomill.ui.entry import inputs
from robomill.ui.markup import quiet
from robomill.ui.work import job
from robomill.ui.work.job import Job, Underway
from robomill.units import format_duration, format_percent

FIRST_S = 0.3  # any work is waited for so long, lest the page changes twice
ASK_S = 60.0  # what takes longer than this is asked for


def on_a_page() -> bool:
    """Whether it is a page that asks, and not work beside one."""
    return get_script_run_ctx(suppress_warning=True) is not None


def made(place: str, name: Any, make: Callable[[], Any], doing: str, seconds: float = 0.0, group: str = "") -> Any:
    """What ``make`` answers, called in another thread, so that it knows no page. Raises its refusal, and ``Underway``
    while it is not there: then ``doing`` says what is done, and where it takes ``seconds`` beyond a minute it is begun
    by a button only.

    Work of another ``name`` at this ``place`` is superseded, and given up; so is work of the same ``group`` that this
    run of the page has not asked for yet.
    """
    now: Job | None = session.kept(place)
    if now is None or now.about != name:
        job.give_up(place)
        stopped = session.kept(f"{place}.stopped") == name
        if stopped or (seconds > ASK_S and session.kept(f"{place}.asked") != name):
            raise Underway(partial(_ask, place, name, doing, seconds), place)
        _supersede(group)
        now = Job(make, name, group)
        job.begin(place, now)
        session.hold(place, now)  # what it makes is kept for everyone, too
    runs = session.store().runs
    waited = now.run == runs  # this run of the page has waited for it once
    now.run = runs
    ended = job.finished(place, 0.0 if waited else FIRST_S)
    if ended is None:
        raise Underway(partial(job.waiting, place, partial(words, doing), partial(_stop, place)), place)
    session.drop(place)
    if ended.error is not None:
        raise ended.error
    return ended.made


def _supersede(group: str) -> None:
    """Give up the work of ``group`` that an earlier run of the page has asked for, and this one not."""
    held = session.store()
    for place, kept in list(held.values.items()):
        if group and isinstance(kept, Job) and kept.group == group and kept.run < held.runs:
            job.give_up(place)


def words(doing: str, now: Job) -> str:
    """How far a job is."""
    return f"{now.progress.stage or doing}, {format_percent(now.progress.share)}{left(now)}"


def left(now: Job) -> str:
    """How long a job goes on, where one can tell."""
    return f", about {format_duration(now.progress.left_s, 0)} left" if now.progress.left_s >= 1.0 else ""


def _stop(place: str) -> None:
    now: Job | None = session.kept(place)
    if now is not None:
        session.keep(f"{place}.stopped", now.about)
    session.drop(f"{place}.asked")
    job.give_up(place)


def _ask(place: str, name: Any, doing: str, seconds: float) -> None:
    with st.container(horizontal=True, vertical_alignment="center", gap="small", key=job.box(place)):
        inputs.button("Run", f"{place}.ask", "play_arrow", begin, place, name, type="primary")
        takes = f" This takes about {format_duration(max(seconds, 1.0), 0)}." if seconds else ""
        st.html(quiet(f"{doing}: not computed yet.{takes}"))


def begin(place: str, name: Any) -> None:
    """Have work of this ``name`` begun, which a button asks for."""
    session.drop(f"{place}.stopped")
    session.keep(f"{place}.asked", name)
