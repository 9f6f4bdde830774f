"""A sketch as the table and the pad show it, in display units, and back: pure functions."""

import re
from collections.abc import Mapping
from typing import Any

import numpy as np
import pandas as pd

from robomill.errors import ToolpathError
from robomill.toolpath.sketch import SHAPES, Element, Sketch
from robomill.typed_numbers import read_number, write_number
from robomill.ui.entry.grid import empty
from robomill.units import from_si, to_si, unit_label

COLUMNS = ("line", "shape", "points", "depth", "feed")
MAX_SHOWN_POINTS = 60
_LONG = re.compile(r"\d+ points$")


def sketch_frame(sketch: Sketch, unit: str) -> pd.DataFrame:
    """One row a shape, its numbers in SI, its points in ``unit``: "x, y; x, y", or "1253 points" where they are too
    many to type.
    """
    rows = [
        (number, e.shape, points_text(e, unit), e.depth, e.v_f) for number, e in enumerate(sketch.elements, start=1)
    ]
    return pd.DataFrame(rows, columns=list(COLUMNS))


def sketch_from_frame(frame: pd.DataFrame, sketch: Sketch, unit: str) -> Sketch:
    """``sketch`` with the table's shapes. Raises ToolpathError naming row and column of what cannot be read."""
    kept = frame.dropna(how="all", subset=["shape", "points"])
    found = []
    for row, (_, entry) in enumerate(kept.iterrows(), start=1):
        old = None if empty(entry["line"]) else sketch.elements[int(entry["line"]) - 1]
        shape = "line" if empty(entry["shape"]) else str(entry["shape"])
        if shape not in SHAPES:
            raise ToolpathError(f"Row {row}: {shape!r} is not a shape; choose one of {', '.join(SHAPES)}.")
        depth = sketch.depth if empty(entry["depth"]) else float(entry["depth"])
        v_f = sketch.v_f if empty(entry["feed"]) else float(entry["feed"])
        try:
            found.append(Element(shape, _points(entry["points"], old, unit), depth, v_f))  # type: ignore[arg-type]
        except ToolpathError as exc:
            raise ToolpathError(f"Row {row}: {exc}", where=f"row {row}") from None
    return sketch.replace(elements=tuple(found))


def points_text(element: Element, unit: str) -> str:
    """The points as people type them."""
    if len(element.points) > MAX_SHOWN_POINTS:
        return f"{len(element.points)} points"
    numbers = ((write_number(from_si(float(value), unit)) for value in point) for point in element.points)
    return "; ".join(", ".join(point) for point in numbers)


def pad_elements(sketch: Sketch, unit: str, feed_unit: str) -> list[dict[str, Any]]:
    """The shapes as the pad keeps them."""
    return [
        {
            "shape": e.shape,
            "points": in_unit(e.points, unit).tolist(),
            "depth": in_unit(e.depth, unit),
            "feed": in_unit(e.v_f, feed_unit),
        }
        for e in sketch.elements
    ]


def sketch_from_pad(sent: Mapping[str, Any], sketch: Sketch, unit: str, feed_unit: str) -> Sketch:
    """``sketch`` with the shapes and the snap that the pad sent. Raises ToolpathError naming the shape."""
    found = []
    for number, e in enumerate(sent["elements"], start=1):
        try:
            found.append(
                Element(
                    e["shape"],
                    to_si(np.array(e["points"], dtype=float), unit),
                    to_si(float(e["depth"]), unit),
                    to_si(float(e["feed"]), feed_unit),
                )
            )
        except ToolpathError as exc:
            raise ToolpathError(f"Shape {number}: {exc}", where=f"shape {number}") from None
    return sketch.replace(elements=tuple(found), grid=to_si(float(sent["grid"]), unit))


def _points(typed: Any, old: Element | None, unit: str) -> Any:
    text = "" if empty(typed) else str(typed).strip()
    if not text:
        raise ToolpathError(f"points are missing; type them as x, y; x, y in {unit_label(unit)}.")
    if _LONG.match(text) and old is not None:
        return old.points
    pairs = [part for part in re.split(r"[;\n]", text) if part.strip()]
    if old is not None and points_text(old, unit) == text:
        return old.points
    return to_si(np.array([_point(pair.strip().strip("()"), unit) for pair in pairs]), unit)


def _point(pair: str, unit: str) -> list[float]:
    """x and y of a point, parted by a comma, or by a blank where each then may have a decimal comma."""
    numbers = pair.split(",") if pair.count(",") == 1 else pair.split()
    try:
        x, y = (read_number(number, unit).value for number in numbers)
    except ValueError:
        raise ToolpathError(
            f"{pair!r:.40} is not a point; type x, y with a point as decimal mark, and a semicolon between points."
        ) from None
    return [x, y]


def in_unit(value: Any, unit: str) -> Any:
    """SI values as the table and the pad show them, without what the conversion leaves behind."""
    shown = np.round(from_si(np.asarray(value, dtype=float), unit), 6) + 0.0  # no minus before a zero
    return shown if shown.ndim else float(shown)
