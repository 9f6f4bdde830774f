"""Cutting moves into a height map, tile by tile: small tiles keep memory low and the work in the processor's cache."""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from robomill.arrays import BoolArray, FloatArray, IntArray
from robomill.cutting.tool import Cutter
from robomill.progress import slices
from robomill.surface.stock import Cells

TILE_CELLS = 100_000  # what is noted of so many stays in the memory that is at hand


@dataclass(frozen=True)
class EdgeCells:
    """Cells whose mean height is not their height at the centre.

    index  (e,)      flat index of the cell
    mean   (e,) m    mean height
    wall   (e, 6)    the one or two walls through the cell, of each its unit normal (x, y) into the material and how
                     far (m) inside of it the centre lies (below 0: in the material); 0 where there is no second one,
                     NaN where a later cut took them away
    """

    index: IntArray
    mean: FloatArray
    wall: FloatArray


def cut_upright(z: FloatArray, cells: Cells, cutter: Cutter, ends: FloatArray) -> EdgeCells:
    """Cut moves ``ends`` (n, 6) m (start, end) of an upright cutter into ``z`` (nx, ny) m, in place."""
    from robomill.surface.cells_kernels import EdgeRecord, Heights, cut_moves, settle

    ends = np.ascontiguousarray(ends)
    shape, reach = cutter.solid, cutter.radius + cells.dx
    low = np.minimum(ends[:, 0], ends[:, 3]) - reach
    high = np.maximum(ends[:, 0], ends[:, 3]) + reach
    size = rows_of_tile(z.shape), z.shape[1]
    z_centre, z_low, share = np.full(size, np.inf), np.full(size, np.inf), np.zeros((*size, 11))
    flat = np.empty(size[0] * size[1], dtype=np.int64)
    index, mean, wall = [np.zeros(0, dtype=np.int64)], [np.zeros(0)], [np.zeros((0, 6))]
    for i, chosen in tiles(z.shape, cells, low, high):
        part = z[i : i + size[0]]
        n = len(part)
        tile = Heights(part, cells.x0 + i * cells.dx, cells.y0, cells.dx, cells.dy)
        edge = EdgeRecord(z_centre[:n], z_low[:n], share[:n], flat, np.zeros(1, dtype=np.int64))
        for some in slices(len(chosen), "Surface"):
            cut_moves(shape, ends, chosen[some], tile, edge)
        heights = np.empty(edge.noted[0])
        walls = np.empty((edge.noted[0], 6))
        settle(tile, edge, heights, walls)
        index.append(flat[: edge.noted[0]] + i * z.shape[1])
        mean.append(heights)
        wall.append(walls)
    return EdgeCells(np.concatenate(index), np.concatenate(mean), np.concatenate(wall))


def cut_tilted(z: FloatArray, cells: Cells, cutter: Cutter, moves: tuple[FloatArray, FloatArray]) -> BoolArray:
    """Cut moves of a tilted cutter, ends (n, 6) m and axes (n, 3), into ``z`` (nx, ny) m, in place.

    Returns the cells (nx, ny) left with an overhang. Voids below the material that later moves lay open are open.
    """
    from robomill.surface.cells_kernels import Heights, Hidden, cut_tilted_moves
    from robomill.surface.tilt_kernels import TiltedMoves, plan_boxes

    ends, axes = (np.ascontiguousarray(a) for a in moves)
    shape, top, rows = cutter.solid, float(z.max()), rows_of_tile(z.shape)
    boxes = np.empty((len(ends), 4))
    plan_boxes(cutter.radius, ends, axes, top, boxes)
    tilted = TiltedMoves(ends, axes, boxes)
    overhang = np.zeros(z.shape, dtype=bool)
    for i, chosen in tiles(z.shape, cells, boxes[:, 0], boxes[:, 1]):
        part = z[i : i + rows]
        tile = Heights(part, cells.x0 + i * cells.dx, cells.y0, cells.dx, cells.dy)
        hidden = Hidden(np.full(part.shape, np.inf), np.full(part.shape, -np.inf))
        for some in slices(len(chosen), "Surface"):
            cut_tilted_moves(shape, tilted, chosen[some], tile, hidden)
        opened = hidden.high >= part
        part[opened] = np.minimum(part, hidden.low)[opened]
        overhang[i : i + rows] = (hidden.high > -np.inf) & ~opened
    return overhang


def rows_of_tile(shape: tuple[int, ...]) -> int:
    """Rows of a tile: about ``TILE_CELLS`` cells."""
    return int(min(shape[0], max(1, TILE_CELLS // shape[1])))


def tiles(shape: tuple[int, ...], cells: Cells, low: FloatArray, high: FloatArray) -> Iterator[tuple[int, IntArray]]:
    """First row of each tile that moves meet in x, and these moves: their range is (low, high), (n,) m."""
    rows = rows_of_tile(shape)
    for i in range(0, shape[0], rows):
        x_low, x_high = cells.x0 + i * cells.dx, cells.x0 + (min(i + rows, shape[0]) - 1) * cells.dx
        chosen = np.flatnonzero((low <= x_high) & (high >= x_low))
        if len(chosen):
            yield i, chosen
