"""Corners between two straight cuts that a program rounds or chamfers: Fanuc's ``,R`` and ``,C``, RND=, CHF=, CHR=."""

import math

import numpy as np

from robomill.errors import GCodeError
from robomill.toolpath.gcode.motion_rules import ARC, FEED, axes
from robomill.toolpath.gcode.program import Move
from robomill.units import format_si

ROUND, LEGS, BEVEL = "round", "legs", "bevel"
"""What the size of a corner is: its radius, its length along each cut, or the length of the bevel itself."""
_STRAIGHT = 1e-9


def joined(first: Move, then: Move, corner: tuple[str, float]) -> list[Move]:
    """``first``, the corner and ``then``, of which both ends are cut; ``corner`` is its kind and size (m).

    Raises GCodeError where the two are no straight cuts in one plane, or shorter than the corner.
    """
    kind, size = corner
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
    if kind == ROUND:
        _bend(middle, b + (back + on) / np.linalg.norm(back + on) * size / math.sin(half), np.cross(back, on), half)
    return [first, middle, then]


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
