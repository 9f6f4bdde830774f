"""Cutting moves of a tilted cutter into a height map, and noticing what a height map cannot hold."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from robomill.arrays import BoolArray, FloatArray, as_floats
from robomill.errors import SurfaceError
from robomill.surface.compiler import Kernels
from robomill.surface.envelope import Move, Shape
from robomill.surface.removal import Cancel, Grid, Progress, Watch, rows_of_tile, tiles_of
from robomill.surface.tilt import Tilt, tilted_interval

SMALLEST_RISE = 0.1


def tool_axes(k: ArrayLike | None, m: int) -> FloatArray:
    """Unit tool axes (m, 3) from one axis (3,) or (m, 3), upright if None. Raises SurfaceError for a wrong axis."""
    if k is None:
        return np.tile([0.0, 0.0, 1.0], (m, 1))
    axes = as_floats(k, "tool axis", (3,), error=SurfaceError)
    if axes.shape not in ((3,), (m, 3)):
        raise SurfaceError(f"Tool axis: found shape {axes.shape} for {m} points; expected (3,) or ({m}, 3).")
    axes = np.array(np.broadcast_to(axes, (m, 3)))
    length = np.linalg.norm(axes, axis=1, keepdims=True)
    if (np.abs(length - 1.0) > 1e-6).any():
        raise SurfaceError("Tool axis: expected unit vectors, found a length that is not 1.")
    return axes / length


def split_turning(R: float, ends: FloatArray, axes: FloatArray, cell: float) -> tuple[FloatArray, FloatArray]:
    """Divide moves whose axis turns into pieces of constant axis: ends (n, 6), axes (n, 6) -> (q, 6), (q, 3).

    Each piece takes the axis of its middle, so no point of the cutter strays by more than about a tenth of a cell.
    Raises SurfaceError for an axis too close to level for a height map.
    """
    k_a, k_b = axes[:, :3], axes[:, 3:]
    if len(axes) and min(k_a[:, 2].min(), k_b[:, 2].min()) < SMALLEST_RISE:
        raise SurfaceError(
            f"Tool axis: its upward part is {min(k_a[:, 2].min(), k_b[:, 2].min()):.2f}; a height map needs at least"
            f" {SMALLEST_RISE}, so tilt the tool less or turn the part."
        )
    turn = np.arctan2(np.linalg.norm(np.cross(k_a, k_b), axis=1), np.einsum("ni,ni->n", k_a, k_b))
    pieces = np.maximum(1, np.ceil(turn * R / (0.2 * cell))).astype(int)
    owner = np.repeat(np.arange(len(ends)), pieces)
    first = np.repeat(np.cumsum(pieces) - pieces, pieces)
    n = (np.arange(len(owner)) - first)[:, None]
    count = pieces[owner][:, None]
    a, b = ends[owner, :3], ends[owner, 3:]
    split = np.hstack([a + n / count * (b - a), np.where(n + 1 == count, b, a + (n + 1) / count * (b - a))])
    k = k_a[owner] + (n + 0.5) / count * (k_b - k_a)[owner]
    k = np.where(count == 1, 0.5 * (k_a + k_b)[owner], k)
    return split, k / np.linalg.norm(k, axis=1, keepdims=True)


class TiltedMoves(NamedTuple):
    """Moves of a tilted cutter: moves (n, 7) and frames (n, 8) as ``kernels.cut_tilted`` takes them, boxes (n, 4) m."""

    moves: FloatArray
    frames: FloatArray
    boxes: FloatArray


def tilted_moves(shape: Shape, ends: FloatArray, axes: FloatArray, top: float) -> TiltedMoves:
    """Moves ``ends`` (n, 6) with one axis (n, 3) each; ``top`` is the stock's highest point, above which nothing is."""
    sine = np.hypot(axes[:, 0], axes[:, 1])
    k = axes
    e1 = np.stack([-k[:, 1], k[:, 0], np.zeros(len(k))], axis=1) / sine[:, None]
    e2 = np.cross(k, e1)
    frame = np.stack([e1, e2, k], axis=1)
    a, b = np.einsum("nij,nj->ni", frame, ends[:, :3]), np.einsum("nij,nj->ni", frame, ends[:, 3:])
    swap = b[:, 2] < a[:, 2]
    a, b = np.where(swap[:, None], b, a), np.where(swap[:, None], a, b)
    span = b - a
    length = np.hypot(span[:, 0], span[:, 1])
    point = length < 1e-12
    safe = np.where(point, 1.0, length)
    u = np.where(point[:, None], [1.0, 0.0], span[:, :2] / safe[:, None])
    moves = np.column_stack([a, u, np.where(point, 0.0, length), np.where(point, 0.0, span[:, 2] / safe)])
    frames = np.column_stack([e1[:, :2], e2[:, :2], k[:, :2], sine, k[:, 2]])
    lowest = np.minimum(ends[:, 2], ends[:, 5])
    up = np.maximum(0.0, top - lowest + shape.R * sine) / k[:, 2]
    lean = k[:, :2] * up[:, None]
    corners = np.stack([ends[:, :2], ends[:, 3:5], ends[:, :2] + lean, ends[:, 3:5] + lean])
    low, high = corners.min(axis=0) - shape.R, corners.max(axis=0) + shape.R
    boxes = np.column_stack([low[:, 0], high[:, 0], low[:, 1], high[:, 1]])
    return TiltedMoves(moves, frames, boxes)


def cut_tilted(
    z: FloatArray,
    grid: Grid,
    shape: Shape,
    tilted: TiltedMoves,
    module: Kernels | None,
    progress: Progress | None = None,
    cancel: Cancel | None = None,
) -> BoolArray:
    """Cut moves of a tilted cutter into ``z`` in place; returns the cells (nx, ny) left with an overhang."""
    boxes = tilted.boxes
    tiles = [(i, chosen) for i, chosen in tiles_of(z, grid, boxes[:, 0], boxes[:, 1]) if len(chosen)]
    watch = Watch(sum(len(chosen) for _, chosen in tiles), progress, cancel)
    overhang = np.zeros(z.shape, dtype=bool)
    rows = rows_of_tile(z.shape)
    for i, chosen in tiles:
        part = z[i : i + rows]
        hidden_low, hidden_high = np.full(part.shape, np.inf), np.full(part.shape, -np.inf)
        place = Grid(grid.x0 + i * grid.dx, *grid[1:])
        for start in range(0, len(chosen), 50):
            chunk = chosen[start : start + 50]
            if module is not None:
                module.cut_tilted(tuple(shape), *tilted, chunk, tuple(place), part, hidden_low, hidden_high)
            else:
                for n in chunk:
                    cut_tilted_move(shape, tilted, n, place, part, hidden_low, hidden_high)
            watch.advance(len(chunk))
        joined = hidden_high >= part
        part[joined] = np.minimum(part, hidden_low)[joined]
        overhang[i : i + rows] = (hidden_high > -np.inf) & ~joined
    return overhang


def cut_tilted_move(
    shape: Shape,
    tilted: TiltedMoves,
    n: int,
    grid: Grid,
    z: FloatArray,
    hidden_low: FloatArray,
    hidden_high: FloatArray,
) -> None:
    """One tilted move into a tile, with NumPy."""
    box, frame = tilted.boxes[n], tilted.frames[n]
    first = np.maximum(0, np.ceil([(box[0] - grid.x0) / grid.dx, (box[2] - grid.y0) / grid.dy])).astype(int)
    last = np.floor([(box[1] - grid.x0) / grid.dx, (box[3] - grid.y0) / grid.dy]).astype(int)
    last = np.minimum(last, np.array(z.shape) - 1)
    if (first > last).any():
        return
    i, j = (a.ravel() for a in np.mgrid[first[0] : last[0] + 1, first[1] : last[1] + 1])
    tilt = Tilt(
        np.append(frame[0:2], 0.0),
        np.append(frame[2:4], frame[6]),
        np.append(frame[4:6], frame[7]),
        float(frame[6]),
        float(frame[7]),
    )
    move = Move(*(float(value) for value in tilted.moves[n]))
    top = z[i, j]
    low, high = tilted_interval(shape, tilt, move, grid.x0 + i * grid.dx, grid.y0 + j * grid.dy, top)
    hit = low < high
    i, j, low, high, top = i[hit], j[hit], low[hit], high[hit], top[hit]
    open_above = high >= top
    z[i[open_above], j[open_above]] = low[open_above]
    i, j, low, high = i[~open_above], j[~open_above], low[~open_above], high[~open_above]
    hidden_low[i, j] = np.minimum(hidden_low[i, j], low)
    hidden_high[i, j] = np.maximum(hidden_high[i, j], high)
