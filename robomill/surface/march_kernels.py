"""A path marched through the stock, compiled: what each step meets, then the step cut into the columns."""

from __future__ import annotations

import math
from typing import Annotated, NamedTuple

import numpy as np
from numpy.typing import NDArray

from robomill.arrays import FloatArray
from robomill.compiled import Axes, Out2, OutInt1, called, kernel, part
from robomill.cutting.engaged import FACING
from robomill.cutting.profile_kernels import FLAT, Shape, profile, profile_within, radius_at, shape_of
from robomill.surface.cells_kernels import cells_between
from robomill.surface.division_kernels import add_part
from robomill.surface.engagement_kernels import Room
from robomill.surface.envelope_kernels import POINT, Move, nearest, row_interval, swept_height
from robomill.surface.material_kernels import (
    AXIS,
    ENDS,
    MOVE,
    NOBODY,
    SKIN,
    Dexels,
    World,
    cell_of,
    height_of_run,
    is_upright,
    see_move,
)
from robomill.surface.soon import soon
from robomill.surface.step_kernels import step_at
from robomill.surface.tilt_kernels import tilted_interval, tool_frame, vertical_line

Singles1 = Annotated[NDArray[np.float32], Axes("float32", 1)]
Singles2 = Annotated[NDArray[np.float32], Axes("float32", 2, written=True)]
Bits1 = Annotated[NDArray[np.int32], Axes("int32", 1)]
Halves1 = Annotated[NDArray[np.int16], Axes("int16", 1, written=True)]

ROWS_AHEAD = 6  # of columns, that are asked for while one is cut,
LINE = 8  # columns at once, which come together from memory
SMALL_HALF, LEAST_HALF = 2.0**-14, 2.0**-24  # half precision keeps numbers below the first in steps of the second
HALF_BITS, HALF_BIAS = 13, (127 - 15) << 23  # fewer in its fraction than in single precision; between their exponents


class Steps(NamedTuple):
    """Steps of a path: ends (n, 6) m, then the tip (m), unit feed, axis of the tool and heading (see ``step_at``)
    where each is looked at (n, 3), the run it belongs to, whether it begins it and whether nothing goes on from its
    end (n,)."""

    ends: Out2
    tip: Out2
    feed: Out2
    axis: Out2
    heading: Out2
    run: OutInt1
    begins: OutInt1
    stops: OutInt1


@part
def go_on(run: FloatArray, ends: FloatArray, begins: bool) -> None:
    """Let a run begin with a step or go on with it. Nothing of it is cut before it ends: no step of a straight run
    meets what the run has opened behind it."""
    for n in range(0 if begins else 3, 6):
        run[ENDS + n] = ends[n]


@part
def cut_run(world: World, r: int, stops: bool) -> None:
    """Cut a run into the columns, as far as it goes. ``stops``: nothing goes on from there."""
    run = world.runs[r]
    shape, move = shape_of(run), see_move(run)
    if not is_upright(run):
        cut_leaning(world, shape, move, r)
    else:
        cut_upright(world, shape, move, r)
    note_rim(world, shape, r, stops)


@part
def goes_on(runs: FloatArray, r: int) -> bool:
    """Whether a run begins where the one before left off, with the same tool and axis."""
    same = r > 0
    if same:
        for n in range(MOVE):
            before = n + 3 if ENDS <= n < ENDS + 3 else n
            same = same and (ENDS + 3 <= n < AXIS or runs[r - 1, before] == runs[r, n])
    return same


@part
def follows(runs: FloatArray, r: int) -> bool:
    """Whether a run has nothing to cut behind its start: it goes on from another and does not go down."""
    return goes_on(runs, r) and runs[r, ENDS + 5] >= runs[r, ENDS + 2]


@part
def leaves(runs: FloatArray, r: int) -> bool:
    """Whether a run leaves what lies ahead of its end to the next one, which begins with the tool there: it does not
    go up, and not straight down."""
    if r + 1 == len(runs) or runs[r, ENDS + 5] > runs[r, ENDS + 2] or not goes_on(runs, r + 1):
        return False
    ux, uy = way_in_plan(runs, r)
    return ux != 0.0 or uy != 0.0


@part
def way_in_plan(runs: FloatArray, r: int) -> tuple[float, float]:
    """Unit vector of a run in plan, from its start to its end; (0, 0) straight up or down."""
    vx, vy = runs[r, ENDS + 3] - runs[r, ENDS], runs[r, ENDS + 4] - runs[r, ENDS + 1]
    length = math.hypot(vx, vy)
    return (vx / length, vy / length) if length > POINT else (0.0, 0.0)


@part
def ahead_of(place: FloatArray, way: tuple[float, float], x: float) -> tuple[float, float]:
    """Where the line at ``x`` parallel to y lies ahead of a place (x, y), or abreast of it: (low, high) m; everywhere
    if there is no way."""
    if way[1] == 0.0:
        return (-math.inf, math.inf) if (x - place[0]) * way[0] >= -SKIN else (math.inf, -math.inf)
    y = place[1] - ((x - place[0]) * way[0] + SKIN) / way[1]
    return (y, math.inf) if way[1] > 0.0 else (-math.inf, y)


@part
def cut_upright(world: World, shape: Shape, move: Move, r: int) -> None:
    """Cut a run of an upright cutter: ahead of its start, where it follows another, and of where that one stopped; up
    to its end, where it leaves what lies ahead."""
    dexels, runs, height = world.dexels, world.runs, world.bounds.z_high - move.az
    if height <= 0.0:
        return
    radius, follow, leave = radius_at(shape, height), follows(runs, r), leaves(runs, r)
    a, b, way = runs[r, ENDS : ENDS + 3], runs[r, ENDS + 3 : AXIS], way_in_plan(runs, r)
    before, back = way_in_plan(runs, r - 1) if follow else way, (-way[0], -way[1])
    turn = 2.0 * math.hypot(way[0] - before[0], way[1] - before[1])  # at least the angle between both ways
    side = radius * abs(way[1])  # how far its sides stand off in x; the tool at either end reaches further
    start, stop = min(radius, side + turn * radius) if follow else radius, side if leave else radius
    low, high = min(a[0] - start, b[0] - stop), max(a[0] + start, b[0] + stop)
    first, end = cells_between(low, high, dexels.x0, dexels.dx, dexels.heights.shape[0])
    for i in range(first, end):
        x = dexels.x0 + i * dexels.dx
        y_low, y_high = row_interval(move, radius, x)
        if follow:
            own, others = ahead_of(a, way, x), ahead_of(a, before, x)
            y_low, y_high = max(y_low, min(own[0], others[0])), min(y_high, max(own[1], others[1]))
        if leave:
            behind = ahead_of(b, back, x)
            y_low, y_high = max(y_low, behind[0]), min(y_high, behind[1])
        if y_low <= y_high:
            j, j_end = cells_between(y_low, y_high, dexels.y0, dexels.dy, dexels.heights.shape[1])
            for n in range(j, j_end, LINE):
                soon(dexels.heights, i + ROWS_AHEAD, n)
                soon(dexels.names, i + ROWS_AHEAD, n)
            open_row(dexels, shape, move, r, (i, j, j_end))


@part
def open_row(dexels: Dexels, shape: Shape, move: Move, r: int, row: tuple[int, int, int]) -> None:
    """Open columns within the track from above down to what a move of run ``r`` leaves; ``row``: i, first j, end."""
    i, first, end = row
    x, single = dexels.x0 + i * dexels.dx, dexels.heights.shape[2] == 1
    for j in range(first, end):
        height, top = move.az, dexels.heights[i, j, 0]
        if top <= height + SKIN:
            continue
        if shape.kind != FLAT or move.m != 0.0:
            y = dexels.y0 + j * dexels.dy
            if move.m == 0.0:
                ex, ey = nearest(move, x, y)
                height += profile_within(shape, ex * ex + ey * ey)
            else:
                height = swept_height(shape, move, x, y)
        if not single:
            take_out(dexels, (i, j, r), height, math.inf)
        elif height < top - SKIN:
            dexels.heights[i, j, 0] = height
            dexels.names[i, j, 1] = r


@part
def cut_leaning(world: World, shape: Shape, move: Move, r: int) -> None:
    """Cut a step of a leaning cutter, ``move`` in its own frame, into columns of several layers."""
    dexels, ends, k = world.dexels, world.runs[r, ENDS:AXIS], world.runs[r, AXIS:MOVE]
    frame = tool_frame(k[0], k[1], k[2])
    up = max(0.0, world.bounds.z_high - min(ends[2], ends[5]) + shape.R * frame.sine) / k[2]
    first, end = cells_between(
        min(ends[0], ends[3]) + min(0.0, up * k[0]) - shape.R,
        max(ends[0], ends[3]) + max(0.0, up * k[0]) + shape.R,
        dexels.x0,
        dexels.dx,
        dexels.heights.shape[0],
    )
    j_first, j_end = cells_between(
        min(ends[1], ends[4]) + min(0.0, up * k[1]) - shape.R,
        max(ends[1], ends[4]) + max(0.0, up * k[1]) + shape.R,
        dexels.y0,
        dexels.dy,
        dexels.heights.shape[1],
    )
    for i in range(first, end):
        for j in range(j_first, j_end):
            top = dexels.heights[i, j, 0]
            if top == -math.inf:
                continue
            line = vertical_line(frame, dexels.x0 + i * dexels.dx, dexels.y0 + j * dexels.dy)
            low, high = tilted_interval(shape, move, frame, line, top + SKIN)
            if low < high:
                take_out(dexels, (i, j, r), low, high)


@called
def take_out(dexels: Dexels, place: tuple[int, int, int], low: float, high: float) -> None:
    """Take the heights from ``low`` to ``high`` m out of a column (i, j) for a run: place is (i, j, run)."""
    i, j, r = place
    ends, by = dexels.heights[i, j], dexels.names[i, j, 1:]
    layers, n = ends.size // 2, 0
    while n < layers and ends[2 * n] > -math.inf:
        top, bottom = ends[2 * n], ends[2 * n + 1]
        if low >= top - SKIN or high <= bottom + SKIN:
            n += 1
        elif low <= bottom + SKIN and high >= top - SKIN:
            for m in range(2 * n, 2 * layers - 2):
                ends[m], by[m] = ends[m + 2], by[m + 2]
            ends[2 * layers - 2] = -math.inf
        elif high >= top - SKIN:
            ends[2 * n], by[2 * n] = low, r
            n += 1
        elif low <= bottom + SKIN:
            ends[2 * n + 1], by[2 * n + 1] = high, r
            n += 1
        elif ends[2 * layers - 2] > -math.inf:  # no room for another layer
            dexels.lost[0] += 1
            if top - high < low - bottom:
                ends[2 * n], by[2 * n] = low, r
            n += 1
        else:
            for m in range(2 * layers - 1, 2 * n + 1, -1):
                ends[m], by[m] = ends[m - 2], by[m - 2]
            ends[2 * n + 1], by[2 * n + 1] = high, r
            ends[2 * n + 2], by[2 * n + 2] = low, r
            n += 2


@called
def note_rim(world: World, shape: Shape, r: int, stops: bool) -> None:
    """Note a run in the cells that the two sides of its step pass through, and where it stops its front."""
    dexels, ends, k = world.dexels, world.runs[r, ENDS:AXIS], world.runs[r, AXIS:MOVE]
    vx, vy, vz = ends[3] - ends[0], ends[4] - ends[1], ends[5] - ends[2]
    lx, ly, lz = k[1] * vz - k[2] * vy, k[2] * vx - k[0] * vz, k[0] * vy - k[1] * vx
    size = math.sqrt(lx * lx + ly * ly + lz * lz)
    length = math.sqrt(vx * vx + vy * vy + vz * vz)
    if size <= FACING * length:
        return
    lx, ly, lz = lx / size, ly / size, lz / size
    fx, fy, fz = ly * k[2] - lz * k[1], lz * k[0] - lx * k[2], lx * k[1] - ly * k[0]
    nose, out = profile(shape, shape.R), shape.R - 10.0 * SKIN
    up = (nose * k[0], nose * k[1], nose * k[2] + 10.0 * SKIN)
    cell = min(dexels.dx, dexels.dy)
    pieces = 2 * int(length / cell) + 2
    sides, front = 2 * pieces + 2, int(2.0 * math.pi * shape.R / cell) if stops else 0
    for n in range(sides + max(front - 1, 0)):
        if n < sides:
            part_of, f, side = n // 2 / pieces, 0.0, out if n % 2 else -out
        else:
            phi = math.pi * (n - sides + 1) / front
            part_of, f, side = 1.0, out * math.sin(phi), out * math.cos(phi)
        x, y, z = ends[0] + part_of * vx + up[0], ends[1] + part_of * vy + up[1], ends[2] + part_of * vz + up[2]
        note_place(world, r, (x + f * fx + side * lx, y + f * fy + side * ly, z + f * fz + side * lz))


@part
def note_place(world: World, r: int, place: tuple[float, float, float]) -> None:
    """Note a run in the cell of a place on its rim (m), unless a noted run reaches further there."""
    x, y, z = place
    if z > world.bounds.z_high:
        return
    i, j = cell_of(world.dexels, x, y)
    noted = world.dexels.names[i, j, 0]
    if noted == NOBODY or height_of_run(world.runs, noted, x, y, z) <= SKIN:
        world.dexels.names[i, j, 0] = r


@kernel
def march(world: World, room: Room, steps: Steps, found: Out2, sectors: Singles2, do: tuple[bool, bool]) -> None:
    """Steps one after the other: ``do`` (meet, cut) them; what they meet goes to ``found`` (n, 8 e + 7), ``sectors``
    (n, 4 s)."""
    for n in range(len(steps.ends)):
        r, ends = steps.run[n], steps.ends[n]
        if do[0]:
            step = step_at(steps.tip[n], steps.axis[n], steps.feed[n], steps.heading[n], r)
            add_part(room, world, shape_of(world.runs[r]), step, found[n], sectors[n])
        if do[1]:
            go_on(world.runs[r], ends, steps.begins[n] == 1)
            if n + 1 == len(steps.ends) or steps.begins[n + 1] == 1:
                cut_run(world, r, steps.stops[n] == 1)


@kernel
def as_halves(singles: Singles1, bits: Bits1, halves: Halves1) -> None:
    """The bits of numbers (n,) >= 0 in half precision, from those in single precision; to the nearest."""
    for n in range(len(singles)):
        small = int(singles[n] / LEAST_HALF + 0.5)
        even = (bits[n] >> HALF_BITS) & 1
        other = (bits[n] + (1 << (HALF_BITS - 1)) - 1 + even - HALF_BIAS) >> HALF_BITS
        halves[n] = small if singles[n] < SMALL_HALF else other
