"""The first start on a computer: its machine code is made once, with how far that is; every page waits for it."""

import html
import re
import threading
import time

import streamlit as st

from robomill import compiled, seals
from robomill.ui.markup import quiet
from robomill.units import format_count, format_duration

EVERY_S = 0.4
USUAL_S = 90.0  # that it takes on a computer that does something else, too
MARKED = re.compile(r"^@kernel\b", re.MULTILINE)
_ready = threading.Event()  # once kernels were looked for in this process
_lock = threading.Lock()
_made: list[threading.Thread] = []


def wait() -> None:
    """Until the machine code is there; nothing where it is."""
    if _ready.is_set():
        return
    if compiled.missing():
        made, began = _making(), time.monotonic()
        st.html(
            '<p class="rm-kicker rm-first">robomill</p>'
            '<h1 class="rm-title">Preparing the calculation for this computer</h1>'
            '<p class="rm-lead">At the first start only. Afterwards a page is there at once.</p>'
        )
        shown, beneath = st.progress(0.0), st.empty()
        while made.is_alive():
            done, count = so_far()
            shown.progress(done / max(count, 1), html.escape(f"{done} of {format_count(count, 'part')}"))
            beneath.html(quiet(words(time.monotonic() - began)))
            made.join(EVERY_S)
        _ready.set()
        st.rerun()
    _ready.set()


def so_far() -> tuple[int, int]:
    """How many kernels are compiled, whoever does it, and of how many."""
    folder = compiled.kept_in()
    root = compiled.PACKAGE
    sources = {source for pattern in compiled.PATTERNS for source in root.glob(pattern)}
    count = sum(len(MARKED.findall(source.read_text(encoding="utf-8"))) for source in sources)
    return 0 if folder is None else min(len(list(folder.glob(f"*/*{seals.SEAL}"))), count), count


def words(spent_s: float) -> str:
    """How long it takes: what is usual, and once that is over, that it goes on."""
    if spent_s <= USUAL_S:
        return "It takes about a minute."
    return f"It takes longer than usual ({format_duration(spent_s, 0)} so far) and goes on: the computer is busy."


def _making() -> threading.Thread:
    """The one thread that has it made, for every page that waits."""
    with _lock:
        if not _made:
            _made.append(threading.Thread(target=compiled.build, daemon=True))
            _made[0].start()
        return _made[0]
