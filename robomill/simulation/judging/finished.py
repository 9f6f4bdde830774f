"""How much of the finished surface each reading stands for: what several passes have come by counts once.

A floor belongs to the readings nearest to it, from wherever a cutter went down to where the stock ends. A wall belongs
to the passes that made it, each from its own tip up to the tip of the next pass above, the last one up to the stock's
top; passes at one height share it. Around the outside of a turn a wall is longer than the path, inside it is shorter.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from robomill.arrays import BoolArray, FloatArray, IntArray
from robomill.progress import slices
from robomill.simulation.judging.gauge import CORNER, Gauge, Readings
from robomill.simulation.judging.places import stock_top
from robomill.simulation.judging.seen import WHOLE, Run
from robomill.surface.outline import SAME
from robomill.values import ReadOnly
from robomill.vectors import angle_between, nearest_on

MOST_CELLS = 250_000
FINE = 16  # cells of a floor to a radius of the smallest cutter, where not too many
NEAR = 0.6  # of the length that a reading stands for: another pass has one as near along the same wall
OWN = 3.0  # of that length, along the path: nearer readings are the same pass
LEAST = 1e-4  # share of the area that a single place stands for


@dataclass(frozen=True, eq=False)
class Spread(ReadOnly):
    """Signed errors (q,) m of readings, and the areas (q,) m^2 of finished surface that they stand for."""

    error: FloatArray
    area: FloatArray

    def out(self, tolerance: float) -> tuple[float, float]:
        """(out of ``tolerance`` (m), all) m^2; the first is never 0 where something is out, however small."""
        far, total = np.abs(self.error) > WHOLE * tolerance, float(self.area.sum())
        return (max(float(self.area[far].sum()), LEAST * total) if far.any() else 0.0), total

    def histogram(self, edges: FloatArray) -> FloatArray:
        """(bins,) m^2 between ``edges`` (bins + 1,) m; the outer bins hold what is beyond."""
        bins = len(edges) - 1
        which = np.clip(np.searchsorted(edges, self.error, side="right") - 1, 0, bins - 1)
        return np.asarray(np.bincount(which, self.area, bins), dtype=np.float64)

    @property
    def squares(self) -> float:
        """m^4: the squares of the errors over the area."""
        return float(np.sum(self.error**2 * self.area))


@dataclass(frozen=True, eq=False)
class Finished(ReadOnly):
    """The walls and the floors that are left in the end, each place once."""

    walls: Spread
    floors: Spread

    @property
    def rms(self) -> float:
        """m: root mean square of the errors of walls and floors, each by its own area; NaN where there are none."""
        area = float(self.walls.area.sum() + self.floors.area.sum())
        return math.sqrt((self.walls.squares + self.floors.squares) / area) if area > 0.0 else math.nan

    def edges(self, tolerance: float, bins: int) -> FloatArray:
        """(bins + 1,) m: limits of the bins of a histogram of walls and floors, alike on both sides of zero: beyond
        ``tolerance`` (m), as far as the largest error, but not further than three times the tolerance."""
        largest = float(np.abs(np.concatenate([self.walls.error, self.floors.error])).max(initial=0.0))
        limit = min(max(1.15 * tolerance, 1.05 * largest), 3.0 * tolerance)
        return np.linspace(-limit, limit, bins + 1)


def finished(result: Run, gauge: Gauge) -> Finished:
    """The areas that a gauge's readings stand for on the part that a run leaves."""
    walls, floors = gauge.walls, gauge.floors
    return Finished(Spread(walls.error, _wall_areas(result, walls)), Spread(floors.error, _floor_areas(result, floors)))


def _floor_areas(result: Run, floors: Readings) -> FloatArray:
    """(q,) m^2: small squares under the cutters, each given to the reading nearest to it in plan."""
    from scipy.spatial import cKDTree

    area = np.zeros(len(floors.error))
    bottom = float(result.setup.stock_block.lower[2])
    some = np.flatnonzero(floors.place[:, 2] >= bottom - SAME)  # a cut through the stock has no floor
    if not len(some):
        return area
    sample, radius = np.unique(floors.sample[some]), result.tooling.each("radius")
    points, side = _squares(result.path.p[sample, :2], radius[sample])
    tree = cKDTree(floors.place[some, :2])
    for each in slices(len(points), "Floors that are left"):
        xy = points[each]
        nearest = some[tree.query(xy)[1]]
        there = _swept(result, sample, radius, xy)
        there &= stock_top(result.setup, xy) > floors.place[nearest, 2] + SAME
        area += side**2 * np.bincount(nearest[there], minlength=len(area))
    return area


def _squares(tips: FloatArray, radius: FloatArray) -> tuple[FloatArray, float]:
    """Middles (n, 2) m of squares over all that cutters at ``tips`` (m, 2) may cover, and their side, m."""
    widest = float(radius.max())
    low, high = tips.min(axis=0) - widest, tips.max(axis=0) + widest
    side = max(float(radius.min()) / FINE, math.sqrt(float(np.prod(high - low)) / MOST_CELLS))
    x, y = (np.arange(a + 0.5 * side, b, side) for a, b in zip(low, high, strict=True))
    return np.column_stack([np.repeat(x, len(y)), np.tile(y, len(x))]), side


def _swept(result: Run, sample: IntArray, radius: FloatArray, xy: FloatArray) -> BoolArray:
    """(n,) bool: points that a cutter passes over on the way to or from one of the samples that is nearest."""
    from scipy.spatial import cKDTree

    p, removes = result.path.p[:, :2], result.removes
    inside = np.zeros(len(xy), dtype=bool)
    for R in np.unique(radius[sample]).tolist():
        own = sample[radius[sample] == R]
        at = own[cKDTree(p[own]).query(xy)[1]]
        for end in (at, np.minimum(at + 1, len(p) - 1)):
            start = np.maximum(end - 1, 0)
            moved = np.where(removes[end], nearest_on(xy, p[start], p[end])[1], np.inf)
            inside |= moved <= R
        inside |= np.linalg.norm(xy - p[at], axis=1) <= R
    return inside


class _Sides(NamedTuple):
    """One side of one sample each, (n,): its first reading, length m of wall, height m of the tip or the bottom of the
    stock, how high m the wall is above that, place along the path s m, whether a plunge leaves it."""

    first: IntArray
    length: FloatArray
    base: FloatArray
    deep: FloatArray
    s: FloatArray
    steep: BoolArray


def _wall_areas(result: Run, walls: Readings) -> FloatArray:
    """(q,) m^2: each side of each sample has its own slice of the wall, shared by the readings within it."""
    area = np.zeros(len(walls.error))
    along = np.flatnonzero(walls.length > 0.0)
    if not len(along):
        return area
    _, first, of = np.unique(
        2 * walls.sample[along] + (walls.side[along] > 0.0), return_index=True, return_inverse=True
    )
    count = np.bincount(of)
    sides = _sides(result, walls, along[first], np.bincount(of, walls.length[along]).astype(float))
    slice_, passes = _slices(walls, sides)
    own = sides.length * slice_ / passes
    # Lower down than a wider pass leaves its wall only the readings beneath it count.
    z = walls.place[along, 2]
    within = (z >= sides.base[of] - SAME) & (z <= (sides.base + slice_)[of] + SAME)
    any_within = np.bincount(of, within, minlength=len(count)) > 0
    counts = within | ~any_within[of]
    area[along] = np.where(counts, (own / np.maximum(np.bincount(of, counts), 1))[of], 0.0)
    return area


def _sides(result: Run, walls: Readings, first: IntArray, told: FloatArray) -> _Sides:
    """Sides by their ``first`` readings (n,); ``told`` (n,) m is how much of the path all of their readings tell."""
    path, i = result.path, walls.sample[first]
    steep, R = result.conditions.mostly_axial[i], result.tooling.each("radius")[i]
    step = path.step_length[i]
    bend = _bend(result)[i]
    outer = bend * walls.side[first] > 0.0  # the left side (-1) is the outer one of a turn to the right (-)
    longer = R * np.abs(bend)
    sharp = ~outer & (np.abs(bend) > 0.5 * CORNER)
    length = np.where(outer, step + longer, np.where(sharp, step, np.maximum(step - longer, 0.0)))
    length = np.where(steep, np.pi * R, length)  # half of the way around a hole
    bottom = float(result.setup.stock_block.lower[2])
    share = np.minimum(told / np.maximum(step, 1e-30), 1.0)  # of the height at which this pass made the wall
    deep = np.where(steep, np.minimum(told, walls.height[first]), walls.height[first] * share)
    return _Sides(first, length, np.maximum(path.p[i, 2], bottom), deep, path.s[i], steep)


def _bend(result: Run) -> FloatArray:
    """(m,) rad: how far the path turns at each sample that has a length, half of it before, half after; to the left
    +."""
    path, bend = result.path, np.zeros(len(result.path))
    level = path.cutting & ~result.conditions.mostly_axial
    i = np.flatnonzero(level & (path.step_length > 0.0))  # at a corner another sample, of no length, looks the new way
    ahead, left = result.R_MF[i, :, 0], result.R_MF[i, :, 1]
    angle = angle_between(ahead[1:], ahead[:-1]) * np.sign(np.einsum("mi,mi->m", ahead[1:], left[:-1]))
    breaks = np.cumsum(~level)
    angle[breaks[i[1:]] != breaks[i[:-1]]] = 0.0
    bend[i] = 0.5 * (np.append(0.0, angle) + np.append(angle, 0.0))
    return bend


def _slices(walls: Readings, sides: _Sides) -> tuple[FloatArray, FloatArray]:
    """Height (n,) m from each tip up to the next pass above along the same wall, and how many passes share it."""
    from scipy.spatial import cKDTree

    step = np.where(sides.steep, 0.0, sides.length)
    reach = NEAR * np.maximum(step, 1e-4)
    high, passes = sides.deep.copy(), np.ones(len(step))
    # Walls that look another way stand further apart than any that are one.
    turned = 2.0 * reach.max() * walls.out[sides.first, :2]
    where = np.column_stack([walls.place[sides.first, :2], turned])
    tree, rise = cKDTree(where), sides.base
    for some in slices(len(step), "Walls that are left"):
        rows = np.arange(len(step))[some]
        found = tree.query_ball_point(where[rows], reach[rows])
        a = np.repeat(rows, [len(each) for each in found])
        b = np.concatenate([np.asarray(each, dtype=np.int64) for each in found])
        other = np.abs(sides.s[a] - sides.s[b]) > OWN * np.maximum(step[a], 1e-4)
        above = other & (rise[b] > rise[a] + SAME) & ~sides.steep[b]
        np.minimum.at(high, a[above], (rise[b] - rise[a])[above])
        level = np.abs(rise[b] - rise[a]) <= SAME
        own, all_ = (np.bincount(a[chosen], sides.length[b[chosen]], len(step)) for chosen in (level & ~other, level))
        passes[rows] = np.maximum(all_[rows] / np.maximum(own[rows], 1e-30), 1.0)
    return np.maximum(high, 0.0), passes
