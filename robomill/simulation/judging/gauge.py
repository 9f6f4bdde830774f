"""What a gauge would read on the part: how far its walls, floors and ends stand from where they were commanded.

The deviation of the tip shows where the tool leaves a surface: beside it where material stays, under it where nothing
cuts deeper. So each sample of a run is asked for its walls (to the left and right of the feed; all around in a plunge;
ahead and behind too where the path turns), and for its floor, and every one is measured on the surface that is left in
the end, by all passes that come by: what a later pass removes is not on the part. Where a cut begins or ends in the
material the wall across its end is moved by the deviation along the feed; that is its own quantity (``ends``).
"""

from __future__ import annotations

from dataclasses import dataclass, field, fields, replace

import numpy as np

from robomill.arrays import BoolArray, FloatArray, IntArray, frozen
from robomill.simulation.judging.leaning import lies
from robomill.simulation.judging.places import Places, places
from robomill.simulation.judging.seen import Run, share_out
from robomill.surface.outline import SAME, Walls
from robomill.values import ReadOnly

CORNER = np.radians(45.0)
TURNS = np.radians(5.0)  # where the path turns more, walls ahead and behind are looked for too
AROUND = np.radians(np.arange(0.0, 360.0, 22.5))
LOOK = np.radians(np.arange(0.0, 360.0, 10.0))  # for anything that stands
ACROSS = (0.0, -0.3, 0.3, -0.6, 0.6)  # of the flat radius: where a floor is looked for,
RIM = 0.98  # and at this share of what the tool cuts flat although it goes aside: a ledge beside a wall is narrow
HEIGHTS = (0.05, 0.9)  # of the depth, above the nose: where a wall is measured
ON_NOSE = 0.95  # of the depth, where the nose alone cuts
BESIDE = 20e-6  # m: material this far beyond the rim makes a wall, and bears its mark
ON_NOSES = (0.02, 0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7)  # of the way from the flat end to the rim
LEVEL = 1.4e-3  # how far a path may rise on its way that counts as level
CROWN = 0.5  # how steep across the feed a floor may be that the heel of a sinking or rising end has rounded
BESIDE_ROOT = (1.0, 1.25, 1.5, 1.75, 2.0)  # of how far a groove has gone aside: where nobody may cut below its root
SLENDER = 0.125  # of its height: a wall as thin gives way to a cutter as the arm does
ALIKE = 2e-6  # m: readings, and deviations, that differ by less are one


@dataclass(frozen=True, eq=False)
class Readings(ReadOnly):
    """Places on the part: samples (q,) of the path that made them, signed errors (q,) m, lengths (q,) m along the path
    and heights (q,) m of the walls from the tip up (of floors the cutter's width). Walls: left of the feed +; floors:
    up +; ends: along the feed +. ``own`` (q,) m is the deviation of the sample itself: where several passes come by,
    one of them has made the surface. ``way`` (q, 3) is how far the error goes with the tip there, by feed, feed-normal
    and axial deviation.
    ``place`` (q, 3) m in {W} is where on the commanded surface the gauge was put, ``out`` (q, 3) the unit vector from
    the tool into the part there, and ``side`` (q,) is -1 where a positive error goes that way, else 1.
    """

    sample: IntArray
    error: FloatArray
    length: FloatArray
    height: FloatArray
    own: FloatArray
    way: FloatArray
    place: FloatArray
    out: FloatArray
    side: FloatArray

    @property
    def material_left(self) -> FloatArray:
        """(q,) m normal to the surface: + where material was left, - where too much went."""
        return frozen(self.error * self.side)

    @property
    def worst(self) -> int:
        """Which is largest, -1 where there is none; among equals the one whose sample is off by as much itself."""
        if not len(self.error):
            return -1
        size = np.abs(self.error)
        equal = np.flatnonzero(size >= size.max() - ALIKE)
        return int(equal[np.argmin(np.abs(self.error - self.own)[equal] + (size.max() - size[equal]))])

    def share_out(self, tolerance: float) -> float:
        """Share of the length that is out of ``tolerance`` (m): 0 where nothing is, and never 0 where something is,
        however short."""
        return share_out(self.error, self.length, tolerance)


@dataclass(frozen=True, eq=False)
class Gauge(ReadOnly):
    """All that a gauge would find on the part; samples (g,) beside which a wall should stand and does not, and samples
    (t,) beside which one is so ``thin`` that it gives way to the cut."""

    walls: Readings
    floors: Readings
    ends: Readings
    gone: IntArray = field(default_factory=lambda: np.zeros(0, dtype=np.int64))
    thin: IntArray = field(default_factory=lambda: np.zeros(0, dtype=np.int64))


def gauge(result: Run, most: int | None = None) -> Gauge:
    """Everything that can be measured on the part that a run leaves, at so ``most`` of its samples; nothing where a
    tool that lies leaves no surface to be read from above."""
    if lies(result.path).any() or not (result.judged.any() and result.removes.any()):
        none = np.zeros(0)
        rows = np.zeros((0, 3))
        nothing = Readings(none.astype(np.int64), none, none, none, none, rows, rows, rows, none)
        return Gauge(nothing, nothing, nothing)
    at = places(result, most)
    walls, gone, thin = _walls(at)
    return Gauge(walls, _floors(at), _ends(at), gone, thin)


@dataclass(frozen=True, eq=False)
class Rims:
    """Points of tools' rims where material stood beside them: at places q (m,), in direction u (m, 3), ``sign`` (m,) of
    what lies outwards, ``length`` (m,) m of wall; measured at a ``height`` (m,) above the tip where the tool has a
    ``radius`` (m,), on a wall ``deep`` (m,) m.
    """

    q: IntArray
    u: FloatArray
    sign: FloatArray
    length: FloatArray
    height: FloatArray
    radius: FloatArray
    deep: FloatArray

    def only(self, keep: BoolArray) -> Rims:
        """Some of them."""
        return Rims(*(getattr(self, each.name)[keep] for each in fields(self)))


def _rims(at: Places, q: IntArray, u: FloatArray, sign: FloatArray, length: FloatArray) -> Rims:
    """Every rim at each of ``HEIGHTS``, which share its length."""
    share = np.repeat(HEIGHTS, len(q))
    q, u, sign = np.tile(q, len(HEIGHTS)), np.tile(u, (len(HEIGHTS), 1)), np.tile(sign, len(HEIGHTS))
    length = np.tile(length, len(HEIGHTS)) / len(HEIGHTS)
    deep = _deep(at, q, u)
    low = np.maximum(at.number("nose_height")[q], at.below[q])
    height = np.where(deep > low, low + share * (deep - low), ON_NOSE * deep)
    return _at_height(at, Rims(q, u, sign, length, height, at.radius_at(q, height), deep))


def _on_fillets(at: Places, q: IntArray, u: FloatArray, sign: FloatArray) -> Rims:
    """Beneath rims: round noses at the height at which their surface faces the way that the tip is off, out and down
    or in and up, and so is off further than wall and floor; cones half-way up, where others may have cut their rim."""
    out = at.d[q, 0] * _dot(u, at.feed[q]) + at.d[q, 1] * _dot(u, at.left_of[q])
    faces = np.arctan2(np.abs(out), np.abs(at.d[q, 2]))
    deep, cone = _deep(at, q, u), (at.number("conical") > 0)[q]
    height = np.where(cone, 0.5 * np.minimum(deep, at.number("nose_height")[q]), _round(at, q) * (1.0 - np.cos(faces)))
    rims = Rims(q, u, sign, np.zeros(len(q)), height, at.radius_at(q, height), deep)
    some = np.where(cone, ~at.steep[q], out * at.d[q, 2] < 0.0)
    return _at_height(at, rims.only(some & (height > at.below[q] + SAME) & (height < deep)))


def _round(at: Places, q: IntArray) -> FloatArray:
    """(m,) m: radii of the round noses at places q; 0 of cones and flat ends."""
    return np.asarray(np.where(at.number("conical") > 0, 0.0, at.number("nose_height"))[q])


def _normal(at: Places, rims: Rims, error: FloatArray, upright: FloatArray) -> FloatArray:
    """(m,) m: how far what stands ``error`` (m,) m further out at the height of a rim is from the side that was told,
    normal to it: of a round nose from the middle of its arc."""
    rho, out = _round(at, rims.q), rims.radius - at.number("flat_radius")[rims.q] + error
    return np.where(rims.height < rho, np.hypot(out, rho - rims.height) - rho, error * upright)


def _deep(at: Places, q: IntArray, u: FloatArray) -> FloatArray:
    """(m,) m: how high the stock stood above the tip beside the tools at places q, in directions u (m, 3)."""
    return at.depth(q, at.c[q] + (at.number("radius")[q] + BESIDE)[:, None] * u)


def _at_height(at: Places, rims: Rims) -> Rims:
    """Those with material at their height, each on a wall from the bottom of the stock on."""
    below = at.below[rims.q]
    stands = at.stands(rims.q, at.c[rims.q] + (rims.radius + BESIDE)[:, None] * rims.u, rims.height)
    return replace(rims, deep=rims.deep - below).only((rims.deep > below + SAME) & stands)


def _standing(at: Places, rims: Rims) -> Walls:
    """The walls that stand beyond rims; infinitely far where none was told."""
    found = at.outline.walls(np.hstack([at.c[rims.q], at.axial[rims.q], rims.u]), rims.height, rims.radius)
    return found._replace(told=np.nan_to_num(found.told, nan=np.inf))


def _walls(at: Places) -> tuple[Readings, IntArray, IntArray]:
    """Walls at every place and direction where material stands beside the tool in the end; samples beside which one
    should stand and does not, and beside which it is thin."""
    steep, (begin, end), turn = at.steep, at.begins_or_ends, at.turn
    rims = _directions(at, (turn > TURNS) & ~begin & ~end | steep)
    told, left, one, carried = _standing(at, rims)
    # Chords of an arc overlap on its inner side by no more than this.
    gentle = (rims.length > 0.0) & (turn[rims.q] < CORNER) & ~steep[rims.q]
    same = SAME + np.where(gentle, rims.radius * (1.0 - np.cos(turn[rims.q])), 0.0) + _leads(at, rims)
    # A tool lifted above the height at which a wall is measured leaves metal over its whole width: the floor's error.
    keep = (told <= same) & (at.d[rims.q, 2] < rims.height) & (one | np.isnan(left))
    rims, told, left, carried = rims.only(keep), told[keep], left[keep], carried[keep]
    q = rims.q
    ahead, aside = _dot(rims.u, at.feed[q]), _dot(rims.u, at.left_of[q])
    upright = at.upright(q, rims.height)
    slanting = np.sqrt(1.0 - upright**2)
    lean = np.where(steep & ~at.bottoms, at.across / np.where(steep, at.along, 1.0), 0.0)
    level_d = at.d[:, 0] - at.d[:, 2] * lean  # what a steep move is off along itself moves no wall
    own = level_d[q] * ahead + at.d[q, 1] * aside - at.d[q, 2] * slanting / upright
    # Beside a corner one looks along the wall of another pass: it is off by what that one has carried it, no more.
    carried = np.where(left > told, np.maximum(np.maximum(carried, own), 0.0), carried)
    error = np.where(np.abs(carried) < np.abs(left - told), carried, left - told)
    error = np.where(np.isnan(left) | steep[q] | begin[q] | end[q], own, error)
    level, up = np.hypot(level_d, at.d[:, 1]).max(), np.abs(at.d[:, 2]).max()
    most = level * upright + up * slanting  # no wall moves further
    error = np.clip(_normal(at, rims, error, upright), -most, most)
    reached = at.c[q] + (rims.radius + np.nan_to_num(left) + BESIDE)[:, None] * rims.u
    lost = _nothing_stands(at, rims, (left - told > most + SAME) | ~at.stands(q, reached, rims.height))
    axial = -slanting - lean[q] * ahead * upright
    way = rims.sign[:, None] * np.column_stack([ahead * upright, aside * upright, axial])
    own = own * upright * rims.sign
    where = (_place(at, rims), rims.u, -rims.sign)
    readings = Readings(at.i[q], error * rims.sign, rims.length, rims.deep, own, at.in_cut(q, way), *where)
    along = rims.only(rims.length > 0.0)
    return readings, np.unique(at.i[q[lost]]), np.unique(at.i[along.q[_thin(at, along)]])


def _leads(at: Places, rims: Rims) -> FloatArray:
    """(m,) m by which the wall of a nose or a cone that sinks or rises stands further out than its rim at a place: it
    is made a little ahead or behind, where the tool is wider, and by moves that are each taken at their middle."""
    wider = at.wider(rims.q, rims.height)
    step = at.result.path.step_length[at.i[rims.q]]
    return np.asarray(rims.radius * (1.0 / np.sqrt(1.0 - wider**2) - 1.0) + wider * step)


def _place(at: Places, rims: Rims) -> FloatArray:
    """(m, 3) m in {W}: where walls were told to stand."""
    return np.asarray(at.c[rims.q] + rims.radius[:, None] * rims.u + rims.height[:, None] * at.axial[rims.q])


def _thin(at: Places, rims: Rims) -> BoolArray:
    """(m,) bool: walls that were told to be thinner than ``SLENDER`` of their height over at least that height; shorter
    ones are the tips between two cuts that cross."""
    behind = at.c[rims.q] + (rims.radius + SLENDER * rims.deep)[:, None] * rims.u
    lines = np.hstack([behind, at.axial[rims.q], rims.u])
    cut = np.isfinite(at.outline.walls(lines, rims.height, np.zeros(len(rims.q))).told)
    thin = cut | ~at.stands(rims.q, behind, rims.height)
    i, there = at.i[rims.q], np.zeros(len(at.result.path), dtype=bool)
    there[i[thin]] = True
    stretch, goes_on = np.cumsum(~there), there & np.append(False, there[:-1])
    length = np.bincount(stretch, np.where(goes_on, at.result.path.step_length, 0.0))
    return np.asarray(thin & (length[stretch[i]] >= rims.deep))


def _nothing_stands(at: Places, rims: Rims, suspects: BoolArray) -> BoolArray:
    """(m,) bool: whether nothing stands any more around where the wall beyond a rim was told to be, whichever way one
    looks; asked of ``suspects`` (m,), where one looks through it."""
    lost = np.zeros(len(suspects), dtype=bool)
    some = np.flatnonzero(suspects)
    if not len(some):
        return lost
    n = len(LOOK)
    q, height = np.repeat(rims.q[some], n), np.repeat(rims.height[some], n)
    wall = np.repeat((at.c[rims.q] + rims.radius[:, None] * rims.u)[some], n, axis=0)
    way = (
        np.tile(np.cos(LOOK), len(some))[:, None] * at.feed[q]
        + np.tile(np.sin(LOOK), len(some))[:, None] * at.left_of[q]
    )
    left = at.outline.walls(np.hstack([wall, at.axial[q], way]), height, np.zeros(len(q))).left
    near = np.isnan(left) | (left < at.outline.reach) & at.stands(q, wall + (left + BESIDE)[:, None] * way, height)
    lost[some] = ~near.reshape(-1, n).any(axis=1)
    return lost


def _directions(at: Places, around: BoolArray) -> Rims:
    """To the left and right of the feed at every place, and all around where asked for; left of the feed counts +."""
    every, turning = np.arange(len(at.i)), np.flatnonzero(around)
    ahead, aside = np.tile(np.cos(AROUND), len(turning)), np.tile(np.sin(AROUND), len(turning))
    q = np.repeat(turning, len(AROUND))
    u = np.concatenate([at.left_of, -at.left_of, ahead[:, None] * at.feed[q] + aside[:, None] * at.left_of[q]])
    sign = np.concatenate([np.ones(len(every)), -np.ones(len(every)), np.where(aside < -1e-9, -1.0, 1.0)])
    length = np.concatenate([at.length, at.length, np.zeros(len(q))])
    q = np.concatenate([every, every, q])
    both = _rims(at, q, u, sign, length), _on_fillets(at, q, u, sign)
    return Rims(*(np.concatenate([getattr(some, each.name) for some in both]) for each in fields(Rims)))


def _floors(at: Places) -> Readings:
    """The floor under every place, where there is one left: lowest over the width that the tool cuts flat."""
    aside = np.hypot(at.d[:, 0], at.d[:, 1])
    q, offset, u = _under(at, at.number("flat_radius"), aside)
    inside = at.depth(q, at.c[q] + offset[:, None] * u) > SAME
    inside &= at.below[q] <= SAME  # there is no floor beneath a cut through the stock
    q, offset, u = q[inside], offset[inside], u[inside]
    lines = np.hstack([at.c[q], at.axial[q], u])
    along_itself = np.maximum(at.slope, np.minimum(at.slope / np.sqrt(1.0 - RIM**2), CROWN))
    told, error, found = at.outline.floors(lines, offset, (along_itself * aside)[q])
    found &= ~(at.bottoms[q] & (told < -SAME))  # a peck's end is drilled away
    found &= told >= -((at.slope * at.number("radius"))[q] + SAME)  # a deeper one is of the pass that has made it
    # Across a slope the heel rounds the floor: it is read beneath the axis, and beside it where none is left there, as
    # beside a shoulder or over a deeper slot.
    found &= (offset == 0.0) | (at.slope < LEVEL)[q] | at.steep[q] | ~np.isin(q, q[found & (offset == 0.0)])
    # A hole, or a groove with the sides of a cone, is as deep as its lowest point, wherever that has gone aside.
    roots, lost = _roots(at, aside)
    found &= ~lost[q]
    deepest = (at.bottoms | roots)[q] & (told > -SAME)
    rise = np.where(at.steep, 0.0, at.along)
    root = at.d[:, 2] * np.where(at.steep, 1.0, at.across) - at.d[:, 0] * rise
    error[deepest] = np.where(roots[q], root[q], np.fmin(error, root[q]))[deepest]
    where = at.c[q] + offset[:, None] * u + np.where(found, told, 0.0)[:, None] * at.axial[q]
    q, error, where = q[found], error[found], where[found]
    beside, off, height, normal = _on_noses(at, ~np.isin(np.arange(len(at.i)), q) & ~at.steep & ~lost, aside)
    where = np.concatenate([where, at.c[beside] + height])
    normal = np.concatenate([np.tile([0.0, 0.0, 1.0], (len(q), 1)), normal])
    q, error = np.concatenate([q, beside]), np.concatenate([error, off])
    length = at.length[q] / np.maximum(np.bincount(q, minlength=len(at.i)), 1)[q]
    out = -(normal[:, 1:2] * at.left_of[q] + normal[:, 2:] * at.axial[q])
    place = (where, out, np.ones(len(q)))
    own, way = _dot(normal, at.d[q]), at.in_cut(q, normal)
    return Readings(at.i[q], error, length, 2.0 * at.number("radius")[q], own, way, *place)


def _on_noses(at: Places, where: BoolArray, aside: FloatArray) -> tuple[IntArray, FloatArray, FloatArray, FloatArray]:
    """What noses and cones leave beside their axis ``where`` (q,) no floor lies beneath it, as along the edge of the
    stock: places (m,), errors (m,) m normal to the surface, where that is from the tip (m, 3) m in {W}, and its normals
    (m, 3) by feed, left and axis."""
    chosen = np.flatnonzero(where & (at.number("flat_radius") < at.number("radius")))
    q = np.repeat(chosen, 2 * len(ON_NOSES))
    share = np.tile([*ON_NOSES, *(-each for each in ON_NOSES)], len(chosen))
    flat, R = at.number("flat_radius")[q], at.number("radius")[q]
    offset = np.sign(share) * (flat + np.abs(share) * (R - flat))
    own = at.profile(q, np.abs(offset))
    inside = (at.depth(q, at.c[q] + offset[:, None] * at.left_of[q]) > own + SAME) & (at.below[q] <= SAME)
    q, offset, own = q[inside], offset[inside], own[inside]
    slope = at.slope[q]
    lines = np.hstack([at.c[q], at.axial[q], at.left_of[q]])
    told, error, found = at.outline.floors(lines, offset, slope * aside[q])
    found &= np.abs(told - own) <= slope * at.number("radius")[q] + SAME  # what another pass leaves is read along that
    q, offset, own = q[found], offset[found], own[found]
    upright = at.upright(q, own)
    normal = np.column_stack([np.zeros(len(q)), -np.sign(offset) * upright, np.sqrt(1.0 - upright**2)])
    beside = offset[:, None] * at.left_of[q] + own[:, None] * at.axial[q]
    return q, error[found], beside, normal


def _roots(at: Places, aside: FloatArray) -> tuple[BoolArray, BoolArray]:
    """(q,) bool: grooves of cones and balls, as deep as their root; and (q,) bool: those of cones without one.

    A groove has a root where nobody else was told to cut below one of its sides at least, as far as it has gone
    ``aside``; or nobody below its root, up to twice as far (the next leg at a corner, a crossing, a raster). On a slope
    cut in steps others come by on both sides, one of them below it: it is off where it has gone aside, all along. None
    is left where another pass has cut deeper where the tip really went."""
    roots, lost = np.zeros((2, len(at.i)), dtype=bool)
    cone = at.number("conical") > 0
    q = np.flatnonzero((cone | (at.number("flat_radius") == 0.0)) & ~at.steep)
    # On its way down or up a cone's groove is flatter across than the cone, and made by moves taken at their middle.
    flatter = np.sqrt(1.0 - at.wider(q, at.profile(q, aside[q]) + SAME) ** 2)
    slack = SAME + at.incline[q] * at.result.path.step_length[at.i[q]]
    went = at.c[q] + at.d[q, :1] * at.feed[q] + at.d[q, 1:2] * at.left_of[q]
    lost[q] = at.outline.left_over(np.hstack([went, at.axial[q], at.left_of[q]])) < at.d[q, 2] - slack
    roots[q] = _beside(at, q, aside[q]).max(axis=0) >= at.profile(q, aside[q]) * flatter - slack
    q, slack = q[~roots[q]], slack[~roots[q]]
    roots[q] = np.min([_beside(at, q, share * aside[q]) for share in BESIDE_ROOT], axis=(0, 1)) >= -slack
    q, slack = q[~roots[q]], slack[~roots[q]] + (at.slope * aside)[q[~roots[q]]]
    along = [_beside(at, q, aside[q], share * aside[q]) for share in (-1.0, 0.0, 1.0)]
    lost[q] |= ~(np.ptp(along, axis=0).max(axis=0) <= slack)
    return roots & (cone | ~lost), lost & cone


def _beside(at: Places, q: IntArray, offset: FloatArray, ahead: float | FloatArray = 0.0) -> FloatArray:
    """(2, m) m: how high above the tips of places q the told floors are at an ``offset`` (m,) m to the left and to the
    right, so far ``ahead`` (m,) m."""
    lines = np.hstack([at.c[q] + np.reshape(ahead, (-1, 1)) * at.feed[q], at.axial[q], at.left_of[q]])
    return np.array([at.outline.floors(lines, side * offset, np.zeros(len(q)))[0] for side in (1.0, -1.0)])


def _under(at: Places, flat: FloatArray, aside: FloatArray) -> tuple[IntArray, FloatArray, FloatArray]:
    """Where a floor is looked for: places q (m,), offsets (m,) m along unit directions u (m, 3). Beneath the axis;
    where the tool cuts flat across its feed, to both sides too; and at the bottom of a plunge all around."""
    every, bottom = np.arange(len(at.i)), np.flatnonzero(at.bottoms & at.steep & (flat > 0.0))
    even = np.where(at.steep, 1.0, CROWN / np.hypot(at.slope, CROWN))
    rim = np.minimum(RIM, even) * np.maximum(flat - aside, 0.0)
    beneath = every[~at.steep | at.bottoms]
    wide = np.flatnonzero((flat > 0.0) & ~at.steep)
    aims = [(beneath, np.zeros(len(beneath)))]
    for at_side in (*(share * flat for share in ACROSS if share), rim, -rim):
        seen = (np.abs(at_side) + aside < flat) & (np.abs(at_side) <= even * flat)
        some = wide[seen[wide]]  # else metal left there is the wall's error
        aims.append((some, at_side[some]))
    turned = np.repeat(bottom, len(AROUND))
    ahead, left = np.tile(np.cos(AROUND), len(bottom)), np.tile(np.sin(AROUND), len(bottom))
    around = ahead[:, None] * at.feed[turned] + left[:, None] * at.left_of[turned]
    q, offset = (np.concatenate(parts) for parts in zip(*aims, strict=True))
    u = np.concatenate([at.left_of[q], around])
    return np.concatenate([q, turned]), np.concatenate([offset, rim[turned]]), u


def _ends(at: Places) -> Readings:
    """Walls across the end of a cut, where material stands ahead of its last sample or behind its first."""
    begin, end = (np.flatnonzero(chosen) for chosen in at.begins_or_ends)
    q = np.concatenate([begin, end])
    way = np.concatenate([-np.ones(len(begin)), np.ones(len(end))])
    rims = _rims(at, q, way[:, None] * at.feed[q], way, np.zeros(len(q)))
    rims = rims.only(_standing(at, rims).told <= SAME)
    way = at.in_cut(rims.q, np.tile([1.0, 0.0, 0.0], (len(rims.q), 1)))
    where = (_place(at, rims), rims.u, -rims.sign)
    return Readings(at.i[rims.q], at.d[rims.q, 0], rims.length, rims.deep, at.d[rims.q, 0], way, *where)


def _dot(a: FloatArray, b: FloatArray) -> FloatArray:
    return np.asarray(np.einsum("qi,qi->q", a, b))
