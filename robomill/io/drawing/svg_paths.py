"""Paths of an SVG drawing, as svgelements reads them, as circles, lines and polylines within the chord error."""

import math
import re
from collections.abc import Iterator
from typing import Any
from xml.etree import ElementTree

import numpy as np

from robomill.arrays import FloatArray
from robomill.extras import needed
from robomill.io.drawing.reading import STUMBLES, Reading
from robomill.io.drawing.svg_viewports import NUMBER
from robomill.toolpath.arcs import CHORD_ERROR
from robomill.units import format_count

with needed("An SVG drawing"):
    from svgelements import Arc, Close, CubicBezier, Matrix, Move, Path, QuadraticBezier

TAKES = {"M": 2, "L": 2, "T": 2, "H": 1, "V": 1, "C": 6, "S": 4, "Q": 4, "A": 7, "Z": 0}
"""How many numbers each command of a path takes."""


def lines_of(path: Any, scale: float, to: Reading) -> Iterator[tuple[Any, FloatArray]]:
    """Shape and points (r, 2) m of every stretch of a path that is drawn without lifting."""
    run: list[Any] = []
    for segment in path:
        if isinstance(segment, Move) and run:
            yield _line(run, scale, to)
            run = []
        if not isinstance(segment, Move):
            run.append(segment)
            if isinstance(segment, Close):
                yield _line(run, scale, to)
                run = []
    if run:
        yield _line(run, scale, to)


def broken_in(root: ElementTree.Element) -> str:
    """What cannot be read of a page, in words; "" where every path and transform can be by itself."""
    for element in root.iter():
        for key, read in (("d", Path), ("transform", Matrix)):
            text = element.get(key, "")
            try:
                read(text)
            except (*STUMBLES, RecursionError):
                named = f" of {element.get('id'):.40}" if element.get("id") else ""
                what = f'the path{named}, d="{text:.40}"' if key == "d" else f'transform="{text:.40}"'
                return f"{what} cannot be read{_wrong_of(text) if key == 'd' else ''}"
    return ""


def _wrong_of(d: str) -> str:
    """The first command of a path that has other things than its numbers behind it."""
    for found in re.finditer(r"([MLTHVCSQAZmlthvcsqaz])([^MLTHVCSQAZmlthvcsqaz]*)", d):
        takes, numbers = TAKES[found[1].upper()], NUMBER.findall(found[2])
        rest = NUMBER.sub("", found[2]).replace(",", " ").strip()
        if rest or (takes and found[1] not in "Aa" and (not numbers or len(numbers) % takes)):
            return f": found {found[0].strip()[:40]!r}, where {found[1]} takes {format_count(takes, 'number')}"
    return ""


def _line(run: list[Any], scale: float, to: Reading) -> tuple[Any, FloatArray]:
    """One stretch: a circle where all of it is, else a line or a polyline."""
    arcs = [each for each in run if isinstance(each, Arc)]
    others = [each for each in run if each not in arcs and abs(each.end - each.start) * scale > CHORD_ERROR]
    begin = _at(run[0].start)
    if arcs and not others and _one_circle(arcs, scale):
        return "circle", np.array([_at(arcs[0].center), begin]) * scale
    found, count = [begin[None]], 1
    for each in run:
        found.append(_corners(each, scale, to, count))
        count += len(found[-1])
    points = np.vstack(found) * scale
    if not np.isfinite(points).all():
        raise ValueError("a point is no number")
    return ("line" if len(points) == 2 else "polyline"), points


def _at(point: Any) -> FloatArray:
    return np.array([float(point.x), float(point.y)])


def _one_circle(arcs: list[Any], scale: float) -> bool:
    first = arcs[0]
    turn = sum(float(arc.sweep) for arc in arcs)
    alike = all(
        abs(arc.rx - arc.ry) * scale < CHORD_ERROR
        and abs(arc.rx - first.rx) * scale < CHORD_ERROR
        and abs(arc.center - first.center) * scale < CHORD_ERROR
        for arc in arcs
    )
    return alike and math.isclose(abs(turn), 2.0 * math.pi, rel_tol=1e-9)


def _corners(segment: Any, scale: float, to: Reading, before: int) -> FloatArray:
    """(r, 2) px: the corners behind the start of a segment, within ``CHORD_ERROR`` of it; ``before`` come before."""
    if isinstance(segment, Arc):
        largest = max(float(segment.rx), float(segment.ry)) * scale
        step = 2.0 * math.acos(max(1.0 - CHORD_ERROR / max(largest, CHORD_ERROR), 0.5))
        count = max(2, math.ceil(abs(float(segment.sweep)) / step))
    elif isinstance(segment, QuadraticBezier | CubicBezier):
        count = _bezier_chords([_at(p) * scale for p in _controls(segment)])
    else:
        count = 1
    to.look(before + count)
    if count == 1:
        return _at(segment.end)[None]
    return np.vstack([np.asarray(segment.npoint(np.arange(1, count) / count)), _at(segment.end)])


def _controls(segment: Any) -> list[Any]:
    if isinstance(segment, QuadraticBezier):
        return [segment.start, segment.control, segment.end]
    return [segment.start, segment.control1, segment.control2, segment.end]


def _bezier_chords(controls: list[FloatArray]) -> int:
    """How many equal steps of the parameter keep the chords of a Bezier curve within ``CHORD_ERROR``: its second
    derivative is at most n (n - 1) times the largest second difference of its control points."""
    n = len(controls) - 1
    most = max(float(np.linalg.norm(a - 2.0 * b + c)) for a, b, c in zip(controls, controls[1:], controls[2:]))
    return max(1, math.ceil(math.sqrt(n * (n - 1) * most / (8.0 * CHORD_ERROR))))
