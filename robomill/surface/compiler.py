"""The compiled path, loaded in the background so that nothing waits for it: until then NumPy does the work.

A long-running program calls ``warm_up()`` when it starts: the kernels are compiled in a process of their own (compiling
would hold this one's interpreter lock) and then loaded from the cache on disk. Without that, kernels are loaded only
for work that would take NumPy longer than loading them. ROBOMILL_NUMPY=1 stays with NumPy.
"""

from __future__ import annotations

import os
import subprocess
import sys
import threading
from pathlib import Path
from typing import Any, Literal, NamedTuple

import numpy as np

from robomill.compiled import cache_folder, cached_in

Engine = Literal["auto", "compiled", "numpy"]

# Work that would take NumPy longer than this waits for the kernels (half a second from the cache on disk).
WORTH_WAITING_SECONDS = 3.0
SOURCES = [Path(__file__).with_name(name) for name in ("kernels.py", "tilted_kernels.py", "engagement_kernels.py")]


class Kernels(NamedTuple):
    """The compiled functions the surface calls."""

    cut_moves: Any
    cut_tilted: Any
    engage_moves: Any


_ready: Kernels | None = None
_failed: BaseException | None = None
_thread: threading.Thread | None = None
_lock = threading.Lock()
_build_lock = threading.Lock()


def warm_up(wait: bool = False) -> bool:
    """Get the kernels ready in the background; with ``wait``, here and now. True once they are.

    Safe to call often and from any thread. Where there is no compiler or no cache, NumPy goes on serving.
    """
    global _thread
    if os.environ.get("ROBOMILL_NUMPY"):
        return False
    if wait:
        _build()
        return _ready is not None
    with _lock:
        if _ready is None and _failed is None and _thread is None:
            _thread = threading.Thread(target=_build_apart, name="surface-kernels", daemon=True)
            _thread.start()
    return _ready is not None


def status() -> str:
    """ "compiled", "compiling", "numpy", or why the kernels cannot be had."""
    if _ready is not None:
        return "compiled"
    if _failed is not None:
        return f"compiled kernels are not available ({type(_failed).__name__}: {_failed})"
    return "compiling" if _thread is not None and _thread.is_alive() else "numpy"


def kernels(engine: Engine = "auto", numpy_seconds: float = 0.0) -> Kernels | None:
    """The kernels, or None where NumPy is to be used. ``numpy_seconds``: about how long NumPy would take."""
    if engine == "numpy":
        return None
    if engine == "compiled" or numpy_seconds > WORTH_WAITING_SECONDS:
        warm_up(wait=True)
    if engine == "compiled" and _ready is None:
        raise RuntimeError("The compiled surface kernels could not be loaded.") from _failed
    return _ready


def _build_apart() -> None:
    """Fill the cache from another process, then load from it."""
    try:
        folder = cache_folder(SOURCES)
        if folder is None or not any(folder.rglob("*.nbi")):
            command = f"import sys; sys.path[:0] = {sys.path!r}; from robomill.surface import compiler as c; c._build()"
            subprocess.run([sys.executable, "-c", command], check=False, capture_output=True, timeout=600)
    except (OSError, subprocess.SubprocessError):
        pass  # no second process to be had: compile in this one
    _build()


def _build() -> None:
    """Load the kernels, compiling what the cache does not hold."""
    global _ready, _failed
    with _build_lock:
        if _ready is not None or _failed is not None:
            return
        try:
            found = _load()
            _exercise(found)
            _ready = found
        except Exception as exc:
            _failed = exc


def _load() -> Kernels:
    with cached_in(cache_folder(SOURCES)):
        from robomill.surface import engagement_kernels, kernels, tilted_kernels
    return Kernels(kernels.cut_moves, tilted_kernels.cut_tilted, engagement_kernels.engage_moves)


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
