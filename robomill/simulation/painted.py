"""The true error that a picture paints: a floor's in height, a wall's normal to it, whatever is enlarged."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from robomill.arrays import BoolArray, FloatArray, IntArray
from robomill.cutting.conditions import STEEP
from robomill.simulation.result import SimulationResult
from robomill.surface.zmap import ZMap

AROUND = 2  # cells: a wall is told so far around it, since a picture that moves is drawn with every second cell
STEEPEST = 2.0  # cells of height among those: what rises more is a wall


def true_error(result: SimulationResult, ideal: ZMap, drawn: ZMap, aside: ZMap, times: float) -> FloatArray:
    """True signed error (nx, ny) m, told by a picture, enlarged or not: one law of colour at every exaggeration.

    A floor's error is one of height, enlarged ``times`` times. Where the path moved sideways alone (``aside``) leaves
    another height than the ideal one, and more than the slope of the path tells, a wall has moved over the cell: that
    has the wall's own error normal to it, as a gauge reads it, however high the wall is. Where the enlarged path leaves
    the stock, the floor is as much too high as the nearest sample.
    """
    error = np.asarray((drawn.z - ideal.z) / times)
    i = np.flatnonzero(result.judged)
    if not len(i):
        return error
    moved = (result.p_machined - result.path.p)[i]
    size = np.linalg.norm(moved[:, :2], axis=1)
    nearest = _Nearest(result.path.p[i])
    over = aside.z - ideal.z
    wall = np.abs(over) > drawn.cell
    sample = nearest.of(drawn, wall, np.minimum(ideal.z, drawn.z))
    moved_over = np.abs(over[wall]) > drawn.cell + times * (size * _slope(result)[i])[sample]
    wall[wall] = moved_over
    error[wall] = np.sign(over[wall]) * size[sample[moved_over]]  # where no gauge was put
    readings, reach = _walls(result), times * float(size.max()) + float(result.tooling.each("radius").max())
    for sign in (1.0, -1.0):
        some = readings.only(sign * readings.left > 0.0)
        cells = wall & (np.sign(over) == sign)
        if cells.any() and len(some.left):
            where = np.concatenate([some.place, some.moved(0.5 * times), some.moved(times)])
            found, distance = _Nearest(where).near(drawn, cells, drawn.z)
            near = distance <= reach
            error[cells] = np.where(near, some.left[found % len(some.left)], error[cells])
    out = ideal.cut_mask & ~drawn.cut_mask
    up = moved[nearest.of(drawn, out, ideal.z), 2]
    error[out] = np.where(times * up > (drawn.z - ideal.z)[out], up, error[out])
    return error


class _Walls(NamedTuple):
    """Where a gauge was put on walls (q, 3) m, the way (q, 3) into the part, and the material left there (q,) m."""

    place: FloatArray
    out: FloatArray
    left: FloatArray

    def only(self, some: BoolArray) -> _Walls:
        return _Walls(*(each[some] for each in self))

    def moved(self, times: float) -> FloatArray:
        """(q, 3) m: where the walls stand with their error so many times enlarged."""
        return np.asarray(self.place - times * self.left[:, None] * self.out)


def _walls(result: SimulationResult) -> _Walls:
    """Walls along cuts and across their ends."""
    read = (result.gauge.walls, result.gauge.ends)
    place, out = (np.concatenate([getattr(each, name) for each in read]) for name in ("place", "out"))
    return _Walls(place, out, np.concatenate([each.material_left for each in read]))


class _Nearest:
    """Points (q, 3) m, asked which is nearest to the cells of a surface."""

    def __init__(self, points: FloatArray) -> None:
        from scipy.spatial import cKDTree

        self._tree = cKDTree(points)

    def near(self, surface: ZMap, cells: BoolArray, z: FloatArray) -> tuple[IntArray, FloatArray]:
        """(c,) which point, and (c,) m how far it is from each of the ``cells`` at its height ``z`` (nx, ny) m."""
        i, j = np.nonzero(cells)
        distance, which = self._tree.query(np.column_stack([surface.x[i], surface.y[j], z[cells]]))
        return np.asarray(which), np.asarray(distance)

    def of(self, surface: ZMap, cells: BoolArray, z: FloatArray) -> IntArray:
        """(c,) which point is nearest to each of the ``cells``."""
        return self.near(surface, cells, z)[0]


def _slope(result: SimulationResult) -> FloatArray:
    """(m,) how far the path rises or sinks on its way along the part; a plunge has no floor beneath its way."""
    conditions = result.conditions
    slope = np.abs(conditions.along) / np.maximum(conditions.across, STEEP)
    return np.where(conditions.mostly_axial, 0.0, slope)


def wall_error(result: SimulationResult, drawn: ZMap, times: float) -> FloatArray:
    """(nx, ny) m: the error of the wall beside each cell that stands above or below one; NaN beside none."""
    from scipy.ndimage import maximum_filter, minimum_filter

    found, walls = np.full(drawn.z.shape, np.nan), _walls(result)
    high, low = (most(drawn.z, 2 * AROUND + 1, mode="nearest") for most in (maximum_filter, minimum_filter))
    steep = (high - low > STEEPEST * max(drawn.dx, drawn.dy)) & np.isfinite(drawn.z)
    if not (steep.any() and len(walls.left)):
        return found
    # A wall is looked for in the middle of its height: the one that a deeper layer leaves is another one.
    stand = walls.moved(times)
    which = _Nearest(stand).of(drawn, steep, 0.5 * (high + low))
    i, j = np.nonzero(steep)
    distance = np.hypot(drawn.x[i] - stand[which, 0], drawn.y[j] - stand[which, 1])
    near = distance <= result.setup.step + 2.0 * AROUND * max(
        drawn.dx, drawn.dy
    )  # else it is a step between two floors
    found[steep] = np.where(near, walls.left[which], np.nan)
    return found
