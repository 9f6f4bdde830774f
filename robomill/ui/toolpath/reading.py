"""Reading a big program beside the page: progress, a cancel button, and the path in the project once it is read."""

import re
from collections.abc import Callable
from functools import partial

import streamlit as st

from robomill.errors import RobomillError
from robomill.toolpath.source import GCodeSource
from robomill.ui import session
from robomill.ui.toolpath.sources import read_with
from robomill.ui.work import beside, job
from robomill.ui.work.job import Job
from robomill.units import format_bytes, format_percent

KEY = "toolpath.reading"
BACKGROUND_CHARACTERS = 1_500_000
ROUND = re.compile(r"\b(?:o\s*[\d<]|m\s*9[89]\b)", re.IGNORECASE)  # O words and calls: a few lines can go on for long


def read(source: GCodeSource) -> bool:
    """Whether ``source`` was read: a big program, and one that may go round in loops, is begun beside the page. Raises
    its refusal."""
    work = partial(read_with, source, session.project().setup.tools)
    if len(source.text) > BACKGROUND_CHARACTERS or ROUND.search(source.text) is not None:
        job.begin(KEY, Job(work, source))
        return False
    work()
    return True


def reading_inputs(take: Callable[[GCodeSource], None], refuse: Callable[[GCodeSource, RobomillError], None]) -> None:
    """Progress and cancel while a program is read; ``take`` puts it into the project, ``refuse`` shows why not."""
    found = job.finished(KEY, beside.FIRST_S)
    if found is not None:
        session.drop(KEY)
        if found.error is None:
            take(found.about)
        else:
            refuse(found.about, found.error)
        st.rerun()
    if session.kept(KEY) is not None:
        with st.container(border=True):
            job.waiting(KEY, _words)


def _words(made: Job) -> str:
    size = format_bytes(len(made.about.text))
    return f"Reading {made.about.name}: {format_percent(made.progress.share)} of {size}{beside.left(made)}"
