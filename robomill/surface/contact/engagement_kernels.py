"""The engaged part of the cutter on one step, compiled: over the angle and along the profile, ends found to sub-cell.

A point of the cutter's surface cuts where its outward normal n faces the unit feed v and material lies just before it.
Over that part the kernel sums (v . n)^e times the directions in which the edge's forces act, for every exponent e of
the force law (``cutting.engaged``). The feed has its part along the axis, so ramps, helices and plunges are steps like
others: the end of a flat mill faces the feed where it goes down, on gentle slopes with its heel alone (``heel``).

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
    CHAMFER,
    END,
    FLANK,
    FLAT,
    NOSE,
    Place,
    Shape,
    beside_place,
    edge_sums,
    facing_part,
    heel,
    on_profile,
    stretch_ends,
)
from robomill.cutting.tool import DISH
from robomill.surface.contact.material_kernels import FAR, World, standing, standing_near, top_over
from robomill.surface.contact.relief_kernels import UNKNOWN, Relief, square_about, told, tops_between
from robomill.surface.contact.rib_kernels import change_between, is_plain
from robomill.surface.contact.step_kernels import Step, rim_turns
from robomill.surface.contact.turn_kernels import (
    COSINE,
    SINE,
    between_panels,
    jumps,
    turn_row,
)

END_LOOKS = 12  # at most, at a piece of the profile for where material begins or ends in it (rule of false position)
NARROW = 0.3e-3  # m: so far apart a nose is looked at where material may end between its pieces' ends
SLOW = 0.5  # of the way between two such places: two looks that leave more have hardly closed in
EXACT = 1e-7  # m: so near to where it ends is there
END_PIECES, NOSE_PIECES, FLANK_PIECES = 8, 9, 96  # of each stretch of the profile, at most
INSIDE = 1e-2  # of a piece: how far inside the ends of a stretch is looked
# what is known of an angle: itself, its sine and cosine; then what is engaged at it: length, height along the axis,
# where it begins and ends along the axis, its largest radius, how much of the end face; then sums for each exponent
LENGTH, HEIGHT, LOWEST, HIGHEST, WIDEST, FACE, SUMS = range(3, 10)
UNSEEN = -math.inf  # where an angle begins at which nothing was looked at yet
BEGIN, STOP, PIECES, FIRST = range(4)  # of a stretch of the profile: where, in how many pieces, its first place


class Ray(NamedTuple):
    """An angle of the cutter: its sine, and the unit vector e(phi) out of the axis, in {W}."""

    sine: float
    x: float
    y: float
    z: float


class Room(NamedTuple):
    """Room for what is measured (arrays in a tuple count as written, to the compiler).

    exponents (e,); the stretches of the profile (3, 4) and the places on them that are looked at (p, 5);
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
    """A place of the profile at the angle of a ray, in {W}, m."""
    r, t = at.radius, at.height
    return step.x + r * ray.x + t * step.kx, step.y + r * ray.y + t * step.ky, step.z + r * ray.z + t * step.kz


@part
def engaged_at(world: World, step: Step, ray: Ray, at: Place) -> float:
    """How deep in the material the cutter is at a place of its profile at the angle of a ray, m: > 0 where it cuts, if
    it faces the feed there (see ``standing``)."""
    return standing(world, point_at(step, ray, at), step.run)


@part
def about_at(world: World, step: Step, ray: Ray, at: Place) -> float:
    """Whether the cutter is in the material there, told by the relief where it can: ``FAR`` or -``FAR``; else
    ``engaged_at``."""
    x, y, z = point_at(step, ray, at)
    low, high, sides = square_about(world.relief, x, y)
    what = told(world.relief, (low, high), z, z)
    return FAR * what if what != UNKNOWN else standing_near(world, (x, y, z), step.run, sides)


@part
def faces_of(
    shape: Shape, step: Step, stretch: int, turn: tuple[float, float], about: tuple[float, float, float]
) -> tuple[float, float]:
    """How a piece of a stretch faces its way at an angle (its sine and cosine): (a, b) of a sin(kappa) - b cos(kappa).

    Where the axis turns by w a place moves by v + w x (r e + t k) beside the tip's v, so that its normal faces that by
    (t sin(kappa) + r cos(kappa)) (e . w x k) more: on a round nose by (rc sin(kappa) + r0 cos(kappa)) times that,
    elsewhere as in the middle of the piece; ``about``: the radius there, and the heights of its ends, m. Axes that are
    alike but for rounding do not turn."""
    sine, cosine = turn
    a, b = step.across * sine, step.along
    leans = sine * step.turn_f + cosine * step.turn_l
    if abs(leans) * shape.R <= FACING:
        return a, b
    if stretch == NOSE and shape.kind != CHAMFER:
        return a + shape.rc * leans, b - shape.r0 * leans
    return a + 0.5 * (about[1] + about[2]) * leans, b - about[0] * leans


@part
def cutting_end(shape: Shape, step: Step, sine: float, cosine: float) -> tuple[float, float]:
    """From which radius to which a flat end cuts at an angle, m: where its teeth go down by more than they are ground
    hollow, as the axis turns; else from its heel on."""
    if not rim_turns(step, shape.R):
        return heel(shape.r0, step.sinks, sine), shape.r0
    leans, down = sine * step.turn_f + cosine * step.turn_l, -step.along - DISH
    if leans == 0.0:
        return (0.0 if down > 0.0 else shape.r0), shape.r0
    turned = -down / leans
    return (max(turned, 0.0), shape.r0) if leans > 0.0 else (0.0, min(turned, shape.r0))


@part
def add_edge(room: Room, row: FloatArray, shape: Shape, step: Step, stretch: int, ends: tuple[Place, Place]) -> None:
    """Add an engaged piece of the profile, between two places of it, to what is measured at one angle."""
    start, end = ends
    length = end.s - start.s
    if length <= 0.0:
        return
    faces = faces_of(
        shape, step, stretch, (row[SINE], row[COSINE]), (0.5 * (start.radius + end.radius), start.height, end.height)
    )
    for n in range(len(room.exponents)):
        plain, up, lying = edge_sums(shape, ends, faces, room.exponents[n])
        row[SUMS + 3 * n] += plain
        row[SUMS + 3 * n + 1] += up
        row[SUMS + 3 * n + 2] += lying
    row[LENGTH] += length
    row[WIDEST] = max(row[WIDEST], end.radius)
    if stretch == END:
        row[FACE] += length
        return
    row[HEIGHT] += end.height - start.height
    row[LOWEST] = min(row[LOWEST], start.height)
    row[HIGHEST] = max(row[HIGHEST], end.height)


@part
def lay_out(room: Room, shape: Shape, step: Step, world: World) -> None:
    """The stretches of the profile for one step, as far up as material may stand, and the places looked at on them: the
    first and the last a little inside; then where it begins and stops itself."""
    reach = (world.bounds.z_high - step.z + shape.R * math.hypot(step.kx, step.ky)) / step.kz
    first = 0
    for stretch in range(3):
        begin, stop = stretch_ends(shape, stretch, reach)
        if stretch == END and step.sinks <= 0.0 and not rim_turns(step, shape.R):
            stop = begin
        pieces = END_PIECES if stretch == END else NOSE_PIECES
        if stretch == FLANK:
            pieces = int(min(max((stop - begin) / world.dexels.dx, 8.0), 1.0 * FLANK_PIECES))
        noted = room.stretches[stretch]
        noted[BEGIN], noted[STOP], noted[PIECES], noted[FIRST] = begin, stop, pieces, first
        if stop <= begin or (stretch == FLANK and is_plain(world, step)):
            continue
        width = (stop - begin) / pieces
        for n in range(pieces + 1):
            inside = INSIDE if n == 0 else -INSIDE if n == pieces else 0.0
            at = on_profile(shape, stretch, begin + (n + inside) * (stop - begin) / pieces)
            note_at(room, first + n, at, stop if n == pieces else begin + n * width)
        note_at(room, first + pieces + 1, on_profile(shape, stretch, begin), begin)
        note_at(room, first + pieces + 2, on_profile(shape, stretch, stop), stop)
        first += pieces + 3


@part
def note_at(room: Room, row: int, at: Place, s: float) -> None:
    """Note a place of the profile, as one that lies ``s`` m along its stretch."""
    place = room.places[row]
    place[0], place[1], place[2], place[3], place[4] = s, at.radius, at.height, at.sine, at.cosine


@part
def noted_at(room: Room, row: int) -> Place:
    """A noted place of the profile."""
    place = room.places[row]
    return Place(place[0], place[1], place[2], place[3], place[4])


@called
def measure(room: Room, world: World, shape: Shape, step: Step, first: int, end: int) -> None:
    """What is engaged at the angles of some rows. From the first row on they are the turn: there a round or pointed
    nose is as engaged at the ends of panels as at the nodes before, unless it jumps between the nodes about them."""
    plain, rows = is_plain(world, step), room.rows
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
            if stop <= begin:
                continue
            middle = 0.5 * (begin + stop)
            if stretch == END:
                facing = cutting_end(shape, step, sine, cosine)
            else:
                faces = faces_of(shape, step, stretch, (sine, cosine), (shape.R, middle, middle))
                facing = facing_part(shape, stretch, faces)
            begin, stop = max(begin, facing[0]), min(stop, facing[1])
            if stop <= begin:
                continue
            if stretch == FLANK and plain:
                material = top_over(world, step.x + shape.R * ray.x, step.y + shape.R * ray.y)
                low, high = max(begin, world.bounds.z_low - step.z), material - step.z
                ends = (on_profile(shape, FLANK, low), on_profile(shape, FLANK, high))
                add_edge(room, row, shape, step, FLANK, ends)
            else:
                measure_stretch(room, row, world, (shape, step, ray), (stretch, begin, stop))


@part
def measure_stretch(
    room: Room, row: FloatArray, world: World, seen: tuple[Shape, Step, Ray], of: tuple[int, float, float]
) -> None:
    """What is engaged at one angle ``of`` a stretch of the profile between two places, m, beyond which it does not face
    the feed: looked for at the ends of its pieces, and between them where ribs are near."""
    (shape, step, ray), (stretch, facing, to), shut = seen, of, room.fine[0] == 0.0
    pieces, first = int(room.stretches[stretch, PIECES]), int(room.stretches[stretch, FIRST])
    low, begin, stop = noted_at(room, first), noted_at(room, first + pieces + 1), noted_at(room, first + pieces + 2)
    if facing > begin.s:
        low = begin = on_profile(shape, stretch, facing)
    if to < stop.s:
        stop = on_profile(shape, stretch, to)
    wide = stretch == NOSE and room.places[first + 1, 0] - room.places[first, 0] > NARROW
    deep_low = about_at(world, step, ray, low)
    for n in range(first + 1, first + pieces + 1):
        if low.s >= min(room.places[n, 0], stop.s):
            continue
        end = noted_at(room, n) if room.places[n, 0] <= stop.s else stop
        deep_end = about_at(world, step, ray, end)
        while low.s < end.s:
            high, deep_high = end, deep_end
            if (deep_low > 0.0) == (deep_high > 0.0):
                share = 1.0
                if (not shut or (wide and deep_low <= 0.0)) and not told_between(world.relief, seen, (low, high)):
                    if shut:
                        share = narrow_place(world, seen, (low, high))
                    else:
                        share = hidden_place(world, seen, stretch, (low, high), deep_low > 0.0)
                if share < 1.0:
                    high = on_profile(shape, stretch, low.s + share * (end.s - low.s))
                    deep_high = engaged_at(world, step, ray, high)
            if (deep_low > 0.0) != (deep_high > 0.0):
                last, next_begin = end_between(world, seen, stretch, (low, high), (deep_low, deep_high))
                if deep_low > 0.0:
                    add_edge(room, row, shape, step, stretch, (begin, last))
                begin = next_begin
            low, deep_low = high, deep_high
    if deep_low > 0.0:
        add_edge(room, row, shape, step, stretch, (begin, stop))


@part
def told_between(relief: Relief, seen: tuple[Shape, Step, Ray], ends: tuple[Place, Place]) -> bool:
    """Whether the relief tells what stands between two places of a stretch."""
    (_, step, ray), (low, high) = seen, ends
    a, b = point_at(step, ray, low), point_at(step, ray, high)
    return told(relief, tops_between(relief, a, b), min(a[2], b[2]), max(a[2], b[2])) != UNKNOWN


@part
def end_between(
    world: World,
    seen: tuple[Shape, Step, Ray],
    stretch: int,
    ends: tuple[Place, Place],
    about: tuple[float, float],
) -> tuple[Place, Place]:
    """Where material begins or ends between two places of a stretch, of which one is ``about`` so deep in it and the
    other in the air: from and to (rule of false position; two halvings where that hardly closes in, as where one of
    them is near another surface)."""
    (shape, step, ray), (low, high), (deep_low, deep_high), cuts = seen, ends, about, about[0] > 0.0
    if abs(deep_low) == FAR:
        deep_low = engaged_at(world, step, ray, low)
    if abs(deep_high) == FAR:
        deep_high = engaged_at(world, step, ray, high)
    middle = on_profile(shape, stretch, 0.5 * (low.s + high.s))
    wide, halve = math.inf, False
    for look in range(END_LOOKS):
        apart = high.s - low.s
        if look % 2 == 0:
            halve, wide = wide < math.inf and apart > SLOW * wide, apart
        share = 0.5 if halve else deep_low / (deep_low - deep_high)
        at = beside_place(shape, stretch, middle, low.s + share * apart)
        deep = engaged_at(world, step, ray, at)
        if (deep > 0.0) == cuts:
            low, deep_low, deep_high = at, deep, 0.5 * deep_high
        else:
            high, deep_high, deep_low = at, deep, 0.5 * deep_low
        if abs(deep) < EXACT:
            return at, at
    at = beside_place(shape, stretch, middle, 0.5 * (low.s + high.s))
    return at, at


@part
def narrow_place(world: World, seen: tuple[Shape, Step, Ray], ends: tuple[Place, Place]) -> float:
    """How far on between two places of a nose in the air it cuts, as a share; 1 where that is nowhere. What a finishing
    pass meets may be narrower than a piece of the nose, though no rib is near."""
    (shape, step, ray), (low, high) = seen, ends
    parts = math.ceil((high.s - low.s) / NARROW)
    for n in range(1, parts):
        share = n / parts
        if about_at(world, step, ray, on_profile(shape, NOSE, low.s + share * (high.s - low.s))) > 0.0:
            return share
    return 1.0


@part
def hidden_place(
    world: World, seen: tuple[Shape, Step, Ray], stretch: int, ends: tuple[Place, Place], cuts: bool
) -> float:
    """How far on between two places of a stretch it is otherwise than at both, where the cutter ``cuts`` or does not,
    as a share; 1 where that is nowhere."""
    (shape, step, ray), (low, high), share = seen, ends, 0.0
    a, b = point_at(step, ray, low), point_at(step, ray, high)
    while share < 1.0:
        share = change_between(world, step.run, (a, b), share, cuts)
        if share < 1.0:
            at = on_profile(shape, stretch, low.s + share * (high.s - low.s))
            if (engaged_at(world, step, ray, at) > 0.0) != cuts:
                return share
    return share
