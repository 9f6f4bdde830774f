"""Whose turn it is: so many pieces of work at once as the machine has cores, the others in the order in which they
came. Long work lets those pass that wait, so nobody waits long for a short piece, and what is no longer wanted when its
turn comes is never begun."""

from __future__ import annotations

import threading
import time
from collections import deque
from collections.abc import Callable

from robomill import budgets
from robomill.progress import Cancelled

AT_ONCE_S = 0.2  # so long work goes on before it lets others pass
LOOK_S = 0.05  # who waits looks so often whether it is still wanted


class Turns:
    """``places`` for work; who leaves hands its place to the one that has waited longest."""

    def __init__(self, places: int) -> None:
        self._free = places
        self._waiting: deque[threading.Event] = deque()
        self._lock = threading.Lock()

    @property
    def waited_for(self) -> bool:
        """Whether somebody waits."""
        return bool(self._waiting)

    def take(self, unwanted: Callable[[], bool]) -> None:
        """Wait for a place. Raises Cancelled where it is ``unwanted`` before it comes."""
        called = threading.Event()
        with self._lock:
            if self._free:
                self._free -= 1
                return
            self._waiting.append(called)
        while not called.wait(LOOK_S):
            if unwanted():
                self._go(called)
                raise Cancelled

    def _go(self, called: threading.Event) -> None:
        """Wait no more; a place that was handed over at this very moment goes to the next."""
        with self._lock:
            if not called.is_set():
                self._waiting.remove(called)
                return
        self.leave()

    def leave(self) -> None:
        """Give the place up."""
        with self._lock:
            if self._waiting:
                self._waiting.popleft().set()
            else:
                self._free += 1


TURNS = Turns(budgets.cores())


class Turn:
    """A place that is held while a piece of work goes on."""

    def __init__(self, unwanted: Callable[[], bool], turns: Turns = TURNS) -> None:
        self._unwanted, self._turns, self._since, self._held = unwanted, turns, 0.0, False

    def __enter__(self) -> Turn:
        self._turns.take(self._unwanted)
        self._since, self._held = time.monotonic(), True
        return self

    def __exit__(self, *_: object) -> None:
        if self._held:
            self._turns.leave()

    def let_pass(self) -> None:
        """Let those pass that wait, where this one was at it for long. Raises Cancelled where it is then unwanted."""
        if self._turns.waited_for and time.monotonic() - self._since > AT_ONCE_S:
            self._held = False
            self._turns.leave()
            self.__enter__()
