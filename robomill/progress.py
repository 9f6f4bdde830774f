"""How far long work has come, and whether anybody still wants it: said by the work, asked by whoever waits.

    with watched(Progress(stop=event.is_set)):      # whoever waits
        simulate(setup)

    for some in slices(len(steps), "steps cut"):    # the work, a tenth of a second at a time
        kernel(steps[some], ...)

What is watched belongs to the thread that works, so that results which are made when they are first asked for
(surfaces, gauges) can be stopped too. Unwatched, nothing of this does anything.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from contextvars import ContextVar
from dataclasses import dataclass, field
from typing import Any, TypeVar, cast

import numpy as np

Array = TypeVar("Array", bound=np.ndarray[Any, Any])
SLICE_S = 0.04  # s: what a piece of work should take
FEW = 16  # items of the first piece


class Cancelled(Exception):  # noqa: N818 - no error
    """The work was given up by whoever had asked for it. No refusal: there is nothing to mend and nothing to say."""


@dataclass(eq=False)
class Progress:
    """What is being done (``stage``), the share of it (0 to 1) that is, and what is told ``beside``; ``stop`` says that
    it is wanted no more."""

    stop: Callable[[], bool] = bool
    say: Callable[[Progress], object] = bool
    stage: str = ""
    share: float = 0.0
    beside: str = ""
    began: float = field(default_factory=time.monotonic)

    def reach(self, share: float | None = None, stage: str = "", beside: str = "") -> None:
        """Say how much of the stage is done, where that is known. Raises Cancelled where it is wanted no more."""
        self.beside = beside
        if stage and stage != self.stage:
            self.stage, self.share, self.began = stage, 0.0, time.monotonic()
        if share is not None:
            self.share = max(self.share, min(float(share), 1.0))
        self.say(self)
        if self.stop():
            raise Cancelled

    @property
    def left_s(self) -> float:
        """Seconds until the stage is done, as far as one can tell; NaN at its beginning."""
        spent = time.monotonic() - self.began
        return spent * (1.0 / self.share - 1.0) if self.share > 0.02 else float("nan")


_watching: ContextVar[Progress | None] = ContextVar("watching", default=None)


@contextmanager
def watched(progress: Progress | None) -> Iterator[None]:
    """What is done meanwhile, in this thread, tells ``progress``."""
    before = _watching.set(progress)
    try:
        yield
    finally:
        _watching.reset(before)


def slices(count: int, stage: str, most: int = 1 << 20) -> Iterator[slice]:
    """0 to ``count`` in pieces that take less than a tenth of a second each, with a checkpoint before each; in pieces
    of ``most`` where nobody waits. Without a ``stage`` they are a part of another's work, and say no share of it."""
    begin, size = 0, FEW if _watching.get() is not None else most
    while begin < count:
        checkpoint(begin / count if stage else None, stage)
        before = time.monotonic()
        yield slice(begin, min(begin + size, count))
        begin += size
        if _watching.get() is not None:
            faster = SLICE_S / max(time.monotonic() - before, 1e-9)
            size = int(min(max(size * min(faster, 2.0), 1), most))


def gathered(count: int, stage: str, make: Callable[[slice], Array]) -> Array:
    """(count, ...) of what ``make`` answers, (k, ...) for each of the ``slices`` of ``count``."""
    whole: Any = make(slice(0, 0)) if count == 0 else None
    for some in slices(count, stage):
        part = make(some)
        if len(part) == count:
            return part
        if whole is None:
            whole = np.empty((count, *part.shape[1:]), dtype=part.dtype)
        whole[some] = part
    return cast("Array", whole)


@contextmanager
def step(index: int, count: int, stage: str) -> Iterator[None]:
    """What is done meanwhile is the ``index``-th (0-based) of ``count`` equal steps of ``stage``: its own stages are
    not told."""
    progress = _watching.get()
    if progress is None:
        yield
        return
    progress.reach(index / count, stage)
    with watched(Progress(stop=progress.stop)):
        yield


def checkpoint(share: float | None = None, stage: str = "", beside: str = "") -> None:
    """Say that ``share`` of ``stage`` is done, and what is told beside. Raises Cancelled where it is wanted no more."""
    progress = _watching.get()
    if progress is not None:
        progress.reach(share, stage, beside)
