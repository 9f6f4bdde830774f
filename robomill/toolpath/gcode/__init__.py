"""G-code (RS274/NGC with LinuxCNC's semantics): from program text to canonical moves and toolpaths."""

from robomill.toolpath.arcs import CHORD_ERROR
from robomill.toolpath.gcode.program import Program
from robomill.toolpath.gcode.reading import interpret, read_gcode
from robomill.toolpath.gcode.report import gcode_report, write_moves_jsonl
from robomill.toolpath.tools import Tool

__all__ = [
    "CHORD_ERROR",
    "Program",
    "Tool",
    "gcode_report",
    "interpret",
    "read_gcode",
    "write_moves_jsonl",
]
