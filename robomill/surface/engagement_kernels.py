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
from robomill.cutting.tool import DISH
from robomill.surface.envelope_kernels import Shape
from robomill.surface.material_kernels import World, is_solid, top_over
from robomill.surface.step_kernels import END, FACING, FLANK, NOSE, Step, on_profile, stretch_ends

PANELS = 12  # of a half turn
GAUSS = 0.5 - math.sqrt(3.0) / 6.0  # first node of Gauss' rule of two points on 0..1
HALVINGS = 8  # of the angle across which the engaged length jumps
JUMP = 0.2  # of the longer one: neighbouring engaged lengths that differ by more than this are a jump
ENDS = 7  # halvings of a piece of the profile in which material begins or ends
END_PIECES, NOSE_PIECES, FLANK_PIECES = 8, 12, 96  # of each stretch of the profile, at most
SIDE = 1e-3  # rad off the sides of the tool, where its surface does not face the feed: the first angle looked at
INSIDE = 1e-2  # of a piece: how far inside the ends of a stretch is looked
SECTORS = PANELS  # of the half turn, for the course of the force over a revolution: each panel looks into its own
MOMENTS = 8
# of a part beside its moments: hull of its angles, mean height along the axis over them, width, highest place, size
PHI_ST, PHI_EX, DEPTH, WIDTH, REACH, SIZE, REST = range(7)
# what is measured at one angle: sums for each exponent, then the engaged length, its height along the axis, where it
# begins and ends along the axis, and its largest radius
LENGTH, HEIGHT, LOWEST, HIGHEST, WIDEST, EXTRA = range(6)


class Ray(NamedTuple):
    """An angle of the cutter: its sine, and the unit vector e(phi) out of the axis, in {W}."""

    sine: float
    x: float
    y: float
    z: float


class Piece(NamedTuple):
    """A piece of the profile: which stretch of it, from where to where along it, m."""

    stretch: int
    start: float
    end: float


class Room(NamedTuple):
    """Room for what is measured (arrays in a tuple count as written, to the compiler).

    exponents (e,), the table of the nose (37, 5), four angles of a panel (4, 3 e + 5), three between two of them, and
    the part being summed: moments and the rest (8 e + 6,) and, of each sector, where it begins and ends along the axis
    (36,), m.
    """

    exponents: Out1
    nose: Out2
    panel: Out2
    between: Out2
    sum: Out1
    spans: Out1


@part
def cuts_at(world: World, step: Step, ray: Ray, at: tuple[float, float, float, float]) -> bool:
    """Whether the cutter cuts at a place of its profile (radius, height, sine, cosine) at the angle of a ray."""
    r, t, sine, cosine = at
    if step.across * ray.sine * sine - step.along * cosine <= FACING:
        return False
    x, y, z = step.x + r * ray.x + t * step.kx, step.y + r * ray.y + t * step.ky, step.z + r * ray.z + t * step.kz
    return is_solid(world, (x, y, z), step.run)


@part
def add_edge(room: Room, row: FloatArray, facing: float, at: tuple[float, float], length: float) -> None:
    """Add a length of edge that faces the feed by so much, whose normal leans (sine, cosine), to the sums."""
    for n in range(len(room.exponents)):
        e = room.exponents[n]
        load = length * (1.0 if e == 0.0 else facing if e == 1.0 else max(facing, 0.0) ** e)
        row[3 * n] += load
        row[3 * n + 1] += load * at[0]
        row[3 * n + 2] += load * at[1]


@part
def add_extent(row: FloatArray, a: tuple[float, float], b: tuple[float, float], length: float) -> None:
    """Add an engaged piece from (radius, height) a to b to what is known of the extent; ``row`` from there on."""
    row[LENGTH] += length
    row[HEIGHT] += b[1] - a[1]
    row[LOWEST] = min(row[LOWEST], a[1])
    row[HIGHEST] = max(row[HIGHEST], b[1])
    row[WIDEST] = max(row[WIDEST], max(a[0], b[0]))


@part
def add_stretch(room: Room, row: FloatArray, shape: Shape, step: Step, ray: Ray, piece: Piece) -> None:
    """Add an engaged piece of the profile to what is measured at one angle, by Gauss' rule."""
    a, b = piece.start, piece.end
    if b <= a:
        return
    for node in range(2):
        s = a + (GAUSS if node == 0 else 1.0 - GAUSS) * (b - a)
        _, _, sine, cosine = on_profile(shape, piece.stretch, s)
        facing = step.across * ray.sine * sine - step.along * cosine
        add_edge(room, row, facing, (sine, cosine), 0.5 * (b - a))
    r_a, t_a, _, _ = on_profile(shape, piece.stretch, a)
    r_b, t_b, _, _ = on_profile(shape, piece.stretch, b)
    add_extent(row[3 * len(room.exponents) :], (r_a, t_a), (r_b, t_b), b - a)


@part
def add_whole(room: Room, row: FloatArray, step: Step, ray: Ray, first: int) -> None:
    """Add a whole piece of the nose: rows of the table from its beginning on (its nodes, its end)."""
    table, length = room.nose, room.nose[first + 3, 4] - room.nose[first, 4]
    for n in range(first + 1, first + 3):
        facing = step.across * ray.sine * table[n, 2] - step.along * table[n, 3]
        add_edge(room, row, facing, (table[n, 2], table[n, 3]), 0.5 * length)
    a, b = (table[first, 0], table[first, 1]), (table[first + 3, 0], table[first + 3, 1])
    add_extent(row[3 * len(room.exponents) :], a, b, length)


@part
def lay_out_nose(room: Room, shape: Shape, step: Step, world: World) -> None:
    """The table of the nose for one step: radius, height, sine, cosine and place of every piece's beginning and two
    nodes, and the last one's end."""
    start, end = stretch_ends(shape, NOSE, reach_of(shape, step, world))
    width = (end - start) / NOSE_PIECES
    for n in range(3 * NOSE_PIECES + 1):
        within = 0.0 if n % 3 == 0 else GAUSS if n % 3 == 1 else 1.0 - GAUSS
        s = start + (n // 3 + within) * width
        r, t, sine, cosine = on_profile(shape, NOSE, s)
        room.nose[n, 0], room.nose[n, 1], room.nose[n, 2], room.nose[n, 3], room.nose[n, 4] = r, t, sine, cosine, s


@part
def reach_of(shape: Shape, step: Step, world: World) -> float:
    """How far up the axis material may stand, m above the tip."""
    return (world.block.z_high - step.z + shape.R * math.hypot(step.kx, step.ky)) / step.kz


@called
def measure(room: Room, row: FloatArray, world: World, shape: Shape, step: Step, phi: float) -> None:
    """What is engaged at one angle, into ``row``."""
    sine, cosine = math.sin(phi), math.cos(phi)
    ray = Ray(
        sine,
        sine * step.fx + cosine * step.lx,
        sine * step.fy + cosine * step.ly,
        sine * step.fz + cosine * step.lz,
    )
    row[:] = 0.0
    row[3 * len(room.exponents) + LOWEST] = math.inf
    plain = world.columns.top.shape[2] == 1 and step.kx == 0.0 and step.ky == 0.0
    for stretch in range(3):
        start, end = stretch_ends(shape, stretch, reach_of(shape, step, world))
        if (
            end <= start
            or (stretch == END and step.along >= -DISH)
            or (stretch == FLANK and sine * step.across <= FACING)
        ):
            continue
        if stretch == FLANK and plain:
            material = top_over(world, step.x + shape.R * ray.x, step.y + shape.R * ray.y)
            low = max(start, world.block.z_low - step.z)
            add_stretch(room, row, shape, step, ray, Piece(FLANK, low, material - step.z))
            continue
        pieces = END_PIECES if stretch == END else NOSE_PIECES
        if stretch == FLANK:
            pieces = int(min(max((end - start) / world.columns.dx, 8.0), 1.0 * FLANK_PIECES))
        measure_stretch(room, row, world, (shape, step, ray), Piece(stretch, start, end), pieces)


@part
def measure_stretch(
    room: Room, row: FloatArray, world: World, seen: tuple[Shape, Step, Ray], whole: Piece, pieces: int
) -> None:
    """What is engaged of a stretch of the profile at one angle, looked for at the ends of so many pieces."""
    shape, step, ray = seen
    width = (whole.end - whole.start) / pieces
    since = False
    for n in range(pieces + 1):
        s = whole.start + n * width
        inside = s + INSIDE * width * (1.0 if n == 0 else -1.0 if n == pieces else 0.0)
        if whole.stretch == NOSE and 0 < n < pieces:
            known = room.nose[3 * n]
            at = (known[0], known[1], known[2], known[3])
        else:
            at = on_profile(shape, whole.stretch, inside)
        low, high, cuts = s - width, s, since
        for halving in range(ENDS + 1):  # first the end of the piece, then, where material begins or ends, that place
            if halving > 0:
                at = on_profile(shape, whole.stretch, 0.5 * (low + high))
            here = cuts_at(world, step, ray, at)
            if halving == 0:
                cuts = here
                if n == 0 or cuts == since:
                    break
            elif here == since:
                low = 0.5 * (low + high)
            else:
                high = 0.5 * (low + high)
        if n > 0 and cuts and since and whole.stretch == NOSE:
            add_whole(room, row, step, ray, 3 * (n - 1))
        elif n > 0 and (cuts or since):
            begin = s - width if since else high
            add_stretch(room, row, shape, step, ray, Piece(whole.stretch, begin, s if cuts else low))
        since = cuts


@part
def add_angle(room: Room, row: FloatArray, phi: float, width: float) -> None:
    """Add what was measured at one angle, for a piece of the turn ``width`` rad wide, to the part."""
    count = len(room.exponents)
    rest, total = row[3 * count :], room.sum[MOMENTS * count :]
    if rest[LENGTH] <= 0.0:
        return
    sine, cosine = math.sin(phi), math.cos(phi)
    for n in range(count):
        plain, upright, lying = width * row[3 * n], width * row[3 * n + 1], width * row[3 * n + 2]
        moments = room.sum[MOMENTS * n : MOMENTS * (n + 1)]
        moments[0] += plain * cosine
        moments[1] += plain * sine
        moments[2] += upright * sine
        moments[3] += upright * cosine
        moments[4] += lying
        moments[5] += lying * sine
        moments[6] += lying * cosine
        moments[7] += upright
    total[SIZE] += rest[LENGTH] * width
    total[REACH] = max(total[REACH], rest[HIGHEST])
    if phi > math.pi:
        return
    total[PHI_ST], total[PHI_EX] = min(total[PHI_ST], phi - 0.5 * width), max(total[PHI_EX], phi + 0.5 * width)
    total[DEPTH] += rest[HEIGHT] * width
    total[WIDTH] += rest[WIDEST] * sine * width
    sector = int(min(phi / math.pi * SECTORS, SECTORS - 1.0))
    room.spans[2 * sector] = min(room.spans[2 * sector], rest[LOWEST])
    room.spans[2 * sector + 1] = max(room.spans[2 * sector + 1], rest[HIGHEST])


@part
def copy(source: FloatArray, to: FloatArray) -> None:
    """Copy numbers."""
    for n in range(source.size):
        to[n] = source[n]


@part
def jumps(a: float, b: float) -> bool:
    """Whether two engaged lengths at neighbouring angles differ by more than what is smooth."""
    return abs(a - b) > JUMP * max(a, b)


@part
def panel_end(n: int) -> float:
    """Where the n-th panel of the turn begins, rad; finer towards the sides of the tool."""
    return math.pi * (n // PANELS + 0.5 - 0.5 * math.cos(math.pi * (n % PANELS) / PANELS))


@part
def add_panel(room: Room, world: World, shape: Shape, step: Step, panel: int) -> None:
    """Add the engaged part of the n-th panel of the turn. Its last angle is the first of the next."""
    start, end = panel_end(panel), panel_end(panel + 1)
    at, length = 3 * len(room.exponents) + LENGTH, end - start
    first, second = start + GAUSS * length, end - GAUSS * length
    fresh, last = panel % PANELS == 0, panel % PANELS == PANELS - 1
    rough = False
    copy(room.panel[3], room.panel[0])
    for n in range(0 if fresh else 1, 4):
        phi = first if n == 1 else second
        if n == 0:
            phi = start + SIDE
        if n == 3:
            phi = end - SIDE if last else end
        measure(room, room.panel[n], world, shape, step, phi)
        rough = rough or (n > 0 and jumps(room.panel[n, at], room.panel[n - 1, at]))
    if not rough:
        add_angle(room, room.panel[1], first, 0.5 * length)
        add_angle(room, room.panel[2], second, 0.5 * length)
        return
    for n in range(3):
        a = start if n == 0 else first if n == 1 else second
        b = first if n == 0 else second if n == 1 else end
        follow_jump(room, world, shape, step, (n, a, b))


@part
def follow_jump(room: Room, world: World, shape: Shape, step: Step, between: tuple[int, float, float]) -> None:
    """Add what lies between two measured angles (row of the first, from, to), halving where the length jumps."""
    n, a, b = between
    at = 3 * len(room.exponents) + LENGTH
    left, right, middle = room.between[0], room.between[1], room.between[2]
    copy(room.panel[n], left)
    copy(room.panel[n + 1], right)
    halvings = 0
    while halvings < HALVINGS and jumps(left[at], right[at]):
        halvings += 1
        phi, quarter = 0.5 * (a + b), 0.25 * (b - a)
        measure(room, middle, world, shape, step, phi)
        if abs(middle[at] - left[at]) < abs(middle[at] - right[at]):
            add_angle(room, left, a + 0.5 * quarter, quarter)
            add_angle(room, middle, phi - 0.5 * quarter, quarter)
            copy(middle, left)
            a = phi
        else:
            add_angle(room, middle, phi + 0.5 * quarter, quarter)
            add_angle(room, right, b - 0.5 * quarter, quarter)
            copy(middle, right)
            b = phi
    quarter = 0.25 * (b - a)
    add_angle(room, left, a + quarter, 2.0 * quarter)
    add_angle(room, right, b - quarter, 2.0 * quarter)


@part
def add_part(room: Room, world: World, shape: Shape, step: Step) -> None:
    """The engaged part of one step, into ``room.sum`` and ``room.spans``."""
    rest = room.sum[MOMENTS * len(room.exponents) :]
    room.sum[:] = 0.0
    rest[PHI_ST], rest[PHI_EX] = math.inf, -math.inf
    room.spans[0::2] = math.inf
    room.spans[1::2] = -math.inf
    lay_out_nose(room, shape, step, world)
    for n in range(PANELS * (2 if step.along < -FACING else 1)):
        add_panel(room, world, shape, step, n)
    if rest[PHI_EX] < rest[PHI_ST]:
        rest[PHI_ST] = rest[PHI_EX] = 0.0
        return
    rest[PHI_ST], rest[PHI_EX] = max(rest[PHI_ST], 0.0), min(rest[PHI_EX], math.pi)
    rest[DEPTH] /= rest[PHI_EX] - rest[PHI_ST]
