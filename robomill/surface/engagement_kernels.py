"""The engaged part of the cutter on one step, compiled: over the angle and along the profile, ends found to sub-cell.

A point of the cutter's surface cuts where its outward normal n faces the unit feed v and material lies just before it.
Over that part the kernel sums (v . n)^e times the directions in which the edge's forces act, for every exponent e of
the force law (``cutting.engaged``). The feed has its part along the axis, so ramps, helices and plunges are steps like
others: the end of a flat mill faces the feed where it goes down.

The angle phi runs clockwise from the left of the feed; along the profile the end face (radius), the nose (arc or cone)
and the flank (height) follow one another. ``division_kernels`` adds up over the angle.
"""

from __future__ import annotations

import math
from typing import NamedTuple

from robomill.arrays import FloatArray
from robomill.compiled import Out1, Out2, called, part
from robomill.cutting.engaged import FACING
from robomill.cutting.profile_kernels import (
    END,
    FLANK,
    FLAT,
    Shape,
    edge_sums,
    on_profile,
    piece_between,
    stretch_ends,
)
from robomill.cutting.tool import DISH
from robomill.surface.material_kernels import FAR, World, standing, top_over
from robomill.surface.rib_kernels import change_between, is_plain
from robomill.surface.step_kernels import Step, ask_for_rim
from robomill.surface.turn_kernels import (
    ANGLES,
    COSINE,
    SINE,
    between_panels,
    jumps,
    turn_row,
)

ENDS = 7  # looks, at most, at a piece of the profile for where material begins or ends in it (rule of false position)
EXACT = 1e-7  # m: so near to where it ends is there
END_PIECES, NOSE_PIECES, FLANK_PIECES = 8, 9, 96  # of each stretch of the profile, at most
INSIDE = 1e-2  # of a piece: how far inside the ends of a stretch is looked
# what is known of an angle: itself, its sine and cosine; then what is engaged at it: length, height along the axis,
# where it begins and ends along the axis, its largest radius, how much of the end face; then sums for each exponent
LENGTH, HEIGHT, LOWEST, HIGHEST, WIDEST, FACE, SUMS = range(3, 10)
UNSEEN = -math.inf  # where an angle begins at which nothing was looked at yet
BEGIN, STOP, PIECES, FIRST = range(4)  # of a stretch of the profile: where, in how many pieces, its first place


Place = tuple[float, float, float, float]  # of the profile: radius, height, sine and cosine of its normal


class Ray(NamedTuple):
    """An angle of the cutter: its sine, and the unit vector e(phi) out of the axis, in {W}."""

    sine: float
    x: float
    y: float
    z: float


class Room(NamedTuple):
    """Room for what is measured (arrays in a tuple count as written, to the compiler).

    exponents (e,); the stretches of the profile (3, 4) and the places on them that are looked at (r, t, sine, cosine);
    the angles (``ROWS``, 9 + 3 e) looked at in one step, those of both half turns first; gaps between two of them
    across which the length jumps (their rows, from, to, and their panel: number, beginning, quarters a rad); the pieces
    of the turn that follow (row, middle, width, sector); sectors (s, 5): width, engaged height, that height times where
    it begins and times where it ends, and engaged length of the end face.
    """

    exponents: Out1
    stretches: Out2
    places: Out2
    rows: Out2
    gaps: Out2
    pieces: Out2
    sectors: Out2
    circles: Out2
    fine: Out1


@part
def point_at(step: Step, ray: Ray, at: Place) -> tuple[float, float, float]:
    """A place of the profile (radius, height, ...) at the angle of a ray, in {W}, m."""
    r, t = at[0], at[1]
    return step.x + r * ray.x + t * step.kx, step.y + r * ray.y + t * step.ky, step.z + r * ray.z + t * step.kz


@part
def engaged_at(world: World, step: Step, ray: Ray, at: Place) -> float:
    """How deep in the material the cutter cuts at a place of its profile (radius, height, sine, cosine) at the angle of
    a ray, m: > 0 where it does (see ``standing``)."""
    sine, cosine = at[2], at[3]
    if step.across * ray.sine * sine - step.along * cosine <= FACING:
        return -FAR
    return standing(world, point_at(step, ray, at), step.run)


@part
def add_edge(room: Room, row: FloatArray, shape: Shape, step: Step, stretch: int, ends: tuple[float, float]) -> None:
    """Add an engaged piece of the profile to what is measured at one angle."""
    length = ends[1] - ends[0]
    if length <= 0.0:
        return
    piece = piece_between(shape, stretch, ends[0], ends[1])
    for n in range(len(room.exponents)):
        faces = (step.across * row[SINE], step.along)
        plain, up, lying = edge_sums(shape, piece, faces, room.exponents[n])
        row[SUMS + 3 * n] += plain
        row[SUMS + 3 * n + 1] += up
        row[SUMS + 3 * n + 2] += lying
    row[LENGTH] += length
    row[WIDEST] = max(row[WIDEST], piece.radius)
    if stretch == END:
        row[FACE] += length
        return
    row[HEIGHT] += piece.high - piece.low
    row[LOWEST] = min(row[LOWEST], piece.low)
    row[HIGHEST] = max(row[HIGHEST], piece.high)


@part
def lay_out(room: Room, shape: Shape, step: Step, world: World) -> None:
    """The stretches of the profile for one step, as far up as material may stand, and the places looked at on them."""
    reach = (world.bounds.z_high - step.z + shape.R * math.hypot(step.kx, step.ky)) / step.kz
    first = 0
    for stretch in range(3):
        begin, stop = stretch_ends(shape, stretch, reach)
        if stretch == END and step.along >= -DISH:
            stop = begin
        pieces = END_PIECES if stretch == END else NOSE_PIECES
        if stretch == FLANK:
            pieces = int(min(max((stop - begin) / world.dexels.dx, 8.0), 1.0 * FLANK_PIECES))
        noted = room.stretches[stretch]
        noted[BEGIN], noted[STOP], noted[PIECES], noted[FIRST] = begin, stop, pieces, first
        if stop <= begin or (stretch == FLANK and is_plain(world, step)):
            continue
        for n in range(pieces + 1):
            inside = INSIDE if n == 0 else -INSIDE if n == pieces else 0.0
            at = on_profile(shape, stretch, begin + (n + inside) * (stop - begin) / pieces)
            for q in range(4):
                room.places[first, q] = at[q]
            first += 1


@called
def measure(room: Room, world: World, shape: Shape, step: Step, first: int, end: int) -> None:
    """What is engaged at the angles of some rows. From the first row on they are the turn: there a round or pointed
    nose is as engaged at the ends of panels as at the nodes before, unless it jumps between the nodes about them."""
    plain, rows = is_plain(world, step), room.rows
    if first == 0:
        ask_for_rim(world.dexels, step, shape.R, end // ANGLES)
    for place in range(first, end):
        n = turn_row(place) if first == 0 else place
        row = rows[n]
        spared = first == 0 and shape.kind != FLAT and room.fine[0] == 0.0 and between_panels(n)
        if spared and not jumps(rows[n - 1, LENGTH], rows[n + 1, LENGTH]):
            row[LENGTH], row[LOWEST] = rows[n - 1, LENGTH], UNSEEN
            continue
        row[LENGTH:] = 0.0
        row[LOWEST] = math.inf
        sine, cosine = row[SINE], row[COSINE]
        ray = Ray(
            sine,
            sine * step.fx + cosine * step.lx,
            sine * step.fy + cosine * step.ly,
            sine * step.fz + cosine * step.lz,
        )
        for stretch in range(3):
            begin, stop = room.stretches[stretch, BEGIN], room.stretches[stretch, STOP]
            if stop <= begin or (stretch == FLANK and sine * step.across <= FACING):
                continue
            if stretch == FLANK and plain:
                material = top_over(world, step.x + shape.R * ray.x, step.y + shape.R * ray.y)
                ends = (max(begin, world.bounds.z_low - step.z), material - step.z)
                add_edge(room, row, shape, step, FLANK, ends)
            else:
                measure_stretch(room, row, world, (shape, step, ray), stretch)


@part
def place_of(room: Room, first: int, n: int) -> Place:
    """A place that is looked at on the profile, of those of a stretch, the first of which is so far on."""
    place = room.places[first + n]
    return place[0], place[1], place[2], place[3]


@part
def measure_stretch(room: Room, row: FloatArray, world: World, seen: tuple[Shape, Step, Ray], stretch: int) -> None:
    """What is engaged of a stretch of the profile at one angle, looked for at the ends of its pieces, and between them
    where ribs are near."""
    _, step, ray = seen
    whole = room.stretches[stretch]
    pieces, first = int(whole[PIECES]), int(whole[FIRST])
    width = (whole[STOP] - whole[BEGIN]) / pieces
    low, at_low = whole[BEGIN], place_of(room, first, 0)
    deep_low = engaged_at(world, step, ray, at_low)
    begin, n, shut = low, 1, room.fine[0] == 0.0
    at_end, deep_end = at_low, 0.0
    while n <= pieces:
        high = whole[BEGIN] + n * width
        if low == whole[BEGIN] + (n - 1) * width:
            at_end = place_of(room, first, n)
            deep_end = engaged_at(world, step, ray, at_end)
        at_high, deep_high = at_end, deep_end
        if not shut and (deep_low > 0.0) == (deep_high > 0.0):
            gap = (low, high), (deep_low, deep_high), (at_low, at_high)
            high, deep_high, at_high = hidden_place(world, seen, stretch, gap)
        if (deep_low > 0.0) != (deep_high > 0.0):
            ends = end_between(world, seen, stretch, (low, high), (deep_low, deep_high))
            if deep_low > 0.0:
                add_edge(room, row, seen[0], step, stretch, (begin, ends[0]))
            begin = ends[1]
        if high == whole[BEGIN] + n * width:
            n += 1
        low, deep_low, at_low = high, deep_high, at_high
    if deep_low > 0.0:
        add_edge(room, row, seen[0], step, stretch, (begin, whole[STOP]))


@part
def end_between(
    world: World,
    seen: tuple[Shape, Step, Ray],
    stretch: int,
    ends: tuple[float, float],
    deeps: tuple[float, float],
) -> tuple[float, float]:
    """Where material begins or ends between two places of a stretch, m, of which one is so deep in it and the other in
    the air: from and to (rule of false position)."""
    (low, high), (deep_low, deep_high), cuts = ends, deeps, deeps[0] > 0.0
    for _ in range(ENDS):
        s = low + (high - low) * deep_low / (deep_low - deep_high)
        deep = engaged_at(world, seen[1], seen[2], on_profile(seen[0], stretch, s))
        if (deep > 0.0) == cuts:
            low, deep_low, deep_high = s, deep, 0.5 * deep_high
        else:
            high, deep_high, deep_low = s, deep, 0.5 * deep_low
        if abs(deep) < EXACT:
            return s, s
    return low, high


@part
def hidden_place(
    world: World,
    seen: tuple[Shape, Step, Ray],
    stretch: int,
    gap: tuple[tuple[float, float], tuple[float, float], tuple[Place, Place]],
) -> tuple[float, float, Place]:
    """A place between two of a stretch at which it is otherwise than at both: where, m, how deep, and itself; the
    second of them where there is none. ``gap``: where the two are, m, how deep, and themselves."""
    (shape, step, ray), ((low, high), deeps, places), share = seen, gap, 0.0
    a, b = point_at(step, ray, places[0]), point_at(step, ray, places[1])
    while share < 1.0:
        share = change_between(world, step.run, (a, b), share, deeps[0] > 0.0)
        if share < 1.0:
            s = low + share * (high - low)
            at = on_profile(shape, stretch, s)
            deep = engaged_at(world, step, ray, at)
            if (deep > 0.0) != (deeps[0] > 0.0):
                return s, deep, at
    return high, deeps[1], places[1]
