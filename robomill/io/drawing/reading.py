"""What a drawing holds while it is read, and an end to what is too much, too far away, or takes too long."""

import math
import time
from collections import Counter
from dataclasses import dataclass, field

import numpy as np

from robomill.arrays import FARTHEST, FloatArray
from robomill.errors import ToolpathError
from robomill.progress import checkpoint
from robomill.toolpath.arcs import CHORD_ERROR, turn_counts
from robomill.toolpath.chaining import SHORTEST
from robomill.toolpath.contour import Contour
from robomill.toolpath.sketch import MAX_POINTS, Shape, centre_of
from robomill.units import format_count, to_si

LONGEST_S = 10.0
PER_INCH = {"px": 96, "pt": 72}  # pixels as browsers and Inkscape count them, points as Illustrator does
US_FOOT = 1200 / 3937  # m, by its definition
IN_METRES = {
    **{"angstrom": 1e-10, "nm": 1e-9, "dm": 0.1, "dam": 10.0, "hm": 100.0, "km": 1e3, "yd": 0.9144, "mi": 1609.344},
    **{"US in": US_FOOT / 12, "US ft": US_FOOT, "US yd": 3 * US_FOOT, "US mi": 5280 * US_FOOT},
}
"""Units that a DXF may say, and nobody else."""
# What the libraries that read drawings meet in a file that is damaged, or none of theirs.
STUMBLES = (OSError, EOFError, LookupError, ValueError, TypeError, AttributeError, ArithmeticError)


def metres(unit: str) -> float:
    """A unit of length of a drawing, a key of ``units.UNITS``, ``PER_INCH`` or ``IN_METRES``, in m."""
    if unit in IN_METRES:
        return IN_METRES[unit]
    return float(to_si(1.0 / PER_INCH[unit], "in") if unit in PER_INCH else to_si(1.0, unit))


@dataclass(frozen=True)
class Read:
    """What a file holds: its lines in m, layers that are switched off, and what was not taken, by its name.

    ``unseen`` is what the file itself makes invisible, and ``partly`` what it hides in part.
    """

    pieces: list[Contour] = field(default_factory=list)
    hidden: set[str] = field(default_factory=set)
    left_out: Counter[str] = field(default_factory=Counter)
    unseen: Counter[str] = field(default_factory=Counter)
    partly: Counter[str] = field(default_factory=Counter)


class Reading:
    """One pass through a drawing called ``name``: what was ``found``, and an end to what is too much or takes too long.

    ``room`` is how many points may still come.
    """

    def __init__(self, name: str) -> None:
        self.name, self.found, self.room = name, Read(), MAX_POINTS
        self._until = time.thread_time() + LONGEST_S

    def refuse(self, why: str) -> ToolpathError:
        """Why it is not read to its end."""
        return ToolpathError(f"{self.name}: {why}; save what is to be cut in a drawing of its own.")

    def look(self, points: int = 0) -> None:
        """Whether so many ``points`` may come. Raises ToolpathError where that is too much, or it is too late."""
        checkpoint()
        if points > self.room:
            raise self.refuse(f"its lines have more than {format_count(MAX_POINTS)} points")
        if time.thread_time() > self._until:
            raise self.refuse(f"it takes longer than {LONGEST_S:.0f} s to read")

    def near(self, points: FloatArray) -> None:
        """Refuse ``points`` (m) that no part has."""
        if not (np.abs(points) <= FARTHEST).all():
            raise self.refuse(f"a line goes farther than {FARTHEST / 1e3:g} km")

    def take(self, layer: str, shape: Shape, points: FloatArray) -> None:
        """One line of it, ``points`` (r, 2) in m."""
        if not np.isfinite(points).all():
            raise self.refuse(f"a line ({shape}) on layer {layer:.40} has a point that is no number")
        self.near(points)
        if shape == "circle" and np.linalg.norm(points[1] - points[0]) < SHORTEST:
            shape = "line"  # a point, which is left out as those are
        count = chords_of(shape, points)
        self.look(count)
        self.room -= count
        self.found.pieces.append(Contour(layer, shape, points))


def chords_of(shape: Shape, points: FloatArray) -> int:
    """Points that a line has, or at most comes to once its arcs are chords."""
    if shape == "circle":
        radius, sweep = float(np.linalg.norm(points[1] - points[0])), math.tau
    elif shape == "arc" and (centre := centre_of(*points)) is not None:
        radius = max(float(np.linalg.norm(points[0] - centre)), 1e-12)
        longest = 0.5 * math.pi * float(np.linalg.norm(np.diff(points, axis=0), axis=1).sum())
        sweep = min(longest / radius, math.tau)
    else:
        return len(points)
    whole = float(turn_counts(np.array([sweep]), np.array([radius]), CHORD_ERROR)[0])
    return math.ceil(whole * sweep / math.tau) + 2
