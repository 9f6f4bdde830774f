"""What the page says about a path at every rerun, worked out once: a million moves are not counted twice."""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from robomill.arrays import FloatArray, IntArray
from robomill.toolpath.path import Toolpath
from robomill.ui.toolpath.reach import PathReach


@dataclass(frozen=True, eq=False)
class PathSummary:
    """Counts, extents and ranges of a path; SI units.

    blocks cutting source lines; low, high (3,) m corners of feed moves; rapids m; feeds, spindles (lowest, highest).
    """

    moves: int
    cuts: int
    blocks: int
    low: FloatArray
    high: FloatArray
    rapids: float
    feeds: tuple[float, float] | None
    spindles: tuple[float, float] | None
    tools: tuple[int, ...]


@lru_cache(maxsize=6)
def path_summary(path: Toolpath) -> PathSummary:
    """The summary of a path (kept for the last few)."""
    low, high = path.extents
    feeds = path.v_f[path.cutting & (path.step_length > 0)]
    spindles = path.n_s[path.cutting] if path.n_s.any() else np.empty(0)
    return PathSummary(
        moves=len(path) - 1,
        cuts=int(path.cutting.sum()),
        blocks=len(distinct(path.block[path.cutting])),
        low=low,
        high=high,
        rapids=float(path.step_length[~path.cutting].sum()),
        feeds=_range(feeds),
        spindles=_range(spindles),
        tools=tuple(int(t) for t in distinct(path.tool) if t > 0),
    )


@lru_cache(maxsize=6)
def missed_blocks(reach: PathReach) -> tuple[int, float, IntArray]:
    """How many samples at feed are out of reach, the length (m) they stand for, and their source lines."""
    lost = reach.missed
    if not lost.any():
        return 0, 0.0, np.empty(0, dtype=np.int64)
    return int(lost.sum()), float(reach.path.step_length[lost].sum()), distinct(reach.path.block[lost])


def distinct(values: IntArray) -> IntArray:
    """Sorted distinct values of whole numbers (m,); by counting where they are small, which beats sorting."""
    if len(values) == 0:
        return np.empty(0, dtype=np.int64)
    low, high = int(values.min()), int(values.max())
    if low < 0 or high > 50_000_000:
        return np.asarray(np.unique(values), dtype=np.int64)
    return np.flatnonzero(np.bincount(values, minlength=1))


def _range(values: FloatArray) -> tuple[float, float] | None:
    return (float(values.min()), float(values.max())) if len(values) else None
