"""Arcs: sweep, true length, exact extremes, and the one place where they become chords.

An arc is the turn of a point about ``centre`` in one of the planes G17 (x, y), G18 (z, x) or G19 (y, z), seen
from the positive end of the third axis, along which it may climb (helix). Lengths in m, angles in rad.
"""

from __future__ import annotations

import math

import numpy as np

from robomill.arrays import BoolArray, FloatArray, IntArray
from robomill.errors import GCodeError

CHORD_ERROR = 1e-6
"""m: no chord lies farther than this from its arc, unless the caller asks for another figure."""

MAX_POINTS = 20_000_000
MAX_STEP = math.radians(30.0)
MAX_TILT_STEP = math.radians(2.0)
FULL_TURN = 1e-8
"""rad: an arc that would sweep less than this is a full turn, as an arc back to its start is."""

AXES = {17: (0, 1, 2), 18: (2, 0, 1), 19: (1, 2, 0)}
"""Plane -> (first axis, second axis, axis along which a helix climbs); a positive turn goes first to second."""

_FIRST = np.zeros(20, dtype=np.int64)
_SECOND = np.zeros(20, dtype=np.int64)
_NORMAL = np.zeros(20, dtype=np.int64)
for _plane, (_a, _b, _c) in AXES.items():
    _FIRST[_plane], _SECOND[_plane], _NORMAL[_plane] = _a, _b, _c


def in_plane(plane: IntArray, point: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
    """First, second and third coordinate (m,) of points (m, 3) in their planes (m,)."""
    rows = np.arange(len(point))
    return point[rows, _FIRST[plane]], point[rows, _SECOND[plane]], point[rows, _NORMAL[plane]]


def sweeps(
    start: FloatArray, end: FloatArray, centre: FloatArray, plane: IntArray, turns: IntArray, clockwise: BoolArray
) -> tuple[FloatArray, FloatArray, FloatArray, FloatArray]:
    """Start angle, signed sweep (rad) and the radii (m) at both ends of arcs, each (m,)."""
    u0, v0, _ = in_plane(plane, start)
    u1, v1, _ = in_plane(plane, end)
    cu, cv, _ = in_plane(plane, centre)
    angle = np.arctan2(v0 - cv, u0 - cu)
    sign = np.where(clockwise, -1.0, 1.0)
    part = np.mod(sign * (np.arctan2(v1 - cv, u1 - cu) - angle), 2.0 * math.pi)
    part = np.where((part < FULL_TURN) | (2.0 * math.pi - part < FULL_TURN), 2.0 * math.pi, part)
    sweep = sign * (part + 2.0 * math.pi * (turns - 1))
    return angle, sweep, np.hypot(u0 - cu, v0 - cv), np.hypot(u1 - cu, v1 - cv)


def arc_lengths(sweep: FloatArray, r0: FloatArray, r1: FloatArray, climb: FloatArray) -> FloatArray:
    """True length (m,) of helical arcs: mean radius times sweep, and the climb."""
    return np.hypot(0.5 * (r0 + r1) * sweep, climb)


def arc_extents(
    start: FloatArray, end: FloatArray, centre: FloatArray, plane: IntArray, turns: IntArray, clockwise: BoolArray
) -> tuple[FloatArray, FloatArray]:
    """Lowest and highest corner (m, 3) of each arc, its extreme points included."""
    lower, upper = np.minimum(start, end), np.maximum(start, end)
    angle, sweep, r0, r1 = sweeps(start, end, centre, plane, turns, clockwise)
    radius = np.maximum(r0, r1)
    cu, cv, _ = in_plane(plane, centre)
    first = np.minimum(angle, angle + sweep)
    rows = np.arange(len(start))
    for quarter in range(4):
        reached = np.mod(quarter * math.pi / 2.0 - first, 2.0 * math.pi) <= np.abs(sweep)
        axis = _FIRST[plane] if quarter % 2 == 0 else _SECOND[plane]
        middle = cu if quarter % 2 == 0 else cv
        side = middle + radius if quarter < 2 else middle - radius
        side = np.where(reached, side, start[rows, axis])
        lower[rows, axis] = np.minimum(lower[rows, axis], side)
        upper[rows, axis] = np.maximum(upper[rows, axis], side)
    return lower, upper


def chord_counts(sweep: FloatArray, radius: FloatArray, chord_error: float) -> IntArray:
    """Chords (m,) that keep within ``chord_error`` (m) of arcs: the sagitta is r (1 - cos(step / 2)).

    Raises GCodeError if the chord error is not positive or would need more than ``MAX_POINTS`` points.
    """
    if not (math.isfinite(chord_error) and chord_error > 0):
        raise GCodeError(f"Chord error: found {chord_error} m; expected a length above 0.")
    ratio = np.minimum(chord_error / np.maximum(radius, 1e-300), 2.0)
    step = np.minimum(4.0 * np.arcsin(np.sqrt(ratio / 2.0)), MAX_STEP)
    counts = np.maximum(np.ceil(np.abs(sweep) / step - 1e-9), 1.0)
    total = float(counts.sum())
    if total > MAX_POINTS:
        fits = chord_error * (total / MAX_POINTS) ** 2
        raise GCodeError(
            f"Arcs: a chord error of {chord_error * 1e3:.3g} mm would need {total:.3g} points; "
            f"at most {MAX_POINTS} fit, so use {fits * 1e3:.2g} mm or more, or fewer turns."
        )
    return counts.astype(np.int64)


def chord_points(
    start: FloatArray,
    end: FloatArray,
    centre: FloatArray,
    plane: IntArray,
    turns: IntArray,
    clockwise: BoolArray,
    *,
    counts: IntArray,
) -> FloatArray:
    """End points (sum of counts, 3) of the chords of arcs (m,); the last point of each arc is its end, exactly."""
    angle, sweep, r0, r1 = sweeps(start, end, centre, plane, turns, clockwise)
    owner = np.repeat(np.arange(len(start)), counts)
    first = np.repeat(np.cumsum(counts) - counts, counts)
    fraction = (np.arange(len(owner)) - first + 1) / counts[owner]
    phi = angle[owner] + fraction * sweep[owner]
    radius = r0[owner] + fraction * (r1 - r0)[owner]
    cu, cv, _ = in_plane(plane, centre)
    rows = np.arange(len(owner))
    points = start[owner] + fraction[:, None] * (end - start)[owner]
    points[rows, _FIRST[plane[owner]]] = cu[owner] + radius * np.cos(phi)
    points[rows, _SECOND[plane[owner]]] = cv[owner] + radius * np.sin(phi)
    last = np.cumsum(counts) - 1
    points[last] = end
    return points
