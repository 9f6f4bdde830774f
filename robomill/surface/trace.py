"""Following one groove in a section plane: where its walls stand, how they lean, how its floor lies."""

from dataclasses import dataclass

import numpy as np

from robomill.arrays import BoolArray, FloatArray
from robomill.surface.swept import Heights

WALL_LEVELS = 9
FLOOR_POINTS = 21
SUBDIVISIONS, NARROWINGS = 16, 6  # from a fiftieth of the radius to less than a picometre for each millimetre of it
FINEST = 1 / 20_000  # of the way to the side of the stock: the shortest step by which a wall is sought


@dataclass(frozen=True)
class Trace:
    """One groove in a section plane: wall positions and angles, floor, and its height function."""

    left: float
    right: float
    left_angle: float
    right_angle: float
    left_straightness: float
    right_straightness: float
    floor: float
    floor_tilt: float
    top: float
    height: Heights


def trace_groove(height: Heights, middle: float, low: float, high: float, radius: float, skin: Heights) -> Trace | None:
    """Follow the cut region from the tool axis at ``middle`` to the first material on either side.

    Walls are NaN where the region runs out of the stock (low, high). None if nothing is cut at the tool axis.
    """
    floor, top = float(height(np.array([middle]))[0]), float(skin(np.array([middle]))[0])
    if not floor < top - 1e-12:
        return None
    levels = top - (top - floor) * np.concatenate([[1e-9], np.linspace(0.02, 0.6, WALL_LEVELS)])
    walls = {side: _wall(height, skin, middle, end, levels, radius) for side, end in ((1, high), (-1, low))}
    left, left_angle, left_bow = _wall_form(walls[1], levels, 1)
    right, right_angle, right_bow = _wall_form(walls[-1], levels, -1)
    inner = [0.5 * ((limit if np.isnan(edge) else edge) - middle) for edge, limit in ((right, low), (left, high))]
    across = np.linspace(max(inner[0], -0.5 * radius), min(inner[1], 0.5 * radius), FLOOR_POINTS)
    slope = float(np.polyfit(across, height(middle + across) - floor, 1)[0])
    return Trace(left, right, left_angle, right_angle, left_bow, right_bow, floor, slope, top, height)


def _wall(height: Heights, skin: Heights, middle: float, end: float, levels: FloatArray, radius: float) -> FloatArray:
    """Position w of the first material above each level, from ``middle`` towards ``end``; NaN if there is none.

    Where the stock itself lies below a level, material is what was not cut. Found on a line of points, then on
    ever finer ones between two of them; material narrower than a fiftieth of the radius may be missed, and under a
    cutter much smaller than the stock, what is narrower than a twenty-thousandth of the way.
    """
    side = 1.0 if end > middle else -1.0
    reach = abs(end - middle)
    step = max(radius / 50, FINEST * reach)
    thin = 1e-9 * abs(levels[0] - levels[-1]) + 1e-12

    def above(w: FloatArray, level: FloatArray) -> BoolArray:
        return np.asarray(height(w) >= np.minimum(level, skin(w) - thin))

    start, found = 0.0, np.full((len(levels), 2), np.nan)
    while start < reach and np.isnan(found[:, 0]).any():
        ahead = np.minimum(start + step * np.arange(76), reach)
        w = middle + side * ahead[1:]
        z, uncut = height(w), skin(w) - thin
        for n in np.flatnonzero(np.isnan(found[:, 0])):
            hits = np.flatnonzero(z >= np.minimum(levels[n], uncut))
            if len(hits):
                found[n] = ahead[hits[0]], ahead[hits[0] + 1]
        start = float(ahead[-1])
    a, b = found[:, 0], found[:, 1]
    known = np.isfinite(a)
    if not known.any():
        return a
    a, b, level = a[known], b[known], levels[known]
    parts = np.arange(SUBDIVISIONS + 1) / SUBDIVISIONS
    for _ in range(NARROWINGS):
        c = a[:, None] + parts * (b - a)[:, None]
        inner = middle + side * c[:, 1:-1]
        solid = above(inner.ravel(), np.repeat(level, inner.shape[1])).reshape(inner.shape)
        first = np.where(solid.any(axis=1), solid.argmax(axis=1), SUBDIVISIONS - 1)
        a, b = c[np.arange(len(a)), first], c[np.arange(len(a)), first + 1]
    result = np.full(len(levels), np.nan)
    result[known] = middle + side * 0.5 * (a + b)
    return result


def _wall_form(wall: FloatArray, levels: FloatArray, side: int) -> tuple[float, float, float]:
    """Position at the top, angle and straightness of a wall from its positions at the levels: whoever meets material
    as high as the top has met it at every level below."""
    if np.isnan(wall[0]):
        return float("nan"), float("nan"), float("nan")
    z, w = levels[1:], wall[1:]
    slope, offset = np.polyfit(z, w, 1)
    off_line = (w - (slope * z + offset)) / np.sqrt(1 + slope * slope)
    return float(wall[0]), float(np.pi / 2 + np.arctan(side * slope)), float(np.ptp(off_line))
