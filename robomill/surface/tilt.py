"""The envelope of a cutter whose axis is tilted: upright in the tool's own frame, met there by vertical lines."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from robomill.arrays import FloatArray
from robomill.surface.envelope import Move, Shape, move_of, row_interval, swept_height

GOLDEN = 0.6180339887498949


class Tilt(NamedTuple):
    """The tool's own frame for a tilted axis k: e1 level, e2 uphill across the tool, and the tilt's sine and cosine."""

    e1: FloatArray
    e2: FloatArray
    k: FloatArray
    sine: float
    cosine: float


def tilt_of(k: FloatArray) -> Tilt:
    """Frame of a tool axis k (3,) that is not vertical."""
    sine = math.hypot(k[0], k[1])
    e1 = np.array([-k[1], k[0], 0.0]) / sine
    return Tilt(e1, np.cross(k, e1), k, sine, float(k[2]))


def tilted_move(tilt: Tilt, a: FloatArray, b: FloatArray) -> Move:
    """The move a -> b (3,) in {W}, seen in the tool's frame."""
    frame = np.stack([tilt.e1, tilt.e2, tilt.k])
    return move_of(frame @ a, frame @ b)


def tilted_interval(
    shape: Shape, tilt: Tilt, move: Move, x: FloatArray, y: FloatArray, ceiling: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Heights (low, high) of the vertical lines at (x, y) (n,) inside the swept body, not above ``ceiling`` (n,).

    ``move`` is in the tool's frame. Along a vertical line the gap to the swept surface is convex, so the line is
    inside between two roots. low > high where a line misses the body.
    """
    X = x * tilt.e1[0] + y * tilt.e1[1]
    Y0, h0 = x * tilt.e2[0] + y * tilt.e2[1], x * tilt.k[0] + y * tilt.k[1]
    track_low, track_high = row_interval(move, shape.R, X)
    low, high = (track_low - Y0) / tilt.sine, np.minimum((track_high - Y0) / tilt.sine, ceiling)
    z_low, z_high = np.full(X.shape, np.inf), np.full(X.shape, -np.inf)
    hit = np.flatnonzero(low < high)
    if len(hit) == 0:
        return z_low, z_high
    X, Y0, h0, low, high = X[hit], Y0[hit], h0[hit], low[hit], high[hit]

    def gap(z: FloatArray) -> FloatArray:
        return swept_height(shape, move, X, Y0 + z * tilt.sine)[0] - (h0 + z * tilt.cosine)

    inside = _point_inside(gap, low, high)
    found = np.isfinite(inside)
    held = np.where(found, inside, low)
    z_low[hit] = np.where(found, _root(gap, low, held), np.inf)
    z_high[hit] = np.where(found, _root(gap, high, held), -np.inf)
    return z_low, z_high


def _point_inside(gap: Callable[[FloatArray], FloatArray], low: FloatArray, high: FloatArray) -> FloatArray:
    """A z in [low, high] where the convex gap is not positive; inf where there is none."""
    inside = np.where(gap(high) <= 0, high, np.inf)
    inside = np.where(gap(low) <= 0, low, inside)
    a, b = low, high
    c, d = b - GOLDEN * (b - a), a + GOLDEN * (b - a)
    gap_c, gap_d = gap(c), gap(d)
    for _ in range(64):
        inside = np.where(np.isinf(inside) & (gap_c <= 0), c, inside)
        inside = np.where(np.isinf(inside) & (gap_d <= 0), d, inside)
        if np.isfinite(inside).all():
            break
        left = gap_c < gap_d
        a, b = np.where(left, a, c), np.where(left, d, b)
        c_new, d_new = b - GOLDEN * (b - a), a + GOLDEN * (b - a)
        fresh = gap(np.where(left, c_new, d_new))
        c, d = np.where(left, c_new, d), np.where(left, c, d_new)
        gap_c, gap_d = np.where(left, fresh, gap_d), np.where(left, gap_c, fresh)
    return inside


def _root(gap: Callable[[FloatArray], FloatArray], outside: FloatArray, inside: FloatArray) -> FloatArray:
    """Where the gap changes sign between an end and a point inside; the end itself if it is inside."""
    at_end = gap(outside) <= 0
    a, b = outside, inside
    for _ in range(48):
        middle = 0.5 * (a + b)
        out = gap(middle) > 0
        a, b = np.where(out, middle, a), np.where(out, b, middle)
    return np.where(at_end, outside, b)
