"""G-code (RS274/NGC with LinuxCNC's semantics): from program text to canonical moves and toolpaths."""

from __future__ import annotations

from robomill.toolpath.gcode.arcs import CHORD_ERROR
from robomill.toolpath.gcode.interpreter import interpret, read_gcode
from robomill.toolpath.gcode.program import Program

__all__ = ["CHORD_ERROR", "Program", "interpret", "read_gcode"]
