"""Where compiled kernels are kept: a cache on disk that knows every source they were made from."""

from __future__ import annotations

import hashlib
import os
import threading
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any

_lock = threading.RLock()


def cache_folder(sources: Sequence[Path]) -> Path | None:
    """The folder for kernels made from ``sources``, or None for the compiler's own choice.

    Its name holds a digest of all of them: the compiler by itself looks only at a function's own file, and would
    keep running old code of the functions it calls.
    """
    key = hashlib.sha256(b"".join(source.read_bytes() for source in sources)).hexdigest()[:12]
    for root in (sources[0].parent / "__pycache__", Path.home() / ".cache" / "robomill"):
        folder = root / f"kernels-{key}"
        try:
            folder.mkdir(parents=True, exist_ok=True)
        except OSError:
            continue
        if os.access(folder, os.W_OK):
            return folder
    return None


@contextmanager
def cached_in(folder: Path | None) -> Iterator[None]:
    """Kernels imported inside the block are compiled into, or loaded from, ``folder``."""
    import numba

    config: Any = numba.config
    with _lock:
        before = config.CACHE_DIR
        config.CACHE_DIR = before if before or folder is None else str(folder)
        try:
            yield
        finally:
            config.CACHE_DIR = before
