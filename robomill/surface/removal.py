"""Cutting moves into a height map, tile by tile: the loop around ``envelope.py`` or its compiled twin.

Heights at cell centres are exact. Beside them each cell that the edge of a track crosses keeps the share of it
that was covered and the lowest height cut there, which gives the mean height of the cell and so the removed
volume well below the size of a cell. Tiles keep that extra memory small and the work in the processor's cache.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from robomill.arrays import FloatArray, IntArray
from robomill.errors import SurfaceError
from robomill.surface import envelope
from robomill.surface.compiler import Kernels
from robomill.surface.envelope import Shape

TILE_CELLS = 250_000
CHUNK_MOVES = 20_000
STRAIGHT = 1e-11  # rad: a divided line bends less by rounding

Progress = Callable[[float], None]
Cancel = Callable[[], bool]


class Grid(NamedTuple):
    """Centre of cell [0, 0] and the size of a cell, m."""

    x0: float
    y0: float
    dx: float
    dy: float


@dataclass(frozen=True)
class EdgeCells:
    """Cells whose mean height is not their height at the centre: flat index (e,) and mean height (e,) m."""

    index: IntArray
    mean: FloatArray


class Watch:
    """Reports progress (0 to 1) and stops on cancel; raises SurfaceError then."""

    def __init__(self, total: int, progress: Progress | None, cancel: Cancel | None) -> None:
        self.total, self.done = max(total, 1), 0
        self.progress, self.cancel = progress, cancel

    def advance(self, count: int) -> None:
        """``count`` moves done."""
        self.done += count
        if self.cancel is not None and self.cancel():
            share = 100.0 * self.done / self.total
            raise SurfaceError(f"Cut: stopped on request after {share:.0f} % of the work; nothing was kept.")
        if self.progress is not None:
            self.progress(min(1.0, self.done / self.total))


def cut_upright(
    z: FloatArray,
    grid: Grid,
    shape: Shape,
    ends: FloatArray,
    module: Kernels | None,
    progress: Progress | None = None,
    cancel: Cancel | None = None,
) -> EdgeCells:
    """Cut moves ``ends`` (n, 6) m (start, end) of an upright cutter into ``z`` (nx, ny), in place."""
    reach = shape.R + grid.dx
    low = np.minimum(ends[:, 0], ends[:, 3]) - reach
    high = np.maximum(ends[:, 0], ends[:, 3]) + reach
    tiles = [(i, chosen) for i, chosen in tiles_of(z, grid, low, high) if len(chosen)]
    watch = Watch(sum(len(chosen) for _, chosen in tiles), progress, cancel)
    index: list[IntArray] = []
    mean: list[FloatArray] = []
    scratch = _Scratch(z.shape)
    for i, chosen in tiles:
        part = z[i : i + scratch.rows]
        tile = scratch.tile(part)
        place = Grid(grid.x0 + i * grid.dx, *grid[1:])
        for chunk in _chunks(chosen, module is not None):
            if module is not None:
                module.cut_moves(tuple(shape), ends, chunk, tuple(place), tile)
            else:
                for n in chunk:
                    _cut_move(shape, envelope.move_of(ends[n, :3], ends[n, 3:]), place, tile)
            watch.advance(len(chunk))
        cells, heights = scratch.settle(tile)
        index.append(cells + i * z.shape[1])
        mean.append(heights)
    if not index:
        return EdgeCells(np.zeros(0, dtype=np.int64), np.zeros(0))
    return EdgeCells(np.concatenate(index), np.concatenate(mean))


Tile = tuple[FloatArray, FloatArray, FloatArray, FloatArray, IntArray, IntArray]


class _Scratch:
    """Working arrays of one tile, cleaned behind each use at the cells that were touched."""

    def __init__(self, shape: tuple[int, ...]) -> None:
        self.rows = rows_of_tile(shape)
        size = (self.rows, shape[1])
        self.z_centre, self.z_low = np.full(size, np.inf), np.full(size, np.inf)
        self.share = np.zeros((*size, 5))
        self.edges = np.empty(size[0] * size[1], dtype=np.int64)

    def tile(self, z: FloatArray) -> Tile:
        n = len(z)
        count = np.zeros(1, dtype=np.int64)
        return z, self.z_centre[:n], self.z_low[:n], self.share[:n], self.edges, count

    def settle(self, tile: Tile) -> tuple[IntArray, FloatArray]:
        """Write the heights at the centres of edge cells into z; return edge cells and their mean heights."""
        z, z_centre, z_low = (a.reshape(-1) for a in tile[:3])
        share = tile[3].reshape(-1, 5)
        cells = tile[4][: tile[5][0]].copy()
        top = z[cells]
        mean = top - envelope.union_share(share[cells]) * np.maximum(0.0, top - z_low[cells])
        z[cells] = np.minimum(top, z_centre[cells])
        z_centre[cells] = z_low[cells] = np.inf
        share[cells] = 0.0
        return cells, mean


def _cut_move(shape: Shape, move: envelope.Move, grid: Grid, tile: Tile) -> None:
    """One move into a tile, with NumPy; the compiled twin is ``kernels.cut_upright``."""
    z, z_centre, z_low, share, edges, count = tile
    half = 0.5 * float(np.hypot(grid.dx, grid.dy))
    box = box_of(z.shape, grid, move, shape.R + half)
    if box is None:
        return
    rows, columns = box
    view = z[rows, columns]
    x = (grid.x0 + np.arange(rows.start, rows.stop) * grid.dx)[:, None]
    y = (grid.y0 + np.arange(columns.start, columns.stop) * grid.dy)[None, :]
    height, d = envelope.swept_height(shape, move, x, y)
    full = d >= half
    view[full] = np.minimum(view, height)[full]
    i, j = np.nonzero((d > -half) & ~full & (view > move.az))
    if len(i) == 0:
        return
    X, Y, d, height, top = x[i, 0], y[0, j], d[i, j], height[i, j], view[i, j]
    ex, ey = _outward(move, X, Y)
    half_width = 0.5 * (np.abs(ex) * grid.dx + np.abs(ey) * grid.dy)
    full = d >= half_width
    view[i[full], j[full]] = np.minimum(top[full], height[full])
    shift = np.where(d >= 0, 0.0, 0.5 * (half_width - d))
    height = np.where(d >= 0, height, envelope.swept_height(shape, move, X - shift * ex, Y - shift * ey)[0])
    part = ~full & (d > -half_width) & (height < top)
    centre = part & (d >= 0)
    i, j = i + rows.start, j + columns.start
    z_centre[i[centre], j[centre]] = np.minimum(z_centre[i[centre], j[centre]], height[centre])
    i, j = i[part], j[part]
    fresh = (i * z.shape[1] + j)[np.isinf(z_low[i, j])]
    edges[count[0] : count[0] + len(fresh)] = fresh
    count[0] += len(fresh)
    z_low[i, j] = np.minimum(z_low[i, j], height[part])
    covered = envelope.covered_share(d[part], ex[part], ey[part], grid.dx, grid.dy)
    share[i, j] = envelope.note_share(share[i, j], covered, ex[part], ey[part])


def _outward(move: envelope.Move, x: FloatArray, y: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Unit vector (ex, ey) from the nearest point of the move to (x, y); along x if they coincide."""
    X, Y = x - move.ax, y - move.ay
    near = np.clip(X * move.ux + Y * move.uy, 0.0, move.length)
    ex, ey = X - near * move.ux, Y - near * move.uy
    distance = np.sqrt(ex * ex + ey * ey)
    away = distance > 0
    safe = np.where(away, distance, 1.0)
    return np.where(away, ex / safe, 1.0), np.where(away, ey / safe, 0.0)


def box_of(shape: tuple[int, ...], grid: Grid, move: envelope.Move, reach: float) -> tuple[slice, slice] | None:
    """Rows and columns of the cells within ``reach`` of a move's bounds; None if there are none."""
    ranges = []
    for n, start, span, origin, step in (
        (shape[0], move.ax, move.length * move.ux, grid.x0, grid.dx),
        (shape[1], move.ay, move.length * move.uy, grid.y0, grid.dy),
    ):
        low = max(0, int(np.ceil((start + min(0.0, span) - reach - origin) / step)))
        high = min(n - 1, int(np.floor((start + max(0.0, span) + reach - origin) / step)))
        if low > high:
            return None
        ranges.append(slice(low, high + 1))
    return ranges[0], ranges[1]


def joined(ends: FloatArray, axes: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Moves ends (n, 6), axes (n, a), with runs of moves that go straight on under one axis made one move.

    A line that was divided for the deflection is so cut at once where it is still a line.
    """
    if len(ends) < 2:
        return ends, axes
    span = ends[:, 3:] - ends[:, :3]
    length = np.linalg.norm(span, axis=1)
    before, after = span[:-1], span[1:]
    scale = length[:-1] * length[1:]
    bend = np.linalg.norm(np.cross(before, after), axis=1)
    goes_on = (
        (scale > 0)
        & (bend <= STRAIGHT * scale)
        & (np.einsum("ni,ni->n", before, after) > 0)
        & (ends[:-1, 3:] == ends[1:, :3]).all(axis=1)
        & (axes[:-1] == axes[1:]).all(axis=1)
        & (axes[:, : axes.shape[1] // 2] == axes[:, axes.shape[1] // 2 :]).all(axis=1)[1:]
    )
    first = np.flatnonzero(np.append(True, ~goes_on))
    last = np.append(first[1:], len(ends)) - 1
    return np.hstack([ends[first, :3], ends[last, 3:]]), axes[first]


def numpy_seconds(ends: FloatArray, R: float, grid: Grid, tilted: bool = False) -> float:
    """About how long NumPy takes to cut moves (n, 6): some per move, and some per cell of each move's box."""
    if len(ends) == 0:
        return 0.0
    span = np.abs(ends[:, 3:5] - ends[:, :2]) + 2 * R
    cells = float((span[:, 0] * span[:, 1]).sum()) / (grid.dx * grid.dy)
    return 1.5e-4 * len(ends) + (5e-6 if tilted else 5e-8) * cells


def rows_of_tile(shape: tuple[int, ...]) -> int:
    """Rows of a tile: about ``TILE_CELLS`` cells."""
    return int(min(shape[0], max(1, TILE_CELLS // shape[1])))


def tiles_of(z: FloatArray, grid: Grid, low: FloatArray, high: FloatArray) -> list[tuple[int, IntArray]]:
    """First row of each tile and the moves whose x range (low, high) meets it."""
    rows = rows_of_tile(z.shape)
    found = []
    for i in range(0, z.shape[0], rows):
        x_low, x_high = grid.x0 + (i - 1) * grid.dx, grid.x0 + (min(i + rows, z.shape[0])) * grid.dx
        found.append((i, np.flatnonzero((low <= x_high) & (high >= x_low))))
    return found


def _chunks(chosen: IntArray, compiled: bool) -> list[IntArray]:
    size = CHUNK_MOVES if compiled else 50
    return [chosen[n : n + size] for n in range(0, len(chosen), size)]
