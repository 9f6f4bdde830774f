"""Walls and floors that a path leaves, asked at single places: exact, without a grid, with every pass that comes by."""

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from robomill.arrays import BoolArray, FloatArray, IntArray
from robomill.cutting.tool import Cutter
from robomill.lazy import cached_property
from robomill.progress import slices
from robomill.surface.contact.block_kernels import Blocks
from robomill.surface.outline_kernels import Tracks, floors_left, walls_left

MOST_SQUARES = 1_000_000
BLOCK = 8  # moves, at least, that are passed over at once
SAME = 2e-6  # m: tracks whose heights differ by no more are one floor, and walls that stand so close are one


class Walls(NamedTuple):
    """How far beyond a rim walls stand: ``told`` (q,) m and ``left`` (q,) m, NaN where nothing is cut; whether it is
    ``one`` wall (q,), as where a floor beside it sinks or rises through the height, the wall that was told is none any
    more; and how far (q,) m the pass that makes it in the end has ``carried`` it.
    """

    told: FloatArray
    left: FloatArray
    one: BoolArray
    carried: FloatArray


@dataclass(frozen=True, eq=False)
class Outline:
    """What straight moves were told to leave and do leave: ``told`` and ``left`` (n, 6) m are their ends, each made by
    one of ``cutters`` (its index (n,)).

    Places (q, 9) are given by tip c, tool axis k and a direction u across it; walls are looked for within ``reach`` (m)
    of the rim.
    """

    told: FloatArray
    left: FloatArray
    cutters: tuple[Cutter, ...]
    cutter: IntArray
    reach: float

    def walls(self, places: FloatArray, height: FloatArray, radius: FloatArray) -> Walls:
        """The walls that stand along u beyond the rim of ``radius`` (q,) at ``height`` (q,) above the tip."""
        start = radius - np.minimum(self.reach, 0.9 * radius)
        asked = np.ascontiguousarray(np.column_stack([places, height, start]))
        result = np.empty((len(asked), 4))
        for some in slices(len(asked), "Walls"):
            walls_left(*self._tracks, self._blocks, asked[some], result[some])
        told, told_both, left, carried = result.T
        with np.errstate(invalid="ignore"):
            return Walls(told - radius, left - radius, np.asarray(np.abs(told_both - told) <= SAME), carried)

    def floors(
        self, places: FloatArray, offset: FloatArray, slack: FloatArray
    ) -> tuple[FloatArray, FloatArray, BoolArray]:
        """At c + offset u: the height (q,) m of the floor above the tip along k as told (inf where nothing is cut), how
        far normal to it the floor that is left stands above it (q,) m, and whether one floor is left there (q,).

        Beside a step between two depths that has moved sideways there is none: there the lowest pass, of those told or
        of those left, comes by in one of the two only. What that changes by no more than ``slack`` (q,) m (a slope that
        has moved along itself) is one floor.
        """
        told, left, told_both, left_both, upright = self._floors(places, offset)
        with np.errstate(invalid="ignore"):
            one = (told_both - told <= SAME + slack) & (left_both - left <= SAME + slack)
            return told, (left - told) * upright, np.asarray(np.isfinite(told_both) & one)

    def left_over(self, places: FloatArray) -> FloatArray:
        """(q,) m: how high above c along k the floor that is left lies; inf where nothing is cut."""
        return self._floors(places, np.zeros(len(places)))[1]

    def _floors(self, places: FloatArray, offset: FloatArray) -> FloatArray:
        """(5, q): what is known of the floors at c + offset u (see ``floors_left``)."""
        asked = np.ascontiguousarray(np.column_stack([places, offset]))
        result = np.empty((len(asked), 5))
        for some in slices(len(asked), "Floors"):
            floors_left(*self._tracks, self._blocks, asked[some], result[some])
        return result.T

    @cached_property
    def _tracks(self) -> tuple[Tracks, Tracks]:
        """Told and left, in one order: by the squares in which the moves were told to be."""
        middle = 0.5 * (self.told[:, :2] + self.told[:, 3:5])
        half = 0.5 * float(np.linalg.norm(self.told[:, 3:] - self.told[:, :3], axis=1).max())
        moved = float(np.abs(self.left - self.told).max())
        size = 2.0 * max(cutter.radius for cutter in self.cutters) + 2.0 * self.reach + half + moved
        low, span = middle.min(axis=0), np.ptp(middle, axis=0)
        size = max(size, float(np.sqrt(max(span[0] * span[1], 0.0) / MOST_SQUARES)), float(span.max()) / MOST_SQUARES)
        corner = low - 0.5 * size
        count = (np.floor((span + 0.5 * size) / size) + 1).astype(np.int64)
        square = np.floor((middle - corner) / size).astype(np.int64)
        number = square[:, 0] * count[1] + square[:, 1]
        order = np.argsort(number, kind="stable")
        first = np.searchsorted(number[order], np.arange(count[0] * count[1] + 1)).astype(np.int64)
        shapes = np.array([cutter.solid for cutter in self.cutters], dtype=float)
        cutter = np.ascontiguousarray(self.cutter[order], dtype=np.int64)
        told, left = (
            Tracks(np.ascontiguousarray(ends[order]), shapes, cutter, first, corner, size, count)
            for ends in (self.told, self.left)
        )
        return told, left

    @cached_property
    def _blocks(self) -> Blocks:
        """The moves of every square in blocks: as many of them as there are moves in one."""
        told, left = self._tracks
        count = np.diff(told.first)
        size = np.maximum(np.ceil(np.sqrt(count)).astype(np.int64), BLOCK)
        blocks = -(-count // size)
        of_square = np.append(0, np.cumsum(blocks))
        square = np.repeat(np.arange(len(count)), blocks)
        first = told.first[square] + (np.arange(len(square)) - of_square[square]) * size[square]
        widest = np.maximum.reduceat(told.shapes[told.cutter, 1], first)
        boxes = []
        for ends in (told.ends, left.ends):
            low = np.minimum.reduceat(np.minimum(ends[:, :3], ends[:, 3:]), first)
            high = np.maximum.reduceat(np.maximum(ends[:, :3], ends[:, 3:]), first)
            boxes.append(np.column_stack([0.5 * (low + high), 0.5 * (high - low), widest]))
        return Blocks(of_square, np.append(first, len(told.ends)), *boxes)
