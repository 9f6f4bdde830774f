"""Between which heights the material ends over squares of a coarse grid, compiled.

Most places that a step looks at lie well inside the material or well above it, and so do all others of their square:
there nothing is looked up cell by cell, and no rib is looked for. What a square says holds for the material as it
stands, not only for the columns: a run lowers the squares that its track touches by its own geometry.
"""

from __future__ import annotations

import math
from typing import NamedTuple

from robomill.arrays import FloatArray
from robomill.compiled import Out3, part
from robomill.cutting.profile_kernels import FLAT, Shape, clip, profile
from robomill.surface.envelope_kernels import Move, nearest

CLOSE = 1e-9  # m: so near to a bound nothing is said: rounding
AIR, UNKNOWN, MATERIAL = -1, 0, 1
LOW, HIGH, SIDES = range(3)  # of a square: below which all is material, above which all is air, whether sides pass

Point = tuple[float, float, float]


class Relief(NamedTuple):
    """Squares of a coarse grid over the stock, from its lower corner on.

    tops (nx, ny, 3) m: below the first all is material down to the bottom, above the second all is air, in a square and
    up to ``margin`` m about it; not 0 where the side of a run may pass there; x0, y0 m; how many squares there are on a
    metre along x and y; and the bottom, m. Nothing is known beside them.
    """

    tops: Out3
    x0: float
    y0: float
    per_x: float
    per_y: float
    margin: float
    bottom: float


@part
def square_about(relief: Relief, x: float, y: float) -> tuple[float, float, bool]:
    """Between which heights the material ends about a point in plan, m, and whether the side of a run may pass there:
    within the margin."""
    i, j = math.floor((x - relief.x0) * relief.per_x), math.floor((y - relief.y0) * relief.per_y)
    if i < 0 or j < 0 or i >= relief.tops.shape[0] or j >= relief.tops.shape[1]:
        return -math.inf, math.inf, True
    return relief.tops[i, j, LOW], relief.tops[i, j, HIGH], relief.tops[i, j, SIDES] != 0.0


@part
def tops_about(relief: Relief, x: float, y: float) -> tuple[float, float]:
    """Between which heights the material ends about a point in plan, m: within the margin."""
    low, high, _ = square_about(relief, x, y)
    return low, high


@part
def tops_between(relief: Relief, a: Point, b: Point) -> tuple[float, float]:
    """Between which heights the material ends about the straight way or a flat arc between two points, m."""
    x, y = 0.5 * (a[0] + b[0]), 0.5 * (a[1] + b[1])
    if (x - a[0]) ** 2 + (y - a[1]) ** 2 > relief.margin**2:
        return -math.inf, math.inf
    return tops_about(relief, x, y)


@part
def told(relief: Relief, tops: tuple[float, float], z_low: float, z_high: float) -> int:
    """What stands between two heights where the material ends between ``tops``: AIR, MATERIAL or UNKNOWN."""
    if z_low > tops[1] + CLOSE:
        return AIR
    return MATERIAL if z_high < tops[0] - CLOSE and z_low >= relief.bottom else UNKNOWN


@part
def half_of(relief: Relief) -> float:
    """How far from the middle of a square its bounds hold, m."""
    return 0.5 * math.hypot(1.0 / relief.per_x, 1.0 / relief.per_y) + relief.margin + CLOSE


@part
def covered(shape: Shape, move: Move, x: float, y: float, half: float) -> float:
    """Up to which height an upright cutter's move leaves material in a disc of radius ``half`` m about a point in plan,
    at most, m; inf where no place of the tool covers the disc."""
    X, Y = x - move.ax, y - move.ay
    s, v = X * move.ux + Y * move.uy, Y * move.ux - X * move.uy
    within = (shape.R - half - CLOSE) ** 2 - v * v
    if within < 0.0 or half >= shape.R:
        return math.inf
    lag = 0.0
    if move.m != 0.0:
        lag = math.sqrt(within) * (1.0 if shape.kind == FLAT else move.m / math.sqrt(1.0 + move.m * move.m))
    t = clip(s - lag, 0.0, move.length)
    far = math.sqrt((s - t) ** 2 + v * v) + half
    return move.az + move.m * t + profile(shape, far) if far <= shape.R else math.inf


@part
def lower_tops(tops: FloatArray, square: Point, shape: Shape, move: Move, radius: float) -> None:
    """Lower the bounds of a square, its middle and how far they hold (x, y, half), for an upright cutter's move,
    which reaches ``radius`` m wide into the stock."""
    x, y, half = square
    if tops[HIGH] <= move.az:
        return
    ex, ey = nearest(move, x, y)
    near = max(math.sqrt(ex * ex + ey * ey) - half, 0.0)
    if near < radius:
        first = clip((x - move.ax) * move.ux + (y - move.ay) * move.uy - half - radius, 0.0, move.length)
        tops[LOW] = min(tops[LOW], move.az + move.m * first + profile(shape, near))
        tops[HIGH] = min(tops[HIGH], covered(shape, move, x, y, half))


@part
def tell(relief: Relief, low: tuple[float, float], high: tuple[float, float], which: int, number: float) -> None:
    """Have ``which`` number of all squares be ``number`` from now on, between two corners in plan and the margin about
    them."""
    i = max(math.floor((low[0] - relief.margin - relief.x0) * relief.per_x), 0)
    j_first = max(math.floor((low[1] - relief.margin - relief.y0) * relief.per_y), 0)
    i_last = min(math.floor((high[0] + relief.margin - relief.x0) * relief.per_x), relief.tops.shape[0] - 1)
    j_last = min(math.floor((high[1] + relief.margin - relief.y0) * relief.per_y), relief.tops.shape[1] - 1)
    while i <= i_last:
        for j in range(j_first, j_last + 1):
            relief.tops[i, j, which] = number
        i += 1
