"""A turn of the cutter divided into pieces that are smooth, and what they add up to: the part of a step, compiled.

Over the angle Gauss' rule of two points, in panels finer towards the sides; where the engaged length jumps from one
angle to the next, the jump is followed by halving. Ribs and gaps of material that pass between the angles have angles
of their own.
"""

from __future__ import annotations

import math

from robomill.arrays import FloatArray
from robomill.compiled import part
from robomill.cutting.edge import MOMENTS, moments
from robomill.cutting.engaged import FACING, PANELS
from robomill.cutting.profile_kernels import Shape
from robomill.surface.contact.engagement_kernels import (
    FACE,
    HEIGHT,
    HIGHEST,
    LENGTH,
    LOWEST,
    SUMS,
    UNSEEN,
    WIDEST,
    Room,
    lay_out,
    measure,
)
from robomill.surface.contact.material_kernels import World
from robomill.surface.contact.rib_kernels import Walk, aim_at_changes, alternates, fine_pitch, look_about, walk_on
from robomill.surface.contact.step_kernels import Step, ask_for_rim, rim_turns
from robomill.surface.contact.turn_kernels import (
    ANGLES,
    COSINE,
    HALF,
    HIDDEN,
    PHI,
    SINE,
    aim,
    gap_end,
    jumps,
    panel_end,
)

HALVINGS = 8  # of the angle across which the engaged length jumps
# of a part beside its moments: hull of its angles, mean height along the axis over them, width, highest place, size and
# how many gaps between layers of material were closed before
PHI_ST, PHI_EX, DEPTH, WIDTH, REACH, SIZE, LOST, REST = range(8)
RIB_STEP = 0.04  # rad: from angle to angle where there are ribs
GAPS = 6 * PANELS + HIDDEN
ROWS = 2 * ANGLES + HIDDEN + GAPS * HALVINGS  # angles looked at in a turn, at most


@part
def note(pieces: FloatArray, count: int, row: float, middle: float, width: float, sector: float) -> int:
    """Note a piece of the turn at which a row was measured; returns how many there are then."""
    piece = pieces[count]
    piece[0], piece[1], piece[2], piece[3] = row, middle, width, sector
    return count + 1


@part
def divide(room: Room, world: World, shape: Shape, step: Step, angles: tuple[int, int]) -> tuple[int, int, int]:
    """Divide the turn into pieces that are smooth and gaps across which the engaged length jumps: how many of both, and
    how many rows of angles there are. ``angles``: how many gaps between the angles of the turn, and how many more
    angles were measured between for ribs and gaps of material that its panels pass over."""
    rows, (every, hidden), count, gaps = room.rows, angles, 0, 0
    between, last = 2 * ANGLES, 2 * ANGLES + hidden
    for panel in range(every // 3):
        begun, start, end = gaps, panel_end(panel), panel_end(panel + 1)
        first, rough = gap_end(3 * panel) - 1, room.fine[0] > 0.0
        for n in range(3):
            left, right = first + n, first + n + 1
            a = start if n == 0 else rows[left, PHI]
            b = end if n == 2 else rows[right, PHI]
            while between < last and rows[between, PHI] < rows[right, PHI]:
                phi = rows[between, PHI]
                rough = rough or jumps(rows[left, LENGTH], rows[between, LENGTH])
                gaps = note_gap(room, gaps, (left, between), (a, phi), (panel, start, end))
                left, a, between = between, phi, between + 1
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
    return count, gaps, last


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
def follow_jumps(room: Room, world: World, shape: Shape, step: Step, counts: tuple[int, int, int]) -> int:
    """Halve the gaps between angles while the engaged length jumps across them; returns how many pieces there are.
    ``counts``: of pieces, gaps and rows so far."""
    rows, (count, gaps, first) = room.rows, counts
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
    """Add pieces of the turn to the part, ``total`` (8 e + 7,), and to its sectors."""
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
def look_round(room: Room, world: World, shape: Shape, step: Step, halves: int) -> tuple[int, int]:
    """Measure the angles of the turn, and those between at which ribs or gaps of material are passed over, more finely
    along the profile where there are any: how many gaps between the angles of the turn, and how many more angles."""
    ask_for_rim(world.dexels, step, shape.R, halves)
    rows, every, hidden = room.rows, HALF * halves, 0
    walk = walk_on(world, shape, step, room.stretches, room.circles)
    room.fine[0] = 0.0
    if walk.used > 0:
        look_about(world, step, walk, rows, halves)
        hidden = aim_at_changes(world, step, walk, rows, every, HIDDEN if walk.plain else 1)
        if not walk.plain and (hidden > 0 or alternates(world, step, walk, rows, ANGLES * halves)):
            room.fine[0] = fine_pitch(world)
            walk = Walk(walk.circles, walk.used, walk.coarse, walk.fine, walk.plain, RIB_STEP, walk.rim)
            hidden = aim_at_changes(world, step, walk, rows, every, HIDDEN)
    measure(room, world, shape, step, 0, ANGLES * halves)
    if hidden > 0:
        measure(room, world, shape, step, 2 * ANGLES, 2 * ANGLES + hidden)
    return every, hidden


@part
def add_part(room: Room, world: World, shape: Shape, step: Step, total: FloatArray, sectors: FloatArray) -> None:
    """The engaged part of one step, into ``total`` (8 e + 7,) and ``sectors`` (4 s,), see ``EngagedPart``."""
    rest = total[MOMENTS * len(room.exponents) :]
    total[:] = 0.0
    rest[PHI_ST], rest[PHI_EX], rest[LOST] = math.inf, -math.inf, world.dexels.lost[0]
    room.sectors[:] = 0.0
    lay_out(room, shape, step, world)
    halves = 2 if step.along < -FACING or rim_turns(step, shape.R) else 1
    angles = look_round(room, world, shape, step, halves)
    count = follow_jumps(room, world, shape, step, divide(room, world, shape, step, angles))
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
