"""A browser has gone: what is left of its session.

Streamlit remembers a session for two minutes, up to 128 of them, in case the browser comes back. The project stays so
long; what can be had again is let go of at once. A session is a ring of objects that point at each other, which Python
finds when it looks for such rings: too seldom where each holds megabytes, so it is made to look, now and then, and what
the allocator has free goes back to the system.

Most of what Python looks through then are modules and classes, which stand for as long as the server: they are set
aside once its pages have run. A look took 0.16 s, in which nobody is answered, and Python takes one by itself now and
then, too.
"""

from __future__ import annotations

import ctypes
import gc
import itertools
import time
from contextlib import suppress
from typing import Protocol

import streamlit as st

COLLECT_S = 30.0  # at least so long between two looks
SETTLED = 40  # runs of pages after which most of what they need is loaded, while few sessions are there

_collected = time.monotonic()
_runs = itertools.count(1)


class Held(Protocol):
    """What a session holds."""

    def let_go(self) -> None:
        """Let go of what is heavy."""


def settle() -> None:
    """Set aside, once, what is there after so many runs of pages; of a session that is set aside with it, only what is
    heavy is let go of when its browser goes."""
    if next(_runs) == SETTLED:
        gc.collect()
        gc.freeze()


def _gone(held: Held) -> None:
    global _collected
    held.let_go()
    if time.monotonic() - _collected > COLLECT_S:
        gc.collect()
        with suppress(OSError, TypeError, AttributeError):  # glibc only
            ctypes.CDLL(None).malloc_trim(0)
        _collected = time.monotonic()


@st.cache_resource(scope="session", show_spinner=False, on_release=_gone)
def while_open(_held: Held) -> Held:
    """What a session holds, which lets go of what is heavy once the browser has gone."""
    return _held
