"""The groove as a section shows it: walls, width, depth, centre offset, floor, from the exact swept envelope.

A section is a vertical plane across the commanded feed. ``w`` (m) counts in it from the commanded tool tip
along the feed-normal z x feed, so positive is left of the feed. Nothing here is read off a grid.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from robomill.arrays import BoolArray, FloatArray, IntArray, as_floats, frozen
from robomill.cutting.tool import Cutter
from robomill.errors import SurfaceError
from robomill.surface.envelope import Shape, cutter_shape, moves_of, swept_height, tilt_of, tilted_interval, tilted_move
from robomill.surface.raster import stock_heights
from robomill.surface.stock import Stock
from robomill.units import format_si

Heights = Callable[[FloatArray], FloatArray]

UPRIGHT = 1e-9
WALL_LEVELS = 9
FLOOR_POINTS = 21


@dataclass(frozen=True)
class GrooveSection:
    """One section across the commanded feed; lengths in m, angles in rad, NaN where there is nothing to measure.

    station        path length of the commanded feed path
    block          source line of the move there
    centre, normal (3,) commanded tool tip and unit feed-normal in {W}
    width, depth   of the machined groove: between its walls at the top, and from the stock's top to its floor
    centre_offset  machined middle between the walls minus the ideal one, positive along the feed-normal (left)
    floor_error    machined floor minus ideal floor at the tool axis, positive: material left
    wall_left, wall_right            positions w of the machined walls at the top
    wall_left_ideal, wall_right_ideal
    wall_left_angle, wall_right_angle    from the floor's side of the horizontal: 90 degrees is upright, more opens up
    wall_left_straightness, wall_right_straightness   range about the best straight line
    floor, floor_ideal, floor_tilt   heights at the tool axis; slope of the machined floor across the groove
    open_left, open_right            True where the cut reaches the stock's side: no wall there
    w, z_ideal, z_machined           (q,) the section's profile
    note                             why something could not be measured, or ""
    """

    station: float
    block: int
    centre: FloatArray
    normal: FloatArray
    width: float
    depth: float
    centre_offset: float
    floor_error: float
    wall_left: float
    wall_right: float
    wall_left_ideal: float
    wall_right_ideal: float
    wall_left_angle: float
    wall_right_angle: float
    wall_left_straightness: float
    wall_right_straightness: float
    floor: float
    floor_ideal: float
    floor_tilt: float
    open_left: bool
    open_right: bool
    w: FloatArray
    z_ideal: FloatArray
    z_machined: FloatArray
    note: str = ""


@dataclass(frozen=True)
class SweptPath:
    """Feed moves of a cutter, ready to be asked for the height they leave on a line in plan."""

    stock: Stock
    shape: Shape
    ends: FloatArray
    axes: FloatArray

    def heights(self, centre: FloatArray, normal: FloatArray, reach: float) -> Heights:
        """Function w (q,) -> height left (q,) on the line centre + w normal, |w| <= reach, before any clipping."""
        near = self._near(centre, normal, reach)
        return lambda w: self._cut(w, centre, normal, near)

    def _near(self, centre: FloatArray, normal: FloatArray, reach: float) -> IntArray:
        margin = self.shape.R
        tilt = np.hypot(self.axes[:, 0], self.axes[:, 1])
        rise = np.maximum(self.stock.upper[2] - np.minimum(self.ends[:, 2], self.ends[:, 5]), 0.0) + self.shape.R
        lean = np.where(tilt > UPRIGHT, rise * tilt / np.maximum(self.axes[:, 2], 0.05), 0.0)
        feed = np.array([normal[1], -normal[0]])
        a, b = self.ends[:, :2] - centre[:2], self.ends[:, 3:5] - centre[:2]
        along_a, along_b, across_a, across_b = a @ feed, b @ feed, a @ normal[:2], b @ normal[:2]
        limit = margin + lean
        return np.flatnonzero(
            (np.minimum(along_a, along_b) <= limit) & (np.maximum(along_a, along_b) >= -limit)
            & (np.minimum(across_a, across_b) <= reach + limit) & (np.maximum(across_a, across_b) >= -reach - limit)
        )  # fmt: skip

    def _cut(self, w: FloatArray, centre: FloatArray, normal: FloatArray, near: IntArray) -> FloatArray:
        x, y = centre[0] + w * normal[0], centre[1] + w * normal[1]
        height = self._stock_top(x, y)
        upright = np.hypot(self.axes[near, 0], self.axes[near, 1]) <= UPRIGHT
        if upright.any():
            z, d = swept_height(self.shape, moves_of(self.ends[near[upright]]), x, y)
            height = np.minimum(height, np.where(d >= 0.0, z, np.inf).min(axis=0))
        for n in near[~upright]:
            tilt = tilt_of(self.axes[n])
            move = tilted_move(tilt, self.ends[n, :3], self.ends[n, 3:])
            low, high = tilted_interval(self.shape, tilt, move, x, y, height)
            height = np.where((low < high) & (high >= height), low, height)
        return height

    def _stock_top(self, x: FloatArray, y: FloatArray) -> FloatArray:
        if self.stock.triangles is None:
            return np.full(x.shape, float(self.stock.upper[2]))
        return np.array([float(stock_heights(self.stock, x[i : i + 1], y[i : i + 1])[0, 0]) for i in range(len(x))])


def swept_path(stock: Stock, cutter: Cutter, p: ArrayLike, k: ArrayLike | None, cutting: ArrayLike) -> SweptPath:
    """The feed moves of a path p (m, 3) m with tool axes k; moves with an end that is not finite are left out."""
    points = as_floats(p, "toolpath points", (None, 3), error=SurfaceError, finite=False)
    axes = np.broadcast_to(np.array([0.0, 0.0, 1.0]) if k is None else np.asarray(k, dtype=float), points.shape)
    n = np.flatnonzero(np.asarray(cutting, dtype=bool)[1:]) + 1
    ends = np.hstack([points[n - 1], points[n]])
    middle = axes[n - 1] + axes[n]
    known = np.isfinite(ends).all(axis=1)
    middle = middle[known] / np.linalg.norm(middle[known], axis=1, keepdims=True)
    return SweptPath(stock, cutter_shape(cutter), ends[known], middle)


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


def groove_section(
    stock: Stock,
    cutter: Cutter,
    p_ideal: ArrayLike,
    p_machined: ArrayLike,
    cutting: ArrayLike,
    block: ArrayLike | None,
    station: float,
    *,
    k: ArrayLike | None = None,
    samples: int = 401,
) -> GrooveSection:
    """Section of the groove at path length ``station`` (m) of the commanded path; see GrooveSection.

    p_ideal, p_machined (m, 3) m commanded and deflected tool tips, cutting (m,) bool, block (m,) source lines.
    The groove is the cut region around the tool, between the first material on either side; its walls come from
    all feed moves of the path, so a neighbouring pass that merges with it moves its wall.
    """
    return groove_sections(stock, cutter, p_ideal, p_machined, cutting, block, [station], k=k, samples=samples)[0]


def groove_sections(
    stock: Stock,
    cutter: Cutter,
    p_ideal: ArrayLike,
    p_machined: ArrayLike,
    cutting: ArrayLike,
    block: ArrayLike | None,
    stations: ArrayLike,
    *,
    k: ArrayLike | None = None,
    samples: int = 401,
) -> tuple[GrooveSection, ...]:
    """``groove_section`` at each of ``stations`` (q,) m."""
    ideal = as_floats(p_ideal, "commanded points", (None, 3), error=SurfaceError)
    moved = as_floats(p_machined, "deflected points", (len(ideal), 3), error=SurfaceError, finite=False)
    used = np.asarray(cutting, dtype=bool)
    lines = np.zeros(len(ideal), dtype=int) if block is None else np.asarray(block)
    paths = swept_path(stock, cutter, ideal, k, used), swept_path(stock, cutter, moved, k, used)
    found = []
    for station in np.atleast_1d(np.asarray(stations, dtype=float)):
        place = station_at(ideal, used, float(station))
        i, f = place.entry, place.fraction
        tip = moved[i - 1] + f * (moved[i] - moved[i - 1])
        found.append(_section(stock, cutter, paths, place, tip, int(lines[i]), samples))
    return tuple(found)


def _section(
    stock: Stock, cutter: Cutter, paths: tuple[SweptPath, SweptPath], place: Station, tip: FloatArray,
    block: int, samples: int,
) -> GrooveSection:  # fmt: skip
    if place.normal is None:
        return _empty(place, block, "the feed is along the tool axis here, so there is no section across it")
    if not np.isfinite(tip).all():
        return _empty(place, block, "the tool does not reach this point")
    shift = float((tip - place.centre) @ place.normal)
    low, high = stock_span(stock, place.centre, place.normal)
    window = 2.5 * cutter.radius + abs(shift)
    if not (low < 0.0 < high and low < shift < high):
        return _empty(place, block, "the tool is outside the stock here")
    w = np.linspace(max(low, -window), min(high, window), samples)
    traces = []
    for path, middle in zip(paths, (0.0, shift), strict=True):
        height = path.heights(place.centre, place.normal, float(high - low))
        traces.append(trace_groove(height, middle, low, high, cutter.radius, top_of(stock, place.centre, path)))
    ideal, machined = traces
    if machined is None or ideal is None:
        which = "deflected" if machined is None else "commanded"
        return _empty(place, block, f"the {which} tool cuts nothing here")
    return GrooveSection(
        station=place.station, block=block, centre=frozen(place.centre), normal=frozen(place.normal),
        width=machined.left - machined.right,
        depth=machined.top - machined.floor,
        centre_offset=0.5 * (machined.left + machined.right) - 0.5 * (ideal.left + ideal.right),
        floor_error=machined.floor - ideal.floor,
        wall_left=machined.left, wall_right=machined.right,
        wall_left_ideal=ideal.left, wall_right_ideal=ideal.right,
        wall_left_angle=machined.left_angle, wall_right_angle=machined.right_angle,
        wall_left_straightness=machined.left_straightness, wall_right_straightness=machined.right_straightness,
        floor=machined.floor, floor_ideal=ideal.floor, floor_tilt=machined.floor_tilt,
        open_left=bool(np.isnan(machined.left)), open_right=bool(np.isnan(machined.right)),
        w=frozen(w), z_ideal=frozen(ideal.height(w)), z_machined=frozen(machined.height(w)),
    )  # fmt: skip


def _empty(place: Station, block: int, note: str) -> GrooveSection:
    nan = float("nan")
    none = frozen(np.zeros(0))
    normal = np.full(3, nan) if place.normal is None else place.normal
    return GrooveSection(
        place.station, block, frozen(place.centre), frozen(normal),
        *([nan] * 15), False, False, none, none, none, note,
    )  # type: ignore[arg-type]  # fmt: skip


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


def top_of(stock: Stock, centre: FloatArray, path: SweptPath) -> float:
    """Height of the stock before the cut over the commanded tip, m."""
    return float(path._stock_top(centre[:1], centre[1:2])[0])


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


def trace_groove(height: Heights, middle: float, low: float, high: float, radius: float, top: float) -> Trace | None:
    """Follow the cut region from the tool axis at ``middle`` to the first material on either side.

    Walls are NaN where the region runs out of the stock (low, high). None if nothing is cut at the tool axis.
    """
    floor = float(height(np.array([middle]))[0])
    if not floor < top - 1e-12:
        return None
    levels = top - (top - floor) * np.concatenate([[1e-9], np.linspace(0.02, 0.6, WALL_LEVELS)])
    walls = {side: _wall(height, middle, end, levels, radius) for side, end in ((1, high), (-1, low))}
    left, left_angle, left_bow = _wall_form(walls[1], levels, 1)
    right, right_angle, right_bow = _wall_form(walls[-1], levels, -1)
    inner = [0.5 * ((limit if np.isnan(edge) else edge) - middle) for edge, limit in ((right, low), (left, high))]
    across = np.linspace(max(inner[0], -0.5 * radius), min(inner[1], 0.5 * radius), FLOOR_POINTS)
    slope = float(np.polyfit(across, height(middle + across) - floor, 1)[0])
    return Trace(left, right, left_angle, right_angle, left_bow, right_bow, floor, slope, top, height)


def _wall(height: Heights, middle: float, end: float, levels: FloatArray, radius: float) -> FloatArray:
    """Position w of the first material above each level, from ``middle`` towards ``end``; NaN if there is none.

    Found on a fine line of points, then by bisection; material narrower than a fiftieth of the radius may be missed.
    """
    side = 1.0 if end > middle else -1.0
    reach, step = abs(end - middle), radius / 50
    start, found = 0.0, np.full((len(levels), 2), np.nan)
    while start < reach and np.isnan(found[:, 0]).any():
        ahead = np.minimum(start + step * np.arange(151), reach)
        z = height(middle + side * ahead)
        for n in np.flatnonzero(np.isnan(found[:, 0])):
            hits = np.flatnonzero(z[1:] >= levels[n])
            if len(hits):
                found[n] = ahead[hits[0]], ahead[hits[0] + 1]
        start = float(ahead[-1])
    a, b = found[:, 0], found[:, 1]
    known = np.isfinite(a)
    if not known.any():
        return a
    a, b, level = a[known], b[known], levels[known]
    for _ in range(36):
        c = 0.5 * (a + b)
        solid = height(middle + side * c) >= level
        a, b = np.where(solid, a, c), np.where(solid, c, b)
    result = np.full(len(levels), np.nan)
    result[known] = middle + side * 0.5 * (a + b)
    return result


def _wall_form(wall: FloatArray, levels: FloatArray, side: int) -> tuple[float, float, float]:
    """Position at the top, angle and straightness of a wall from its positions at the levels."""
    known = np.isfinite(wall[1:])
    if np.isnan(wall[0]) or known.sum() < 3:
        return float(wall[0]), float("nan"), float("nan")
    z, w = levels[1:][known], wall[1:][known]
    slope, offset = np.polyfit(z, w, 1)
    off_line = (w - (slope * z + offset)) / np.sqrt(1 + slope * slope)
    return float(wall[0]), float(np.pi / 2 + np.arctan(side * slope)), float(np.ptp(off_line))
