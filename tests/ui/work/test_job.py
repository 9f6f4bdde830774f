"""A page that waits for its work waits as long as it said, and gives way to what is asked for meanwhile."""

from __future__ import annotations

import time
from collections.abc import Callable
from types import SimpleNamespace
from typing import Any

import pytest

from robomill.progress import Cancelled
from robomill.ui import session
from robomill.ui.work import job
from robomill.ui.work.job import Job


@pytest.fixture
def looked(monkeypatch: pytest.MonkeyPatch) -> Callable[[Job], list[float]]:
    """Keeps a job under "run"; when the session was looked into since then."""

    def kept(work: Job) -> list[float]:
        times: list[float] = []
        held = SimpleNamespace(values={"run": work})

        def store() -> Any:
            times.append(time.monotonic())
            return held

        monkeypatch.setattr(session, "store", store)
        return times

    return kept


def test_it_gives_way_while_it_waits(looked: Callable[[Job], list[float]]) -> None:
    times = looked(Job(lambda: None, "nothing that ends"))
    begun = time.monotonic()
    assert job.finished("run", 0.2) is None
    assert time.monotonic() - begun >= 0.19
    assert len(times) >= 8
    assert times[-1] - begun > 0.1


def test_one_that_is_not_waited_for_is_looked_at_once(looked: Callable[[Job], list[float]]) -> None:
    assert len(times := looked(Job(lambda: None, "nothing that ends"))) == 0
    assert job.finished("run") is None
    assert len(times) == 1


def test_what_ends_meanwhile_is_there(looked: Callable[[Job], list[float]]) -> None:
    work = Job(lambda: time.sleep(0.05) or 7, "seven")
    looked(work)
    work.start()
    found = job.finished("run", 20.0)
    assert found is work
    assert found.made == 7


def test_a_bug_is_raised_where_the_page_asks(looked: Callable[[Job], list[float]]) -> None:
    def broken() -> None:
        raise ZeroDivisionError

    work = Job(broken, "a bug")
    looked(work)
    work.start()
    with pytest.raises(ZeroDivisionError):
        job.finished("run", 20.0)


def test_what_was_cancelled_is_forgotten(looked: Callable[[Job], list[float]]) -> None:
    def cancelled() -> None:
        raise Cancelled

    work = Job(cancelled, "given up")
    looked(work)
    work.start()
    assert job.finished("run", 20.0) is None
    assert session.kept("run") is None
