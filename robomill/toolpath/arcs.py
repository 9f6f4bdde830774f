"""Arcs of a program as arrays: true length, exact extremes, and the one place where they become chords.

An arc is the turn of a point about ``centre`` in one of the planes G17 (x, y), G18 (z, x) or G19 (y, z), seen
from the positive end of the third axis, along which it may climb (helix). Lengths in m, angles in rad.
"""

import math
from dataclasses import dataclass

import numpy as np

from robomill.arrays import BoolArray, FloatArray, IntArray
from robomill.errors import GCodeError
from robomill.lazy import cached_property
from robomill.toolpath.plane import axes
from robomill.units import from_si

CHORD_ERROR = 1e-6
"""m: no chord lies farther than this from its arc, unless the caller asks for another figure."""

MAX_POINTS = 5_000_000
_LEAST = 12.0
"""Chords of a whole turn: none turns by more than 30 degrees."""
_SAME_END = 1e-3
"""So near to the end of a chord, as a share of it, an arc begins or ends there: written centres are rounded."""


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

    @cached_property
    def _widening(self) -> FloatArray:
        """(m,) m/rad, 0 or more: by how much the radius changes as a spiral turns; it does so evenly."""
        _, r0, r1 = self._polar
        return np.abs(r1 - r0) / np.abs(self.sweep)

    @property
    def bend(self) -> FloatArray:
        """(m,) m: eight times the sagitta of a short chord over the square of its angle; a circle's radius.

        For a spiral (r^2 + 2 r'^2) / sqrt(r^2 + r'^2), with r' its ``_widening``.
        """
        rho = self._widening
        pace = np.hypot(np.maximum(*self._polar[1:]), rho)
        return pace + rho * (rho / pace)

    @property
    def length(self) -> FloatArray:
        """(m,) m: along the spiral and the climb (Simpson's rule; exact for helices)."""
        _, r0, r1 = self._polar
        climb = (self.end - self.start)[np.arange(len(self)), axes(self.plane)[2]]
        aside = np.hypot(self._widening, climb / self.sweep)
        pace = np.hypot(r0, aside) + 4.0 * np.hypot(0.5 * (r0 + r1), aside) + np.hypot(r1, aside)
        return np.abs(self.sweep) * pace / 6.0

    def may_leave(self, lower: FloatArray, upper: FloatArray) -> BoolArray:
        """(m,) True unless an arc's whole circle lies within ``lower`` and ``upper`` (3,), which hold its ends."""
        rows, reach = np.arange(len(self)), np.maximum(*self._polar[1:])
        leaves = np.zeros(len(self), dtype=bool)
        for axis in axes(self.plane)[:2]:
            middle = self.centre[rows, axis]
            leaves |= (middle - reach < lower[axis]) | (middle + reach > upper[axis])
        return leaves

    @cached_property
    def extents(self) -> tuple[FloatArray, FloatArray]:
        """Lowest and highest corner (m, 3) of each arc, its extreme points included.

        The farthest point in a direction lies in the turn next to the wider end, psi before that end, where the
        radius r(psi) makes psi = a - atan(widening / r(psi)): Newton's method on a function that rises by 1 to 2.
        """
        lower, upper = np.minimum(self.start, self.end), np.maximum(self.start, self.end)
        angle, r0, r1 = self._polar
        wider, whole, rho = np.maximum(r0, r1), np.abs(self.sweep), self._widening
        towards = np.sign(self.sweep) * np.where(r1 >= r0, 1.0, -1.0)
        last = angle + np.where(r1 >= r0, self.sweep, 0.0)
        rows = np.arange(len(self))
        for quarter in range(4):
            axis = axes(self.plane)[quarter % 2]
            before = np.mod(towards * (last - quarter * math.pi / 2.0), 2.0 * math.pi)
            for a in (before, before + 2.0 * math.pi):  # the first may lie beyond the end
                psi = _peak(a, wider, rho, whole)
                phi, radius = last - towards * psi, wider - rho * psi
                side = self.centre[rows, axis] + radius * (np.sin(phi) if quarter % 2 else np.cos(phi))
                lower[rows, axis] = np.minimum(lower[rows, axis], side)
                upper[rows, axis] = np.maximum(upper[rows, axis], side)
        return lower, upper

    def whole(self, chord_error: float) -> FloatArray:
        """(m,) chords of a whole turn that keep within ``chord_error`` (m), a multiple of four (see `turn_counts`)."""
        return turn_counts(self.sweep, self.bend, chord_error)

    def counts(self, whole: FloatArray) -> IntArray:
        """(m,) chords of each arc, of which ``whole`` (m,) make a turn."""
        return chord_counts(self._polar[0], self.sweep, whole)

    def ends(self, whole: FloatArray) -> tuple[IntArray, FloatArray]:
        """For each chord its arc, and which part of the arc's sweep has been made where it ends, (sum of `counts`,)."""
        return chord_ends(self._polar[0], self.sweep, whole)

    def chords(self, whole: FloatArray) -> FloatArray:
        """End points (sum of `counts`, 3) m of the chords of each arc; the last one is its end, exactly."""
        owner, fraction = self.ends(whole)
        points = self.at(owner, fraction)
        points[fraction == 1.0] = self.end
        return points

    def at(self, owner: IntArray, fraction: FloatArray) -> FloatArray:
        """Points (n, 3) m of the arcs ``owner`` (n,) at ``fraction`` (n,) of their sweep and climb."""
        angle, r0, r1 = self._polar
        phi = angle[owner] + fraction * self.sweep[owner]
        radius = r0[owner] + fraction * (r1 - r0)[owner]
        points = self.start[owner] + fraction[:, None] * (self.end - self.start)[owner]
        first, second, _ = axes(self.plane[owner])
        rows = np.arange(len(owner))
        points[rows, first] = self.centre[owner, first] + radius * np.cos(phi)
        points[rows, second] = self.centre[owner, second] + radius * np.sin(phi)
        return points


def _peak(a: FloatArray, wider: FloatArray, rho: FloatArray, whole: FloatArray) -> FloatArray:
    """(m,) rad from 0 to ``whole``: where psi + atan(rho / (wider - rho psi)) = a, or the nearer end."""
    psi = np.clip(a, 0.0, whole)
    for _ in range(20):
        radius = np.maximum(wider - rho * psi, 1e-300)
        off = psi + np.arctan2(rho, radius) - a
        better = np.clip(psi - off / (1.0 + (rho / np.hypot(radius, rho)) ** 2), 0.0, whole)
        moved, psi = np.abs(better - psi), better
        if moved.max(initial=0.0) < 1e-13:
            break
    return psi


def steps(counts: IntArray) -> tuple[IntArray, IntArray]:
    """For each of the ``counts`` (m,) pieces of moves: its move, and its number in the move, from 1."""
    owner = np.repeat(np.arange(len(counts)), counts)
    return owner, np.arange(len(owner)) - (np.cumsum(counts) - counts)[owner] + 1


def turn_counts(sweep: FloatArray, radius: FloatArray, chord_error: float) -> FloatArray:
    """Chords (m,) of a whole turn that keep within ``chord_error`` (m) of arcs of a ``radius`` or ``bend`` (m,) m.

    It is a multiple of four, so that a circle's farthest points in its plane end chords. Raises GCodeError if the chord
    error is not positive or would need more than ``MAX_POINTS`` points for the ``sweep`` (m,) rad of the arcs.
    """
    if not (math.isfinite(chord_error) and chord_error > 0):
        raise GCodeError(f"Chord error: found {chord_error} m; expected a length above 0.")
    whole, turns = _whole(radius, chord_error), np.abs(sweep) / (2.0 * math.pi)
    total = float(turns @ whole)
    if total > MAX_POINTS:
        fits = chord_error * (total / MAX_POINTS) ** 2
        while turns @ _whole(radius, fits) > MAX_POINTS >= turns.sum() * _LEAST:
            fits *= 1.02
        raise GCodeError(
            f"Arcs: a chord error of {from_si(chord_error, 'mm'):.3g} mm would need {total:.3g} points; "
            f"at most {MAX_POINTS} fit, so use {from_si(fits, 'mm'):.2g} mm or more, or fewer turns."
        )
    return whole


def _whole(radius: FloatArray, chord_error: float) -> FloatArray:
    """(m,) chords of whole turns: the sagitta is r (1 - cos(step / 2))."""
    ratio = np.minimum(chord_error / np.maximum(radius, 1e-300), 2.0)
    step = 4.0 * np.arcsin(np.sqrt(ratio / 2.0)) / (1.0 + 2.0 * _SAME_END)
    return np.maximum(4.0 * np.ceil(0.5 * math.pi / step - 1e-9), _LEAST)


def chord_counts(angle: FloatArray, sweep: FloatArray, whole: FloatArray) -> IntArray:
    """Chords (m,) of arcs from ``angle`` (m,) through ``sweep`` (m,) rad, of which ``whole`` (m,) make a turn.

    They end at whole multiples of their step from angle 0, wherever the arc begins, and at its own end: two laps of
    one circle share their corners, so that the second finds nothing which chords of the first have left standing.
    """
    return _numbered(angle, sweep, whole)[1]


def chord_ends(angle: FloatArray, sweep: FloatArray, whole: FloatArray) -> tuple[IntArray, FloatArray]:
    """For each chord its arc, and which part of the arc's sweep has been made where it ends: 1 at the last alone."""
    before, counts, begin = _numbered(angle, sweep, whole)
    owner, number = steps(counts)
    fraction = (before[owner] + number - begin[owner]) * (2.0 * math.pi / whole / np.abs(sweep))[owner]
    fraction[np.cumsum(counts) - 1] = 1.0
    return owner, fraction


def _numbered(angle: FloatArray, sweep: FloatArray, whole: FloatArray) -> tuple[FloatArray, IntArray, FloatArray]:
    """Steps counted along the turn from angle 0, each (m,): the last at or before the arc's begin, how many lead from
    there to its end or beyond, at least 1, and its begin. What lies within ``_SAME_END`` of a step stands on it."""
    step = 2.0 * math.pi / whole
    begin = np.sign(sweep) * angle / step
    end = begin + np.abs(sweep) / step
    before = np.floor(begin + _SAME_END)
    return before, np.maximum(np.ceil(end - _SAME_END) - before, 1.0).astype(np.int64), begin
