"""In which order material goes, compiled: each lowering of a cell, move after move."""

from __future__ import annotations

from typing import NamedTuple

from robomill.arrays import FloatArray
from robomill.compiled import InInt1, Out1, OutInt1, kernel, part
from robomill.cutting.profile_kernels import Shape
from robomill.surface.cells_kernels import Heights, cells_in, columns_near, interval_below, rows_near
from robomill.surface.envelope_kernels import move_between, swept_height
from robomill.surface.tilt_kernels import UPRIGHT, TiltedMoves, move_in_frame, tool_frame


class Lowerings(NamedTuple):
    """Cells that were lowered, in the order of the moves: flat index (e,), new height (e,) m, number (e,) of the move;
    ``told`` (1,) how many there were, beyond e where they found no room."""

    cell: OutInt1
    height: Out1
    move: OutInt1
    told: OutInt1


@part
def lower(tile: Heights, i: int, j: int, height: float, n: int, found: Lowerings) -> None:
    """Lower a cell in move n, and note it where there is room."""
    tile.z[i, j] = height
    if found.told[0] < found.cell.size:
        found.cell[found.told[0]] = i * tile.z.shape[1] + j
        found.height[found.told[0]] = height
        found.move[found.told[0]] = n
    found.told[0] += 1


@part
def lower_upright(shape: Shape, ends: FloatArray, n: int, tile: Heights, least: float, found: Lowerings) -> None:
    """A move ``ends`` (6,) m of an upright cutter: cells whose centres its track covers."""
    move = move_between(ends[0], ends[1], ends[2], ends[3], ends[4], ends[5])
    first, end = rows_near(move, shape.R, tile)
    for i in range(first, end):
        x = tile.x0 + i * tile.dx
        j_first, j_end = columns_near(move, shape.R, x, tile)
        for j in range(j_first, j_end):
            if tile.z[i, j] - least > move.az:
                height = swept_height(shape, move, x, tile.y0 + j * tile.dy)
                if height < tile.z[i, j] - least:
                    lower(tile, i, j, height, n, found)


@kernel
def lower_in_turn(
    shape: Shape, moves: TiltedMoves, number: InInt1, tile: Heights, least: float, found: Lowerings
) -> None:
    """Lower a tile by moves in their order, each as much as ``least`` m or more; ``number`` (n,) names the moves.

    What a leaning cutter takes from below the material that is seen is not told.
    """
    for n in range(len(moves.ends)):
        k = moves.axes[n]
        if abs(k[0]) + abs(k[1]) <= UPRIGHT:
            lower_upright(shape, moves.ends[n], number[n], tile, least, found)
            continue
        frame = tool_frame(k[0], k[1], k[2])
        move = move_in_frame(frame, moves.ends[n])
        first, end, j_first, j_end = cells_in(moves.boxes[n], tile)
        for i in range(first, end):
            for j in range(j_first, j_end):
                low, high = interval_below(shape, move, frame, tile, i, j)
                if high >= tile.z[i, j] and low < tile.z[i, j] - least:
                    lower(tile, i, j, low, number[n], found)
