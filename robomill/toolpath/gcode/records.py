"""What the rules read and write, as records: the state of a machine, a move, and the text of a program."""

from typing import Annotated, Any, NamedTuple

import numpy as np

from robomill.compiled import Axes, InInt1
from robomill.toolpath.gcode.codes import LETTERS

_NUMBERS = ("rotation", "factor", "feed", "speed", "waited", "dwell_time", "initial_level")
_CODES = (
    *("unit_code", "units_said", "system", "dwells", "motion", "plane"),
    *("feed_mode", "spindle", "spindle_mode", "in_spindle", "moves"),
)
_FLAGS = ("absolute", "retract_r", "mist", "flood", "arc_absolute", "arc_not_allowed")
STATE = np.dtype(
    [
        *((name, "f8", 6) for name in ("p", "sent", "g5x", "g92")),
        *((name, "f8", 3) for name in ("at", "turned")),
        ("cycle", "f8", len(LETTERS)),
        ("figures", "f8", 3),
        *((name, "f8") for name in _NUMBERS),
        *((name, "i8") for name in _CODES),
        *((name, "?") for name in _FLAGS),
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
        ("thread", "?"),
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
