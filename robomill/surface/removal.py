"""Cutting moves into a height map, tile by tile: small tiles keep memory low and the work in the processor's cache."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass

import numpy as np

from robomill.arrays import BoolArray, FloatArray, IntArray
from robomill.cutting.tool import Cutter
from robomill.errors import SurfaceError
from robomill.surface.stock import Cells

TILE_CELLS = 250_000
CHUNK_MOVES = 20_000  # between two looks at the watch
CHUNK_TILTED = 50

Progress = Callable[[float], None]
Cancel = Callable[[], bool]


@dataclass(frozen=True)
class EdgeCells:
    """Cells whose mean height is not their height at the centre: flat index (e,) and mean height (e,) m."""

    index: IntArray
    mean: FloatArray


class Watch:
    """Reports progress (0 to 1) and stops on cancel; raises SurfaceError then."""

    def __init__(self, progress: Progress | None = None, cancel: Cancel | None = None) -> None:
        self.total, self.done = 1, 0
        self.progress, self.cancel = progress, cancel

    def begin(self, total: int) -> None:
        """``total`` moves are to be done."""
        self.total, self.done = max(total, 1), 0

    def advance(self, count: int) -> None:
        """``count`` moves done."""
        self.done += count
        if self.cancel is not None and self.cancel():
            share = 100.0 * self.done / self.total
            raise SurfaceError(f"Cut: stopped on request after {share:.0f} % of the work; nothing was kept.")
        if self.progress is not None:
            self.progress(min(1.0, self.done / self.total))


def cut_upright(z: FloatArray, cells: Cells, cutter: Cutter, ends: FloatArray, watch: Watch) -> EdgeCells:
    """Cut moves ``ends`` (n, 6) m (start, end) of an upright cutter into ``z`` (nx, ny) m, in place."""
    from robomill.surface.cells_kernels import EdgeRecord, Heights, cut_moves, settle
    from robomill.surface.envelope_kernels import cutter_shape

    ends = np.ascontiguousarray(ends)
    shape, reach = cutter_shape(cutter), cutter.radius + cells.dx
    low = np.minimum(ends[:, 0], ends[:, 3]) - reach
    high = np.maximum(ends[:, 0], ends[:, 3]) + reach
    size = rows_of_tile(z.shape), z.shape[1]
    z_centre, z_low, share = np.full(size, np.inf), np.full(size, np.inf), np.zeros((*size, 5))
    flat = np.empty(size[0] * size[1], dtype=np.int64)
    index, mean = [np.zeros(0, dtype=np.int64)], [np.zeros(0)]
    for i, chosen in _tiles(z.shape, cells, low, high, watch):
        part = z[i : i + size[0]]
        n = len(part)
        tile = Heights(part, cells.x0 + i * cells.dx, cells.y0, cells.dx, cells.dy)
        edge = EdgeRecord(z_centre[:n], z_low[:n], share[:n], flat, np.zeros(1, dtype=np.int64))
        for start in range(0, len(chosen), CHUNK_MOVES):
            chunk = chosen[start : start + CHUNK_MOVES]
            cut_moves(shape, ends, chunk, tile, edge)
            watch.advance(len(chunk))
        heights = np.empty(edge.noted[0])
        settle(tile, edge, heights)
        index.append(flat[: edge.noted[0]] + i * z.shape[1])
        mean.append(heights)
    return EdgeCells(np.concatenate(index), np.concatenate(mean))


def cut_tilted(
    z: FloatArray, cells: Cells, cutter: Cutter, moves: tuple[FloatArray, FloatArray], watch: Watch
) -> BoolArray:
    """Cut moves of a tilted cutter, ends (n, 6) m and axes (n, 3), into ``z`` (nx, ny) m, in place.

    Returns the cells (nx, ny) left with an overhang. Voids below the material that later moves lay open are open.
    """
    from robomill.surface.cells_kernels import Heights, Hidden, cut_tilted_moves
    from robomill.surface.envelope_kernels import cutter_shape
    from robomill.surface.tilt_kernels import TiltedMoves, plan_boxes

    ends, axes = (np.ascontiguousarray(a) for a in moves)
    shape, top, rows = cutter_shape(cutter), float(z.max()), rows_of_tile(z.shape)
    boxes = np.empty((len(ends), 4))
    plan_boxes(cutter.radius, ends, axes, top, boxes)
    tilted = TiltedMoves(ends, axes, boxes)
    overhang = np.zeros(z.shape, dtype=bool)
    for i, chosen in _tiles(z.shape, cells, boxes[:, 0], boxes[:, 1], watch):
        part = z[i : i + rows]
        tile = Heights(part, cells.x0 + i * cells.dx, cells.y0, cells.dx, cells.dy)
        hidden = Hidden(np.full(part.shape, np.inf), np.full(part.shape, -np.inf))
        for start in range(0, len(chosen), CHUNK_TILTED):
            chunk = chosen[start : start + CHUNK_TILTED]
            cut_tilted_moves(shape, tilted, chunk, tile, hidden)
            watch.advance(len(chunk))
        opened = hidden.high >= part
        part[opened] = np.minimum(part, hidden.low)[opened]
        overhang[i : i + rows] = (hidden.high > -np.inf) & ~opened
    return overhang


def rows_of_tile(shape: tuple[int, ...]) -> int:
    """Rows of a tile: about ``TILE_CELLS`` cells."""
    return int(min(shape[0], max(1, TILE_CELLS // shape[1])))


def _tiles(
    shape: tuple[int, ...], cells: Cells, low: FloatArray, high: FloatArray, watch: Watch
) -> Iterator[tuple[int, IntArray]]:
    """First row of each tile and the moves whose x range (low, high) meets it; tells the watch how much there is."""
    rows, found = rows_of_tile(shape), []
    for i in range(0, shape[0], rows):
        x_low, x_high = cells.x0 + (i - 1) * cells.dx, cells.x0 + min(i + rows, shape[0]) * cells.dx
        found.append((i, np.flatnonzero((low <= x_high) & (high >= x_low))))
    watch.begin(sum(len(chosen) for _, chosen in found))
    return ((i, chosen) for i, chosen in found if len(chosen))
