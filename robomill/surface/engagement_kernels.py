"""The engaged part of the cutter on one step, compiled: over the angle and along the profile, ends found to sub-cell.

A point of the cutter's surface cuts where its outward normal n faces the unit feed v and material lies just before it.
Over that part the kernel sums (v . n)^e times the directions in which the edge's forces act, for every exponent e of
the force law (``cutting.engaged``). The feed has its part along the axis, so ramps, helices and plunges are steps like
others: the end of a flat mill faces the feed where it goes down.

The angle phi runs clockwise from the left of the feed; along the profile the end face (radius), the nose (arc or cone)
and the flank (height) follow one another. Over the angle Gauss' rule of two points, in panels finer towards the sides;
where the engaged length jumps from one angle to the next, the jump is followed by halving.
"""

from __future__ import annotations

import math
from typing import NamedTuple

from robomill.arrays import FloatArray
from robomill.compiled import Out1, Out2, called, part
from robomill.cutting.edge import MOMENTS, moments
from robomill.cutting.engaged import FACING, PANELS
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
from robomill.surface.rib_kernels import Walk, is_plain, next_change, walk_on
from robomill.surface.step_kernels import Step, ask_for_rim
from robomill.surface.turn_kernels import (
    ANGLES,
    COSINE,
    HALF,
    PHI,
    SINE,
    between_panels,
    gap_end,
    jumps,
    panel_end,
    turn_row,
)

HALVINGS = 8  # of the angle across which the engaged length jumps
ENDS = 7  # looks, at most, at a piece of the profile for where material begins or ends in it (rule of false position)
EXACT = 1e-7  # m: so near to where it ends is there
END_PIECES, NOSE_PIECES, FLANK_PIECES = 8, 9, 96  # of each stretch of the profile, at most
INSIDE = 1e-2  # of a piece: how far inside the ends of a stretch is looked
# of a part beside its moments: hull of its angles, mean height along the axis over them, width, highest place, size
PHI_ST, PHI_EX, DEPTH, WIDTH, REACH, SIZE, REST = range(7)
# what is known of an angle: itself, its sine and cosine; then what is engaged at it: length, height along the axis,
# where it begins and ends along the axis, its largest radius, how much of the end face; then sums for each exponent
LENGTH, HEIGHT, LOWEST, HIGHEST, WIDEST, FACE, SUMS = range(3, 10)
UNSEEN = -math.inf  # where an angle begins at which nothing was looked at yet
BEGIN, STOP, PIECES, FIRST = range(4)  # of a stretch of the profile: where, in how many pieces, its first place
HIDDEN = 2 * PANELS  # looks at such, at most
GAPS = 6 * PANELS + HIDDEN
ROWS = 2 * ANGLES + HIDDEN + GAPS * HALVINGS  # angles looked at in a turn, at most


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


@part
def engaged_at(world: World, step: Step, ray: Ray, at: tuple[float, float, float, float]) -> float:
    """How deep in the material the cutter cuts at a place of its profile (radius, height, sine, cosine) at the angle of
    a ray, m: > 0 where it does (see ``standing``)."""
    r, t, sine, cosine = at
    if step.across * ray.sine * sine - step.along * cosine <= FACING:
        return -FAR
    x, y, z = step.x + r * ray.x + t * step.kx, step.y + r * ray.y + t * step.ky, step.z + r * ray.z + t * step.kz
    return standing(world, (x, y, z), step.run)


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
        spared = first == 0 and shape.kind != FLAT and between_panels(n)
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
def measure_stretch(room: Room, row: FloatArray, world: World, seen: tuple[Shape, Step, Ray], stretch: int) -> None:
    """What is engaged of a stretch of the profile at one angle, looked for at the ends of its pieces."""
    shape, step, ray = seen
    whole = room.stretches[stretch]
    pieces, first = int(whole[PIECES]), int(whole[FIRST])
    width = (whole[STOP] - whole[BEGIN]) / pieces
    begin, since, before = whole[BEGIN], False, -1.0
    for n in range(pieces + 2):  # the last one to end what is still engaged
        place = room.places[first + min(n, pieces)]
        at = (place[0], place[1], place[2], place[3])
        low, high, s = whole[BEGIN] + (n - 1) * width, whole[BEGIN] + n * width, 0.0
        cuts, deep_low, deep_high, after = since, before, before, before
        for search in range(ENDS + 1):  # first the end of the piece, then, where material begins or ends, that place
            deep = engaged_at(world, step, ray, at) if n <= pieces else -1.0
            if search == 0:
                cuts, deep_high, after = deep > 0.0, deep, deep
                if n == 0 or n > pieces or cuts == since:
                    break
            elif (deep > 0.0) == since:
                low, deep_low, deep_high = s, deep, 0.5 * deep_high
            else:
                high, deep_high, deep_low = s, deep, 0.5 * deep_low
            if search > 0 and abs(deep) < EXACT:
                low = high = s
                break
            s = low + (high - low) * deep_low / (deep_low - deep_high)
            at = on_profile(shape, stretch, s)
        before = after
        if since and not cuts:
            add_edge(room, row, shape, step, stretch, (begin, low))
        elif cuts and not since:
            begin = high
        since = cuts


@part
def note(pieces: FloatArray, count: int, row: float, middle: float, width: float, sector: float) -> int:
    """Note a piece of the turn at which a row was measured; returns how many there are then."""
    piece = pieces[count]
    piece[0], piece[1], piece[2], piece[3] = row, middle, width, sector
    return count + 1


@part
def divide(room: Room, world: World, shape: Shape, step: Step, walk: Walk, halves: int) -> tuple[int, int, int]:
    """Divide the turn into pieces that are smooth and gaps across which the engaged length jumps: how many of both, and
    how many angles between were looked at for ribs and gaps of material that its panels pass over."""
    rows, count, gaps, looked, every = room.rows, 0, 0, 0, HALF * halves
    changed, phi = next_change(world, walk, rows, (0, 0, 0), every) if walk.pitch > 0.0 else (every, 0.0)
    for panel in range(PANELS * halves):
        begun, start, end = gaps, panel_end(panel), panel_end(panel + 1)
        first, rough = gap_end(3 * panel) - 1, False
        for n in range(3):
            left, right = first + n, first + n + 1
            a = start if n == 0 else rows[left, PHI]
            b = end if n == 2 else rows[right, PHI]
            while changed == 3 * panel + n and looked < HIDDEN:
                between = 2 * ANGLES + looked
                aim(room.rows[between], phi)
                measure(room, world, shape, step, between, between + 1)
                looked += 1
                if jumps(rows[left, LENGTH], rows[between, LENGTH]) and jumps(
                    rows[between, LENGTH], rows[right, LENGTH]
                ):
                    gaps = note_gap(room, gaps, (left, between), (a, phi), (panel, start, end))
                    left, a, rough = between, phi, True
                changed, phi = next_change(world, walk, rows, (changed, between, left), every)
            rough = rough or jumps(rows[left, LENGTH], rows[right, LENGTH])
            gaps = note_gap(room, gaps, (left, right), (a, b), (panel, start, end))
        for n in range(first, first + 4, 3):
            if rough and rows[n, LOWEST] == UNSEEN:
                measure(room, world, shape, step, n, n + 1)
        if not rough:
            gaps = begun
            for n in range(1, 3):
                middle = rows[first + n, PHI]
                count = note(room.pieces, count, first + n, middle, 0.5 * (end - start), 4 * panel + 3 * (n - 1))
    return count, gaps, looked


@part
def note_gap(
    room: Room, gaps: int, rows: tuple[int, int], ends: tuple[float, float], panel: tuple[int, float, float]
) -> int:
    """Note a gap between two rows, from an angle to another; ``panel``: number, beginning, end. Returns how many."""
    gap = room.gaps[gaps]
    gap[0], gap[1], gap[2], gap[3] = rows[0], rows[1], ends[0], ends[1]
    gap[4], gap[5], gap[6] = panel[0], panel[1], 4.0 / (panel[2] - panel[1])
    return gaps + 1


@part
def aim(row: FloatArray, phi: float) -> None:
    """A row for what is to be measured at an angle."""
    row[PHI], row[SINE], row[COSINE] = phi, math.sin(phi), math.cos(phi)


@part
def follow_jumps(room: Room, world: World, shape: Shape, step: Step, counts: tuple[int, int, int]) -> int:
    """Halve the gaps between angles while the engaged length jumps across them; returns how many pieces there are."""
    rows, (count, gaps, hidden) = room.rows, counts
    first = 2 * ANGLES + hidden
    for halving in range(HALVINGS + 1):
        kept = 0
        for n in range(gaps):
            gap = room.gaps[n]
            left, right, a, b = int(gap[0]), int(gap[1]), gap[2], gap[3]
            if halving == HALVINGS or not jumps(rows[left, LENGTH], rows[right, LENGTH]):
                half = 0.5 * (b - a)
                for row, middle in ((left, a + 0.5 * half), (right, b - 0.5 * half)):
                    count = note(room.pieces, count, row, middle, half, sector_of(gap, middle))
                continue
            aim(rows[first + kept], 0.5 * (a + b))
            for q in range(7):
                room.gaps[kept, q] = gap[q]
            kept += 1
        gaps = kept
        if gaps == 0:
            break
        measure(room, world, shape, step, first, first + gaps)
        for n in range(gaps):
            count = halve(room, n, first + n, count)
        first += gaps
    return count


@part
def sector_of(gap: FloatArray, phi: float) -> float:
    """The sector, a quarter of a gap's panel, in which an angle lies."""
    return 4.0 * gap[4] + math.floor((phi - gap[5]) * gap[6])


@part
def halve(room: Room, n: int, middle: int, count: int) -> int:
    """Leave of the n-th gap the half across which the length jumps more; the other one is smooth."""
    rows, gap = room.rows, room.gaps[n]
    left, right, a, b, phi = int(gap[0]), int(gap[1]), gap[2], gap[3], rows[middle, PHI]
    quarter, length = 0.25 * (b - a), rows[middle, LENGTH]
    early = abs(length - rows[left, LENGTH]) < abs(length - rows[right, LENGTH])
    start = a if early else phi
    for row, phi in (
        (left if early else middle, start + 0.5 * quarter),
        (middle if early else right, start + 1.5 * quarter),
    ):
        count = note(room.pieces, count, row, phi, quarter, sector_of(gap, phi))
    gap[0 if early else 1], gap[2 if early else 3] = middle, rows[middle, PHI]
    return count


@part
def add_pieces(room: Room, count: int, total: FloatArray) -> None:
    """Add pieces of the turn to the part, ``total`` (8 e + 6,), and to its sectors."""
    exponents = len(room.exponents)
    rest = total[MOMENTS * exponents :]
    for p in range(count):
        row, phi, width = room.rows[int(room.pieces[p, 0])], room.pieces[p, 1], room.pieces[p, 2]
        sector = room.sectors[min(int(room.pieces[p, 3]), len(room.sectors) - 1)]
        sector[0] += width
        if row[LENGTH] <= 0.0:
            continue
        sine, cosine = row[SINE], row[COSINE]
        if phi != row[PHI]:
            sine, cosine = math.sin(phi), math.cos(phi)
        for n in range(exponents):
            sums = row[SUMS + 3 * n :]
            each = moments(width * sums[0], width * sums[1], width * sums[2], sine, cosine)
            for q in range(MOMENTS):
                total[MOMENTS * n + q] += each[q]
        if row[HEIGHT] > 0.0:
            sector[1] += width * row[HEIGHT]
            sector[2] += width * row[HEIGHT] * row[LOWEST]
            sector[3] += width * row[HEIGHT] * row[HIGHEST]
        sector[4] += width * row[FACE]
        rest[SIZE] += row[LENGTH] * width
        rest[REACH] = max(rest[REACH], row[HIGHEST])
        if phi > math.pi:
            continue
        rest[PHI_ST], rest[PHI_EX] = min(rest[PHI_ST], phi - 0.5 * width), max(rest[PHI_EX], phi + 0.5 * width)
        rest[DEPTH] += row[HEIGHT] * width
        rest[WIDTH] += row[WIDEST] * sine * width


@part
def add_part(room: Room, world: World, shape: Shape, step: Step, total: FloatArray, sectors: FloatArray) -> None:
    """The engaged part of one step, into ``total`` (8 e + 6,) and ``sectors`` (4 s,), see ``EngagedPart``."""
    rest = total[MOMENTS * len(room.exponents) :]
    total[:] = 0.0
    rest[PHI_ST], rest[PHI_EX] = math.inf, -math.inf
    room.sectors[:] = 0.0
    lay_out(room, shape, step, world)
    halves = 2 if step.along < -FACING else 1
    measure(room, world, shape, step, 0, ANGLES * halves)
    walk = walk_on(world, shape, step)
    count = follow_jumps(room, world, shape, step, divide(room, world, shape, step, walk, halves))
    add_pieces(room, count, total)
    for n in range(len(room.sectors)):
        width, height, low, high, face = room.sectors[n if room.sectors[n, 0] > 0.0 else n ^ 1]
        sectors[4 * n] = height / width if width > 0.0 else 0.0
        sectors[4 * n + 1] = low / height if height > 0.0 else 0.0
        sectors[4 * n + 2] = high / height if height > 0.0 else 0.0
        sectors[4 * n + 3] = face / width if width > 0.0 else 0.0
    if rest[PHI_EX] < rest[PHI_ST]:
        rest[PHI_ST] = rest[PHI_EX] = 0.0
        return
    rest[PHI_ST], rest[PHI_EX] = max(rest[PHI_ST], 0.0), min(rest[PHI_EX], math.pi)
    rest[DEPTH] /= rest[PHI_EX] - rest[PHI_ST]
