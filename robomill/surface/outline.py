"""Walls and floors that a path leaves, asked at single places: exact, without a grid, with every pass that comes by."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from robomill.arrays import FloatArray, IntArray
from robomill.cutting.tool import Cutter
from robomill.surface.outline_kernels import Tracks, floors_left, walls_left

MOST_SQUARES = 1_000_000


@dataclass(frozen=True, eq=False)
class Outline:
    """What straight moves ends (n, 6) m leave, each made by one of ``cutters`` (its index (n,)).

    Places (q, 9) are given by tip c, tool axis k and a direction u across it; walls are looked for within ``reach`` (m)
    of the rim.
    """

    ends: FloatArray
    cutters: tuple[Cutter, ...]
    cutter: IntArray
    reach: float

    def walls(self, places: FloatArray, height: FloatArray, radius: FloatArray) -> FloatArray:
        """(q,) m: how far beyond the tool's own rim, of ``radius`` (q,) at ``height`` (q,) above its tip, the wall
        stands along u; NaN where nothing is cut."""
        start = radius - np.minimum(self.reach, 0.9 * radius)
        asked = np.ascontiguousarray(np.column_stack([places, height, start]))
        result = np.empty((len(asked), 1))
        walls_left(self._tracks, asked, result)
        return result[:, 0] - radius

    def floors(self, places: FloatArray, offset: FloatArray) -> tuple[FloatArray, FloatArray]:
        """(q,) m: height of the floor above the tip along k at c + offset u, inf where nothing is cut; and (q,) the
        part of its normal along k."""
        asked = np.ascontiguousarray(np.column_stack([places, offset]))
        result = np.empty((len(asked), 2))
        floors_left(self._tracks, asked, result)
        return result[:, 0], result[:, 1]

    @cached_property
    def _tracks(self) -> Tracks:
        from robomill.surface.envelope_kernels import cutter_shape

        middle = 0.5 * (self.ends[:, :2] + self.ends[:, 3:5])
        half = 0.5 * float(np.linalg.norm(self.ends[:, 3:] - self.ends[:, :3], axis=1).max())
        size = 2.0 * max(cutter.radius for cutter in self.cutters) + 2.0 * self.reach + half
        low, span = middle.min(axis=0), np.ptp(middle, axis=0)
        size = max(size, float(np.sqrt(max(span[0] * span[1], 0.0) / MOST_SQUARES)), float(span.max()) / MOST_SQUARES)
        corner = low - 0.5 * size
        count = (np.floor((span + 0.5 * size) / size) + 1).astype(np.int64)
        square = np.floor((middle - corner) / size).astype(np.int64)
        number = square[:, 0] * count[1] + square[:, 1]
        order = np.argsort(number, kind="stable")
        first = np.searchsorted(number[order], np.arange(count[0] * count[1] + 1)).astype(np.int64)
        shapes = np.array([cutter_shape(cutter) for cutter in self.cutters], dtype=float)
        return Tracks(
            np.ascontiguousarray(self.ends[order]),
            shapes,
            np.ascontiguousarray(self.cutter[order], dtype=np.int64),
            first,
            corner,
            size,
            count,
        )
