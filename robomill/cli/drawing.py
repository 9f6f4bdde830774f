"""``robomill drawing``: what a DXF or SVG holds, layer by layer, and a program that cuts along its lines."""

from pathlib import Path
from typing import Any

from robomill.cli import given
from robomill.cli.saying import Written, say
from robomill.errors import ToolpathError
from robomill.provenance import Finding

STANDING = Finding(
    "warning", "the program starts no spindle, and its tool would plunge standing; give --spindle.", code="no-spindle"
)


def run_drawing(arguments: Any) -> int:
    """List the layers; with ``--cut`` make the path, with ``--out`` write it."""
    from robomill.io.writers import write_gcode
    from robomill.report.drawing_record import drawing_lines, drawing_record

    drawing = given.drawing(arguments.file, arguments.unit).moved(arguments.origin)
    if not arguments.cut:
        if arguments.out:
            raise ToolpathError("--out: say what is cut, with --cut LAYER:SIDE:DEPTH for each layer.")
        record = drawing_record(drawing)
        return say(arguments, record, drawing_lines(record), files=[])
    cuts = [_cut(text, arguments) for text in arguments.cut]
    path = drawing.sketch(cuts, diameter_mm=arguments.diameter, sketch=_base(arguments)).toolpath()
    files = Written.before([Path(arguments.out)] if arguments.out else [])
    if arguments.out:
        write_gcode(arguments.out, path, title=drawing.name)
    record = drawing_record(drawing, path)
    if not path.turns:
        record["findings"].append(STANDING.record())
    return say(arguments, record, drawing_lines(record), files=files)


def _base(arguments: Any) -> Any:
    """Plunge feed, clearance and spindle; what is not said is a sketch's own."""
    from robomill.toolpath.sketch import Sketch

    said = {
        "plunge_mm_min": arguments.plunge,
        "clearance_mm": arguments.clearance,
        "spindle_1_min": arguments.spindle,
    }
    return Sketch(**{name: value for name, value in said.items() if value is not None})


def _cut(text: str, arguments: Any) -> Any:
    """A cut of "LAYER:SIDE:DEPTH", the depth in mm."""
    from robomill.toolpath.drawing import SIDES, LayerCut

    layer, _, words = text.partition(":") if text.count(":") <= 2 else _parted(text)
    side, _, depth = words.partition(":")
    side = side or "on"
    if not layer or side not in SIDES:
        raise ToolpathError(f"--cut {text!r:.60}: expected LAYER:SIDE:DEPTH, with a side of {', '.join(SIDES)}.")
    try:
        deep = float(depth) if depth else arguments.depth
    except ValueError:
        deep = None
    if deep is None:
        raise ToolpathError(f"--cut {text!r:.60}: expected a depth in mm, as {layer}:{side}:3, or --depth for all.")
    if arguments.feed is None:
        raise ToolpathError("--feed: say how fast the tool goes along the lines, in mm/min.")
    return LayerCut(layer, depth_mm=deep, feed_mm_min=arguments.feed, side=side, step_down_mm=arguments.step_down)


def _parted(text: str) -> tuple[str, str, str]:
    """A layer whose name has colons in it; side and depth are the last two words."""
    layer, side, depth = text.rsplit(":", 2)
    return layer, ":", f"{side}:{depth}"
