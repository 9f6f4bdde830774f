"""Moves made one after the other, compiled: feed moves lower the cells, of the others it is asked what they meet."""

from __future__ import annotations

import math
from typing import NamedTuple

from robomill.arrays import FloatArray
from robomill.compiled import InInt1, Out2, OutInt1, kernel, part
from robomill.cutting.profile_kernels import Shape, shape_of
from robomill.surface.cells_kernels import Heights, cells_in, columns_near, interval_below, lower_row, rows_near
from robomill.surface.envelope_kernels import Move, move_between, swept_height
from robomill.surface.tilt_kernels import UPRIGHT, TiltedMoves, move_in_frame, tool_frame

ROUNDING = 1e-6  # m: what is met by less than this is rounding


class Program(NamedTuple):
    """Who makes a move: shapes (t, 5) of the cutters, which (n,) of them, feed (n,) or 0 where it must meet nothing."""

    shapes: Out2  # read only, as in TiltedMoves
    which: OutInt1
    feed: OutInt1


@part
def met_in_row(shape: Shape, move: Move, x: float, y: float, dy: float, row: FloatArray) -> bool:
    """Whether a move goes through the material of a row, centres (x, y + j dy) within its track."""
    for j in range(row.size):
        top = row[j] - ROUNDING
        if top > move.az and swept_height(shape, move, x, y + j * dy) < top:
            return True
    return False


@part
def make_upright(shape: Shape, move: Move, feed: bool, tile: Heights) -> bool:
    """Make a move of an upright cutter: cut it at feed; otherwise whether it meets material."""
    first, end = rows_near(move, shape.R, tile)
    for i in range(first, end):
        x = tile.x0 + i * tile.dx
        j, j_end = columns_near(move, shape.R, x, tile)
        y, row = tile.y0 + j * tile.dy, tile.z[i, j:j_end]
        if feed:
            lower_row(shape, move, x, y, tile.dy, row)
        elif met_in_row(shape, move, x, y, tile.dy, row):
            return True
    return False


@part
def make_leaning(shape: Shape, k: FloatArray, ends: FloatArray, box: FloatArray, feed: bool, tile: Heights) -> bool:
    """Likewise of a cutter leaning along k (3,), within ``box`` (4,) m: what it opens from above, not voids below."""
    frame = tool_frame(k[0], k[1], k[2])
    move = move_in_frame(frame, ends)
    first, end, j_first, j_end = cells_in(box, tile)
    for i in range(first, end):
        for j in range(j_first, j_end):
            low, high = interval_below(shape, move, frame, tile, i, j)
            if low >= high or high < tile.z[i, j]:
                continue
            if feed:
                tile.z[i, j] = low
            elif low < tile.z[i, j] - ROUNDING:
                return True
    return False


@kernel
def make_in_order(program: Program, moves: TiltedMoves, chosen: InInt1, tile: Heights, met: OutInt1) -> None:
    """Make the ``chosen`` moves one after the other in a tile: 1 in ``met`` (n,) for those that meet material."""
    for n in chosen:
        shape, feed = shape_of(program.shapes[program.which[n]]), program.feed[n] > 0
        k, ends = moves.axes[n], moves.ends[n]
        if math.hypot(k[0], k[1]) > UPRIGHT:
            meets = make_leaning(shape, k, ends, moves.boxes[n], feed, tile)
        else:
            move = move_between(ends[0], ends[1], ends[2], ends[3], ends[4], ends[5])
            meets = make_upright(shape, move, feed, tile)
        if meets:
            met[n] = 1
