"""Corners between two straight cuts that a program rounds or chamfers: Fanuc's ``,R`` and ``,C``, RND=, CHF=, CHR=."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from robomill.errors import GCodeError
from robomill.toolpath.gcode.program import Move
from robomill.toolpath.gcode.rules.motion_rules import ARC, FEED
from robomill.toolpath.plane import axes
from robomill.units import format_si

ROUND, LEGS, BEVEL, EACH = "round", "legs", "bevel", "each"
"""What the size of a corner is: its radius, its length along each cut, the length of the bevel itself, or the radius of
each corner of a contour (RNDM), where there is one: none beside a rapid, or a move that leaves the plane XY."""
_STRAIGHT = 1e-9
_SMOOTH = math.radians(0.01)
"""Cuts whose directions differ by less than this meet in no corner."""


class Corner(NamedTuple):
    """What becomes of a corner: its kind, its size and a ``feed`` of its own, 0 where it is that of its line; as a line
    says them in program units (a minute), or in m and m/s."""

    kind: str
    size: float
    feed: float = 0.0

    def scaled(self, length: float, speed: float | None = None) -> Corner:
        """In other units of length; of speed, too, where they do not go with those."""
        return Corner(self.kind, self.size * length, self.feed * (length if speed is None else speed))


def joined(first: Move, then: Move, corner: Corner) -> list[Move]:
    """``first``, the corner (m, m/s) and ``then``, of which both ends are cut.

    Raises GCodeError where the two are no straight cuts in one plane, or shorter than the corner.
    """
    kind, size, feed = corner
    if kind == EACH:
        if not _is_corner(first, then):
            return [first, then]
        kind = ROUND
    if first.kind != FEED or then.kind != FEED or first.rotary != then.rotary:
        raise GCodeError.at(first.line, "a corner is rounded or chamfered between two straight cuts (G1) alone.")
    a, b, c = (np.array(point) for point in (first.start, first.end, then.end))
    back, on = a - b, c - b
    lengths = float(np.linalg.norm(back)), float(np.linalg.norm(on))
    if min(lengths) < _STRAIGHT:
        raise GCodeError.at(first.line, "a corner lies between two cuts that have a length.")
    back, on = back / lengths[0], on / lengths[1]
    half = 0.5 * math.acos(float(np.clip(back @ on, -1.0, 1.0)))
    if half > 0.5 * math.pi - 1e-7 or size == 0.0:
        return [first, then]
    leg = {ROUND: size / math.tan(max(half, 1e-9)), LEGS: size, BEVEL: 0.5 * size / math.sin(max(half, 1e-9))}[kind]
    if leg > min(lengths) + _STRAIGHT:
        text = f"a corner takes {format_si(leg, 'mm')} of both cuts, and one has {format_si(min(lengths), 'mm')}."
        raise GCodeError.at(first.line, text)
    here, there = b + leg * back, b + leg * on
    middle = _copy(first)
    first.end, then.start = here.tolist(), there.tolist()
    middle.start, middle.end, middle.dwell = list(first.end), list(then.start), 0.0
    middle.rotary0 = list(first.rotary)
    middle.v_f = feed or middle.v_f
    if kind == ROUND:
        _bend(middle, b + (back + on) / np.linalg.norm(back + on) * size / math.sin(half), np.cross(back, on), half)
    return [first, middle, then]


def _is_corner(first: Move, then: Move) -> bool:
    """Whether two moves meet in a corner of a contour in the plane XY. Raises GCodeError at one beside an arc."""
    courses = []
    for move, point in ((first, first.end), (then, then.start)):
        along = [b - a for a, b in zip(move.start, move.end)]
        if move.kind not in (FEED, ARC) or abs(along[2]) > _STRAIGHT or move.rotary != move.rotary0:
            return False
        if move.kind == ARC:
            turn = 1.0 if move.sweep > 0.0 else -1.0
            along = [-turn * (point[1] - move.centre[1]), turn * (point[0] - move.centre[0]), 0.0]
            if move.plane != 17:
                return False
        courses.append((along[0], along[1]))
    (a, b), (c, d) = courses
    size = math.hypot(a, b) * math.hypot(c, d)
    if size <= _STRAIGHT**2 or a * c + b * d >= size * math.cos(_SMOOTH):
        return False
    if ARC in (first.kind, then.kind):
        text = "RNDM rounds the corner between a cut and an arc, which is not read; write that arc out, or RNDM=0."
        raise GCodeError.at(first.line, text)
    return True


def _bend(row: Move, centre: np.ndarray, across: np.ndarray, half: float) -> None:
    """Make ``row`` an arc about ``centre`` in the plane that ``across`` is the normal of."""
    third = int(np.argmax(np.abs(across)))
    if abs(across[third]) < np.linalg.norm(across) * (1.0 - 1e-9):
        raise GCodeError.at(row.line, "a corner is rounded in one of the planes XY, XZ and YZ alone.")
    row.plane = 19 - third
    assert axes(row.plane)[2] == third
    row.kind, row.turns, row.centre = ARC, 1, centre.tolist()
    row.clockwise = bool(across[third] > 0.0)
    row.sweep = (-1.0 if row.clockwise else 1.0) * (math.pi - 2.0 * half)


def _copy(row: Move) -> Move:
    out = Move(row.line)
    for name in Move.__slots__:
        value = getattr(row, name)
        setattr(out, name, list(value) if isinstance(value, list) else value)
    return out
