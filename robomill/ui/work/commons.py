"""Things kept for everyone on the server, bounded by the bytes they take: the longest unused make room for new ones."""

import threading
from collections import OrderedDict
from collections.abc import Callable, Hashable
from typing import Any

from robomill import budgets
from robomill.progress import checkpoint

LOOK_S = 0.05  # who waits for what another one makes looks so often whether it is still wanted
ENTRY = 1000  # bytes of an entry beside its value
NOTHING = object()


class Commons:
    """Values by key, together no larger than ``most()`` bytes; the one last put always stays.

    A result makes more of itself when it is looked at (surfaces, gauges), so what was taken is weighed again.
    """

    def __init__(self, most: Callable[[], int] = budgets.kept_results) -> None:
        self._most = most
        self._held: OrderedDict[Hashable, Any] = OrderedDict()
        self._weights: dict[Hashable, int] = {}
        self._taken: set[Hashable] = set()
        self._making: dict[Hashable, threading.Lock] = {}
        self._lock = threading.Lock()

    def find(self, key: Hashable, otherwise: Any = None) -> Any:
        """What is kept under ``key``."""
        with self._lock:
            if key not in self._held:
                return otherwise
            self._held.move_to_end(key)
            self._taken.add(key)
            return self._held[key]

    def put(self, key: Hashable, value: Any) -> None:
        """Keep ``value``; what was not used for longest goes where that is too much."""
        with self._lock:
            self._held[key] = value
            self._held.move_to_end(key)
            again = {each: self._held[each] for each in self._taken | {key}}
            self._taken = {key}
        weights = {
            each: ENTRY + budgets.weight(held) for each, held in again.items()
        }  # takes its time: others need not wait
        with self._lock:
            self._weights |= {each: heavy for each, heavy in weights.items() if each in self._held}
            over = sum(self._weights.values()) - self._most()
            while over > 0 and len(self._held) > 1:
                oldest, _ = self._held.popitem(last=False)
                over -= self._weights.pop(oldest, 0)
                self._taken.discard(oldest)

    def get(self, key: Hashable, make: Callable[[], Any]) -> Any:
        """What is kept under ``key``, or else what ``make`` makes: once, however many ask for it meanwhile. What it
        raises is not kept."""
        with self._lock:
            mine = self._making.setdefault(key, threading.Lock())
        try:
            while not mine.acquire(timeout=LOOK_S):
                checkpoint()
            try:
                found = self.find(key, NOTHING)
                if found is NOTHING:
                    found = make()
                    self.put(key, found)
            finally:
                mine.release()
            return found
        finally:
            with self._lock:
                self._making.pop(key, None)

    def clear(self) -> None:
        """Forget everything."""
        with self._lock:
            self._held.clear()
            self._weights.clear()
            self._taken.clear()

    @property
    def bytes(self) -> int:
        """So many are kept, as last weighed."""
        return sum(self._weights.values())

    def __len__(self) -> int:
        return len(self._held)
