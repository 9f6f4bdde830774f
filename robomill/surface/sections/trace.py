"""Following a section outwards from the tool's axis: what stands beside the floor, and how a wall there stands."""

from dataclasses import dataclass
from typing import Literal

import numpy as np

from robomill.arrays import BoolArray, FloatArray
from robomill.surface.swept import Heights

WALL_LEVELS = 9
LEVELS = (0.05, 0.98)  # of a wall's own height: where it is measured
SUBDIVISIONS, NARROWINGS = 16, 6  # from a fiftieth of the radius to less than a picometre for each millimetre of it
FINE, FINEST = 1 / 50, 1 / 20_000  # of the radius, and of the way to the side of the stock: the step of a search
AT_ONCE = 75  # points asked for at a time
AT_TOP = 1e-9  # of a wall's height, below what was not cut: where its upper edge is looked for
LEDGE, LAND = 0.1e-3, 0.25  # m, and of the radius: what is as high and as wide, below the stock's top, ends a wall
CUSP = 1e-7  # m: a crest between two passes is higher
OWN = 1.05  # of the radius: what stands as close to the axis the pass itself has left
STEPPED = 0.1  # of a wall's height: where its place jumps by more from one level to the next it is not one wall
SHORTEST = 0.1e-3  # m: the lean and the form of a wall that is lower say nothing

Ends = Literal["wall", "open", "lower", "crest", "slope"]
SHORT = "the wall is too low for its lean to be measured"
SEVERAL = "several passes here: the wall is not one"


@dataclass(frozen=True)
class Side:
    """Where a floor ends on one side: at a "wall", at the stock's side ("open"), where another pass has cut "lower", at
    a "crest" between two passes, on a "slope" that rises further than a cutter reaches.

    w    m  of the wall's edge: at its top where that is the stock's, half way up where it is a ledge below it
    top  m  height of what the wall carries; ``of_stock``: it is the stock's own top
    """

    ends: Ends
    w: float = float("nan")
    top: float = float("nan")
    of_stock: bool = False


@dataclass(frozen=True)
class WallForm:
    """A wall's lean from the floor's side of the horizontal (rad, 90 degrees is upright, more opens up), the range
    about its best straight line (m); NaN with the reason ``why`` where it has none."""

    angle: float = float("nan")
    straightness: float = float("nan")
    why: str = ""


@dataclass(frozen=True)
class Line:
    """The section line around one floor: the height left on it, the stock's ``skin``, the stock's sides ``low`` and
    ``high``, the cutter's ``radius``; all m."""

    height: Heights
    skin: Heights
    low: float
    high: float
    radius: float

    def end(self, side: float) -> float:
        """Where the stock ends on a side (+1: left, -1: right)."""
        return self.high if side > 0 else self.low


def side_of(line: Line, middle: float, side: float) -> Side:
    """What ends the floor at ``middle`` on a side (+1: left, -1: right)."""
    floor = float(line.height(np.array([middle]))[0])
    step, reach = _step(line, middle, side), abs(line.end(side) - middle)
    start, highest, lowest, far = 0.0, floor, floor, 0.0
    while start < reach:
        ahead = np.minimum(start + step * np.arange(1, AT_ONCE + 1), reach)
        w = middle + side * ahead
        z, skin = line.height(w), line.skin(w)
        for a, height, top in zip(ahead.tolist(), z.tolist(), skin.tolist(), strict=True):
            if top <= floor + CUSP:
                return Side("open")
            if height >= top - AT_TOP * (top - floor):
                return _wall(line, middle, side, (top, floor, True))
            if height < floor - LEDGE and a > OWN * line.radius:
                return Side("lower")
            if highest > lowest + CUSP and height < highest - CUSP:
                return Side("crest")
            if height < lowest or height > highest + CUSP:
                lowest, highest, far = min(lowest, height), height, a
            land = a - far
            if highest > floor + LEDGE and land >= LAND * line.radius:
                return _wall(line, middle, side, (highest, floor, False))
        start = float(ahead[-1])
    return Side("open")


def _wall(line: Line, middle: float, side: float, heights: tuple[float, float, bool]) -> Side:
    """The wall between a floor and what it carries, ``heights`` (top, floor, whether the top is the stock's), or the
    slope that it is where it goes on for more than a cutter's flank can."""
    top, floor, of_stock = heights
    levels = top - (top - floor) * np.array([AT_TOP if of_stock else 0.5, 0.1 if of_stock else 0.4, 0.9])
    edge, _, foot = first_above(line, middle, side, levels)
    own = abs(edge - middle) <= OWN * line.radius
    if not own and not abs(edge - foot) <= OWN * line.radius:
        return Side("slope")
    return Side("wall", float(edge), top, of_stock)


def first_above(line: Line, middle: float, side: float, levels: FloatArray, most: float = np.inf) -> FloatArray:
    """Position w of the first material above each level, from ``middle`` towards a side; NaN if there is none within
    ``most`` (m).

    Where the stock itself lies below a level, material is what was not cut. Found on a line of points, then on
    ever finer ones between two of them; material narrower than a fiftieth of the radius may be missed, and under a
    cutter much smaller than the stock, what is narrower than a twenty-thousandth of the way.
    """
    reach = min(abs(line.end(side) - middle), most)
    step, start = _step(line, middle, side), 0.0
    floor = float(line.height(np.array([middle]))[0])
    thin = AT_TOP * abs(float(levels.max()) - floor) + 1e-12

    def above(w: FloatArray, level: FloatArray) -> BoolArray:
        skin = line.skin(w)
        return np.asarray((line.height(w) >= np.minimum(level, skin - thin)) & (skin > floor + CUSP))

    found = np.full((len(levels), 2), np.nan)
    while start < reach and np.isnan(found[:, 0]).any():
        ahead = np.minimum(start + step * np.arange(AT_ONCE + 1), reach)
        w = middle + side * ahead[1:]
        z, skin = line.height(w), line.skin(w)
        for n in np.flatnonzero(np.isnan(found[:, 0])):
            hits = np.flatnonzero((z >= np.minimum(levels[n], skin - thin)) & (skin > floor + CUSP))
            if len(hits):
                found[n] = ahead[hits[0]], ahead[hits[0] + 1]
        start = float(ahead[-1])
    a, b = found[:, 0], found[:, 1]
    known = np.isfinite(a)
    result = np.full(len(levels), np.nan)
    if not known.any():
        return result
    a, b, level = a[known], b[known], levels[known]
    parts = np.arange(SUBDIVISIONS + 1) / SUBDIVISIONS
    for _ in range(NARROWINGS):
        c = a[:, None] + parts * (b - a)[:, None]
        inner = middle + side * c[:, 1:-1]
        solid = above(inner.ravel(), np.repeat(level, inner.shape[1])).reshape(inner.shape)
        first = np.where(solid.any(axis=1), solid.argmax(axis=1), SUBDIVISIONS - 1)
        a, b = c[np.arange(len(a)), first], c[np.arange(len(a)), first + 1]
    result[known] = middle + side * 0.5 * (a + b)
    return result


def wall_form(line: Line, middle: float, side: float, span: tuple[float, float]) -> WallForm:
    """Lean and form of the wall on a side between two heights, ``span`` (foot, top) m: its own, without nose and
    floor."""
    foot, top = span
    if not top - foot >= SHORTEST:
        return WallForm(why=SHORT)
    levels = foot + (top - foot) * np.linspace(*LEVELS, WALL_LEVELS)
    w = first_above(line, middle, side, levels)
    if np.isnan(w).any() or np.abs(np.diff(w)).max() > max(STEPPED, np.ptp(w) / (top - foot) / 2) * (top - foot):
        return WallForm(why=SEVERAL)
    slope, offset = np.polyfit(levels, w, 1)
    off_line = (w - (slope * levels + offset)) / np.sqrt(1 + slope * slope)
    return WallForm(float(np.pi / 2 + np.arctan(side * slope)), float(np.ptp(off_line)))


def _step(line: Line, middle: float, side: float) -> float:
    return max(FINE * line.radius, FINEST * abs(line.end(side) - middle))
