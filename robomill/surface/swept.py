"""The feed moves of a path as one swept body that can be asked for the height it leaves along a line in plan."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from robomill.arrays import BoolArray, FloatArray, IntArray, as_floats
from robomill.cutting.tool import Cutter
from robomill.errors import SurfaceError
from robomill.surface.envelope import Move, Shape, cutter_shape, moves_of, swept_height
from robomill.surface.raster import skin_on_line
from robomill.surface.removal import joined
from robomill.surface.stock import Stock
from robomill.surface.tilt import tilt_of, tilted_interval, tilted_move
from robomill.surface.tilted import tool_axes
from robomill.units import format_si

Heights = Callable[[FloatArray], FloatArray]

UPRIGHT = 1e-9


@dataclass(frozen=True)
class SweptPath:
    """Feed moves of a cutter, ready to be asked for the height they leave on a line in plan."""

    stock: Stock
    shape: Shape
    ends: FloatArray
    axes: FloatArray

    def heights(self, centre: FloatArray, normal: FloatArray, reach: float) -> Heights:
        """Function w (q,) -> height left (q,) on the line centre + w normal, |w| <= reach, before any clipping."""
        stock_top = skin_on_line(self.stock, centre, normal)
        near, low, high = self._near(centre, normal, reach)
        upright = np.hypot(self.axes[near, 0], self.axes[near, 1]) <= UPRIGHT
        moves, low, high = np.hstack(moves_of(self.ends[near[upright]])), low[upright], high[upright]
        leaning = [tilt_of(self.axes[n]) for n in near[~upright]]
        tilted = [
            (tilt, tilted_move(tilt, self.ends[n, :3], self.ends[n, 3:]))
            for tilt, n in zip(leaning, near[~upright], strict=True)
        ]

        def height(w: FloatArray) -> FloatArray:
            x, y = centre[0] + w * normal[0], centre[1] + w * normal[1]
            z = stock_top(w)
            here = moves[(high >= w.min()) & (low <= w.max())]
            if len(here):
                cut, d = swept_height(self.shape, Move(*here.T[:, :, None]), x, y)
                z = np.minimum(z, np.where(d >= 0.0, cut, np.inf).min(axis=0))
            for tilt, move in tilted:
                below, above = tilted_interval(self.shape, tilt, move, x, y, z)
                z = np.where((below < above) & (above >= z), below, z)
            return z

        return height

    def _near(self, centre: FloatArray, normal: FloatArray, reach: float) -> tuple[IntArray, FloatArray, FloatArray]:
        """Moves whose track may meet the line, and the part of the line (low, high) each may meet."""
        tilt = np.hypot(self.axes[:, 0], self.axes[:, 1])
        rise = np.maximum(self.stock.upper[2] - np.minimum(self.ends[:, 2], self.ends[:, 5]), 0.0) + self.shape.R
        limit = self.shape.R + np.where(tilt > UPRIGHT, rise * tilt / np.maximum(self.axes[:, 2], 0.05), 0.0)
        feed = np.array([normal[1], -normal[0]])
        a, b = self.ends[:, :2] - centre[:2], self.ends[:, 3:5] - centre[:2]
        along_a, along_b, across_a, across_b = a @ feed, b @ feed, a @ normal[:2], b @ normal[:2]
        low, high = np.minimum(across_a, across_b) - limit, np.maximum(across_a, across_b) + limit
        near = np.flatnonzero(
            (np.minimum(along_a, along_b) <= limit)
            & (np.maximum(along_a, along_b) >= -limit)
            & (low <= reach)
            & (high >= -reach)
        )
        return near, low[near], high[near]


def swept_path(stock: Stock, cutter: Cutter, p: ArrayLike, k: ArrayLike | None, cutting: ArrayLike) -> SweptPath:
    """The feed moves of a path p (m, 3) m with tool axes k; moves with an end that is not finite are left out."""
    points = as_floats(p, "toolpath points", (None, 3), error=SurfaceError, finite=False)
    axes = tool_axes(k, len(points))
    n = np.flatnonzero(np.asarray(cutting, dtype=bool)[1:]) + 1
    ends = np.hstack([points[n - 1], points[n]])
    known = np.isfinite(ends).all(axis=1)
    ends, pairs = joined(ends[known], np.hstack([axes[n - 1], axes[n]])[known])
    middle = pairs[:, :3] + pairs[:, 3:]
    return SweptPath(stock, cutter_shape(cutter), ends, middle / np.linalg.norm(middle, axis=1, keepdims=True))


@dataclass(frozen=True)
class Station:
    """A place on the commanded feed path: entry i of the path, the fraction along its move, tip and feed-normal."""

    station: float
    entry: int
    fraction: float
    centre: FloatArray
    normal: FloatArray | None


def feed_length(p: ArrayLike, cutting: ArrayLike) -> float:
    """Length of the feed moves of a path p (m, 3) m, m: the last station."""
    points, used = np.asarray(p, dtype=float), np.asarray(cutting, dtype=bool)
    return float(np.linalg.norm(np.diff(points, axis=0), axis=1)[used[1:]].sum())


def station_at(p: FloatArray, cutting: BoolArray, station: float) -> Station:
    """Where path length ``station`` (m) lies on the feed moves. Raises SurfaceError beyond either end."""
    steps = np.where(cutting[1:], np.linalg.norm(np.diff(p, axis=0), axis=1), 0.0)
    s = np.concatenate([[0.0], np.cumsum(steps)])
    if not s[-1] > 0:
        raise SurfaceError("Section: the path has no feed move with a length, so it leaves no groove to measure.")
    if not -1e-12 <= station <= s[-1] + 1e-12:
        raise SurfaceError(
            f"Section at {format_si(station, 'mm', 2)}: the feed path runs from 0 to {format_si(s[-1], 'mm', 2)}."
        )
    entry = int(np.searchsorted(s, station, side="left"))
    entry = int(np.flatnonzero(steps > 0)[0]) + 1 if entry == 0 else entry
    fraction = float((station - s[entry - 1]) / steps[entry - 1])
    span = p[entry] - p[entry - 1]
    plan = np.hypot(span[0], span[1])
    normal = None if plan < 1e-9 * steps[entry - 1] else np.array([-span[1], span[0], 0.0]) / plan
    return Station(station, entry, fraction, p[entry - 1] + fraction * span, normal)


def stock_span(stock: Stock, centre: FloatArray, normal: FloatArray) -> tuple[float, float]:
    """Where the line centre + w normal lies over the stock: (low, high) m, low > high if nowhere."""
    low, high = -np.inf, np.inf
    for axis in range(2):
        a, b = stock.lower[axis] - centre[axis], stock.upper[axis] - centre[axis]
        if abs(normal[axis]) < 1e-12:
            if a > 0 or b < 0:
                return 1.0, -1.0
            continue
        a, b = sorted((a / normal[axis], b / normal[axis]))
        low, high = max(low, a), min(high, b)
    return float(low), float(high)
