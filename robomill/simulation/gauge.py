"""What a gauge would read on the part: how far its walls, floors and ends stand from where they were commanded.

The deviation of the tip shows where the tool leaves a surface: beside it where material stays, under it where nothing
cuts deeper. So each sample of a run is asked for its walls (to the left and right of the feed; all around in a plunge;
ahead and behind too where the path turns), and for its floor, and every one is measured on the surface that is left in
the end, by all passes that come by: what a later pass removes is not on the part. Where a cut begins or ends in the
material the wall across its end is moved by the deviation along the feed; that is its own quantity (``ends``).
"""

from __future__ import annotations

from dataclasses import dataclass, fields

import numpy as np

from robomill.arrays import BoolArray, FloatArray, IntArray
from robomill.cutting.tool import Cutter
from robomill.simulation.seen import Run
from robomill.surface.outline import Outline
from robomill.surface.raster import stock_heights
from robomill.surface.stock import stock_grid
from robomill.vectors import angle_between

STEEP = 0.5  # share of the feed across the tool below which a move is a plunge: its wall is a hole's
CORNER = np.radians(45.0)
TURNS = np.radians(5.0)  # where the path turns more, walls ahead and behind are looked for too
AROUND = np.radians(np.arange(0.0, 360.0, 22.5))
ACROSS = (0.0, -0.3, 0.3, -0.6, 0.6)  # of the flat radius: where a floor is looked for
HEIGHTS = (0.05, 0.9)  # of the depth, above the nose: where a wall is measured
ON_NOSE = 0.95  # of the depth, where the nose alone cuts
BESIDE = 20e-6  # m: material this far beyond the rim makes a wall
LEVEL = 1e-6  # what the share of the feed across the axis lacks of 1 where a move is level
ALIKE = 2e-6  # m: readings that differ by less are one
SAME = 2e-6  # m: what other passes go beyond a wall by no more is the same wall
REACH = 1.5e-3  # m: walls are looked for so far from where they were commanded, and no further than the radius allows


@dataclass(frozen=True, eq=False)
class Readings:
    """Places on the part: samples (q,) of the path that made them, signed errors (q,) m, lengths (q,) m along the path
    and heights (q,) m that they stand for. Walls: left of the feed +; floors: up +; ends: along the feed +. ``own``
    (q,) m is the deviation of the sample itself: where several passes come by, one of them has made the surface.
    """

    sample: IntArray
    error: FloatArray
    length: FloatArray
    height: FloatArray
    own: FloatArray

    @property
    def worst(self) -> int:
        """Which is largest, -1 where there is none; among equals the one whose sample is off by as much itself."""
        if not len(self.error):
            return -1
        size = np.abs(self.error)
        equal = np.flatnonzero(size >= size.max() - ALIKE)
        return int(equal[np.argmin(np.abs(self.error - self.own)[equal] + (size.max() - size[equal]))])

    def share_out(self, tolerance: float) -> float:
        """Share of the length that is out of ``tolerance`` (m); 0 where there is none."""
        total = float(self.length.sum())
        return float(self.length[np.abs(self.error) > tolerance].sum()) / total if total > 0.0 else 0.0

    def area(self, tolerance: float = 0.0) -> float:
        """m^2 of wall that is out of ``tolerance`` (m), or all of it."""
        out = np.abs(self.error) > tolerance if tolerance > 0.0 else np.ones(len(self.error), dtype=bool)
        return float((self.length * self.height)[out].sum())


@dataclass(frozen=True, eq=False)
class Gauge:
    """All that a gauge would find on the part."""

    walls: Readings
    floors: Readings
    ends: Readings


@dataclass(frozen=True, eq=False)
class Places:
    """Judged samples i (q,) of a run: tip c and axes of the cut (feed, left, axial) in {W}, the deviation d along those
    axes, all (q, 3); ``told`` and ``left`` are the surfaces commanded and left, ``of`` (q,) which cutter cuts."""

    result: Run
    i: IntArray
    c: FloatArray
    feed: FloatArray
    left_of: FloatArray
    axial: FloatArray
    d: FloatArray
    cutters: tuple[Cutter, ...]
    of: IntArray
    told: Outline
    left: Outline

    def radius_at(self, q: IntArray, height: FloatArray) -> FloatArray:
        """Radius (m) of the cutters at places q, at a height (m) above their tips."""
        every = np.stack([cutter.radius_at(np.maximum(height, 0.0)) for cutter in self.cutters])
        return np.asarray(every[self.of[q], np.arange(len(q))])

    def number(self, name: str) -> FloatArray:
        """(q,) a number of each place's cutter."""
        return np.array([getattr(cutter, name) for cutter in self.cutters])[self.of]

    def depth(self, q: IntArray, points: FloatArray) -> FloatArray:
        """How high (m) the stock stood over points (m, 3) m along the axes of places q; 0 beside and below it."""
        stock = self.result.setup.stock_block
        inside = ((points[:, :2] >= stock.lower[:2]) & (points[:, :2] <= stock.upper[:2])).all(axis=1)
        inside &= points[:, 2] >= stock.lower[2] - 1e-9
        top = np.full(len(points), float(stock.upper[2]))
        if stock.triangles is not None:
            cells = stock_grid(stock, self.result.setup.cell)
            at = (points[:, :2] - [cells.x0, cells.y0]) / [cells.dx, cells.dy]
            x, y = np.clip(np.rint(at).astype(int), 0, [cells.nx - 1, cells.ny - 1]).T
            top = stock_heights(stock, cells.x, cells.y)[x, y]
        return np.where(inside, np.maximum(top - points[:, 2], 0.0) / self.axial[q, 2], 0.0)


def gauge(result: Run) -> Gauge:
    """Everything that can be measured on the part that a run leaves."""
    if not (result.judged.any() and result.removes.any()):
        nothing = Readings(np.zeros(0, dtype=np.int64), *(np.zeros(0) for _ in range(4)))
        return Gauge(nothing, nothing, nothing)
    at = _places(result)
    return Gauge(_walls(at), _floors(at), _ends(at))


def _places(result: Run) -> Places:
    i, path = np.flatnonzero(result.judged), result.path
    tooling = result.tooling
    moves, of = np.flatnonzero(result.removes), np.asarray(tooling.of_step)
    reach = min(REACH, max(cutter.radius for cutter in tooling.cutters))
    axes, lift = _upright_balls(result)
    to_W = result.setup.T_MW[:3, :3]
    d: FloatArray = np.einsum("mij,mj->mi", axes[i], np.asarray(result.delta[i] @ to_W))

    def outline(p: FloatArray) -> Outline:
        p = p + lift
        return Outline(np.hstack([p[moves - 1], p[moves]]), tooling.cutters, of[moves], reach)

    told, left = outline(path.p), outline(result.p_machined)
    feed, left_of, axial = np.moveaxis(axes[i], 1, 0)
    return Places(result, i, (path.p + lift)[i], feed, left_of, axial, d, tooling.cutters, of[i], told, left)


def _upright_balls(result: Run) -> tuple[FloatArray, FloatArray]:
    """Axes of the cut (m, 3, 3), rows feed, left, axial in {W}, and how far (m, 3) m from the tip the lowest point is:
    a ball cuts the same however it leans, so it is taken upright; other tools have their own axes and their tip."""
    to_W, path = result.setup.T_MW[:3, :3], result.path
    axes = np.einsum("ji,mjk->mki", to_W, result.R_MF)
    ball = np.array([cutter.flat_radius == 0.0 and not cutter.conical for cutter in result.tooling.cutters])
    leans = ball[result.tooling.of_step] & (path.k[:, 2] < 1.0 - 1e-12)
    up = np.array([0.0, 0.0, 1.0])
    feed = axes[:, 0] * [1.0, 1.0, 0.0]
    length = np.linalg.norm(feed, axis=1, keepdims=True)
    leans &= length[:, 0] > STEEP
    feed = feed / np.where(length > 0.0, length, 1.0)
    upright = np.stack([feed, np.cross(up, feed), np.broadcast_to(up, feed.shape)], axis=1)
    lift = result.tooling.each("radius")[:, None] * (path.k - up)
    return np.where(leans[:, None, None], upright, axes), np.where(leans[:, None], lift, 0.0)


def _steep(at: Places) -> BoolArray:
    return at.result.conditions.across[at.i] < STEEP


def _begins_or_ends(at: Places) -> tuple[BoolArray, BoolArray]:
    """(q,) (q,): where cutting along the part begins, and where it ends: beside rapids, plunges and nothing."""
    result = at.result
    level = result.path.cutting & (result.conditions.across >= STEEP)
    before, after = np.append(False, level[:-1]), np.append(level[1:], False)
    return (level & ~before)[at.i], (level & ~after)[at.i]


def _bottoms(at: Places) -> BoolArray:
    """(q,): where a plunge ends, at the floor of a hole."""
    conditions, path = at.result.conditions, at.result.path
    down = path.cutting & (conditions.across < STEEP) & (conditions.along < 0.0)
    return np.asarray((down & ~np.append(down[1:], False))[at.i])


def _turn(at: Places) -> FloatArray:
    """(q,) rad: the sharpest turn of the path at each place, towards the sample before or after it."""
    path, R = at.result.path, at.result.R_MF[..., 0]
    angle = angle_between(R[1:], R[:-1])
    angle[~(path.cutting[1:] & path.cutting[:-1])] = 0.0
    return np.maximum(np.append(0.0, angle), np.append(angle, 0.0))[at.i]


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
    R, nose = at.number("radius")[q], at.number("nose_height")[q]
    deep = at.depth(q, at.c[q] + (R + BESIDE)[:, None] * u)
    height = np.where(deep > nose, nose + share * (deep - nose), ON_NOSE * deep)
    radius = at.radius_at(q, height)
    stands = at.depth(q, at.c[q] + (radius + BESIDE)[:, None] * u) > height
    return Rims(q, u, sign, length, height, radius, deep).only((deep > SAME) & stands)


def _standing(surface: Outline, at: Places, rims: Rims) -> FloatArray:
    """(m,) m: how far beyond the rim the wall stands; NaN where there is none."""
    return surface.walls(np.hstack([at.c[rims.q], at.axial[rims.q], rims.u]), rims.height, rims.radius)


def _walls(at: Places) -> Readings:
    """Walls at every place and direction where material stands beside the tool in the end."""
    steep, (begin, end), turn = _steep(at), _begins_or_ends(at), _turn(at)
    rims = _directions(at, (turn > TURNS) & ~begin & ~end | steep)
    told = _standing(at.told, at, rims)
    # Chords of an arc overlap on its inner side by no more than this.
    gentle = (rims.length > 0.0) & (turn[rims.q] < CORNER) & ~steep[rims.q]
    same = SAME + np.where(gentle, rims.radius * (1.0 - np.cos(turn[rims.q])), 0.0)
    # A tool lifted above the height at which a wall is measured leaves metal over its whole width: the floor's error.
    keep = (np.nan_to_num(told, nan=np.inf) <= same) & (at.d[rims.q, 2] < rims.height)
    rims, told = rims.only(keep), told[keep]
    q = rims.q
    own = at.d[q, 0] * _dot(rims.u, at.feed[q]) + at.d[q, 1] * _dot(rims.u, at.left_of[q])
    left = _standing(at.left, at, rims)
    error = np.where(np.isnan(left) | steep[q] | begin[q] | end[q], own, left - told) * _upright(at, q, rims.height)
    return Readings(at.i[q], error * rims.sign, rims.length, rims.deep, own * rims.sign)


def _directions(at: Places, around: BoolArray) -> Rims:
    """To the left and right of the feed at every place, and all around where asked for; left of the feed counts +."""
    every, turning = np.arange(len(at.i)), np.flatnonzero(around)
    ahead, aside = np.tile(np.cos(AROUND), len(turning)), np.tile(np.sin(AROUND), len(turning))
    q = np.repeat(turning, len(AROUND))
    u = [at.left_of, -at.left_of, ahead[:, None] * at.feed[q] + aside[:, None] * at.left_of[q]]
    sign = [np.ones(len(every)), -np.ones(len(every)), np.where(aside < -1e-9, -1.0, 1.0)]
    length = at.result.path.step_length[at.i]
    lengths = [length, length, np.zeros(len(q))]
    return _rims(at, np.concatenate([every, every, q]), *map(np.concatenate, (u, sign, lengths)))


def _upright(at: Places, q: IntArray, height: FloatArray) -> FloatArray:
    """How upright the cutter's side is at a height: 1 on a cylinder, less on a nose or a cone, where an error across
    the axis is further than one normal to the surface."""
    step = 1e-6
    spread = at.radius_at(q, height + step) - at.radius_at(q, height - step)
    return np.asarray(1.0 / np.hypot(1.0, spread / (2.0 * step)))


def _floors(at: Places) -> Readings:
    """The floor under every place, where there is one left: lowest over the width that the tool cuts flat."""
    flat, count = at.number("flat_radius"), len(at.i)
    q = np.repeat(np.arange(count), len(ACROSS))
    offset = np.tile(ACROSS, count) * flat[q]
    level = at.result.conditions.across[at.i] > 1.0 - LEVEL  # else the heel rounds the floor across the feed
    chosen = np.tile(np.array(ACROSS) == 0.0, count) | ((flat > 0.0) & level)[q]
    chosen &= ~_steep(at)[q] | _bottoms(at)[q]
    aside = np.hypot(at.d[q, 0], at.d[q, 1])
    chosen &= (np.abs(offset) + aside < flat[q]) | (offset == 0.0)  # else metal left there is the wall's error
    q, offset = q[chosen], offset[chosen]
    inside = at.depth(q, at.c[q] + offset[:, None] * at.left_of[q]) > SAME
    q, offset = q[inside], offset[inside]
    places = np.hstack([at.c[q], at.axial[q], at.left_of[q]])
    (told, upright), (left, _) = at.told.floors(places, offset), at.left.floors(places, offset)
    found = np.isfinite(told) & np.isfinite(left) & ~(_bottoms(at)[q] & (told < -SAME))  # a peck's end is drilled away
    with np.errstate(invalid="ignore"):
        error = (left - told) * upright
    deepest = _bottoms(at)[q] & (told > -SAME)  # a hole is as deep as its lowest point, wherever its cone has gone
    error[deepest] = np.fmin(error, at.d[q, 2])[deepest]
    q, error = q[found], error[found]
    length = at.result.path.step_length[at.i[q]] / len(ACROSS)
    return Readings(at.i[q], error, length, 2.0 * at.number("radius")[q], at.d[q, 2])


def _ends(at: Places) -> Readings:
    """Walls across the end of a cut, where material stands ahead of its last sample or behind its first."""
    begin, end = (np.flatnonzero(chosen) for chosen in _begins_or_ends(at))
    q = np.concatenate([begin, end])
    way = np.concatenate([-np.ones(len(begin)), np.ones(len(end))])
    rims = _rims(at, q, way[:, None] * at.feed[q], way, np.zeros(len(q)))
    rims = rims.only(np.nan_to_num(_standing(at.told, at, rims), nan=np.inf) <= SAME)
    return Readings(at.i[rims.q], at.d[rims.q, 0], rims.length, rims.deep, at.d[rims.q, 0])


def _dot(a: FloatArray, b: FloatArray) -> FloatArray:
    return np.asarray(np.einsum("qi,qi->q", a, b))
