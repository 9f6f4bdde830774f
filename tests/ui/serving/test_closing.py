"""What a session holds goes with its browser; what it keeps stays."""

import gc
import itertools
import weakref
from types import SimpleNamespace

import pytest
from streamlit.runtime.caching import clear_session_resource_cache
from streamlit.runtime.scriptrunner import get_script_run_ctx
from streamlit.testing.v1 import AppTest

from robomill.ui.project import Project, preset_setup
from robomill.ui.serving import closing
from robomill.ui.session import KEY, Store
from robomill.ui.work.job import Job


def visit() -> None:
    import streamlit as st

    from robomill.ui import session

    session.enter("Start")
    session.keep("note", "kept")
    session.hold("run", "heavy")
    st.text(str(session.kept("run")))


@pytest.fixture
def app(monkeypatch: pytest.MonkeyPatch) -> AppTest:
    """A page that was visited; nobody's before it is still there."""
    clear_session_resource_cache("test session id")
    return AppTest.from_function(visit).run()


def leave() -> None:
    """What Streamlit does when the browser's connection ends."""
    assert get_script_run_ctx(suppress_warning=True) is None
    clear_session_resource_cache("test session id")


def test_what_is_held_goes_with_the_browser_and_comes_back_with_it(app: AppTest) -> None:
    held: Store = app.session_state[KEY]
    assert app.text[0].value == "heavy"
    assert held.values["run"] == "heavy"
    leave()
    assert "run" not in held.values
    assert held.values["note"] == "kept"
    app.run()
    assert held.values["run"] == "heavy"
    leave()
    assert "run" not in held.values


def test_work_under_way_stays_for_a_browser_that_comes_back(app: AppTest) -> None:
    held: Store = app.session_state[KEY]
    work = Job(lambda: "made", "about")
    held.values["work"] = work
    held.heavy.add("work")
    leave()
    assert held.values["work"] is work
    app.run()
    work.done.set()
    held.heavy.add("work")
    leave()
    assert "work" not in held.values


def test_rings_are_looked_for_now_and_then(app: AppTest, monkeypatch: pytest.MonkeyPatch) -> None:
    class Ring(SimpleNamespace):
        pass

    def ring() -> weakref.ref[Ring]:
        made = Ring()
        made.itself = made
        return weakref.ref(made)

    gc.disable()
    try:
        monkeypatch.setattr(closing, "COLLECT_S", 0.0)
        one = ring()
        leave()
        assert one() is None
        monkeypatch.setattr(closing, "COLLECT_S", 3600.0)
        app.run()
        other = ring()
        leave()
        assert other() is not None, "a look takes its time: not at every close"
    finally:
        gc.enable()


def test_what_stands_as_long_as_the_server_is_set_aside_once(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(closing, "_runs", itertools.count(1))
    monkeypatch.setattr(closing, "SETTLED", 2)
    before = gc.get_freeze_count()
    try:
        closing.settle()
        assert gc.get_freeze_count() == before
        closing.settle()
        aside = gc.get_freeze_count()
        assert aside > before + 10_000
        ring = Store(Project(preset_setup("paper_flute")))
        ring.values["itself"], gone = ring, weakref.ref(ring)
        closing.settle()
        assert gc.get_freeze_count() <= aside  # less, where what was set aside has gone by itself
        del ring
        gc.collect()
        assert gone() is None
    finally:
        gc.unfreeze()
