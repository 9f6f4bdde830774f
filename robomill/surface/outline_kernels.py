"""Where the walls and floors that a path leaves stand, asked at single places, exactly and without a grid; compiled.

At a place of the path (tip c, tool axis k, direction u across it) the tracks of all moves near are looked at in the
plane across k at a height h above c. Each straight move covers a capsule there; along the line c + w u the union of
the capsules around the tool ends at the wall. Along k through c + offset u the lowest track is the floor. Moves whose
axis differs from k are taken as if they had it.
"""

from __future__ import annotations

import math
from typing import NamedTuple

from robomill.compiled import In1, In2, Out1, Out2, OutInt1, kernel, part
from robomill.cutting.profile_kernels import clip, radius_at, shape_of
from robomill.surface.contact.block_kernels import NOTHING, Blocks, depth_in, seen_box, span
from robomill.surface.envelope_kernels import Move, move_between, nearest, swept_height, swept_upright

ROUNDS = 6  # of growing the union along a line: a wall seldom stands behind more than two tracks
TOUCH = 1e-7  # m: tracks this close are one
LEVEL = 1e-15  # m: less is no motion


class Tracks(NamedTuple):
    """Moves sorted by the square of the plan they were told to lie in: ends (n, 6) m, shapes (t, 5) of the cutters and
    which of them each move has (n,), the first move of each square (nx ny + 1,), and the squares: corner, size m, how
    many each way.
    """

    ends: Out2
    shapes: Out2
    cutter: OutInt1
    first: OutInt1
    corner: Out1
    size: float
    squares: OutInt1


class Seen(NamedTuple):
    """A move seen from a place: start and span along u, across it (v) and along the tool axis, m."""

    u: float
    v: float
    z: float
    du: float
    dv: float
    dz: float


@part
def seen_from(place: In1, ends: In1) -> Seen:
    """A move in the axes of a place (c, k, u, ...)."""
    cx, cy, cz, kx, ky, kz, ux, uy, uz = (
        place[0],
        place[1],
        place[2],
        place[3],
        place[4],
        place[5],
        place[6],
        place[7],
        place[8],
    )
    vx, vy, vz = ky * uz - kz * uy, kz * ux - kx * uz, kx * uy - ky * ux
    ax, ay, az = ends[0] - cx, ends[1] - cy, ends[2] - cz
    bx, by, bz = ends[3] - ends[0], ends[4] - ends[1], ends[5] - ends[2]
    return Seen(
        ax * ux + ay * uy + az * uz,
        ax * vx + ay * vy + az * vz,
        ax * kx + ay * ky + az * kz,
        bx * ux + by * uy + bz * uz,
        bx * vx + by * vy + bz * vz,
        bx * kx + by * ky + bz * kz,
    )


@part
def furthest(move: Seen, rho: float, way: float) -> float:
    """End of a capsule of radius rho on the line v = 0, furthest in the sense ``way`` (+1, -1) of u; NaN if missed.

    It is the largest of u(t) + sqrt(rho^2 - v(t)^2) over the move, a concave function of t.
    """
    du, dv = way * move.du, move.dv
    length = math.hypot(du, dv)
    if length < LEVEL or abs(dv) < 1e-12 * length:
        if abs(move.v) > rho:
            return math.nan
        return way * (way * move.u + max(du, 0.0) + math.sqrt(rho * rho - move.v * move.v))
    low, high = (-rho - move.v) / dv, (rho - move.v) / dv
    if low > high:
        low, high = high, low
    low, high = max(low, 0.0), min(high, 1.0)
    if low > high:
        return math.nan
    t = clip((math.copysign(rho * du / length, du * dv) - move.v) / dv, low, high)
    v = move.v + t * dv
    return way * (way * move.u + t * du + math.sqrt(max(rho * rho - v * v, 0.0)))


@part
def squares_near(tracks: Tracks, x: float, y: float) -> tuple[int, int, int, int]:
    """(first, end) of the rows and columns of squares around a point."""
    i = math.floor((x - tracks.corner[0]) / tracks.size)
    j = math.floor((y - tracks.corner[1]) / tracks.size)
    return max(i - 1, 0), min(i + 2, tracks.squares[0]), max(j - 1, 0), min(j + 2, tracks.squares[1])


@part
def below(tracks: Tracks, n: int, place: In1, height: float) -> bool:
    """Whether the middle of a move runs lower than ``height`` above the tip."""
    move = seen_from(place, tracks.ends[n])
    return move.z + 0.5 * move.dz < height


@part
def furthest_block(tracks: Tracks, blocks: Blocks, boxes: Out2, place: In1) -> int:
    """The block which, of those over a place (11,) within the tool's own track, may reach furthest; -1 for none."""
    i0, i1, j0, j1 = squares_near(tracks, place[0], place[1])
    furthest_b, furthest_to = -1, -math.inf
    for i in range(i0, i1):
        row = i * tracks.squares[1]
        for b in range(blocks.of_square[row + j0], blocks.of_square[row + j1]):
            box = seen_box(place, boxes[b])
            start, to = span(box)
            if start <= place[10] and to > furthest_to and box.low < place[9]:
                furthest_b, furthest_to = b, to
    return furthest_b


@part
def wall_at(tracks: Tracks, other: Tracks, blocks: Blocks, boxes: Out2, place: In1) -> float:
    """How far out along u the tracks around the tool reach at a height above its tip, m, of the moves that run below
    that height in ``other`` too; NaN where none is. ``place`` (11,) is c, k, u, the height, and a point within the
    tool's own track."""
    height, out, found = place[9], place[10], False
    i0, i1, j0, j1 = squares_near(tracks, place[0], place[1])
    likely = furthest_block(tracks, blocks, boxes, place)
    for turn in range(ROUNDS + 1):  # the likeliest block alone, then all that may reach further
        grown = False
        for i in range(i0, i1):
            row = i * tracks.squares[1]
            for b in range(blocks.of_square[row + j0], blocks.of_square[row + j1]):
                if turn == 0 and b != likely:
                    continue
                box = seen_box(place, boxes[b])
                start, to = span(box)
                if to <= out + NOTHING or start > out + TOUCH or box.low >= height:
                    continue
                for n in range(blocks.first[b], blocks.first[b + 1]):
                    if not (below(tracks, n, place, height) and below(other, n, place, height)):
                        continue
                    move = seen_from(place, tracks.ends[n])
                    rho = radius_at(shape_of(tracks.shapes[tracks.cutter[n]]), height - (move.z + 0.5 * move.dz))
                    end = furthest(move, rho, 1.0)
                    if end > out and furthest(move, rho, -1.0) <= out + TOUCH:
                        out, grown, found = end, True, True
        if turn > 0 and not grown:
            break
    return out if found else math.nan


@part
def inside(tracks: Tracks, n: int, place: In1, out: float) -> tuple[float, bool]:
    """How far (m) the point ``out`` along u is inside of a move's track, at the height of a place (11,), < 0 outside;
    and whether the track comes from behind it."""
    seen = seen_from(place, tracks.ends[n])
    move = move_between(seen.u, seen.v, 0.0, seen.u + seen.du, seen.v + seen.dv, 0.0)
    ex, ey = nearest(move, out, 0.0)
    shape = shape_of(tracks.shapes[tracks.cutter[n]])
    return radius_at(shape, place[9] - (seen.z + 0.5 * seen.dz)) - math.hypot(ex, ey), ex > 0.0


@part
def carried(tracks: tuple[Tracks, Tracks], blocks: Blocks, place: In1, out: float, deep: bool) -> float:
    """How far (m) the wall that was told ``out`` along u has been carried. Where it is cut too ``deep``: that track
    which is deepest over it in the end; else how far it still is to the next track on this side of it, < 0. ``tracks``
    as told and as left."""
    told, left = tracks
    i0, i1, j0, j1 = squares_near(told, place[0], place[1])
    likely, likely_depth, least = -1, -math.inf, -math.inf
    for i in range(i0, i1):
        row = i * told.squares[1]
        for b in range(blocks.of_square[row + j0], blocks.of_square[row + j1]):
            depth = depth_in(seen_box(place, blocks.left[b]), out)
            if depth > likely_depth:
                likely, likely_depth = b, depth
    deepest, found = -math.inf, 0.0
    for turn in range(2):  # how deep the likeliest block is, then the first of all moves that is deepest
        deepest = -math.inf
        for i in range(i0, i1):
            row = i * told.squares[1]
            for b in range(blocks.of_square[row + j0], blocks.of_square[row + j1]):
                if turn == 0 and b != likely:
                    continue
                if depth_in(seen_box(place, blocks.left[b]), out) + NOTHING < max(least, deepest):
                    continue
                for n in range(blocks.first[b], blocks.first[b + 1]):
                    if below(told, n, place, place[9]) and below(left, n, place, place[9]):
                        depth, behind = inside(left, n, place, out)
                        if depth > deepest and (deep or behind):
                            deepest, found = depth, depth - inside(told, n, place, out)[0]
        least = deepest
    return found if deep else deepest


class Floor(NamedTuple):
    """Heights of the lowest track over a point, m (inf: none): as told, as left, and both again of the moves alone that
    pass over the point in both; and the upward part of the normal of the surface that was told."""

    told: float
    left: float
    told_both: float
    left_both: float
    upright: float


@part
def move_seen(seen: Seen) -> Move:
    """A move as an upright cutter makes it in the axes of a place."""
    return move_between(seen.u, seen.v, seen.z, seen.u + seen.du, seen.v + seen.dv, seen.z + seen.dz)


@part
def track_over(tracks: Tracks, n: int, place: In1, offset: float) -> float:
    """Height of a move above the tip at c + offset u; inf if it does not pass over the point."""
    seen, shape = seen_from(place, tracks.ends[n]), shape_of(tracks.shapes[tracks.cutter[n]])
    move = move_seen(seen)
    ex, ey = nearest(move, offset, 0.0)
    return swept_height(shape, move, offset, 0.0) if math.hypot(ex, ey) <= shape.R else math.inf


@part
def upright_at(told: Tracks, blocks: Blocks, place: In1, offset: float, low: float) -> float:
    """Upward part of the normal of the surface told at c + offset u, at the height ``low`` of its lowest track, m."""
    i0, i1, j0, j1 = squares_near(told, place[0], place[1])
    for i in range(i0, i1):
        row = i * told.squares[1]
        for b in range(blocks.of_square[row + j0], blocks.of_square[row + j1]):
            box = seen_box(place, blocks.told[b])
            if box.low > low + NOTHING or depth_in(box, offset) < -NOTHING:
                continue
            for n in range(blocks.first[b], blocks.first[b + 1]):
                if track_over(told, n, place, offset) <= low < math.inf:
                    seen, shape = seen_from(place, told.ends[n]), shape_of(told.shapes[told.cutter[n]])
                    return swept_upright(shape, move_seen(seen), offset, 0.0)
    return 1.0


@part
def floor_at(told: Tracks, left: Tracks, blocks: Blocks, place: In1, offset: float) -> Floor:
    """The floor at c + offset u; both tracks hold the same moves in the same order."""
    i0, i1, j0, j1 = squares_near(told, place[0], place[1])
    told_low, left_low, told_both, left_both = math.inf, math.inf, math.inf, math.inf
    likely, likely_low = -1, math.inf
    for turn in range(3):  # the likeliest block is looked for, is looked at, then all that may lie lower
        for i in range(i0, i1):
            row = i * told.squares[1]
            for b in range(blocks.of_square[row + j0], blocks.of_square[row + j1]):
                if turn == 1 and b != likely:
                    continue
                one, other = seen_box(place, blocks.told[b]), seen_box(place, blocks.left[b])
                over, moved_over = depth_in(one, offset) >= -NOTHING, depth_in(other, offset) >= -NOTHING
                if turn == 0:
                    if over and moved_over and other.low < likely_low:
                        likely, likely_low = b, other.low
                    continue
                if not (over or moved_over):
                    continue
                if one.low >= told_both - NOTHING and other.low >= left_both - NOTHING:
                    continue
                for n in range(blocks.first[b], blocks.first[b + 1]):
                    high, moved = track_over(told, n, place, offset), track_over(left, n, place, offset)
                    told_low, left_low = min(told_low, high), min(left_low, moved)
                    if high < math.inf and moved < math.inf:
                        told_both, left_both = min(told_both, high), min(left_both, moved)
    return Floor(told_low, left_low, told_both, left_both, upright_at(told, blocks, place, offset, told_low))


@kernel
def walls_left(told: Tracks, left: Tracks, blocks: Blocks, places: In2, result: Out2) -> None:
    """result (q, 4): how far out along u (m) the wall stands from the tip, at places (q, 11), see ``wall_at``: as told,
    and as told and as left by the moves alone that run below the height in both; and how far it was ``carried``."""
    for q in range(len(places)):
        place = places[q]
        result[q, 0] = wall_at(told, told, blocks, blocks.told, place)
        result[q, 1] = wall_at(told, left, blocks, blocks.told, place)
        result[q, 2] = wall_at(left, told, blocks, blocks.left, place)
        error = result[q, 2] - result[q, 0]
        known = abs(error) > TOUCH
        result[q, 3] = carried((told, left), blocks, place, result[q, 0], error > 0.0) if known else error


@kernel
def floors_left(told: Tracks, left: Tracks, blocks: Blocks, places: In2, result: Out2) -> None:
    """result (q, 5): the ``Floor`` at places (q, 10): c, k, u and the offset along u."""
    for q in range(len(places)):
        floor = floor_at(told, left, blocks, places[q], places[q, 9])
        result[q, 0], result[q, 1], result[q, 2] = floor.told, floor.left, floor.told_both
        result[q, 3], result[q, 4] = floor.left_both, floor.upright
