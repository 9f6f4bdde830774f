"""Long runs beside the page: progress, cancel, the run before it; superseded work stops; refusals arrive."""

from __future__ import annotations

import re
import threading
from collections.abc import Iterator
from functools import partial
from typing import Any

import pytest
from conftest import errors, go, store, words
from streamlit.testing.v1 import AppTest

from robomill import progress
from robomill.errors import SetupError
from robomill.progress import checkpoint
from robomill.simulation.run import simulate
from robomill.ui.work import beside, cached, job, running
from robomill.ui.work.job import Job


class Slow:
    """``simulate`` that stays in the midst of its work until it is let go or given up."""

    def __init__(self) -> None:
        self.go, self.ended, self.count = threading.Event(), threading.Event(), 0

    def __call__(self, setup: Any) -> Any:
        if progress._watching.get() is None:  # a page that computes by itself would stand still here
            raise AssertionError("a long run in the page's own thread")
        self.count += 1
        try:
            while not self.go.wait(0.01):
                checkpoint(0.25, "Marching")
            return simulate(setup)
        finally:
            self.ended.set()


@pytest.fixture
def slow(app: AppTest, monkeypatch: pytest.MonkeyPatch) -> Iterator[Slow]:
    """From now on every run that is not kept yet is long."""
    made = Slow()
    cached.commons.clear()
    go(app, "6_Milling")  # the run before
    monkeypatch.setattr(cached, "simulate", made)
    monkeypatch.setattr(running, "run_seconds", lambda setup: 5.0)
    monkeypatch.setattr(beside, "FIRST_S", 0.2)
    yield made
    made.go.set()


def edit(app: AppTest, tolerance: float) -> AppTest:
    held = store(app)
    held.put(held.project.replace(setup=held.project.setup.replace(tolerance=tolerance)))
    return app.run()


def running_job(app: AppTest) -> Job:
    found = store(app).values[running.PLACE]
    assert isinstance(found, Job)
    return found


def test_progress_over_the_run_before_and_then_the_new_one(app: AppTest, slow: Slow) -> None:
    edit(app, 0.1e-3)
    assert not app.exception
    assert app.button(key="run.cancel")
    assert running.GREYED in words(app)
    assert "0.23 mm" in words(app)  # of the run before
    assert store(app).values[running.PLACE].progress.stage == "Marching"
    slow.go.set()
    assert running_job(app).done.wait(30)
    app.run()
    assert running.GREYED not in words(app)
    assert running.PLACE not in store(app).values
    assert "of 0.10 mm" in words(app)
    assert not app.exception


def test_bar_and_words_say_one_share_while_the_work_goes_on(
    app: AppTest, slow: Slow, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Between the two the work is made to come as far as the end of its stage."""
    told = beside.words

    def late(doing: str, now: Job) -> str:
        running_job(app).progress.share = 0.99
        return told(doing, now)

    monkeypatch.setattr(beside, "words", late)
    edit(app, 0.1e-3)
    (bar,) = app.get("progress")
    assert running_job(app).progress.share == 0.99
    assert re.findall(r"\d+", bar.proto.text)[:1] == [str(bar.proto.value)]
    assert not bar.proto.text.startswith("Marching:"), "a share after a colon reads as a result"


def test_cancel_stops_the_work_and_offers_to_run(app: AppTest, slow: Slow) -> None:
    edit(app, 0.1e-3)
    now = running_job(app)
    app.button(key="run.cancel").click().run()
    assert now.done.wait(30)
    assert slow.ended.is_set()
    app.run()
    assert slow.count == 1
    assert "not computed yet" in words(app)
    slow.go.set()
    app.button(key="run.ask").click().run()
    if running.PLACE in store(app).values:
        assert running_job(app).done.wait(30)
        app.run()
    assert slow.count == 2
    assert "not computed yet" not in words(app)
    assert not app.exception


def test_an_edit_ends_the_run_of_the_values_before_it(app: AppTest, slow: Slow) -> None:
    edit(app, 0.1e-3)
    first = running_job(app)
    edit(app, 0.2e-3)
    assert first.done.wait(30)
    assert first.made is None
    second = running_job(app)
    assert second is not first
    slow.go.set()
    assert second.done.wait(30)
    app.run()
    assert "of 0.20 mm" in words(app)


def test_a_run_of_minutes_is_asked_for(app: AppTest, slow: Slow, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(running, "run_seconds", lambda setup: 600.0)
    edit(app, 0.1e-3)
    assert slow.count == 0
    assert "about 10 min" in words(app)
    app.button(key="run.ask").click().run()
    assert slow.count == 1
    assert app.button(key="run.cancel")


def test_a_refusal_of_the_long_run_is_shown(app: AppTest, monkeypatch: pytest.MonkeyPatch, slow: Slow) -> None:
    def refuses(setup: Any) -> Any:
        raise SetupError("Nothing fits here.")

    monkeypatch.setattr(cached, "simulate", refuses)
    monkeypatch.setattr(beside, "FIRST_S", 30.0)
    edit(app, 0.1e-3)
    assert "Nothing fits here." in errors(app)
    assert not app.exception


def test_a_page_without_a_run_before_shows_progress_and_keeps_its_inputs(app: AppTest, slow: Slow) -> None:
    store(app).values.pop(running.LAST)
    for page in ("6_Milling", "app", "1_Robot", "5_Toolpath", "7_Improve"):
        go(app, page)
        edit(app, 0.1e-3)
        assert app.button(key="run.cancel")
        assert not app.exception, page


def test_work_that_nobody_looks_at_is_given_up(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(job, "ABANDONED_S", 0.05)
    slow = Slow()
    made = Job(partial(slow, None), None)
    made.start()
    assert made.done.wait(30)
    assert made.stop.is_set()
