"""A drawing, and the path along it, as a record and as lines."""

from typing import Any

from robomill.report.plain import finding_lines, gcode_lines
from robomill.report.records import path_record
from robomill.toolpath.drawing import Drawing
from robomill.toolpath.path import Toolpath
from robomill.units import format_count, format_value, from_si, rounded


def drawing_record(drawing: Drawing, path: Toolpath | None = None) -> dict[str, Any]:
    """Layers with their contours; of a ``path`` its lengths and extents, too."""
    layers = []
    for name in drawing.layers:
        contours = drawing.of_layer(name)
        length = sum(contour.length for contour in contours)
        layers.append(
            {
                "layer": name,
                "contours": len(contours),
                "closed": sum(contour.closed for contour in contours),
                "length_mm": rounded(from_si(length, "mm")),
                "hidden": name in drawing.hidden,
            }
        )
    corners = [[rounded(value) for value in from_si(corner, "mm")] for corner in drawing.extents]
    record = {
        "drawing": drawing.name,
        "unit": drawing.unit,
        "extents_mm": corners,
        "layers": layers,
        "findings": [finding.record() for finding in drawing.findings],
    }
    return record if path is None else record | {"path": path_record(path)}


def drawing_lines(record: dict[str, Any]) -> list[str]:
    """As ``robomill drawing`` prints it."""
    (x0, y0), (x1, y1) = record["extents_mm"]
    lines = [
        f"drawing   {record['drawing']}, drawn in {record['unit']}",
        f"X         {format_value(x0, 'mm')} to {format_value(x1, 'mm')}",
        f"Y         {format_value(y0, 'mm')} to {format_value(y1, 'mm')}",
    ]
    for layer in record["layers"]:
        off = ", switched off in the file" * layer["hidden"]
        lines.append(
            f"layer     {layer['layer']}: {format_count(layer['contours'], 'contour')}, {layer['closed']} closed, "
            f"{format_value(layer['length_mm'], 'mm')} long{off}"
        )
    lines += finding_lines(record["findings"])
    return lines + (["the path", *gcode_lines(record["path"])] if "path" in record else [])
