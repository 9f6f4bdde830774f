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
from robomill.surface.contact.material_kernels import (
    NOBODY,
    SKIN,
    Dexels,
    World,
    beside,
    cell_of,
    in_column,
    standing,
    top_over,
)
from robomill.surface.contact.relief_kernels import UNKNOWN, told, tops_between
from robomill.surface.contact.step_kernels import Step
from robomill.surface.contact.turn_kernels import ANGLES, COSINE, HALF, HIDDEN, PHI, SINE, aim, gap_end, jumps

PITCH = 0.7  # cells: so far apart ribs and gaps of material are looked for
THIN, LEAST = 25e-6, 1.0 / 16.0  # m, cells: so far apart where a side passes, a quarter of a cell at most
THICK = 0.25  # of the radius: ribs and gaps that are thicker are met by the places looked at
CIRCLES = 4  # looked at on a stretch of the profile
ALONG = 0.245  # of a stretch, from one of its circles to the next; a little more to the first one
# of a circle: itself; what stands on it at the angles of rows, whether a side is near there, and what stands on the
# whole gap before each (UNASKED: it is not known)
RADIUS, HEIGHT, SEEN = 0, 1, 2
NEAR = SEEN + 2 * ANGLES
WHOLE = NEAR + 2 * ANGLES
COLUMNS = WHOLE + 2 * ANGLES
UNASKED = -1.0

Point = tuple[float, float, float]
Pace = tuple[float, float, float]


class Walk(NamedTuple):
    """Steps along circles about the axis of the cutter: the circles (c, ``COLUMNS``) m, of which the first ``used`` are
    walked, and the ``pace`` where no side is near and where one is. ``plain``: they see how high material stands above
    them, others only whether it does. ``most``: so far from an angle looked at, rad, there is another; ``rim``: the
    widest radius, m."""

    circles: Out2
    used: int
    coarse: Pace
    fine: Pace
    plain: bool
    most: float
    rim: float


class Ring(NamedTuple):
    """A circle about the axis over the cells: place (u, v) of its middle in cells, as from the corner of the first one,
    and height, m; then how far it reaches along each ahead (the sine of the angle) and to the left (its cosine)."""

    u: float
    ahead_u: float
    left_u: float
    v: float
    ahead_v: float
    left_v: float
    z: float
    ahead_z: float
    left_z: float


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
            at = on_profile(shape, stretch, begin + along * (stop - begin))
            circles[count, RADIUS], circles[count, HEIGHT] = at.radius, at.height
            widest, count = max(widest, at.radius), count + 1
    if step.z >= world.bounds.z_high + widest * math.hypot(step.kx, step.ky):
        count = 0
    only = plain and shape.kind == FLAT and stretches[END, 1] <= stretches[END, 0]
    cell = PITCH * min(world.dexels.dx, world.dexels.dy)
    rim = max(widest, cell)
    return Walk(circles, count, pace(cell / rim), pace(fine_pitch(world) / rim), only, math.inf, rim)


@part
def pace(angle: float) -> Pace:
    """The angle of a step, its sine and cosine."""
    return angle, math.sin(angle), math.cos(angle)


@part
def ring_of(dexels: Dexels, step: Step, circle: FloatArray) -> Ring:
    """A circle about the axis as it passes over the cells."""
    r, t, per_x, per_y = circle[RADIUS], circle[HEIGHT], 1.0 / dexels.dx, 1.0 / dexels.dy
    return Ring(
        (step.x + t * step.kx - dexels.x0) * per_x + 0.5,
        r * step.fx * per_x,
        r * step.lx * per_x,
        (step.y + t * step.ky - dexels.y0) * per_y + 0.5,
        r * step.fy * per_y,
        r * step.ly * per_y,
        step.z + t * step.kz,
        r * step.fz,
        r * step.lz,
    )


@part
def seen_at(
    world: World, step: Step, walk: Walk, seen: tuple[FloatArray, Ring], sine: float, cosine: float
) -> tuple[float, float]:
    """What a circle, ``seen`` with its ring, meets at an angle: how high above it material stands, m, or whether it
    does (1 or 0), by the column there, or exact where a side passes; and whether one does (1 or 0)."""
    dexels, (circle, ring) = world.dexels, seen
    i = math.floor(ring.u + sine * ring.ahead_u + cosine * ring.left_u)
    j = math.floor(ring.v + sine * ring.ahead_v + cosine * ring.left_v)
    if i < 0 or j < 0 or i >= dexels.heights.shape[0] or j >= dexels.heights.shape[1]:
        return 0.0, 0.0
    near, z = dexels.names[i, j, 0] != NOBODY, ring.z + sine * ring.ahead_z + cosine * ring.left_z
    if walk.plain:
        if not near:
            return max(dexels.heights[i, j, 0] - z, 0.0), 0.0
        x, y, _ = place_on(step, circle, sine, cosine)
        return max(top_over(world, x, y) - z, 0.0), 1.0
    deep = 0.0 if near else in_column(dexels, i, j, z)
    if abs(deep) <= dexels.slack or z < world.bounds.z_low:
        deep = standing(world, place_on(step, circle, sine, cosine), step.run)
    return 1.0 if deep > 0.0 else 0.0, 1.0 if near else 0.0


@called
def look_about(world: World, step: Step, walk: Walk, rows: FloatArray, halves: int) -> None:
    """Note on every circle what stands there at the angles of rows, whether a side is near, and what stands on the
    whole of a gap between them, as the relief tells."""
    relief = world.relief
    for n in range(walk.used):
        circle = walk.circles[n]
        seen_as = circle, ring_of(world.dexels, step, circle)
        for half in range(halves):
            first = half * ANGLES
            a = place_on(step, circle, rows[first, SINE], rows[first, COSINE])
            circle[SEEN + first] = UNASKED
            for row in range(first + 1, first + ANGLES):
                b = place_on(step, circle, rows[row, SINE], rows[row, COSINE])
                tops = tops_between(relief, a, b)
                z_low, z_high = min(a[2], b[2]), max(a[2], b[2])
                if step.kz != 1.0:
                    aside = 0.125 * circle[RADIUS] * (rows[row, PHI] - rows[row - 1, PHI]) ** 2
                    z_low, z_high = z_low - aside, z_high + aside
                seen = UNASKED
                if walk.plain:
                    if tops[1] <= z_low + SKIN:
                        seen = 0.0
                    elif tops[1] - tops[0] <= SKIN:
                        seen = tops[1] - z_low
                else:
                    what = told(relief, tops, z_low, z_high)
                    seen = UNASKED if what == UNKNOWN else 0.5 + 0.5 * what
                circle[WHOLE + row] = circle[SEEN + row] = seen
                if seen != UNASKED:
                    circle[SEEN + row - 1] = seen
                a = b
        for row in range(ANGLES * halves):
            circle[NEAR + row] = 0.0
            if circle[SEEN + row] == UNASKED:
                sine, cosine = rows[row, SINE], rows[row, COSINE]
                circle[SEEN + row], circle[NEAR + row] = seen_at(world, step, walk, seen_as, sine, cosine)


@part
def place_on(step: Step, circle: FloatArray, sine: float, cosine: float) -> Point:
    """A point of a circle about the axis at an angle, in {W}, m."""
    r, t = circle[RADIUS], circle[HEIGHT]
    return (
        step.x + r * (sine * step.fx + cosine * step.lx) + t * step.kx,
        step.y + r * (sine * step.fy + cosine * step.ly) + t * step.ky,
        step.z + r * (sine * step.fz + cosine * step.lz) + t * step.kz,
    )


@called
def aim_at_changes(world: World, step: Step, walk: Walk, rows: FloatArray, gaps: int, most: int) -> int:
    """Aim rows, those for what is hidden, at the angles at which material stands otherwise on a circle than at the
    angles looked at about them, one after the other through the ``gaps``; ``most`` of them, or all. How many it are."""
    gap, row, count = 0, 0, 0
    while count < min(most, HIDDEN):
        gap, phi = next_change(world, step, walk, rows, (gap, row, gaps))
        if gap == gaps:
            break
        row, count = 2 * ANGLES + count, count + 1
        aim(rows[row], phi)
    return count


@part
def next_change(
    world: World, step: Step, walk: Walk, rows: FloatArray, since: tuple[int, int, int]
) -> tuple[int, float]:
    """The next change along the circles: the gap between the angles of rows, and the angle in it at which material
    stands otherwise than at the angles looked at about it. ``since``: the gap it is looked for from, the row to look on
    from, and how many gaps there are. Past the last gap if none."""
    gap, row, gaps = since
    while gap < gaps:
        right = gap_end(gap)
        end = rows[right, PHI]
        first = min(end, rows[row, PHI] + walk.most)
        for n in range(walk.used):
            if walk.circles[n, WHOLE + right] == UNASKED:
                first = first_change(world, step, walk, n, (rows[row], row, right, first, end))
        if first < end:
            return gap, first
        gap, row = gap + 1, right
        if gap == HALF:  # where both half turns meet, the other one has a row of its own
            row += 1
    return gaps, 0.0


@part
def first_change(world: World, step: Step, walk: Walk, n: int, gap: tuple[FloatArray, int, int, float, float]) -> float:
    """The first angle on a circle at which material stands otherwise than at both ends of a gap, rad. ``gap``: the row
    where it begins, its number and that of the row where it ends, the angle up to which it is looked for (the answer if
    there is none), and where the gap ends."""
    row, left, right, until, end = gap
    circle = walk.circles[n]
    seen, phi, sine, cosine = (circle, ring_of(world.dexels, step, circle)), row[PHI], row[SINE], row[COSINE]
    if left < 2 * ANGLES:
        low, near = circle[SEEN + left], circle[NEAR + left]
    else:
        low, near = seen_at(world, step, walk, seen, sine, cosine)
    high, to_side, fine = circle[SEEN + right], circle[NEAR + right] > 0.0, near > 0.0
    if not walk.plain and low != high:  # it stands or does not: nothing is otherwise than both
        return until
    while True:
        turn = walk.fine if fine else walk.coarse
        there = phi + turn[0]
        if there >= end and to_side and not fine:
            fine = True
            continue
        if there >= until:
            return until
        on_sine, on_cosine = sine * turn[2] + cosine * turn[1], cosine * turn[2] - sine * turn[1]
        top, near = seen_at(world, step, walk, seen, on_sine, on_cosine)
        if near > 0.0 and not fine:
            fine = True
            continue
        phi, sine, cosine = there, on_sine, on_cosine
        if jumps(top, low) and jumps(top, high):
            return phi
        fine = near > 0.0 or (to_side and phi + walk.coarse[0] >= end)


@called
def alternates(world: World, step: Step, walk: Walk, rows: FloatArray, count: int) -> bool:
    """Whether on a circle material begins and ends within a quarter of the radius over the angles of rows; where it
    ends at the top of the stock does not count."""
    for n in range(walk.used):
        circle, r = walk.circles[n], walk.circles[n, RADIUS]
        before, changed, last = -1.0, -math.inf, 0.0
        for row in range(count):
            if place_on(step, circle, rows[row, SINE], rows[row, COSINE])[2] >= world.bounds.z_high:
                before = -1.0
                continue
            there = circle[SEEN + row]
            if before >= 0.0 and there != before:
                if (last - changed) * r < THICK * walk.rim:
                    return True
                changed = rows[row, PHI]
            before, last = there, rows[row, PHI]
    return False


@part
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
        i, j = cell_of(dexels, x, y)
        near = dexels.names[i, j, 0] != NOBODY
        if (near or there >= 1.0) and not fine:
            fine = True
            continue
        share = there
        deep = 0.0 if near or beside(world.bounds, x, y) else in_column(dexels, i, j, z)
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
