"""A path drawn by hand: shapes in the top face of the part, each with its feed and depth, and the path they make.

The part zero {W} lies on the top face, z up; shapes are drawn in x, y. The tool waits at ``clearance`` above the face,
goes down to ``APPROACH`` above it as a rapid, plunges at the plunge feed, cuts the shape and goes up again as a rapid.
A shape that begins where the one before it ended is cut without lifting.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Literal, get_args

import numpy as np

from robomill.arrays import FloatArray, Rows, frozen, of_kind
from robomill.errors import ToolpathError
from robomill.quantities import again, choice, quantities, quantity, settle
from robomill.spelled import Replaceable, in_units
from robomill.toolpath import arcs
from robomill.toolpath.path import MOST_FEED, SLOWEST, SPINDLE, Toolpath
from robomill.toolpath.plane import doubled_area, swept, through
from robomill.units import format_count, format_short, format_si, from_si, to_si
from robomill.values import Said, Value

Shape = Literal["line", "polyline", "polygon", "rectangle", "arc", "circle"]
SHAPES: tuple[Shape, ...] = get_args(Shape)

# Fewest and most points of each shape; 0 means any number.
POINTS: dict[str, tuple[int, int]] = {
    "line": (2, 2),
    "polyline": (2, 0),
    "polygon": (3, 0),
    "rectangle": (2, 2),
    "arc": (3, 3),
    "circle": (2, 2),
}

APPROACH = 0.5e-3
SAME = 1e-9
MAX_ELEMENTS = 5_000
MAX_POINTS = 100_000
MAX_COORDINATE = 100.0
FARTHEST, DEEPEST, FASTEST = 20.0, 1.0, 1.0  # m, m, m/s: hardly more was meant in SI
SHALLOWEST = 5e-6  # m: nothing as shallow is milled


@in_units(ToolpathError, "Sketch")
@dataclass(frozen=True, eq=False, repr=False)
class Element(Replaceable, Said, Value):
    """One shape: ``points`` (r, 2) m in {W}, cut ``depth`` m below the top face at ``v_f`` m/s.

    line        start, end                      rectangle   two opposite corners
    polyline    two or more points              arc         start, a point on the way, end
    polygon     three or more, closed           circle      centre, a point on it (where the cut begins)

    Examples
    --------
    >>> import robomill as rm
    >>> line = rm.Element("line", [[0.0, 0.0], [0.05, 0.0]], depth=2e-3, v_f=0.03)
    >>> line.points.shape
    (2, 2)
    """

    shape: Shape = choice("Shape", {shape: shape for shape in SHAPES})
    points: FloatArray = quantity("Points", "mm", shape=(None, 2), slip=FARTHEST, tiny=0.1e-3)
    depth: float = quantity("Depth", "mm", above=0.0, slip=DEEPEST, tiny=SHALLOWEST)
    v_f: float = quantity("Feed", "mm/min", above=0.0, most=MOST_FEED, key="feed_mm_min", slip=FASTEST, tiny=SLOWEST)

    if TYPE_CHECKING:

        def __init__(
            self,
            shape: Shape,
            points: Rows = ...,
            depth: float = ...,
            v_f: float = ...,
            *,
            points_mm: Rows = ...,
            depth_mm: float = ...,
            feed_mm_min: float = ...,
        ) -> None: ...

    def _said(self) -> str:
        count, depth = format_count(len(self.points), "point"), format_short(self.depth, "mm")
        return f"{self.shape} of {count}, {depth} deep, {format_short(self.v_f, 'mm/min')}"

    def __post_init__(self) -> None:
        settle(self, ToolpathError, "Sketch")
        points = tidy(self.points, "mm")
        fewest, most = POINTS[self.shape]
        if len(points) < fewest or (most and len(points) > most):
            wanted = f"{fewest}" if most == fewest else f"{fewest} or more"
            raise ToolpathError(f"Sketch: a {self.shape} needs {wanted} points, found {len(points)}.")
        if np.abs(points).max() > MAX_COORDINATE:
            raise ToolpathError(
                f"Sketch: a point of the {self.shape} is {format_si(float(np.abs(points).max()), 'm', 0)} from the "
                f"part zero; at most {format_si(MAX_COORDINATE, 'm', 0)} is drawn."
            )
        _tidy_numbers(self)
        object.__setattr__(self, "points", frozen(points))
        _check_extent(self.shape, points)

    def outline(self) -> FloatArray:
        """(q, 2) m: the corners of the cut in order, arcs as chords within the chord error of the G-code reader."""
        return outline(self.shape, self.points)


@in_units(ToolpathError, "Sketch")
@dataclass(frozen=True, eq=False, repr=False)
class Sketch(Replaceable, Said, Value):
    """Shapes in the order in which they are cut, and what they share; SI units, {W}.

    v_plunge    m/s  feed of plunges            n_s    1/s  spindle speed
    clearance   m    height of rapids above the top face
    v_f, depth  what the next shape gets; grid (m) what points snap to, 0 for none: the path does not depend on them

    Examples
    --------
    >>> import robomill as rm
    >>> ring = rm.Element("circle", [[0.0, 0.0], [0.02, 0.0]], depth=2e-3, v_f=0.03)
    >>> path = rm.Sketch((ring,)).toolpath()
    >>> float(path.s[-1].round(3))
    0.128
    """

    elements: tuple[Element, ...] = ()
    v_plunge: float = quantity(
        "Plunge feed",
        "mm/min",
        default=5e-3,
        above=0.0,
        most=MOST_FEED,
        key="plunge_mm_min",
        slip=FASTEST,
        tiny=SLOWEST,
    )
    clearance: float = quantity("Clearance", "mm", default=5e-3, least=APPROACH, digits=2, slip=DEEPEST)
    n_s: float = again(SPINDLE, label="Spindle", default=0.0)
    v_f: float = quantity("Feed", "mm/min", default=30e-3, above=0.0, key="feed_mm_min", compare=False, slip=FASTEST)
    depth: float = quantity("Depth", "mm", default=2e-3, above=0.0, digits=2, compare=False, slip=DEEPEST)
    grid: float = quantity("Snap", "mm", default=5e-3, least=0.0, key="snap_mm", compare=False)

    if TYPE_CHECKING:

        def __init__(
            self,
            elements: tuple[Element, ...] = ...,
            v_plunge: float = ...,
            clearance: float = ...,
            n_s: float = ...,
            v_f: float = ...,
            depth: float = ...,
            grid: float = ...,
            *,
            plunge_mm_min: float = ...,
            clearance_mm: float = ...,
            spindle_1_min: float = ...,
            feed_mm_min: float = ...,
            depth_mm: float = ...,
            snap_mm: float = ...,
        ) -> None: ...

    def _said(self) -> str:
        return format_count(len(self.elements), "shape")

    def __post_init__(self) -> None:
        given = (self.elements,) if isinstance(self.elements, Element) else self.elements
        for each in given if isinstance(given, Sequence) else (given,):
            of_kind(each, Element, "Sketch, elements", 'rm.Element("line", points_mm=..., ...)', ToolpathError)
        object.__setattr__(self, "elements", tuple(given))
        count = sum(len(e.points) for e in self.elements)
        if len(self.elements) > MAX_ELEMENTS or count > MAX_POINTS:
            raise ToolpathError(
                f"Sketch: {len(self.elements)} shapes with {count} points; at most {MAX_ELEMENTS} shapes and "
                f"{MAX_POINTS} points are kept. Write a program for more."
            )
        settle(self, ToolpathError, "Sketch")
        _tidy_numbers(self)

    def toolpath(self) -> Toolpath:
        """The path in {W}; ``block`` is the 1-based number of the shape.

        Raises ToolpathError where nothing is drawn.
        """
        if not self.elements:
            raise ToolpathError("The sketch is empty: draw a line, or take one of the ready-made sketches.")
        rows = list(self._moves())
        columns = [np.array(column) for column in zip(*rows, strict=True)]
        return Toolpath(
            p=columns[0],
            k=np.array([0.0, 0.0, 1.0]),
            v_f=columns[1],
            cutting=columns[1] > 0,
            block=columns[2],
            n_s=np.full(len(rows), self.n_s),
            tool=np.zeros(len(rows), dtype=np.int64),
            block_name="shape",
        )

    def _moves(self) -> Iterator[tuple[list[float], float, int]]:
        """Point, feed (0 for a rapid) and number of the shape, move by move."""
        at: list[float] | None = None
        for number, element in enumerate(self.elements, start=1):
            outline = element.outline()
            x, y = (float(v) for v in outline[0])
            z = -element.depth
            if at is None or math.hypot(at[0] - x, at[1] - y) > SAME:
                if at is not None:
                    yield [at[0], at[1], self.clearance], 0.0, number - 1
                yield [x, y, self.clearance], 0.0, number
                yield [x, y, APPROACH], 0.0, number
                yield [x, y, z], self.v_plunge, number
            elif abs(at[2] - z) > SAME:
                yield [x, y, z], self.v_plunge, number
            for u, v in outline[1:].tolist():
                yield [u, v, z], element.v_f, number
            at = [*outline[-1].tolist(), z]
        if at is not None:
            yield [at[0], at[1], self.clearance], 0.0, len(self.elements)


def outline(shape: Shape, points: FloatArray) -> FloatArray:
    """(q, 2) m: the corners of a shape of ``points`` (r, 2) m in order, arcs as chords within ``CHORD_ERROR``."""
    if shape == "polygon":
        return np.vstack([points, points[:1]])
    if shape == "rectangle":
        (x0, y0), (x1, y1) = points
        return np.array([[x0, y0], [x1, y0], [x1, y1], [x0, y1], [x0, y0]])
    if shape == "circle":
        centre, rim = points
        return _chords(rim, rim, centre, clockwise=False)
    if shape == "arc":
        start, way, end = points
        middle = centre_of(start, way, end)
        if middle is None:
            return np.array(points)
        return _chords(start, end, middle, clockwise=doubled_area(start, way, end) < 0)
    return np.array(points)


def tidy(value: Any, unit: str) -> Any:
    """An SI value cut to nine decimals in ``unit``, so that files and the screen read it back exactly."""
    return to_si(np.round(from_si(np.asarray(value, dtype=float), unit), 9), unit)


def _tidy_numbers(value: Element | Sketch) -> None:
    for name, declared in quantities(type(value)).items():
        if declared.kind == "number":
            object.__setattr__(value, name, float(tidy(getattr(value, name), declared.unit)))


def _check_extent(shape: str, points: FloatArray) -> None:
    steps = np.linalg.norm(np.diff(points, axis=0), axis=1)
    if (steps < SAME).any():
        i = int(np.argmax(steps < SAME)) + 1
        raise ToolpathError(f"Sketch: points {i} and {i + 1} of the {shape} are the same; move or remove one of them.")
    if shape in ("polygon", "arc") and np.linalg.norm(points[-1] - points[0]) < SAME:
        what = "draw a circle for a full turn" if shape == "arc" else "it closes by itself, so remove the last point"
        raise ToolpathError(f"Sketch: the {shape} ends where it begins; {what}.")
    if shape == "rectangle" and (np.abs(points[1] - points[0]) < SAME).any():
        raise ToolpathError("Sketch: the corners of the rectangle are on one line; draw a line, or move a corner.")


def centre_of(a: FloatArray, b: FloatArray, c: FloatArray) -> FloatArray | None:
    """Centre of the circle through three points; None where they are on a line."""
    sides = float(np.linalg.norm(b - a) * np.linalg.norm(c - a))
    if 2.0 * abs(doubled_area(a, b, c)) < 1e-9 * sides:
        return None
    return np.array(through(a, b, c))


def _chords(start: FloatArray, end: FloatArray, centre: FloatArray, *, clockwise: bool) -> FloatArray:
    def lifted(point: FloatArray) -> FloatArray:
        return np.array([[point[0], point[1], 0.0]])

    sweep = swept(start, end, centre, -1 if clockwise else 1)
    arc = arcs.Arcs(lifted(start), lifted(end), lifted(centre), np.array([17]), np.array([sweep]))
    return np.vstack([lifted(start), arc.chords(arc.whole(arcs.CHORD_ERROR))])[:, :2]
