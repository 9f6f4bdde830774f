"""A path marched through the stock, compiled: what each step meets, then the step cut into the columns."""

from __future__ import annotations

import math
from typing import Annotated, NamedTuple

import numpy as np
from numpy.typing import NDArray

from robomill.arrays import FloatArray
from robomill.compiled import Axes, Out1, Out2, OutInt1, called, kernel, part
from robomill.cutting.engaged import FACING
from robomill.cutting.profile_kernels import FLAT, Shape, profile, profile_within, shape_of
from robomill.surface.cells_kernels import cells_between
from robomill.surface.contact.division_kernels import add_part
from robomill.surface.contact.engagement_kernels import Room
from robomill.surface.contact.material_kernels import (
    AXIS,
    ENDS,
    MOVE,
    NOBODY,
    SKIN,
    Dexels,
    World,
    beside,
    cell_of,
    height_of_run,
    is_upright,
    see_move,
)
from robomill.surface.contact.relief_kernels import LOW, SIDES, Relief, covered, half_of, lower_tops, tell, tops_about
from robomill.surface.contact.soon import soon
from robomill.surface.contact.step_kernels import step_at
from robomill.surface.contact.track_kernels import Track, row_of, track_of
from robomill.surface.envelope_kernels import Move, nearest, swept_height
from robomill.surface.tilt_kernels import plan_box, tilted_interval, tool_frame, vertical_line

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
    where each is looked at (n, 3), by how much its axis ``turns`` there (n, 3) 1/m, how steeply it sinks for its end,
    the run it belongs to, whether it begins it and whether nothing goes on from its end, and whether it is but a link
    to where a cut begins (n,)."""

    ends: Out2
    tip: Out2
    feed: Out2
    axis: Out2
    heading: Out2
    turns: Out2
    sinks: Out1
    run: OutInt1
    begins: OutInt1
    stops: OutInt1
    links: OutInt1


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
        cut_leaning_run(world, shape, move, r)
    else:
        cut_upright_run(world, shape, move, r)
    note_rim(world, shape, r, stops)


@part
def cut_upright_run(world: World, shape: Shape, move: Move, r: int) -> None:
    """Cut a run of an upright cutter."""
    dexels = world.dexels
    if world.bounds.z_high <= move.az:
        return
    track = track_of(world, shape, move, r)
    turn = 2.0 * math.hypot(track.way[0] - track.before[0], track.way[1] - track.before[1])  # at least that of the ways
    side = track.radius * abs(track.way[1])  # how far its sides stand off in x; the tool at either end reaches further
    start = min(track.radius, side + turn * track.radius) if track.follow else track.radius
    stop = side if track.leave else track.radius
    low, high = min(track.a[0] - start, track.b[0] - stop), max(track.a[0] + start, track.b[0] + stop)
    first, end = cells_between(low, high, dexels.x0, dexels.dx, dexels.heights.shape[0])
    for i in range(first, end):
        y_low, y_high = row_of(track, dexels.x0 + i * dexels.dx, 0.0)
        if y_low <= y_high:
            j, j_end = cells_between(y_low, y_high, dexels.y0, dexels.dy, dexels.heights.shape[1])
            for n in range(j, j_end, LINE):
                soon(dexels.heights, i + ROWS_AHEAD, n)
                soon(dexels.names, i + ROWS_AHEAD, n)
            open_row(world, shape, move, r, (i, j, j_end))
    lower_relief(world.relief, shape, track)


@part
def lower_relief(relief: Relief, shape: Shape, track: Track) -> None:
    """Lower the bounds of the squares that a run's track touches."""
    half, (dx, dy), reach = half_of(relief), (1.0 / relief.per_x, 1.0 / relief.per_y), track.radius
    low, high = min(track.a[0], track.b[0]) - reach - half, max(track.a[0], track.b[0]) + reach + half
    first, end = cells_between(low, high, relief.x0 + 0.5 * dx, dx, relief.tops.shape[0])
    for i in range(first, end):
        x = relief.x0 + (i + 0.5) * dx
        y_low, y_high = row_of(track, x, half)
        if y_low <= y_high:
            j_first, j_end = cells_between(y_low, y_high, relief.y0 + 0.5 * dy, dy, relief.tops.shape[1])
            for j in range(j_first, j_end):
                tops = relief.tops[i, j]
                lower_tops(tops, (x, relief.y0 + (j + 0.5) * dy, half), shape, track.move, reach)


@part
def open_row(world: World, shape: Shape, move: Move, r: int, row: tuple[int, int, int]) -> None:
    """Open columns within the track from above down to what a move of run ``r`` leaves; ``row``: i, first j, end. What
    it leaves nothing of is no side any more."""
    i, first, end = row
    dexels = world.dexels
    x, single = dexels.x0 + i * dexels.dx, dexels.heights.shape[2] == 1
    for j in range(first, end):
        height, top = move.az, dexels.heights[i, j, 0]
        if dexels.names[i, j, 0] != NOBODY and swallows(world, shape, move, i, j):
            dexels.names[i, j, 0] = NOBODY
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
def swallows(world: World, shape: Shape, move: Move, i: int, j: int) -> bool:
    """Whether a move of an upright cutter leaves nothing in a cell of the side noted there."""
    dexels = world.dexels
    other = world.runs[dexels.names[i, j, 0]]
    if not is_upright(other):
        return False
    half, side = 0.5 * math.sqrt(dexels.dx**2 + dexels.dy**2), shape_of(other)
    low = other[MOVE + 2] + profile(side, max(side.R - 2.0 * half, 0.0))
    return covered(shape, move, dexels.x0 + i * dexels.dx, dexels.y0 + j * dexels.dy, half) <= low + SKIN


@part
def cut_leaning_run(world: World, shape: Shape, move: Move, r: int) -> None:
    """Cut a step of a leaning cutter, ``move`` in its own frame, into columns of several layers."""
    dexels, ends, k = world.dexels, world.runs[r, ENDS:AXIS], world.runs[r, AXIS:MOVE]
    frame = tool_frame(k[0], k[1], k[2])
    x_low, x_high, y_low, y_high = plan_box(shape.R, ends, k, world.bounds.z_high)
    first, end = cells_between(x_low, x_high, dexels.x0, dexels.dx, dexels.heights.shape[0])
    j_first, j_end = cells_between(y_low, y_high, dexels.y0, dexels.dy, dexels.heights.shape[1])
    tell(world.relief, (x_low, y_low), (x_high, y_high), LOW, -math.inf)
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
    """Note a run in the cell of a place on its rim (m), unless a noted run reaches further there, or nothing stands."""
    x, y, z = place
    if z > world.bounds.z_high or beside(world.bounds, x, y) or tops_about(world.relief, x, y)[1] < z:
        return
    dexels = world.dexels
    i, j = cell_of(dexels, x, y)
    noted = dexels.names[i, j, 0]
    if noted == r:
        return
    if noted == NOBODY:  # a point that looks at the cell lies less than two cells off
        dx, dy = 2.0 * dexels.dx, 2.0 * dexels.dy
        tell(world.relief, (x - dx, y - dy), (x + dx, y + dy), SIDES, 1.0)
    if noted == NOBODY or height_of_run(world.runs, noted, x, y, z) <= SKIN:
        dexels.names[i, j, 0] = r


@kernel
def march(world: World, room: Room, steps: Steps, found: Out2, sectors: Singles2, do: tuple[bool, bool]) -> None:
    """Steps one after the other: ``do`` (meet, cut) them; what they meet goes to ``found`` (n, 8 e + 7), ``sectors``
    (n, 4 s). A link is cut, then the cut that begins at its end is met."""
    for n in range(len(steps.ends)):
        r, ends = steps.run[n], steps.ends[n]
        links = do[0] and do[1] and steps.links[n] == 1
        if links:
            go_on(world.runs[r], ends, True)
            cut_run(world, r, True)
        if do[0]:
            but = NOBODY if links else r
            step = step_at(
                steps.tip[n], steps.axis[n], steps.feed[n], steps.heading[n], (steps.sinks[n], but), steps.turns[n]
            )
            add_part(room, world, shape_of(world.runs[r]), step, found[n], sectors[n])
        if do[1] and not links:
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
