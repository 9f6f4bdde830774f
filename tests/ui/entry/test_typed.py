"""What a widget held before it was given its value is not taken for typed; everything else that it holds is."""

from typing import Any

import pytest
import streamlit as st

from robomill.ui import session
from robomill.ui.entry import typed
from robomill.ui.project import DEFAULT_PRESET, Project, preset_setup


class Clock:
    """A clock that goes by hand."""

    now = 100.0

    def monotonic(self) -> float:
        return self.now


@pytest.fixture
def held(monkeypatch: pytest.MonkeyPatch) -> session.Store:
    made = session.Store(Project(preset_setup(DEFAULT_PRESET)), said={})
    monkeypatch.setattr(st, "session_state", {session.KEY: made})
    return made


@pytest.fixture
def clock(monkeypatch: pytest.MonkeyPatch) -> Clock:
    made = Clock()
    monkeypatch.setattr(typed, "time", made)
    return made


def takes(value: Any) -> bool:
    """Whether ``value``, in the box now, is taken."""
    taken: list[Any] = []
    st.session_state["box"] = value
    typed.news("box", lambda: taken.append(value))()
    return taken == [value]


def told(*values: Any) -> None:
    """The box is given them, one a run."""
    for value in values:
        typed.seed("box", value)


def test_a_box_that_was_only_seeded_is_heard(held: session.Store, clock: Clock):
    told("1")
    assert takes("1")
    assert takes("2")


@pytest.mark.parametrize("late", ["1", "2"])
def test_what_stood_there_before_is_behind_however_often_it_was_told(held: session.Store, clock: Clock, late: str):
    told("1", "2", "3")
    assert not takes(late)
    assert takes("5")


def test_what_the_browser_says_anew_is_typed(held: session.Store, clock: Clock):
    told("1", "2")
    assert held.said is not None
    held.said["box"] = clock.now - 1.0
    assert not takes("1")
    held.said["box"] = clock.now
    assert takes("1")


def test_a_browser_is_behind_for_a_while_only(held: session.Store, clock: Clock):
    told("1", "2")
    clock.now += typed.BEHIND_S - 0.1
    assert not takes("1")
    clock.now += 0.2
    assert takes("1")
    assert takes("2")
    told("3")
    assert not takes("2")
    assert takes("1"), "too long ago to be behind"


def test_where_nobody_listens_everything_is_typed(held: session.Store, clock: Clock):
    held.said = None
    told("1", "2")
    assert takes("1")


def test_another_page_has_nothing_behind(held: session.Store, clock: Clock, monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setattr(session, "while_open", lambda _: None)
    told("1", "2")
    session.enter("Robot")
    assert takes("1")
