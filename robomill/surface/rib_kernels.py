"""Ribs and gaps of material about a cutter, compiled: looked for in the columns, from cell to cell.

What is engaged is measured at a few angles, and at a few places of the profile; what stands between them and is
narrower shows in the columns that circles about the tool's axis pass over. Where the side of a run passes through a
column it is looked for more finely, since a rib may be thinner than a cell.
"""

from __future__ import annotations

import math
from typing import NamedTuple

from robomill.arrays import FloatArray
from robomill.compiled import Out2, called, part
from robomill.cutting.profile_kernels import END, FLANK, FLAT, Shape, on_profile
from robomill.surface.material_kernels import NOBODY, Dexels, World, cell_of, in_column, standing, top_over
from robomill.surface.step_kernels import Step
from robomill.surface.turn_kernels import COSINE, HALF, PHI, SINE, gap_end, jumps

PITCH = 0.7  # cells: so far apart ribs and gaps of material are looked for
THIN, LEAST = 25e-6, 1.0 / 16.0  # m, cells: so far apart where a side passes, a quarter of a cell at most
THICK = 0.25  # of the radius: ribs and gaps that are thicker are met by the places looked at
CIRCLES = 4  # looked at on a stretch of the profile
ALONG = 0.245  # of a stretch, from one of its circles to the next; a little more to the first one
RADIUS, HEIGHT, LOW, HIGH = range(4)  # of a circle, and what stands on it at the angles looked at about a gap

Point = tuple[float, float, float]


class Walk(NamedTuple):
    """Steps along circles about the axis of the cutter: the circles (c, 4) m, of which the first ``used`` are walked,
    and the angles of a step, rad, where no side is near and where one is. ``plain``: they see how high material
    stands above them, others only whether it does. ``most``: so far from an angle looked at, rad, there is another;
    ``rim``: the widest radius, m."""

    circles: Out2
    used: int
    pitch: float
    fine: float
    plain: bool
    most: float
    rim: float


@part
def is_plain(world: World, step: Step) -> bool:
    """Whether the material ends but once over every place, and the tool stands upright in it."""
    return world.dexels.heights.shape[2] == 1 and step.kx == 0.0 and step.ky == 0.0


@part
def fine_pitch(world: World) -> float:
    """How far apart ribs are looked for where the side of a run passes, m: thinner ones may be passed over."""
    cell = min(world.dexels.dx, world.dexels.dy)
    return max(LEAST * cell, min(THIN, 0.25 * cell))


@part
def walk_on(world: World, shape: Shape, step: Step, stretches: FloatArray, circles: FloatArray) -> Walk:
    """Circles from cell to cell about a cutter, ``CIRCLES`` on each of the stretches (3, ...) of its profile that takes
    part (from, to); the flank of an upright cutter in one layer of material needs but one."""
    count, widest, plain = 0, 0.0, is_plain(world, step)
    for stretch in range(3):
        begin, stop = stretches[stretch, 0], stretches[stretch, 1]
        if stop <= begin:
            continue
        for n in range(1 if stretch == FLANK and plain else CIRCLES):
            along = 0.0 if stretch == FLANK and plain else 0.01 + ALONG * (n + (0.0 if stretch == FLANK else 1.0))
            r, t, _, _ = on_profile(shape, stretch, begin + along * (stop - begin))
            circles[count, RADIUS], circles[count, HEIGHT] = r, t
            widest, count = max(widest, r), count + 1
    if step.z >= world.bounds.z_high + widest * math.hypot(step.kx, step.ky):
        count = 0
    cell, fine = PITCH * min(world.dexels.dx, world.dexels.dy), fine_pitch(world)
    rim = max(widest, cell)
    only = plain and shape.kind == FLAT and stretches[END, 1] <= stretches[END, 0]
    return Walk(circles, count, cell / rim, fine / rim, only, math.inf, rim)


@part
def seen_on(world: World, step: Step, walk: Walk, n: int, turn: tuple[float, float]) -> tuple[float, bool]:
    """What a circle meets at an angle (sine, cosine): how high above it material stands, m, or whether it does (1 or
    0), by the column there, or exact where a side passes; and whether one does."""
    dexels, (sine, cosine) = world.dexels, turn
    r, t = walk.circles[n, RADIUS], walk.circles[n, HEIGHT]
    x = step.x + r * (sine * step.fx + cosine * step.lx) + t * step.kx
    y = step.y + r * (sine * step.fy + cosine * step.ly) + t * step.ky
    z = step.z + r * (sine * step.fz + cosine * step.lz) + t * step.kz
    i, j = math.floor((x - dexels.x0) / dexels.dx + 0.5), math.floor((y - dexels.y0) / dexels.dy + 0.5)
    if i < 0 or j < 0 or i >= dexels.heights.shape[0] or j >= dexels.heights.shape[1]:
        return 0.0, False
    near = dexels.names[i, j, 0] != NOBODY
    if walk.plain:
        return max((top_over(world, x, y) if near else dexels.heights[i, j, 0]) - z, 0.0), near
    deep = 0.0 if near else in_column(dexels, i, j, z)
    if abs(deep) <= dexels.slack or z < world.bounds.z_low:
        deep = standing(world, (x, y, z), step.run)
    return 1.0 if deep > 0.0 else 0.0, near


@part
def look(world: World, step: Step, walk: Walk, row: FloatArray, end: int) -> bool:
    """Note on every circle what stands there at the angle of a row, as one end of a gap: ``LOW`` or ``HIGH``; whether a
    side is near."""
    near = False
    for n in range(walk.used):
        walk.circles[n, end], by_side = seen_on(world, step, walk, n, (row[SINE], row[COSINE]))
        near = near or by_side
    return near


@part
def stands_out(world: World, step: Step, walk: Walk, turn: tuple[float, float]) -> tuple[bool, bool]:
    """Whether at an angle (sine, cosine) material stands otherwise on a circle than at both ends of the gap, and
    whether a side is near."""
    near = False
    for n in range(walk.used):
        top, by_side = seen_on(world, step, walk, n, turn)
        near = near or by_side
        if jumps(top, walk.circles[n, LOW]) and jumps(top, walk.circles[n, HIGH]):
            return True, near
    return False, near


@called
def next_change(
    world: World, step: Step, walk: Walk, rows: FloatArray, since: tuple[int, int, int, int]
) -> tuple[int, float]:
    """The next change along the circles: the gap between the angles of rows, and the angle in it at which material
    stands otherwise than at the angles looked at about it. ``since``: the gap it is looked for from, the row to look on
    from, that where the gap begins, and how many gaps there are. Past the last gap if none."""
    gap, row, left, gaps = since
    near_low = look(world, step, walk, rows[left], LOW)
    while gap < gaps:
        right = gap_end(gap)
        near_high = look(world, step, walk, rows[right], HIGH)
        phi, end, sine, cosine = rows[row, PHI], rows[right, PHI], rows[row, SINE], rows[row, COSINE]
        fine, pitch, turn = pace(walk, near_low or row != left)
        while phi + pitch < end or (near_high and not fine):
            there = sine * turn[1] + cosine * turn[0], cosine * turn[1] - sine * turn[0]
            out, near = stands_out(world, step, walk, there)
            if (near or phi + pitch >= end) and not fine:
                fine, pitch, turn = pace(walk, True)
                continue
            phi += pitch
            sine, cosine = there
            if out or phi - rows[row, PHI] >= walk.most:
                return gap, phi
            if fine and not near:
                fine, pitch, turn = pace(walk, phi + walk.pitch >= end and near_high)
        gap, row, left, near_low = gap + 1, right, right, near_high
        if gap == HALF and gap < gaps:  # where both half turns meet, the other one has a row of its own
            row, left = row + 1, row + 1
            look(world, step, walk, rows[row], LOW)
        else:
            for n in range(walk.used):
                walk.circles[n, LOW] = walk.circles[n, HIGH]
    return gaps, 0.0


@part
def pace(walk: Walk, fine: bool) -> tuple[bool, float, tuple[float, float]]:
    """Whether to walk finely, the angle of a step then, and its sine and cosine."""
    pitch = walk.fine if fine else walk.pitch
    return fine, pitch, (math.sin(pitch), math.cos(pitch))


@called
def alternates(world: World, step: Step, walk: Walk, rows: FloatArray, count: int) -> bool:
    """Whether on a circle material begins and ends within a quarter of the radius over the angles of rows; where it
    ends at the top of the stock does not count."""
    for n in range(walk.used):
        r, t = walk.circles[n, RADIUS], walk.circles[n, HEIGHT]
        before, changed, last = -1.0, -math.inf, 0.0
        for row in range(count):
            sine, cosine = rows[row, SINE], rows[row, COSINE]
            if step.z + r * (sine * step.fz + cosine * step.lz) + t * step.kz >= world.bounds.z_high:
                before = -1.0
                continue
            there, _ = seen_on(world, step, walk, n, (sine, cosine))
            if before >= 0.0 and there != before:
                if (last - changed) * r < THICK * walk.rim:
                    return True
                changed = rows[row, PHI]
            before, last = there, rows[row, PHI]
    return False


@called
def change_between(world: World, run: int, ends: tuple[Point, Point], since: float, cuts: bool) -> float:
    """How far on the straight way between two ends m, from the share ``since`` of it on, material is first met where
    there was none (or none where it ``cuts``), as a share; 1 where that is nowhere."""
    dexels, (a, b) = world.dexels, ends
    dx, dy, dz = b[0] - a[0], b[1] - a[1], b[2] - a[2]
    length = math.sqrt(dx * dx + dy * dy + dz * dz)
    if length <= 0.0:
        return 1.0
    coarse, finer = PITCH * min(dexels.dx, dexels.dy) / length, fine_pitch(world) / length
    share, fine, to_side = since, near_side(dexels, a[0] + since * dx, a[1] + since * dy), near_side(dexels, b[0], b[1])
    while share + (finer if fine else coarse) < 1.0 or (to_side and not fine):
        there = share + (finer if fine else coarse)
        x, y, z = a[0] + there * dx, a[1] + there * dy, a[2] + there * dz
        near = near_side(dexels, x, y)
        if (near or there >= 1.0) and not fine:
            fine = True
            continue
        share = there
        i, j = cell_of(dexels, x, y)
        deep = 0.0 if near else in_column(dexels, i, j, z)
        if abs(deep) <= dexels.slack or z < world.bounds.z_low:
            deep = standing(world, (x, y, z), run)
        if (deep > 0.0) != cuts:
            return share
        fine = near or (to_side and share + coarse >= 1.0)
    return 1.0


@part
def near_side(dexels: Dexels, x: float, y: float) -> bool:
    """Whether the side of a run passes through the cell that holds a point in plan."""
    i, j = cell_of(dexels, x, y)
    return bool(dexels.names[i, j, 0] != NOBODY)
