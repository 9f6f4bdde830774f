"""Reading a big program beside the page: progress, a cancel button, and the path in the project once it is read."""

from __future__ import annotations

import threading
import time
from collections.abc import Callable
from dataclasses import dataclass, field

import streamlit as st

from robomill.errors import RobomillError
from robomill.toolpath.source import GCodeSource
from robomill.ui import session

KEY = "toolpath.reading"
BACKGROUND_CHARACTERS = 1_500_000
EVERY_S = 0.3


@dataclass(eq=False)
class ProgramReading:
    """One program being read in a thread of its own; the thread touches nothing of the page."""

    source: GCodeSource
    share: float = 0.0
    error: RobomillError | None = None
    bug: BaseException | None = None
    began: float = field(default_factory=time.monotonic)
    stop: threading.Event = field(default_factory=threading.Event)
    done: threading.Event = field(default_factory=threading.Event)

    def start(self) -> None:
        """Begin to read."""
        threading.Thread(target=self._run, daemon=True, name="read-program").start()

    def _run(self) -> None:
        try:
            self.source.read(progress=self._progress, cancel=self.stop.is_set)
        except RobomillError as exc:
            self.error = exc
        except Exception as exc:  # shown by the page that asked: a thread has nobody to raise to
            self.bug = exc
        finally:
            self.done.set()

    def _progress(self, share: float) -> None:
        self.share = max(self.share, min(float(share), 1.0))

    @property
    def left_s(self) -> float:
        """Seconds until it is read, as far as one can tell; NaN at the beginning."""
        spent = time.monotonic() - self.began
        return spent * (1.0 / self.share - 1.0) if self.share > 0.02 else float("nan")


def read_beside(source: GCodeSource) -> None:
    """Begin to read ``source`` while the page stays alive; an earlier reading is given up."""
    give_up()
    reading = ProgramReading(source)
    session.keep(KEY, reading)
    reading.start()


def current() -> ProgramReading | None:
    """The reading that goes on, if any."""
    reading: ProgramReading | None = session.kept(KEY)
    return reading


def give_up() -> None:
    """Stop the reading that goes on."""
    reading: ProgramReading | None = session.drop(KEY)
    if reading is not None:
        reading.stop.set()


def reading_inputs(take: Callable[[GCodeSource], None], refuse: Callable[[GCodeSource, RobomillError], None]) -> None:
    """Progress and cancel while a program is read; ``take`` puts it into the project, ``refuse`` shows why not."""
    reading = current()
    if reading is None:
        return
    if reading.done.is_set():
        _finish(reading, take, refuse)
        st.rerun()
    _progress()


@st.fragment(run_every=EVERY_S)
def _progress() -> None:
    reading = current()
    if reading is None or reading.done.is_set():
        st.rerun()
        return
    size = len(reading.source.text) / 1e6
    left = reading.left_s
    wait = f", about {left:.0f} s left" if left == left and left >= 1 else ""
    with st.container(border=True):
        st.progress(reading.share, f"Reading {reading.source.name}: {100 * reading.share:.0f} % of {size:.1f} MB{wait}")
        if st.button("Cancel", icon=":material/close:", key="toolpath.cancel"):
            give_up()
            st.rerun()


def _finish(
    reading: ProgramReading, take: Callable[[GCodeSource], None], refuse: Callable[[GCodeSource, RobomillError], None]
) -> None:
    session.drop(KEY)
    if reading.bug is not None:
        raise reading.bug
    if reading.error is not None:
        refuse(reading.source, reading.error)
    else:
        take(reading.source)
