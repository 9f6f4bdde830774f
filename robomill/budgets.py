"""What this machine can hold: one statement of the memory there is, and of the shares of it that work may take.

Work is estimated before it is done. What is above its share is refused in a sentence that names the size found, the
bound and the value that would fit; ``ROBOMILL_MEMORY`` (in GiB) says how much memory there is where the system does
not say it well.
"""

import os
import sys
from collections.abc import Mapping
from contextlib import suppress
from dataclasses import is_dataclass
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np

GIB = 1 << 30
PLACE = "ROBOMILL_MEMORY"
LEAST, MOST = GIB, 64 * GIB  # what is believed of the system
KEPT_RESULTS = 0.15  # share that results kept for all sessions may take
SURFACES, PATHS, MAPS = 1 / 16, 1 / 4, 1 / 16  # shares that the surfaces of a run, its path, a map may take
CELL = 64  # bytes of a cell: heights as told, as left, before, their difference, walls
SAMPLE = 3000  # bytes of a sample of the path: poses, joints in all postures, Jacobians, shares of the compliance
STEP = 4000  # bytes more of a step that is marched: what it meets, by angle and height


@cache
def memory() -> int:
    """Bytes that this process may count on: what the machine, its container and its limits leave."""
    with suppress(ValueError):
        said = float(os.environ.get(PLACE, ""))
        if 0.0 < said < float("inf"):
            return int(said * GIB)
    return int(min(max(min(_limits(), default=4 * GIB), LEAST), MOST))


@cache
def cores() -> int:
    """Cores that this process may use at once: those it may run on, and of a container its share of them."""
    free = len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1
    with suppress(OSError, ValueError):  # "max" is no number
        quota, period = map(int, Path("/sys/fs/cgroup/cpu.max").read_text().split())
        free = min(free, -(-quota // period))
    return max(free, 1)


def kept_results() -> int:
    """Bytes that results kept for all sessions may take together."""
    return int(KEPT_RESULTS * memory())


def cells() -> int:
    """Cells that the surface of a part may have."""
    return int(SURFACES * memory() / CELL)


def samples(marched: bool = False) -> int:
    """Samples that a path may have, or steps of it that are ``marched`` through the stock."""
    return int(PATHS * memory() / (SAMPLE + STEP * marched))


def map_bytes() -> int:
    """Bytes that a map may take."""
    return int(MAPS * memory())


def weight(value: Any) -> int:
    """Bytes of the arrays, texts and containers that ``value`` holds, in its fields, items and what it has made of
    them since; each is counted once."""
    seen: set[int] = set()
    todo, total = [value], 0
    while todo:
        one = todo.pop()
        while isinstance(one, np.ndarray) and isinstance(one.base, np.ndarray):
            one = one.base
        if one is None or isinstance(one, type | bool | int | float) or id(one) in seen:
            continue
        seen.add(id(one))
        if isinstance(one, np.ndarray):
            total += one.nbytes
        elif isinstance(one, bytes | bytearray | str):
            total += sys.getsizeof(one)
        elif isinstance(one, Mapping):
            total += sys.getsizeof(one)
            todo += [*one.keys(), *one.values()]
        elif isinstance(one, list | tuple | set | frozenset):
            total += sys.getsizeof(one)
            todo += one
        elif is_dataclass(one) or hasattr(one, "to_plotly_json"):
            todo += list(getattr(one, "__dict__", {}).values())
    return total


def _limits() -> list[int]:
    found = []
    with suppress(OSError, ValueError, StopIteration):
        lines = Path("/proc/meminfo").read_text().splitlines()
        found.append(1024 * int(next(line for line in lines if line.startswith("MemTotal:")).split()[1]))
    for file in ("/sys/fs/cgroup/memory.max", "/sys/fs/cgroup/memory/memory.limit_in_bytes"):
        with suppress(OSError, ValueError):  # "max" is no number
            found.append(int(Path(file).read_text()))
    with suppress(ImportError, OSError, ValueError):
        import resource

        soft = resource.getrlimit(resource.RLIMIT_AS)[0]
        if soft != resource.RLIM_INFINITY:
            found.append(soft)
    return found
