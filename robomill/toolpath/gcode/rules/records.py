"""What the rules read and write, as records: the state of a machine, a move, and the text of a program."""

from typing import Annotated, Any, NamedTuple

import numpy as np

from robomill.compiled import Axes, InInt1, Out1, OutInt1
from robomill.toolpath.gcode.codes import LETTERS

_NUMBERS = ("rotation", "factor", "feed", "speed", "waited", "dwell_time", "initial_level")
_CODES = (
    *("unit_code", "units_said", "system", "dwells", "motion", "straight", "plane"),
    *("feed_mode", "spindle", "spindle_mode", "in_spindle", "moves"),
)
_FLAGS = (
    *("absolute", "retract_r", "mist", "flood", "arc_absolute", "arc_not_allowed"),
    *("seeking", "broke", "continued", "is_fanuc", "keeps_heights", "kept_steps"),
)
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


OWORD = np.dtype(
    [
        *((name, "i8") for name in ("line", "keyword", "begin", "past", "start", "end", "next", "counter", "most")),
        *((name, "?") for name in ("has_break", "handed")),
    ]
)
"""An O word; the columns are explained in ``flow.OWord``."""


class Text(NamedTuple):
    """The lines of a program, for the rules."""

    codes: Annotated[Any, Axes("uint8", 1)]
    """Its characters,"""
    starts: InInt1
    """and where each line starts; the last number is where one more would."""


class Flow(NamedTuple):
    """The O words of a file and the calls that are open, for the rules: as ``Store`` in plain Python or in arrays."""

    words: Annotated[Any, Axes(OWORD, 1)]
    """The O words in order,"""
    arguments: Annotated[Any, Axes("uint8", 1)]
    """and the characters of their arguments."""
    counters: OutInt1
    """(LEVELS * repeats,) how many rounds each ``repeat`` has left at each level of calls."""
    left_over: OutInt1
    """(words,) how often each went astray for a flag that LinuxCNC had not forgotten."""
    special: OutInt1
    """(LEVELS,) not 0 for a call that only the interpreter can leave,"""
    back: OutInt1
    """(LEVELS,) where each goes back to,"""
    subs: OutInt1
    """(LEVELS,) the subroutine that it is of,"""
    aside: Out1
    """(LEVELS * ARGUMENTS,) and the #1 and so on of its caller."""
