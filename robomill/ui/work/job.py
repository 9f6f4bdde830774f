"""Long work beside the page: in a thread of its own that touches nothing of the page, with progress and cancel."""

from __future__ import annotations

import threading
import time
from collections.abc import Callable
from dataclasses import dataclass, field, replace
from functools import partial
from typing import Any

import streamlit as st

from robomill.arrays import digest
from robomill.errors import RobomillError
from robomill.progress import Cancelled, Progress, watched
from robomill.ui import session
from robomill.ui.entry import inputs
from robomill.ui.serving.asked import heed_pages
from robomill.ui.work.turns import Turn

EVERY_S = 0.4
GIVE_WAY_S = 0.02  # a page that waits looks so often whether something else is asked for
TOLD = "bar.tells"  # the place of the work that the bar of this page speaks of
ABANDONED_S = 90.0  # work whose page has not looked at it for so long is given up

heed_pages()


class Underway(Exception):  # noqa: N818 - no error
    """What a part of a page needs is being made beside it, or was stopped; ``show`` says so in its place."""

    def __init__(self, show: Callable[[], Any], place: str = "") -> None:
        super().__init__()
        self._show, self.place = show, place

    def show(self) -> None:
        """Say so; what the bar speaks of is not said twice."""
        if not self.place or session.kept(TOLD) != self.place:
            self._show()


@dataclass(eq=False)
class Job:
    """``work()`` made in a thread; what it says of itself is its ``progress``, and it ends early once ``stop`` is set.

    ``about`` is what it is made of; ``made`` what it answered, ``error`` why it was refused. Of one ``group`` is what a
    new one may supersede; ``run`` is the run of the page that asked last.
    """

    work: Callable[[], Any]
    about: Any
    group: str = ""
    run: int = -1
    made: Any = None
    error: RobomillError | None = None
    bug: BaseException | None = None
    seen: float = field(default_factory=time.monotonic)
    progress: Progress = field(default_factory=Progress)
    stop: threading.Event = field(default_factory=threading.Event)
    done: threading.Event = field(default_factory=threading.Event)

    def start(self) -> None:
        """Begin."""
        threading.Thread(target=self._run, daemon=True).start()

    @property
    def under_way(self) -> bool:
        """Whether it goes on."""
        return not self.done.is_set()

    def _unwanted(self) -> bool:
        return self.stop.is_set() or time.monotonic() - self.seen > ABANDONED_S

    def _run(self) -> None:
        try:
            with Turn(self._unwanted) as turn:

                def stopped() -> bool:
                    turn.let_pass()
                    return self._unwanted()

                self.progress.stop = stopped
                with watched(self.progress):
                    self.made = self.work()
        except Cancelled:
            self.stop.set()
        except RobomillError as exc:
            self.error = exc
        except Exception as exc:  # shown by the page that asked: a thread has nobody to raise to
            self.bug = exc
        finally:
            self.done.set()


def begin(key: str, job: Job) -> None:
    """Start ``job`` and keep it under ``key``; an earlier one there is given up."""
    give_up(key)
    session.keep(key, job)
    job.start()


def give_up(key: str) -> None:
    """Stop and forget the job kept under ``key``."""
    job: Job | None = session.drop(key)
    if job is not None:
        job.stop.set()


def finished(key: str, wait_s: float = 0.0) -> Job | None:
    """The job kept under ``key`` where it has ended, or ends within ``wait_s``; its bug, if it met one, is raised here.
    One that nobody had looked at for long is forgotten. A page that waits gives way to what is asked for meanwhile."""
    job: Job | None = session.kept(key)
    if job is None:
        return None
    job.seen = time.monotonic()
    while not job.done.wait(min(wait_s, GIVE_WAY_S)):
        wait_s -= GIVE_WAY_S
        if wait_s <= 0.0:
            return None
        session.store()  # a look into the session is where a run gives way
    if job.stop.is_set():
        session.drop(key)
        return None
    if job.bug is not None:
        raise job.bug
    return job


def box(key: str) -> str:
    """The name of the container in which the work kept under ``key`` is spoken of: it stays in sight."""
    return f"job-{digest(key)[:8]}"


@st.fragment(run_every=EVERY_S)
def waiting(key: str, words: Callable[[Job], str], stop: Callable[[], Any] | None = None) -> None:
    """Progress in ``words`` and a button that cancels, by ``stop``; the page runs again at the end."""
    job: Job | None = session.kept(key)
    if job is None or job.done.is_set():
        st.rerun()
        return
    job.seen = time.monotonic()
    now = replace(job, progress=replace(job.progress))  # looked at once: the work goes on between bar and words
    with st.container(key=box(key), horizontal=True, vertical_alignment="center", gap="medium"):
        st.progress(now.progress.share, words(now), width="stretch")
        inputs.button("Cancel", f"{key}.cancel", "close", stop or partial(give_up, key), width="content")
