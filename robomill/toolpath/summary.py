"""A path in a few numbers: counts, extents and ranges."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from robomill.arrays import FloatArray, IntArray
from robomill.toolpath.path import Toolpath

MOST = 50_000_000  # whole numbers up to it are counted


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


def summary_of(path: Toolpath) -> PathSummary:
    """The summary of a path."""
    low, high = path.extents
    feeds = path.v_f[path.cutting & (path.step_length > 0)]
    spindles = path.n_s[path.cutting & np.isfinite(path.n_s)] if path.n_s.any() else np.empty(0)
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


def middle_of_cut(path: Toolpath) -> FloatArray | None:
    """(3,) m in {W}: the mean over the length that is cut; None where nothing is."""
    length = np.where(path.cutting, path.step_length, 0.0)[1:]
    if not length.sum() > 0.0:
        return None
    return np.asarray(0.5 * (path.p[1:] + path.p[:-1]).T @ length / length.sum())


def distinct(values: IntArray) -> IntArray:
    """Sorted distinct values of whole numbers (m,); by counting where they are small, which beats sorting."""
    if len(values) == 0:
        return np.empty(0, dtype=np.int64)
    low, high = int(values.min()), int(values.max())
    if low < 0 or high > MOST:
        return np.asarray(np.unique(values), dtype=np.int64)
    return np.flatnonzero(np.bincount(values, minlength=1))


def _range(values: FloatArray) -> tuple[float, float] | None:
    return (float(values.min()), float(values.max())) if len(values) else None
