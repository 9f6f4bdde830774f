"""A path marched through the stock, compiled: what each step meets, then the step cut into the columns."""

from __future__ import annotations

import math
from typing import NamedTuple

from robomill.arrays import FloatArray
from robomill.compiled import Out2, OutInt1, kernel, part
from robomill.surface.cells_kernels import cells_between
from robomill.surface.engagement_kernels import Room, add_part, copy
from robomill.surface.envelope_kernels import (
    BALL,
    FLAT,
    Move,
    Shape,
    move_between,
    nearest,
    profile,
    row_interval,
    swept_height,
)
from robomill.surface.material_kernels import (
    NOBODY,
    SKIN,
    Columns,
    Runs,
    World,
    cell_of,
    height_of_run,
    shape_of,
)
from robomill.surface.step_kernels import FACING, step_between
from robomill.surface.tilt_kernels import UPRIGHT, move_in_frame, tilted_interval, tool_frame, vertical_line


class Steps(NamedTuple):
    """Steps of a path: ends (n, 6) m, the unit feed each was told (n, 3), the run it belongs to (n,) and whether it
    begins it (n,)."""

    ends: Out2
    feed: Out2
    run: OutInt1
    begins: OutInt1


@part
def go_on(world: World, r: int, ends: FloatArray, begins: bool) -> None:
    """Let run ``r`` begin with a step or go on with it. Nothing of it is cut before it ends: no step of a straight run
    meets what the run has opened behind it."""
    runs = world.runs
    if begins:
        copy(ends, runs.ends[r])
    else:
        copy(ends[3:], runs.ends[r, 3:])


@part
def cut_run(world: World, r: int) -> None:
    """Cut a run into the columns, as far as it goes."""
    runs, columns = world.runs, world.columns
    ends, k, shape = runs.ends[r], runs.axes[r], shape_of(runs, r)
    if math.hypot(k[0], k[1]) > UPRIGHT:
        cut_leaning(world, shape, r, ends)
    elif columns.top.shape[2] == 1:
        cut_tops(columns, shape, r, ends, follows(runs, r) and ends[5] >= ends[2])
    else:
        cut_from_above(world, shape, r, ends)
    note_sides(world, shape, r, ends)
    runs.known[0] = r + 1


@part
def follows(runs: Runs, r: int) -> bool:
    """Whether a run begins where the one before left off, with the same tool and axis."""
    if r == 0 or runs.tool[r - 1] != runs.tool[r]:
        return False
    same = True
    for n in range(3):
        same = same and runs.ends[r - 1, 3 + n] == runs.ends[r, n] and runs.axes[r - 1, n] == runs.axes[r, n]
    return same


@part
def cut_tops(columns: Columns, shape: Shape, r: int, ends: FloatArray, goes_on: bool) -> None:
    """Lower columns of one layer to what a step of an upright cutter leaves. ``goes_on``: the step before it left off
    at its start under it, so that nothing behind that is left to cut."""
    move = move_between(ends[0], ends[1], ends[2], ends[3], ends[4], ends[5])
    level = shape.kind == FLAT and move.m == 0.0
    span = move.length * move.ux
    low, high = move.ax + min(0.0, span) - shape.R, move.ax + max(0.0, span) + shape.R
    first, end = cells_between(low, high, columns.x0, columns.dx, columns.top.shape[0])
    for i in range(first, end):
        x = columns.x0 + i * columns.dx
        y_low, y_high = row_interval(move, shape.R, x)
        if y_low > y_high:
            continue
        if goes_on:  # only what lies ahead of the start
            ahead = (x - ends[0]) * move.ux
            if abs(move.uy) > 1e-9:
                edge = ends[1] - ahead / move.uy
                y_low, y_high = (max(y_low, edge), y_high) if move.uy > 0.0 else (y_low, min(y_high, edge))
            elif ahead < 0.0:
                continue
        j, j_end = cells_between(y_low, y_high, columns.y0, columns.dy, columns.top.shape[1])
        known = shape.R**2 - (x - ends[0]) ** 2 if goes_on and level else 0.0  # level with the end of the step before
        skip, skip_end = j_end, j_end
        if known > 0.0:
            w = math.sqrt(known)
            skip, skip_end = cells_between(ends[1] - w, ends[1] + w, columns.y0, columns.dy, columns.top.shape[1])
        while j < j_end:
            if skip <= j < skip_end:
                j = skip_end
                continue
            lower_top(columns, shape, move, i, j, r)
            j += 1


@part
def lower_top(columns: Columns, shape: Shape, move: Move, i: int, j: int, r: int) -> None:
    """Lower a column of one layer, within the track, to what a move of run ``r`` leaves."""
    top = columns.top[i, j, 0]
    if top <= move.az + SKIN:
        return
    height = move.az
    if shape.kind != FLAT or move.m != 0.0:
        x, y = columns.x0 + i * columns.dx, columns.y0 + j * columns.dy
        if shape.kind == BALL and move.m == 0.0:
            ex, ey = nearest(move, x, y)
            height += shape.R - math.sqrt(max(shape.R**2 - ex * ex - ey * ey, 0.0))
        else:
            height = swept_height(shape, move, x, y)
    if height < top - SKIN:
        columns.top[i, j, 0] = height
        columns.by[i, j, 0] = r


@part
def cut_from_above(world: World, shape: Shape, r: int, ends: FloatArray) -> None:
    """Cut a step of an upright cutter into columns of several layers."""
    columns = world.columns
    move = move_between(ends[0], ends[1], ends[2], ends[3], ends[4], ends[5])
    span = move.length * move.ux
    low, high = move.ax + min(0.0, span) - shape.R, move.ax + max(0.0, span) + shape.R
    first, end = cells_between(low, high, columns.x0, columns.dx, columns.top.shape[0])
    for i in range(first, end):
        x = columns.x0 + i * columns.dx
        y_low, y_high = row_interval(move, shape.R, x)
        if y_low > y_high:
            continue
        j_first, j_end = cells_between(y_low, y_high, columns.y0, columns.dy, columns.top.shape[1])
        for j in range(j_first, j_end):
            if columns.top[i, j, 0] > move.az:
                height = swept_height(shape, move, x, columns.y0 + j * columns.dy)
                take_out(columns, (i, j, r), height, math.inf)


@part
def cut_leaning(world: World, shape: Shape, r: int, ends: FloatArray) -> None:
    """Cut a step of a leaning cutter into columns of several layers."""
    columns, k = world.columns, world.runs.axes[r]
    frame = tool_frame(k[0], k[1], k[2])
    move = move_in_frame(frame, ends)
    up = max(0.0, world.block.z_high - min(ends[2], ends[5]) + shape.R * frame.sine) / k[2]
    first, end = cells_between(
        min(ends[0], ends[3]) + min(0.0, up * k[0]) - shape.R,
        max(ends[0], ends[3]) + max(0.0, up * k[0]) + shape.R,
        columns.x0,
        columns.dx,
        columns.top.shape[0],
    )
    j_first, j_end = cells_between(
        min(ends[1], ends[4]) + min(0.0, up * k[1]) - shape.R,
        max(ends[1], ends[4]) + max(0.0, up * k[1]) + shape.R,
        columns.y0,
        columns.dy,
        columns.top.shape[1],
    )
    for i in range(first, end):
        for j in range(j_first, j_end):
            top = columns.top[i, j, 0]
            if top == -math.inf:
                continue
            line = vertical_line(frame, columns.x0 + i * columns.dx, columns.y0 + j * columns.dy)
            low, high = tilted_interval(shape, move, frame, line, top + SKIN)
            if low < high:
                take_out(columns, (i, j, r), low, high)


@part
def take_out(columns: Columns, place: tuple[int, int, int], low: float, high: float) -> None:
    """Take the heights from ``low`` to ``high`` m out of a column (i, j) for a run: place is (i, j, run)."""
    i, j, r = place
    layers = columns.top.shape[2]
    n = 0
    while n < layers and columns.top[i, j, n] > -math.inf:
        top, bottom = columns.top[i, j, n], columns.low[i, j, n]
        if low >= top - SKIN or high <= bottom + SKIN:
            n += 1
        elif low <= bottom + SKIN and high >= top - SKIN:
            for m in range(n, layers - 1):
                copy_layer(columns, i, j, m + 1, m)
            columns.top[i, j, layers - 1] = -math.inf
        elif high >= top - SKIN:
            columns.top[i, j, n], columns.by[i, j, n] = low, r
            n += 1
        elif low <= bottom + SKIN:
            columns.low[i, j, n], columns.under[i, j, n] = high, r
            n += 1
        elif columns.top[i, j, layers - 1] > -math.inf:  # no room for another layer
            columns.lost[0] += 1
            if top - high < low - bottom:
                columns.top[i, j, n], columns.by[i, j, n] = low, r
            n += 1
        else:
            for m in range(layers - 1, n, -1):
                copy_layer(columns, i, j, m - 1, m)
            columns.low[i, j, n], columns.under[i, j, n] = high, r
            columns.top[i, j, n + 1], columns.by[i, j, n + 1] = low, r
            n += 2


@part
def copy_layer(columns: Columns, i: int, j: int, source: int, to: int) -> None:
    """Copy a layer of a column to another place in it."""
    columns.top[i, j, to], columns.low[i, j, to] = columns.top[i, j, source], columns.low[i, j, source]
    columns.by[i, j, to], columns.under[i, j, to] = columns.by[i, j, source], columns.under[i, j, source]


@part
def note_sides(world: World, shape: Shape, r: int, ends: FloatArray) -> None:
    """Note a run in the cells that the two sides of its step pass through, where no noted run reaches further."""
    columns, k = world.columns, world.runs.axes[r]
    vx, vy, vz = ends[3] - ends[0], ends[4] - ends[1], ends[5] - ends[2]
    lx, ly, lz = k[1] * vz - k[2] * vy, k[2] * vx - k[0] * vz, k[0] * vy - k[1] * vx
    size = math.sqrt(lx * lx + ly * ly + lz * lz)
    length = math.sqrt(vx * vx + vy * vy + vz * vz)
    if size <= FACING * length:
        return
    nose = profile(shape, shape.R)
    pieces = 2 * int(length / min(columns.dx, columns.dy)) + 2
    for side in (-1.0, 1.0):
        out = side * (shape.R - 10.0 * SKIN) / size
        for n in range(pieces + 1):
            share = n / pieces
            x = ends[0] + share * vx + out * lx + nose * k[0]
            y = ends[1] + share * vy + out * ly + nose * k[1]
            z = ends[2] + share * vz + out * lz + nose * k[2] + 10.0 * SKIN
            if z > world.block.z_high:
                continue
            i, j = cell_of(columns, x, y)
            noted = columns.beside[i, j]
            if noted == NOBODY or height_of_run(world.runs, noted, x, y, z) <= SKIN:
                columns.beside[i, j] = r


@kernel
def march(world: World, room: Room, steps: Steps, found: Out2, spans: Out2, do: tuple[bool, bool]) -> None:
    """Steps one after the other: ``do`` (meet, cut) them; what they meet goes to ``found`` (n, 8 e + 6), ``spans``."""
    for n in range(len(steps.ends)):
        r, ends = steps.run[n], steps.ends[n]
        if do[0]:
            step = step_between(ends, world.runs.axes[r], steps.feed[n], r)
            add_part(room, world, shape_of(world.runs, r), step)
            copy(room.sum, found[n])
            copy(room.spans, spans[n])
        if do[1]:
            go_on(world, r, ends, steps.begins[n] == 1)
            if n + 1 == len(steps.ends) or steps.begins[n + 1] == 1:
                cut_run(world, r)
