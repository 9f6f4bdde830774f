"""What the rules read and write, as records: the state of a machine, a move, and the text of a program."""

from typing import Annotated, Any, NamedTuple

import numpy as np

from robomill.compiled import Axes, InInt1
from robomill.toolpath.gcode.codes import LETTERS

STATE = np.dtype(
    [
        ("p", "f8", 6),
        ("sent", "f8", 6),
        ("g5x", "f8", 6),
        ("g92", "f8", 6),
        ("at", "f8", 3),
        ("turned", "f8", 3),
        ("cycle", "f8", len(LETTERS)),
        ("figures", "f8", 3),
        ("rotation", "f8"),
        ("factor", "f8"),
        ("feed", "f8"),
        ("speed", "f8"),
        ("waited", "f8"),
        ("dwell_time", "f8"),
        ("initial_level", "f8"),
        ("unit_code", "i8"),
        ("units_said", "i8"),
        ("system", "i8"),
        ("dwells", "i8"),
        ("motion", "i8"),
        ("plane", "i8"),
        ("feed_mode", "i8"),
        ("spindle", "i8"),
        ("spindle_mode", "i8"),
        ("in_spindle", "i8"),
        ("moves", "i8"),
        ("absolute", "?"),
        ("retract_r", "?"),
        ("mist", "?"),
        ("flood", "?"),
        ("arc_absolute", "?"),
        ("arc_not_allowed", "?"),
    ]
)
"""What of the machine the rules of motion read and change; attributes of ``Machine``, where they are explained."""

MOVE = np.dtype(
    [
        ("line", "i4"),
        ("kind", "i1"),
        ("start", "f8", 3),
        ("end", "f8", 3),
        ("rotary0", "f8", 3),
        ("rotary", "f8", 3),
        ("plane", "i1"),
        ("centre", "f8", 3),
        ("turns", "i4"),
        ("clockwise", "?"),
        ("sweep", "f8"),
        ("v_f", "f8"),
        ("n_s", "f8"),
        ("ccw", "?"),
        ("dwell", "f8"),
        ("tool", "i4"),
    ]
)
"""A move; the columns are explained in ``Program``."""


class Text(NamedTuple):
    """The lines of a program, for the rules."""

    codes: Annotated[Any, Axes("uint8", 1)]
    """Its characters,"""
    starts: InInt1
    """and where each line starts; the last number is where one more would."""
