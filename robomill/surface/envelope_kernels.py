"""What an upright cutter takes away on a straight move, exactly: the lower envelope of the swept body.

A cutter is the solid above its profile, ``h >= profile(r)``, ``r <= R``; every profile here is convex. Along a
straight move with a fixed axis the swept body is convex too, so the lowest cut height over a point of the
plane is the minimum of a convex function of one variable, with a closed form (Newton's steps for bull-nose ramps).
Compiled, one point at a time; ``tilt_kernels.py`` has the cutter that leans.
"""

from __future__ import annotations

import math
from typing import NamedTuple

from robomill.arrays import FloatArray
from robomill.compiled import part
from robomill.cutting.tool import Cutter

FLAT, BALL, BULL, CHAMFER = range(4)
ROUGH = 1e-7  # of the radius: the height is stationary at the contact, so a rough one gives it to rounding
STEPS = 40
POINT = 1e-12  # m: a move shorter than this in plan goes straight up or down


class Shape(NamedTuple):
    """A convex profile in numbers (m): flat out to r0, then a corner of radius rc or a cone rising by ``slope``."""

    kind: int
    R: float
    r0: float
    rc: float
    slope: float


class Move(NamedTuple):
    """A straight move from its lower end, m: start, unit direction and length in plan, rise per length."""

    ax: float
    ay: float
    az: float
    ux: float
    uy: float
    length: float
    m: float


def cutter_shape(cutter: Cutter) -> Shape:
    """The numbers of a cutter's profile (m); a bull-nose with no corner is flat, with a full one a ball."""
    R, r0 = float(cutter.radius), float(cutter.flat_radius)
    if cutter.conical:
        return Shape(CHAMFER, R, r0, 0.0, float(cutter.nose_height) / (R - r0))
    if r0 >= R:
        return Shape(FLAT, R, R, 0.0, 0.0)
    return Shape(BALL if r0 <= 0.0 else BULL, R, max(r0, 0.0), R - max(r0, 0.0), 0.0)


@part
def shape_of(numbers: FloatArray) -> Shape:
    """The shape whose numbers these (5,) are, first of a longer row or alone."""
    return Shape(int(numbers[0]), numbers[1], numbers[2], numbers[3], numbers[4])


@part
def clip(value: float, low: float, high: float) -> float:
    """Value held between low and high."""
    return min(max(value, low), high)


@part
def profile(shape: Shape, r: float) -> float:
    """Height of the cutting surface above the tip at radius r <= R, m."""
    e = max(r - shape.r0, 0.0)
    if shape.kind == FLAT:
        return 0.0
    if shape.kind == CHAMFER:
        return shape.slope * e
    return shape.rc - math.sqrt(max(shape.rc**2 - e * e, 0.0))


@part
def profile_within(shape: Shape, square: float) -> float:
    """Height of the cutting surface above the tip where the squared radius is so much, m; a ball's without its root."""
    if shape.kind == BALL:
        return shape.rc - math.sqrt(max(shape.rc**2 - square, 0.0))
    return profile(shape, math.sqrt(square))


@part
def radius_at(shape: Shape, height: float) -> float:
    """Radius of the cutter ``height`` > 0 above its tip, m: the inverse of its profile."""
    if shape.kind == FLAT:
        return shape.R
    if shape.kind == CHAMFER:
        return min(shape.R, shape.r0 + height / shape.slope)
    h = min(height, shape.rc)
    return shape.r0 + math.sqrt(h * (2.0 * shape.rc - h))


@part
def contact_lag(shape: Shape, m: float, v2: float) -> float:
    """How far behind a point (along the move) the cutter stands when it cuts lowest there, m.

    m >= 0: rise of the move per length in plan; v2: squared distance of the point from the move's line, <= R^2.
    It solves ``m = profile'(r) w / r`` with ``r^2 = w^2 + v^2``; a level move gives 0.
    """
    if m == 0.0:
        return 0.0
    widest = math.sqrt(max(shape.R**2 - v2, 0.0))
    if shape.kind == FLAT:
        return widest
    if shape.kind == BALL:
        return widest * m / math.sqrt(1.0 + m * m)
    kink = math.sqrt(max(shape.r0**2 - v2, 0.0))
    if shape.kind == CHAMFER:
        if m >= shape.slope:
            return widest
        return clip(math.sqrt(v2) * m / math.sqrt(shape.slope**2 - m * m), kink, widest)
    # Newton's steps on f(w) = e w - m r sqrt(rc^2 - e^2), which rises from f(kink) <= 0, held in a bracket
    low, high, w = kink, widest, kink
    for _ in range(STEPS):
        r = math.sqrt(w * w + v2)
        e = max(r - shape.r0, 0.0)
        root = math.sqrt(max(shape.rc**2 - e * e, 0.0))
        f = e * w - m * r * root
        low, high = (w, high) if f < 0.0 else (low, w)
        if abs(f) < ROUGH * m * shape.R**2 or high - low < ROUGH * shape.R:
            break
        w -= f / (e + w / r * (w - m * root + m * r * e / root))
        if not low < w < high:
            w = 0.5 * (low + high)
    return w


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
    return move.az + move.m * t + profile(shape, math.sqrt((s - t) ** 2 + v * v))


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
    a, b = (low - start) / slope, (high - start) / slope
    return min(a, b), max(a, b)
