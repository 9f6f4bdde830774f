"""Cutting moves into the cells of a height map, compiled: heights at centres, and shares of the cells at walls.

Heights at cell centres are exact. Beside them each cell that the edge of a track crosses keeps the share of it
that was covered and the lowest height cut there, which gives the mean height of the cell and so the removed
volume well below the size of a cell.
"""

from __future__ import annotations

import math
from typing import NamedTuple

from robomill.arrays import FloatArray
from robomill.compiled import In1, In2, InInt1, Out1, Out2, Out3, OutInt1, kernel, part
from robomill.cutting.profile_kernels import FLAT, Shape, clip
from robomill.surface.envelope_kernels import Move, move_between, nearest, row_interval, swept_height
from robomill.surface.tilt_kernels import (
    UPRIGHT,
    TiltedMoves,
    ToolFrame,
    move_in_frame,
    tilted_interval,
    tool_frame,
    vertical_line,
)

INSIDE = 1.0 - 1e-9  # of the way from the centre of a cell to an edge
SAME_WALL = 0.5  # cosine: edges that turn less than 60 degrees from each other are one wall, cut again


class Heights(NamedTuple):
    """Heights z (nx, ny) m, the centre of cell [0, 0] and the size of a cell, m."""

    z: Out2
    x0: float
    y0: float
    dx: float
    dy: float


class EdgeRecord(NamedTuple):
    """What is noted of cells that an edge crosses, arrays over the cells of a tile (inf or 0 where none does).

    z_centre (nx, ny) lowest height cut at the centre, z_low (nx, ny) lowest cut anywhere in the cell
    share (nx, ny, 11)  covered by the first edge's direction; covered by edges in other directions; the first
                        edge's normal (x, y); how far the others turn from it (cosine); of the edge of each of the two
                        that covers most its normal (x, y) and how far inside of it the centre lies
    cells (nx ny,) their flat indices, noted (1,) how many there are
    """

    z_centre: Out2
    z_low: Out2
    share: Out3
    cells: OutInt1
    noted: OutInt1


class Hidden(NamedTuple):
    """Voids below the material seen from above: lowest and highest height cut, (nx, ny) m; inf, -inf where none."""

    low: Out2
    high: Out2


@part
def cells_between(low: float, high: float, start: float, step: float, count: int) -> tuple[int, int]:
    """(first, end) of the cells, ``count`` from ``start`` on, whose centres lie in [low, high]; empty: first = end."""
    first = max(0, math.ceil((low - start) / step))
    end = min(count - 1, math.floor((high - start) / step)) + 1
    return first, max(first, end)


@part
def rows_near(move: Move, reach: float, tile: Heights) -> tuple[int, int]:
    """(first, end) of the rows whose centres lie within ``reach`` of a move in x."""
    span = move.length * move.ux
    return cells_between(
        move.ax + min(0.0, span) - reach, move.ax + max(0.0, span) + reach, tile.x0, tile.dx, tile.z.shape[0]
    )


@part
def columns_near(move: Move, reach: float, x: float, tile: Heights) -> tuple[int, int]:
    """(first, end) of the columns of the row at ``x`` whose centres lie within ``reach`` of a move in plan."""
    low, high = row_interval(move, reach, x)
    if low > high:
        return 0, 0
    return cells_between(low, high, tile.y0, tile.dy, tile.z.shape[1])


@part
def lower_row(shape: Shape, move: Move, x: float, y: float, dy: float, row: FloatArray) -> None:
    """Lower the cells of a row, centres (x, y + j dy) within the track, to what a move leaves."""
    if shape.kind == FLAT and move.m == 0.0:  # its own height everywhere: the one loop that must be fast
        for j in range(row.size):
            row[j] = min(row[j], move.az)
        return
    for j in range(row.size):
        if row[j] > move.az:
            row[j] = min(row[j], swept_height(shape, move, x, y + j * dy))


@part
def cut_move(shape: Shape, move: Move, tile: Heights, edge: EdgeRecord) -> None:
    """Cut a move of an upright cutter: cells wholly inside its track at once, those the edge may cross one by one."""
    half = 0.5 * math.hypot(tile.dx, tile.dy)
    first, end = rows_near(move, shape.R + half, tile)
    for i in range(first, end):
        x = tile.x0 + i * tile.dx
        j, j_end = columns_near(move, shape.R + half, x, tile)
        full, full_end = columns_near(move, shape.R - half, x, tile)
        if full >= full_end:
            full = full_end = j_end
        if any_above(tile.z[i, j:full], move.az) or any_above(tile.z[i, full_end:j_end], move.az):
            for column in range(j, full):
                cut_edge_cell(shape, move, i, column, tile, edge)
            for column in range(full_end, j_end):
                cut_edge_cell(shape, move, i, column, tile, edge)
        lower_row(shape, move, x, tile.y0 + full * tile.dy, tile.dy, tile.z[i, full:full_end])


@part
def any_above(row: FloatArray, height: float) -> bool:
    """True if any cell of a row is still above a height: spares the dearer look at its edge cells."""
    for j in range(row.size):  # noqa: SIM110 (compiled code has no any())
        if row[j] > height:
            return True
    return False


@part
def cut_edge_cell(shape: Shape, move: Move, i: int, j: int, tile: Heights, edge: EdgeRecord) -> None:
    """Cut a cell that the edge of the track may cross: wholly, or note the share of it that is covered."""
    z = tile.z
    if z[i, j] <= move.az:
        return
    x, y = tile.x0 + i * tile.dx, tile.y0 + j * tile.dy
    ex, ey = nearest(move, x, y)
    distance = math.sqrt(ex * ex + ey * ey)
    ex, ey = (ex / distance, ey / distance) if distance > 0.0 else (1.0, 0.0)
    d = shape.R - distance  # how far inside the track the centre lies
    half = 0.5 * (abs(ex) * tile.dx + abs(ey) * tile.dy)  # the cell's extent towards the edge
    if d <= -half:
        return
    height = move.az
    if shape.kind != FLAT or move.m != 0.0:
        shift = 0.0 if d >= 0.0 else 0.5 * (half - d)  # of a centre outside: to the middle of what is covered
        height = swept_height(shape, move, x - shift * ex, y - shift * ey)
    if height >= z[i, j]:
        return
    if d >= half:
        z[i, j] = height
        return
    if edge.z_low[i, j] == math.inf:
        edge.cells[edge.noted[0]] = i * z.shape[1] + j
        edge.noted[0] += 1
    if d >= 0.0:
        edge.z_centre[i, j] = min(edge.z_centre[i, j], height)
    edge.z_low[i, j] = min(edge.z_low[i, j], height)
    steps = swept_height(shape, move, x + INSIDE * d * ex, y + INSIDE * d * ey) < z[i, j]  # a round nose may run out
    wall = (ex, ey, d if steps else math.nan)
    note_share(edge.share[i, j], covered_share(d, ex, ey, tile.dx, tile.dy), wall)


@part
def covered_share(d: float, nx: float, ny: float, dx: float, dy: float) -> float:
    """Share of a dx x dy cell inside a straight edge: d, how far its centre lies inside; n, the edge's unit normal."""
    a, b = max(abs(nx) * dx, abs(ny) * dy), min(abs(nx) * dx, abs(ny) * dy)
    p = clip(d + 0.5 * (a + b), 0.0, a + b)
    if p < b:
        return p * p / (2.0 * a * b)
    if p <= a:
        return (p - 0.5 * b) / a
    return 1.0 - (a + b - p) ** 2 / (2.0 * a * b)


@part
def note_share(record: FloatArray, covered: float, wall: tuple[float, float, float]) -> None:
    """Note in a cell's ``EdgeRecord.share`` what an edge covers of it; ``wall``: its unit normal, and d."""
    ex, ey, d = wall
    if record[2] == 0.0 and record[3] == 0.0:
        record[0], record[2], record[3] = covered, ex, ey
        record[5], record[6], record[7] = ex, ey, d
        return
    turn = ex * record[2] + ey * record[3]
    if turn > SAME_WALL:
        if covered > record[0]:
            record[0], record[5], record[6], record[7] = covered, ex, ey, d
    elif covered > record[1]:
        record[1], record[4] = covered, turn
        record[8], record[9], record[10] = ex, ey, d


@part
def union_share(record: FloatArray) -> float:
    """Share of a cell covered in all: opposite edges add, crossing edges overlap."""
    first, other = record[0], record[1]
    overlap = 0.0 if record[4] < -SAME_WALL else first * other
    return min(1.0, first + other - overlap)


@kernel
def settle(tile: Heights, edge: EdgeRecord, mean: Out1, wall: Out2) -> None:
    """Write heights at the centres of edge cells into z, their means and walls (NaN: none left); clean the record."""
    columns = tile.z.shape[1]
    for n in range(edge.noted[0]):
        i, j = edge.cells[n] // columns, edge.cells[n] % columns
        top = tile.z[i, j]
        mean[n] = top - union_share(edge.share[i, j]) * max(0.0, top - edge.z_low[i, j])
        for column in range(6):
            wall[n, column] = edge.share[i, j, 5 + column] if top > edge.z_low[i, j] else math.nan
        tile.z[i, j] = min(top, edge.z_centre[i, j])
        edge.z_centre[i, j] = edge.z_low[i, j] = math.inf
        edge.share[i, j] = 0.0


@part
def cells_in(box: FloatArray, tile: Heights) -> tuple[int, int, int, int]:
    """(first, end) of the rows and (first, end) of the columns whose centres lie in ``box`` (4,) m."""
    first, end = cells_between(box[0], box[1], tile.x0, tile.dx, tile.z.shape[0])
    j_first, j_end = cells_between(box[2], box[3], tile.y0, tile.dy, tile.z.shape[1])
    return first, end, j_first, j_end


@part
def interval_below(shape: Shape, move: Move, frame: ToolFrame, tile: Heights, i: int, j: int) -> tuple[float, float]:
    """Heights (low, high) m over the centre of a cell inside a leaning cutter's move, not above the material there."""
    line = vertical_line(frame, tile.x0 + i * tile.dx, tile.y0 + j * tile.dy)
    return tilted_interval(shape, move, frame, line, tile.z[i, j])


@part
def cut_tilted_move(
    shape: Shape, ends: FloatArray, k: FloatArray, box: FloatArray, tile: Heights, hidden: Hidden
) -> None:
    """Cut a move ``ends`` (6,) m of a cutter leaning along k (3,), seen from above within ``box`` (4,) m."""
    frame = tool_frame(k[0], k[1], k[2])
    move = move_in_frame(frame, ends)
    first, end, j_first, j_end = cells_in(box, tile)
    for i in range(first, end):
        for j in range(j_first, j_end):
            low, high = interval_below(shape, move, frame, tile, i, j)
            if low >= high:
                continue
            if high >= tile.z[i, j]:
                tile.z[i, j] = low
            else:
                hidden.low[i, j] = min(hidden.low[i, j], low)
                hidden.high[i, j] = max(hidden.high[i, j], high)


@kernel
def cut_moves(shape: Shape, ends: In2, chosen: InInt1, tile: Heights, edge: EdgeRecord) -> None:
    """Cut the ``chosen`` rows of ``ends`` (n, 6) m of an upright cutter into a tile."""
    for n in chosen:
        move = move_between(ends[n, 0], ends[n, 1], ends[n, 2], ends[n, 3], ends[n, 4], ends[n, 5])
        cut_move(shape, move, tile, edge)


@kernel
def cut_tilted_moves(shape: Shape, moves: TiltedMoves, chosen: InInt1, tile: Heights, hidden: Hidden) -> None:
    """Cut the ``chosen`` ones of moves of a leaning cutter into a tile."""
    for n in chosen:
        cut_tilted_move(shape, moves.ends[n], moves.axes[n], moves.boxes[n], tile, hidden)


@kernel
def lower_along(shape: Shape, ends: In2, axes: In2, x: In1, y: In1, z: Out1) -> None:
    """Lower z (q,) m at points x, y (q,) m to what moves ``ends`` (n, 6) m with tool axes (n, 3) leave there.

    Upright moves first, then those that lean; a void that does not reach up to z is not seen from above.
    """
    leaning = 0
    for n in range(len(ends)):
        if math.hypot(axes[n, 0], axes[n, 1]) > UPRIGHT:
            leaning += 1
            continue
        move = move_between(ends[n, 0], ends[n, 1], ends[n, 2], ends[n, 3], ends[n, 4], ends[n, 5])
        for q in range(len(z)):
            ex, ey = nearest(move, x[q], y[q])
            if z[q] > move.az and ex * ex + ey * ey <= shape.R * shape.R:
                z[q] = min(z[q], swept_height(shape, move, x[q], y[q]))
    for n in range(len(ends)):
        if leaning == 0 or math.hypot(axes[n, 0], axes[n, 1]) <= UPRIGHT:
            continue
        frame = tool_frame(axes[n, 0], axes[n, 1], axes[n, 2])
        move = move_in_frame(frame, ends[n])
        for q in range(len(z)):
            low, high = tilted_interval(shape, move, frame, vertical_line(frame, x[q], y[q]), z[q])
            if low < high and high >= z[q]:
                z[q] = low
