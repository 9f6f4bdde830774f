"""Compiled kernels when they are ready, NumPy until then: no call ever waits for the compiler.

``warm_up()`` starts the compiling in a process of its own (it would hold this one's interpreter lock), then loads the
result from numba's cache in a thread. Functions ask ``Kernels.get()`` and use their NumPy columns while it is None.
Set ROBOMILL_NUMPY=1 to stay with NumPy.
"""

from __future__ import annotations

import os
import subprocess
import sys
import threading
from importlib import import_module
from pathlib import Path
from types import ModuleType

from robomill.compiled import cache_folder, cached_in

LARGE = 20_000  # configurations from which a call starts the compiling for those that follow
# The modules that hold a ``Kernels``; imported before compiling, so that one warm-up serves all.
PACKAGE = Path(__file__).parents[1]
HOLDERS = ("robomill.kinematics.forward", "robomill.kinematics.solutions", "robomill.workspace.solve")
_registered: list[Kernels] = []
_lock = threading.Lock()
_thread: threading.Thread | None = None
_failure: str = ""


class Kernels:
    """A module of compiled kernels, by name; ``get()`` is the module once it is loaded, else None."""

    def __init__(self, module: str) -> None:
        self.module = module
        self.loaded: ModuleType | None = None
        _registered.append(self)

    def get(self, size: int = 0) -> ModuleType | None:
        """The module, or None: not loaded yet. A large ``size`` (configurations) starts loading for the next call."""
        if self.loaded is None and size >= LARGE:
            warm_up()
        return self.loaded


def warm_up(wait: bool = False) -> bool:
    """Start compiling and loading the kernels in the background; with ``wait`` until they are. True if they are ready.

    Safe to call often and from any thread. Where numba or its cache cannot be had, everything stays with NumPy, and
    ``status()`` says why.
    """
    global _thread
    if os.environ.get("ROBOMILL_NUMPY"):
        return False
    for holder in HOLDERS:
        import_module(holder)
    with _lock:
        pending = [kernels for kernels in _registered if kernels.loaded is None]
        if pending and not _failure and (_thread is None or not _thread.is_alive()):
            _thread = threading.Thread(target=_load, args=(pending,), name="robomill-kernels", daemon=True)
            _thread.start()
    if wait and _thread is not None:
        _thread.join()
    return all(kernels.loaded is not None for kernels in _registered)


def status() -> str:
    """ "compiled", "numpy", "compiling", or why the kernels cannot be had."""
    if _registered and all(kernels.loaded is not None for kernels in _registered):
        return "compiled"
    if _thread is not None and _thread.is_alive():
        return "compiling"
    return _failure or "numpy"


def _load(pending: list[Kernels]) -> None:
    global _failure
    try:
        names = [kernels.module for kernels in pending]
        folder = cache_folder(sorted([*PACKAGE.glob("kinematics/kernel*.py"), *PACKAGE.glob("workspace/kernel*.py")]))
        there = {"NUMBA_CACHE_DIR": str(folder)} if folder is not None else {}
        command = f"import sys; sys.path[:0] = {sys.path!r}; import {', '.join(names)}"
        subprocess.run(
            [sys.executable, "-c", command], check=False, capture_output=True, timeout=600, env={**there, **os.environ}
        )
        with cached_in(folder):
            for kernels in pending:
                kernels.loaded = import_module(kernels.module)
    except Exception as exc:  # no numba, no writable cache, no processes: NumPy serves
        _failure = f"compiled kernels are not available ({type(exc).__name__}: {exc})"
