"""What a cutter takes away on a straight move, exactly: the lower envelope of the swept body.

A cutter is the solid above its profile, ``h >= profile(r)``, ``r <= R``; every profile here is convex. Along a
straight move with a fixed axis the swept body is convex too, so the lowest cut height over a point of the
plane is the minimum of a convex function of one variable, with a closed form (a bisection for bull-nose ramps).

This is the NumPy path. ``kernels.py`` states the same for one cell at a time, compiled.
"""

from __future__ import annotations

import math
from typing import Any, NamedTuple

import numpy as np

from robomill.arrays import FloatArray
from robomill.cutting.tool import Cutter

FLAT, BALL, BULL, CHAMFER = range(4)
BISECTIONS = 32
SAME_EDGE = 0.5


class Shape(NamedTuple):
    """A convex profile in numbers: flat out to r0, then a corner of radius rc or a cone rising by ``slope``."""

    kind: int
    R: float
    r0: float
    rc: float
    slope: float


def cutter_shape(cutter: Cutter) -> Shape:
    """The numbers of a cutter's profile (m); a bull-nose with no corner is flat, with a full one a ball."""
    R, r0 = float(cutter.radius), float(cutter.flat_radius)
    if cutter.conical:
        return Shape(CHAMFER, R, r0, 0.0, float(cutter.nose_height) / (R - r0))
    if r0 >= R:
        return Shape(FLAT, R, R, 0.0, 0.0)
    return Shape(BALL if r0 <= 0.0 else BULL, R, max(r0, 0.0), R - max(r0, 0.0), 0.0)


def profile(shape: Shape, r: FloatArray) -> FloatArray:
    """Height of the cutting surface above the tip at radius r <= R, m."""
    if shape.kind == FLAT:
        return np.zeros_like(r)
    if shape.kind == CHAMFER:
        return shape.slope * np.maximum(r - shape.r0, 0.0)
    e = np.maximum(r - shape.r0, 0.0)
    return shape.rc - np.sqrt(np.maximum(shape.rc**2 - e * e, 0.0))


def contact_lag(shape: Shape, m: float | FloatArray, v2: FloatArray) -> FloatArray:
    """How far behind a point (along the move) the cutter stands when it cuts lowest there, m.

    m >= 0: rise of the move per length in plan; v2: squared distance of the point from the move's line, <= R^2.
    It solves ``m = profile'(r) w / r`` with ``r^2 = w^2 + v^2``; a level move gives 0.
    """
    widest = np.sqrt(np.maximum(shape.R**2 - v2, 0.0))
    if np.ndim(m) == 0 and m == 0.0:
        return np.zeros_like(widest)
    m = np.asarray(m)
    if shape.kind == FLAT:
        return np.where(m > 0.0, widest, 0.0)
    if shape.kind == BALL:
        return widest * (m / np.sqrt(1.0 + m * m))
    kink = np.sqrt(np.maximum(shape.r0**2 - v2, 0.0))
    if shape.kind == CHAMFER:
        steep = m >= shape.slope
        gain = m / np.sqrt(np.where(steep, 1.0, shape.slope**2 - m * m))
        w = np.where(steep, widest, np.minimum(np.maximum(np.sqrt(v2) * gain, kink), widest))
        return np.where(m > 0.0, w, 0.0)
    low, high = np.broadcast_arrays(kink, widest, m)[:2]
    for _ in range(BISECTIONS):
        w = 0.5 * (low + high)
        r = np.sqrt(w * w + v2)
        e = r - shape.r0
        below = e * w < m * r * np.sqrt(np.maximum(shape.rc**2 - e * e, 0.0))
        low, high = np.where(below, w, low), np.where(below, high, w)
    return np.where(m > 0.0, 0.5 * (low + high), 0.0)


class Move(NamedTuple):
    """A straight move seen from above, from its lower end: start, unit direction, length in plan, rise per length.

    The fields are floats, or arrays (n, 1) for n moves asked at once.
    """

    ax: Any
    ay: Any
    az: Any
    ux: Any
    uy: Any
    length: Any
    m: Any


def move_of(a: FloatArray, b: FloatArray) -> Move:
    """The move between two points (3,); which is the start does not matter for what is cut."""
    if b[2] < a[2]:
        a, b = b, a
    length = math.hypot(b[0] - a[0], b[1] - a[1])
    if length < 1e-12:
        return Move(float(a[0]), float(a[1]), float(a[2]), 1.0, 0.0, 0.0, 0.0)
    return Move(
        float(a[0]),
        float(a[1]),
        float(a[2]),
        (b[0] - a[0]) / length,
        (b[1] - a[1]) / length,
        length,
        (b[2] - a[2]) / length,
    )


def moves_of(ends: FloatArray) -> Move:
    """``move_of`` for ends (n, 6): fields (n, 1)."""
    swap = ends[:, 5] < ends[:, 2]
    a = np.where(swap[:, None], ends[:, 3:], ends[:, :3])
    span = np.where(swap[:, None], -1.0, 1.0) * (ends[:, 3:] - ends[:, :3])
    length = np.hypot(span[:, 0], span[:, 1])
    point = length < 1e-12
    safe = np.where(point, 1.0, length)
    ux, uy = np.where(point, 1.0, span[:, 0] / safe), np.where(point, 0.0, span[:, 1] / safe)
    length, m = np.where(point, 0.0, length), np.where(point, 0.0, span[:, 2] / safe)
    return Move(*(value[:, None] for value in (a[:, 0], a[:, 1], a[:, 2], ux, uy, length, m)))


def swept_height(shape: Shape, move: Move, x: FloatArray, y: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Lowest height cut at points (x, y) by an upright cutter on ``move``, and how deep inside its track they are.

    Returns (z, d): z in m (valid where d >= 0), d = R - distance from the move in plan (m).
    """
    X, Y = x - move.ax, y - move.ay
    s = X * move.ux + Y * move.uy
    v = Y * move.ux - X * move.uy
    v2 = v * v
    near = np.clip(s, 0.0, move.length)
    d = shape.R - np.sqrt((s - near) ** 2 + v2)
    t = np.clip(s - contact_lag(shape, move.m, v2), 0.0, move.length)
    if shape.kind == FLAT:
        return move.az + move.m * t, d
    r = np.sqrt((s - t) ** 2 + v2)
    return move.az + move.m * t + profile(shape, r), d


def row_interval(move: Move, R: float, x: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Where the line at ``x`` parallel to y lies inside the track of radius R: (low, high), low > high if nowhere."""
    low, high = np.full(np.shape(x), np.inf), np.full(np.shape(x), -np.inf)
    bx, by = move.ax + move.length * move.ux, move.ay + move.length * move.uy
    for cx, cy in ((move.ax, move.ay), (bx, by)):
        w2 = R * R - (x - cx) ** 2
        w = np.sqrt(np.maximum(w2, 0.0))
        low = np.where(w2 >= 0, np.minimum(low, cy - w), low)
        high = np.where(w2 >= 0, np.maximum(high, cy + w), high)
    X = x - move.ax
    with np.errstate(divide="ignore", invalid="ignore"):
        t_a, t_b = (0.0 - X * move.ux) / move.uy, (move.length - X * move.ux) / move.uy
        v_a, v_b = (X * move.uy - R) / move.ux, (X * move.uy + R) / move.ux
    if move.uy == 0.0:
        inside = (X * move.ux >= 0) & (X * move.ux <= move.length)
        t_a, t_b = np.where(inside, -np.inf, np.inf), np.where(inside, np.inf, -np.inf)
    if move.ux == 0.0:
        inside = np.abs(X * move.uy) <= R
        v_a, v_b = np.where(inside, -np.inf, np.inf), np.where(inside, np.inf, -np.inf)
    else:
        v_a, v_b = np.minimum(v_a, v_b), np.maximum(v_a, v_b)
    if move.uy != 0.0:
        t_a, t_b = np.minimum(t_a, t_b), np.maximum(t_a, t_b)
    strip_low, strip_high = np.maximum(t_a, v_a) + move.ay, np.minimum(t_b, v_b) + move.ay
    strip = (strip_low <= strip_high) & (move.length > 0)
    return np.where(strip, np.minimum(low, strip_low), low), np.where(strip, np.maximum(high, strip_high), high)


def covered_share(d: FloatArray, nx: FloatArray, ny: FloatArray, dx: float, dy: float) -> FloatArray:
    """Share of a dx x dy cell inside a straight edge: d, how far its centre lies inside; n, the edge's unit normal."""
    a, b = np.abs(nx) * dx, np.abs(ny) * dy
    a, b = np.maximum(a, b), np.minimum(a, b)
    p = np.clip(d + 0.5 * (a + b), 0.0, a + b)
    with np.errstate(divide="ignore", invalid="ignore"):
        corner = p * p / (2 * a * b)
        far = 1.0 - (a + b - p) ** 2 / (2 * a * b)
        share = np.where(p < b, corner, np.where(p <= a, (p - 0.5 * b) / a, far))
    return np.clip(share, 0.0, 1.0)


def note_share(record: FloatArray, covered: FloatArray, ex: FloatArray, ey: FloatArray) -> FloatArray:
    """Records (n, 5) of edge cells with one more edge each: what it covers, and its normal (ex, ey).

    A record holds what the first edge's direction covers, what edges in other directions cover, the first edge's
    normal and how far the others turn from it (cosine). Edges within 60 degrees are taken as one wall, cut again.
    """
    fresh = (record[:, 2] == 0.0) & (record[:, 3] == 0.0)
    turn = ex * record[:, 2] + ey * record[:, 3]
    same = ~fresh & (turn > SAME_EDGE)
    other = ~fresh & ~same & (covered > record[:, 1])
    result = record.copy()
    result[fresh, 0], result[fresh, 2], result[fresh, 3] = covered[fresh], ex[fresh], ey[fresh]
    result[same, 0] = np.maximum(record[same, 0], covered[same])
    result[other, 1], result[other, 4] = covered[other], turn[other]
    return result


def union_share(record: FloatArray) -> FloatArray:
    """Share of cells covered in all, from their records (n, 5): opposite edges add, crossing edges overlap."""
    first, other = record[:, 0], record[:, 1]
    together = np.where(record[:, 4] < -SAME_EDGE, first + other, first + other - first * other)
    return np.minimum(1.0, together)
