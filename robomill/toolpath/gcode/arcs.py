"""Arcs of a program as arrays: true length, exact extremes, and the one place where they become chords.

An arc is the turn of a point about ``centre`` in one of the planes G17 (x, y), G18 (z, x) or G19 (y, z), seen
from the positive end of the third axis, along which it may climb (helix). Lengths in m, angles in rad.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from robomill.arrays import FloatArray, IntArray
from robomill.errors import GCodeError
from robomill.toolpath.gcode.motion_rules import axes

CHORD_ERROR = 1e-6
"""m: no chord lies farther than this from its arc, unless the caller asks for another figure."""

MAX_POINTS = 20_000_000
MAX_STEP = math.radians(30.0)


@dataclass(frozen=True, eq=False)
class Arcs:
    """Arcs from ``start`` to ``end`` about ``centre`` (m, 3) m in their ``plane`` (m,), ``sweep`` (m,) rad, signed."""

    start: FloatArray
    end: FloatArray
    centre: FloatArray
    plane: IntArray
    sweep: FloatArray

    def __len__(self) -> int:
        return len(self.sweep)

    @cached_property
    def _polar(self) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Angle at the start, and the radii at both ends, each (m,)."""
        first, second, _ = axes(self.plane)
        rows = np.arange(len(self))
        u0, v0 = (self.start - self.centre)[rows, first], (self.start - self.centre)[rows, second]
        u1, v1 = (self.end - self.centre)[rows, first], (self.end - self.centre)[rows, second]
        return np.arctan2(v0, u0), np.hypot(u0, v0), np.hypot(u1, v1)

    @property
    def radius(self) -> FloatArray:
        """(m,) m: the larger of the radii at both ends; they differ in spirals."""
        return np.maximum(*self._polar[1:])

    @property
    def length(self) -> FloatArray:
        """(m,) m: mean radius times sweep, and the climb."""
        _, r0, r1 = self._polar
        climb = (self.end - self.start)[np.arange(len(self)), axes(self.plane)[2]]
        return np.hypot(0.5 * (r0 + r1) * self.sweep, climb)

    @property
    def extents(self) -> tuple[FloatArray, FloatArray]:
        """Lowest and highest corner (m, 3) of each arc, its extreme points included."""
        lower, upper = np.minimum(self.start, self.end), np.maximum(self.start, self.end)
        angle, radius = self._polar[0], self.radius
        least = np.minimum(angle, angle + self.sweep)
        rows = np.arange(len(self))
        for quarter in range(4):
            reached = np.mod(quarter * math.pi / 2.0 - least, 2.0 * math.pi) <= np.abs(self.sweep)
            axis = axes(self.plane)[quarter % 2]
            side = self.centre[rows, axis] + (radius if quarter < 2 else -radius)
            side = np.where(reached, side, self.start[rows, axis])
            lower[rows, axis] = np.minimum(lower[rows, axis], side)
            upper[rows, axis] = np.maximum(upper[rows, axis], side)
        return lower, upper

    def chords(self, counts: IntArray) -> FloatArray:
        """End points (sum of counts, 3) of ``counts`` (m,) chords of each arc; the last one is its end, exactly."""
        angle, r0, r1 = self._polar
        owner, step = steps(counts)
        fraction = step / counts[owner]
        phi = angle[owner] + fraction * self.sweep[owner]
        radius = r0[owner] + fraction * (r1 - r0)[owner]
        points = self.start[owner] + fraction[:, None] * (self.end - self.start)[owner]
        first, second, _ = axes(self.plane[owner])
        rows = np.arange(len(owner))
        points[rows, first] = self.centre[owner, first] + radius * np.cos(phi)
        points[rows, second] = self.centre[owner, second] + radius * np.sin(phi)
        points[np.cumsum(counts) - 1] = self.end
        return points


def steps(counts: IntArray) -> tuple[IntArray, IntArray]:
    """For each of the ``counts`` (m,) pieces of moves: its move, and its number in the move, from 1."""
    owner = np.repeat(np.arange(len(counts)), counts)
    return owner, np.arange(len(owner)) - (np.cumsum(counts) - counts)[owner] + 1


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
