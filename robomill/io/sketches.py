"""Sketches as the table ``[path.sketch]`` of a set-up file."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from robomill.errors import ToolpathError
from robomill.io.tables import Table
from robomill.toolpath.sketch import Element, Sketch


def sketch_from_table(table: Table) -> Sketch:
    """The sketch; raises ProjectError naming the key, or the shape that cannot be cut."""
    preset = Sketch()
    shared: dict[str, Any] = {
        "v_plunge": table.number("plunge_mm_min", "mm/min", preset.v_plunge),
        "clearance": table.number("clearance_mm", "mm", preset.clearance),
        "n_s": table.number("spindle_1_min", "1/min", preset.n_s),
        "v_f": table.number("feed_mm_min", "mm/min", preset.v_f),
        "depth": table.number("depth_mm", "mm", preset.depth),
        "grid": table.number("snap_mm", "mm", preset.grid),
    }
    elements = tuple(_element(entry) for entry in table.tables("elements"))
    table.finish()
    try:
        return Sketch(elements=elements, **shared)
    except ToolpathError as exc:
        raise table.refuse("elements", str(exc)) from None


def _element(entry: Table) -> Element:
    values: dict[str, Any] = {
        "shape": entry.text("shape"),
        "points": entry.rows("points_mm", 2, "mm"),
        "depth": entry.number("depth_mm", "mm"),
        "v_f": entry.number("feed_mm_min", "mm/min"),
    }
    entry.finish()
    try:
        return Element(**values)
    except ToolpathError as exc:
        raise entry.refuse("shape", str(exc)) from None


def sketch_to_table(sketch: Sketch, shown: Callable[[float, str], float]) -> dict[str, Any]:
    """What ``sketch_from_table`` reads back; ``shown(value, unit)`` writes an SI value so that it is read exactly."""
    return {
        "plunge_mm_min": shown(sketch.v_plunge, "mm/min"),
        "clearance_mm": shown(sketch.clearance, "mm"),
        "spindle_1_min": shown(sketch.n_s, "1/min"),
        "feed_mm_min": shown(sketch.v_f, "mm/min"),
        "depth_mm": shown(sketch.depth, "mm"),
        "snap_mm": shown(sketch.grid, "mm"),
        "elements": [
            {
                "shape": element.shape,
                "points_mm": [[shown(v, "mm") for v in point] for point in element.points.tolist()],
                "depth_mm": shown(element.depth, "mm"),
                "feed_mm_min": shown(element.v_f, "mm/min"),
            }
            for element in sketch.elements
        ],
    }
