"""Corners between two cuts that a program rounds or chamfers: Fanuc's ``,R`` and ``,C``, RND=, CHF=, CHR=.

Between straight cuts in any of the planes; beside an arc of one turn, in the plane of that, a corner is rounded.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from robomill.errors import GCodeError
from robomill.toolpath.gcode.fillets import Cut, tangents_turn, touching
from robomill.toolpath.gcode.program import Move
from robomill.toolpath.gcode.rules.motion_rules import ARC, FEED
from robomill.toolpath.plane import axes, swept
from robomill.units import format_si

ROUND, LEGS, BEVEL, EACH = "round", "legs", "bevel", "each"
"""What the size of a corner is: its radius, its length along each cut, the length of the bevel itself, or the radius of
each corner of a contour (RNDM), where there is one: none beside a rapid, or a move that leaves the plane XY."""
AT_END = "a corner is rounded at the end of a cut (G1, G2, G3), or chamfered at that of a G1 alone."
BETWEEN = "a corner is rounded between two cuts (G1, G2, G3), and chamfered between two straight ones (G1) alone."
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

    Raises GCodeError where the two are no cuts in one plane, or shorter than the corner.
    """
    kind, size, feed = corner
    if kind == EACH:
        if not _is_corner(first, then):
            return [first, then]
        kind = ROUND
    cuts = {first.kind, then.kind}
    if not cuts <= ({FEED, ARC} if kind == ROUND else {FEED}) or first.rotary != then.rotary:
        raise GCodeError.at(first.line, BETWEEN)
    if ARC in cuts:
        return _beside_arc(first, then, size, feed)
    a, b, c = (np.array(point) for point in (first.start, first.end, then.end))
    back, on = a - b, c - b
    lengths = math.hypot(*back), math.hypot(*on)
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
    """Whether two moves meet in a corner of a contour in the plane XY."""
    for move in (first, then):
        climbs = abs(move.end[2] - move.start[2]) > _STRAIGHT
        if move.kind not in (FEED, ARC) or climbs or move.rotary != move.rotary0:
            return False
        if move.plane != 17 if move.kind == ARC else math.dist(move.start, move.end) <= _STRAIGHT:
            return False
    return abs(tangents_turn(_cut(first, -1, (0, 1)), _cut(then, 1, (0, 1)))) > _SMOOTH


def _beside_arc(first: Move, then: Move, size: float, feed: float) -> list[Move]:
    """A corner of which one cut is an arc, rounded with ``size`` (m); where they go on tangentially there is none."""
    plane = first.plane if first.kind == ARC else then.plane
    u, v, w = axes(plane)
    for move in (first, then):
        level = abs(move.end[w] - move.start[w]) <= _STRAIGHT
        if not level or (move.kind == ARC and (move.plane != plane or move.turns != 1)):
            raise GCodeError.at(first.line, "a corner beside an arc is rounded in the plane of that arc alone.")
    cuts = _cut(first, -1, (u, v)), _cut(then, 1, (u, v))
    if size == 0.0 or abs(tangents_turn(*cuts)) <= _SMOOTH:
        return [first, then]
    found = touching((first.end[u], first.end[v]), *cuts, size)
    if found is None:
        text = f"a corner of radius {format_si(size, 'mm')} does not fit between its two cuts; give a smaller one."
        raise GCodeError.at(first.line, text)
    middle = _copy(first)
    middle.kind, middle.plane, middle.turns, middle.dwell = ARC, plane, 1, 0.0
    middle.rotary0, middle.v_f = list(first.rotary), feed or first.v_f
    middle.clockwise = tangents_turn(*cuts) < 0.0
    leaves, joins, centre = found
    for axis, k in ((u, 0), (v, 1)):
        first.end[axis] = middle.start[axis] = leaves[k]
        then.start[axis] = middle.end[axis] = joins[k]
        middle.centre[axis] = centre[k]
    middle.start[w] = middle.end[w] = middle.centre[w] = first.end[w]
    for move in (first, middle, then):
        if move.kind == ARC:
            start, end, about = ((point[u], point[v]) for point in (move.start, move.end, move.centre))
            move.sweep = swept(start, end, about, -1 if move.clockwise else 1)
    return [first, middle, then]


def _cut(move: Move, way: int, plane: tuple[int, int]) -> Cut:
    """A move as ``fillets`` sees it from the corner at its end (``way`` -1) or start (1)."""
    u, v = plane
    point = move.end if way < 0 else move.start
    if move.kind != ARC:
        along = move.end[u] - move.start[u], move.end[v] - move.start[v]
        length = math.hypot(*along)
        return Cut(way, (along[0] / max(length, _STRAIGHT), along[1] / max(length, _STRAIGHT)), length)
    centre, turn = (move.centre[u], move.centre[v]), -1 if move.clockwise else 1
    radius = math.dist((point[u], point[v]), centre)
    along = -turn * (point[v] - centre[1]) / radius, turn * (point[u] - centre[0]) / radius
    return Cut(way, along, abs(move.sweep), centre, radius, turn)


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
