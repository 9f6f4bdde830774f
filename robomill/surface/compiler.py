"""The compiled path, loaded in the background so that nothing waits for it: until then NumPy does the work.

A long-running program calls ``warm_up()`` when it starts. Without that, kernels are loaded only for work that would
take NumPy longer than loading them.
"""

from __future__ import annotations

import threading
from typing import Any, Literal, NamedTuple

import numpy as np

Engine = Literal["auto", "compiled", "numpy"]

# Work that would take NumPy longer than this waits for the kernels (half a second from the cache on disk).
WORTH_WAITING_SECONDS = 3.0


class Kernels(NamedTuple):
    """The compiled functions the surface calls."""

    cut_moves: Any
    cut_tilted: Any
    engage_moves: Any


_ready: Kernels | None = None
_failed: BaseException | None = None
_thread: threading.Thread | None = None
_lock = threading.Lock()


def warm_up(wait: bool = False) -> bool:
    """Load (the first time on a machine: compile) the kernels in a background thread; True once they are ready."""
    global _thread
    with _lock:
        if _ready is None and _failed is None and _thread is None:
            _thread = threading.Thread(target=_load, name="surface-kernels", daemon=True)
            _thread.start()
        thread = _thread
    if wait and thread is not None:
        thread.join()
    return _ready is not None


def kernels(engine: Engine = "auto", numpy_seconds: float = 0.0) -> Kernels | None:
    """The kernels, or None where NumPy is to be used. ``numpy_seconds``: about how long NumPy would take."""
    if engine == "numpy":
        return None
    if engine == "compiled" or numpy_seconds > WORTH_WAITING_SECONDS:
        warm_up(wait=True)
    if engine == "compiled" and _ready is None:
        raise RuntimeError("The compiled surface kernels could not be loaded.") from _failed
    return _ready


def _load() -> None:
    global _ready, _failed
    try:
        from robomill.surface import engagement_kernels, kernels

        found = Kernels(kernels.cut_moves, kernels.cut_tilted, engagement_kernels.engage_moves)
        _exercise(found)
        _ready = found
    except Exception as exc:
        _failed = exc


def _exercise(module: Kernels) -> None:
    """Call every kernel once on a few cells, which compiles it or loads it from the cache on disk."""
    z = np.ones((4, 4))
    tile = (z, z.copy(), z.copy(), np.zeros((4, 4, 5)), np.zeros(16, dtype=np.int64), np.zeros(1, dtype=np.int64))
    grid, shape, chosen = (0.0, 0.0, 0.5, 0.5), (0, 1.0, 1.0, 0.0, 0.0), np.zeros(1, dtype=np.int64)
    module.cut_moves(shape, np.zeros((1, 6)), chosen, grid, tile)
    moves, frames, boxes = np.zeros((1, 7)), np.ones((1, 8)), np.zeros((1, 4))
    module.cut_tilted(shape, moves, frames, boxes, chosen, grid, z, z.copy(), z.copy())
    p, used = np.zeros((2, 3)), np.ones(2, dtype=bool)
    module.engage_moves(shape, p, np.tile([0.0, 0.0, 1.0], (2, 1)), used, grid, z, 0.0, 4, np.zeros((2, 5)), 0, 2)
