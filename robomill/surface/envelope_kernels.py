"""What an upright cutter takes away on a straight move, exactly: the lower envelope of the swept body.

A cutter is the solid above its profile, which is convex (``cutting.profile_kernels``). Along a
straight move with a fixed axis the swept body is convex too, so the lowest cut height over a point of the
plane is the minimum of a convex function of one variable, with a closed form (Newton's steps for bull-nose ramps).
Compiled, one point at a time; ``tilt_kernels.py`` has the cutter that leans.
"""

from __future__ import annotations

import math
from typing import NamedTuple

from robomill.compiled import part
from robomill.cutting.profile_kernels import Shape, clip, contact_lag, profile_within, upright_part

POINT = 1e-12  # m: a move shorter than this in plan goes straight up or down


class Move(NamedTuple):
    """A straight move from its lower end, m: start, unit direction and length in plan, rise per length."""

    ax: float
    ay: float
    az: float
    ux: float
    uy: float
    length: float
    m: float


@part
def move_between(ax: float, ay: float, az: float, bx: float, by: float, bz: float) -> Move:
    """The move between two points; which is the start does not matter for what is cut."""
    if bz < az:
        ax, ay, az, bx, by, bz = bx, by, bz, ax, ay, az
    length = math.hypot(bx - ax, by - ay)
    if length < POINT:
        return Move(ax, ay, az, 1.0, 0.0, 0.0, 0.0)
    return Move(ax, ay, az, (bx - ax) / length, (by - ay) / length, length, (bz - az) / length)


@part
def nearest(move: Move, x: float, y: float) -> tuple[float, float]:
    """From the nearest point of a move in plan to (x, y): (ex, ey) m."""
    X, Y = x - move.ax, y - move.ay
    t = clip(X * move.ux + Y * move.uy, 0.0, move.length)
    return X - t * move.ux, Y - t * move.uy


@part
def swept_height(shape: Shape, move: Move, x: float, y: float) -> float:
    """Lowest height cut at (x, y) by an upright cutter on ``move``, m; holds where (x, y) lies within its track."""
    X, Y = x - move.ax, y - move.ay
    s = X * move.ux + Y * move.uy
    v = Y * move.ux - X * move.uy
    t = clip(s - contact_lag(shape, move.m, v * v), 0.0, move.length)
    return move.az + move.m * t + profile_within(shape, (s - t) ** 2 + v * v)


@part
def swept_upright(shape: Shape, move: Move, x: float, y: float) -> float:
    """Upward part of the normal of what an upright cutter leaves on ``move`` at (x, y), where its track passes.

    A surface ruled along the move rises with it; across it, as the profile does where it touches, whose slope there
    lets the height be stationary along the move (``contact_lag``). At the ends the cutter's own shape is left.
    """
    X, Y = x - move.ax, y - move.ay
    s = X * move.ux + Y * move.uy
    v = Y * move.ux - X * move.uy
    lag = contact_lag(shape, move.m, v * v)
    t = clip(s - lag, 0.0, move.length)
    if move.m == 0.0 or lag <= 0.0 or t != s - lag:
        return upright_part(shape, math.sqrt((s - t) ** 2 + v * v))
    return 1.0 / math.sqrt(1.0 + move.m * move.m * (1.0 + (v / lag) ** 2))


@part
def row_interval(move: Move, R: float, x: float) -> tuple[float, float]:
    """Where the line at ``x`` parallel to y lies inside the track of radius R: (low, high) m, low > high if nowhere.

    The track is convex: a disk about either end of the move, and the strip between them.
    """
    low, high = math.inf, -math.inf
    X = x - move.ax
    along_x, along_y = move.length * move.ux, move.length * move.uy
    for cx, cy in ((0.0, 0.0), (along_x, along_y)):
        w2 = R * R - (X - cx) ** 2
        if w2 >= 0.0:
            low, high = min(low, cy - math.sqrt(w2)), max(high, cy + math.sqrt(w2))
    if move.length > 0.0:
        # the strip: 0 <= s <= length along the move, |v| <= R across it
        s_low, s_high = between(X * move.ux, move.uy, 0.0, move.length)
        v_low, v_high = between(-X * move.uy, move.ux, -R, R)
        a, b = max(s_low, v_low), min(s_high, v_high)
        if a <= b:
            low, high = min(low, a), max(high, b)
    return low + move.ay, high + move.ay


@part
def between(start: float, slope: float, low: float, high: float) -> tuple[float, float]:
    """Where low <= start + slope * y <= high: (from, to), from > to if nowhere."""
    if slope == 0.0:
        return (-math.inf, math.inf) if low <= start <= high else (math.inf, -math.inf)
    per = 1.0 / slope
    a, b = (low - start) * per, (high - start) * per
    return min(a, b), max(a, b)
