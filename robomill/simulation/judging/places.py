"""Where a gauge is put on the part: the judged samples of a run, with the axes of their cut and the outlines there."""

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from robomill.arrays import BoolArray, FloatArray, IntArray
from robomill.cutting.conditions import STEEP
from robomill.cutting.tool import Cutter
from robomill.simulation.judging.seen import Run
from robomill.simulation.setup import SimulationSetup
from robomill.surface.outline import Outline
from robomill.surface.raster import stock_heights
from robomill.surface.stock import stock_grid
from robomill.vectors import angle_between

APART = 10e-6  # m: samples that differ by more are looked at in between,
BETWEEN = (0.25, 0.5, 0.75)  # at these shares of the way
ON_EDGE = 1e-9  # m: a place as near to the stock's edge is on it, whatever the last digit of its coordinates
LIFTED = 4e-6  # m: moves on which a nose is lifted or drawn in by more are taken in parts,
MOST_PARTS = 32  # so many at most
REACH = 1.5e-3  # m: walls are looked for so far from where they were commanded, and no further than the radius allows


@dataclass(frozen=True, eq=False)
class Places:
    """Judged samples i (q,) of a run, and places ``between`` (q,) one and the one before: tip c and axes of the cut
    (feed, left, axial) in {W}, the deviation d along those axes, all (q, 3); ``outline`` holds the surfaces commanded
    and left, ``of`` (q,) says which cutter cuts; ``along`` and ``across`` (q,) are the parts of the unit feed along the
    axis and along ``feed``."""

    result: Run
    i: IntArray
    between: BoolArray
    c: FloatArray
    feed: FloatArray
    left_of: FloatArray
    axial: FloatArray
    d: FloatArray
    cutters: tuple[Cutter, ...]
    of: IntArray
    outline: Outline
    along: FloatArray
    across: FloatArray

    def radius_at(self, q: IntArray, height: FloatArray) -> FloatArray:
        """Radius (m) of the cutters at places q, at a height (m) above their tips."""
        every = np.stack([cutter.radius_at(np.maximum(height, 0.0)) for cutter in self.cutters])
        return np.asarray(every[self.of[q], np.arange(len(q))])

    def profile(self, q: IntArray, offset: FloatArray) -> FloatArray:
        """Heights (m) above their tips of the cutters at places q, at a distance (m) from their axes."""
        every = np.stack([cutter.profile(np.minimum(offset, cutter.radius)) for cutter in self.cutters])
        return np.asarray(every[self.of[q], np.arange(len(q))])

    def upright(self, q: IntArray, height: FloatArray) -> FloatArray:
        """(m,) how upright the sides of the cutters at places q are at a height: 1 on a cylinder, less on a nose or a
        cone, where an error across the axis is further than one normal to the surface."""
        step = 1e-6
        spread = self.radius_at(q, height + step) - self.radius_at(q, height - step)
        return np.asarray(1.0 / np.hypot(1.0, spread / (2.0 * step)))

    def wider(self, q: IntArray, height: FloatArray) -> FloatArray:
        """(m,) by how much the radius of a tool that sinks or rises changes at a height on its way, of that way; where
        it is more than 0.9 the surface is the rim's and no more the side's."""
        incline, wider = self.incline[q], np.zeros(len(q))
        some = np.flatnonzero(incline > 0.0)
        upright = self.upright(q[some], height[some])
        wider[some] = np.minimum(incline[some] * np.sqrt(1.0 - upright**2) / upright, 0.9)
        return wider

    def in_cut(self, q: IntArray, way: FloatArray) -> FloatArray:
        """(m, 3) along the axes of the cut, as ``delta_in_cut`` is given: ways (m, 3) along the axes of places q, which
        are others where a ball leans."""
        world = way[:, :1] * self.feed[q] + way[:, 1:2] * self.left_of[q] + way[:, 2:] * self.axial[q]
        own = cut_axes(self.result)[self.i[q]]
        leans = (own[:, 2] != self.axial[q]).any(axis=1)
        return np.where(leans[:, None], np.einsum("qij,qj->qi", own, world), way)

    @property
    def length(self) -> FloatArray:
        """(q,) m along the path that a place stands for."""
        return np.where(self.between, 0.0, self.result.path.step_length[self.i])

    def number(self, name: str) -> FloatArray:
        """(q,) a number of each place's cutter."""
        return np.array([getattr(cutter, name) for cutter in self.cutters])[self.of]

    def depth(self, q: IntArray, points: FloatArray) -> FloatArray:
        """How high (m) the stock stood over points (m, 3) m along the axes of places q; 0 beside it."""
        top = stock_top(self.result.setup, points[:, :2])
        return np.asarray(np.maximum(top - points[:, 2], 0.0) / self.axial[q, 2])

    def stands(self, q: IntArray, points: FloatArray, height: FloatArray) -> BoolArray:
        """(m,) bool: whether the stock stood higher than ``height`` (m,) m above the tips of places q there."""
        return np.asarray(self.depth(q, points) > height)

    @property
    def below(self) -> FloatArray:
        """(q,) m along the axis: how far the tip stands below the bottom of the stock, where walls begin, or 0."""
        bottom = float(self.result.setup.stock_block.lower[2])
        return np.asarray(np.maximum(bottom - self.c[:, 2], 0.0) / self.axial[:, 2])

    @property
    def steep(self) -> BoolArray:
        """(q,): plunges, whose wall is a hole's."""
        return self.result.conditions.mostly_axial[self.i]

    @property
    def begins_or_ends(self) -> tuple[BoolArray, BoolArray]:
        """(q,) (q,): where cutting along the part begins, and where it ends: beside rapids, plunges and nothing."""
        result = self.result
        level = result.path.cutting & ~result.conditions.mostly_axial
        before, after = np.append(False, level[:-1]), np.append(level[1:], False)
        return (level & ~before)[self.i] & ~self.between, (level & ~after)[self.i] & ~self.between

    @property
    def bottoms(self) -> BoolArray:
        """(q,): where a plunge ends, at the floor of a hole."""
        down = self.result.path.cutting & self.result.conditions.plunges
        return np.asarray((down & ~np.append(down[1:], False))[self.i] & ~self.between)

    @property
    def turn(self) -> FloatArray:
        """(q,) rad: the sharpest turn of the path at each place, towards the sample before or after it."""
        path, R = self.result.path, self.result.R_MF[..., 0]
        angle = angle_between(R[1:], R[:-1])
        angle[~(path.cutting[1:] & path.cutting[:-1])] = 0.0
        return np.where(self.between, 0.0, np.maximum(np.append(0.0, angle), np.append(angle, 0.0))[self.i])

    @property
    def slope(self) -> FloatArray:
        """(q,) how far the path rises or sinks on its way across the tool; a plunge counts as two for one."""
        return np.asarray(np.abs(self.along) / np.maximum(self.across, STEEP))

    @property
    def incline(self) -> FloatArray:
        """(q,) the same of what is no plunge, 0 of those."""
        return np.where(self.steep, 0.0, self.slope)


def stock_top(setup: SimulationSetup, xy: FloatArray) -> FloatArray:
    """(m,) m: how high the stock stood over points (m, 2) m of the plan; -inf beside it."""
    stock = setup.stock_block
    inside = ((xy >= stock.lower[:2] - ON_EDGE) & (xy <= stock.upper[:2] + ON_EDGE)).all(axis=1)
    top = np.full(len(xy), float(stock.upper[2]))
    if stock.triangles is not None:
        cells = stock_grid(stock, setup.cell)
        x, y = np.clip(
            np.rint((xy - [cells.x0, cells.y0]) / [cells.dx, cells.dy]).astype(int), 0, [cells.nx - 1, cells.ny - 1]
        ).T
        top = stock_heights(stock, cells.x, cells.y)[x, y]
    return np.where(inside, top, -np.inf)


def places(result: Run, most: int | None = None) -> Places:
    """The judged samples of a run that cuts; where one is off otherwise than the one before, places between them.
    ``most`` samples: as many in even steps, and a tenth of those as far off as any, where there are more."""
    path, tooling = result.path, result.tooling
    some = np.flatnonzero(result.judged)
    if most is not None and len(some) > most:
        some = some[_chosen(np.cumsum(path.step_length[some]), result.delta_in_cut[some, 1:], most)]
    after = some[(result.removes & np.append(False, result.judged[:-1] & (_changes(result) > APART)))[some]]
    i = np.concatenate([some, *[after] * len(BETWEEN)])
    share = np.repeat([1.0, *BETWEEN], [len(some), *[len(after)] * len(BETWEEN)])[:, None]
    before = np.maximum(i - 1, 0)
    moves, of = np.flatnonzero(result.removes), np.asarray(tooling.of_step)
    reach = min(REACH, max(cutter.radius for cutter in tooling.cutters))
    cut = _upright_balls(result)
    off = np.where(share < 1.0, share * result.delta[i] + (1.0 - share) * result.delta[before], result.delta[i])
    d = np.asarray(np.einsum("mij,mj->mi", cut.axes[i], result.setup.to_part(off)))
    tips = path.p + cut.lift

    told, left = (np.hstack([p[moves - 1], p[moves]]) for p in (tips, result.p_machined + cut.lift))
    rise = np.einsum("mi,mi->m", (left - told)[:, 3:] - (left - told)[:, :3], cut.axes[moves, 2])
    nosed = tooling.each("nose_height")[moves] > 0.0
    parts = np.where(nosed, np.clip(np.ceil(np.abs(rise) / LIFTED), 1, MOST_PARTS), 1).astype(np.int64)
    told, left, made_by = _parted(told, parts), _parted(left, parts), np.repeat(of[moves], parts)
    outline = Outline(told, left, tooling.cutters, made_by, reach)
    feed, left_of, axial = np.moveaxis(cut.axes[i], 1, 0)
    c = share * tips[i] + (1.0 - share) * tips[before]
    which = (tooling.cutters, of[i], outline, cut.along[i], cut.across[i])
    return Places(result, i, share[:, 0] < 1.0, c, feed, left_of, axial, d, *which)


def _parted(ends: FloatArray, parts: IntArray) -> FloatArray:
    """Moves (p, 6) m of which each one (m, 6) m is as many ``parts`` (m,) of equal length: an outline has each move at
    the height of its middle, where the side of a nose that is lifted or drawn in on its way is another."""
    move = np.repeat(np.arange(len(parts)), parts)
    begun = ((np.arange(len(move)) - np.repeat(np.cumsum(parts) - parts, parts)) / parts[move])[:, None]
    ended = np.minimum(begun + 1.0 / parts[move][:, None], 1.0)
    start, way = ends[move, :3], (ends[:, 3:] - ends[:, :3])[move]
    whole = (parts == 1)[move][:, None]
    return np.where(whole, ends[move], np.hstack([start + begun * way, start + ended * way]))


def _chosen(s: FloatArray, off: FloatArray, most: int) -> IntArray:
    """So ``most`` of samples that stand at s (n,) m, in even steps, and a tenth of those that are most ``off`` (n, 2)
    m."""
    size = np.linalg.norm(np.nan_to_num(off), axis=1)
    worst = np.argpartition(size, len(size) - most // 10)[len(size) - most // 10 :]
    even = np.searchsorted(s, np.linspace(0.0, s[-1], most))
    return np.unique(np.concatenate([np.minimum(even, len(s) - 1), worst]))


def _changes(result: Run) -> FloatArray:
    """(m - 1,) m: how much each sample is off otherwise than the one before."""
    return np.asarray(np.linalg.norm(np.diff(np.nan_to_num(result.delta), axis=0), axis=1))


def cut_axes(result: Run) -> FloatArray:
    """(m, 3, 3): the axes of the cut in {W}, rows feed, left, axial."""
    return np.einsum("ji,mjk->mki", result.setup.T_MW[:3, :3], result.R_MF)


class _Cut(NamedTuple):
    """As a gauge takes it: ``axes`` (m, 3, 3), rows feed, left, axial in {W}; how far its lowest point is from the tip,
    ``lift`` (m, 3) m; the parts of the unit feed ``along`` (m,) the axis and ``across`` (m,) it."""

    axes: FloatArray
    lift: FloatArray
    along: FloatArray
    across: FloatArray


def _upright_balls(result: Run) -> _Cut:
    """A ball cuts the same however it leans, so it is taken upright; other tools have their own axes and their tip."""
    path, axes, conditions = result.path, cut_axes(result), result.conditions
    ball = np.array([cutter.flat_radius == 0.0 and not cutter.conical for cutter in result.tooling.cutters])
    leans = ball[result.tooling.of_step] & (path.k[:, 2] < 1.0 - 1e-12)
    up, along, across = np.array([0.0, 0.0, 1.0]), conditions.along, conditions.across
    way = across[:, None] * axes[:, 0] + along[:, None] * axes[:, 2]
    leans &= np.hypot(axes[:, 0, 0], axes[:, 0, 1]) > STEEP
    level = np.where((np.hypot(way[:, 0], way[:, 1]) > STEEP)[:, None], way, axes[:, 0]) * [1.0, 1.0, 0.0]
    length = np.linalg.norm(level, axis=1, keepdims=True)
    feed = level / np.where(length > 0.0, length, 1.0)
    upright = np.stack([feed, np.cross(up, feed), np.broadcast_to(up, feed.shape)], axis=1)
    lift = result.tooling.each("radius")[:, None] * (path.k - up)
    along = np.where(leans, way[:, 2], along)
    across = np.where(leans, np.hypot(way[:, 0], way[:, 1]), across)
    axes, lift = np.where(leans[:, None, None], upright, axes), np.where(leans[:, None], lift, 0.0)
    return _Cut(axes, lift, along, across)
