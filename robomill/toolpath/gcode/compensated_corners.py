"""Corners that are rounded or chamfered while cutter compensation is on (G41 with ``,R``, RND= or RND R).

The contour is rounded first, as it is programmed, and then followed beside: a straight cut waits until the next one is
known, and goes on to the reader of contours with its corner as an arc or a short cut.
"""

from dataclasses import dataclass

from robomill.toolpath.gcode.corners import Corner, joined
from robomill.toolpath.gcode.machine import Machine
from robomill.toolpath.gcode.program import Move
from robomill.toolpath.gcode.rules.motion_rules import ARC, CLOCKWISE, COUNTERCLOCKWISE, FEED, LINE
from robomill.toolpath.gcode.words import Block

BETWEEN = "a corner is rounded or chamfered between two straight cuts (G1) alone."


@dataclass
class Due:
    """A straight cut whose corner waits for the next one: its end (6,) and size in program units, and its feed."""

    block: Block
    end: list[float]
    corner: Corner
    feed: float


def straight(machine: Machine, block: Block, end: list[float]) -> None:
    """G0 or G1 to the programmed point ``end`` (6,) with compensation on, and the corner before or behind it."""
    compensation, corner = machine.compensation, machine.corner
    machine.corner = None
    due, compensation.due = compensation.due, None
    if (corner is not None or due is not None) and block.motion != LINE:
        raise block.refuse(BETWEEN)
    if due is not None:
        _cut_before(machine, due, end)
    if corner is None:
        compensation.straight(machine, block, end)
    elif compensation.programmed is None:
        raise block.refuse("the move that begins cutter compensation cannot end in such a corner; write one before it.")
    else:
        compensation.due = Due(block, list(end), corner, machine.feed)


def _cut_before(machine: Machine, due: Due, end: list[float]) -> None:
    """The straight cut that is due, and its corner, up to where the cut to ``end`` goes on."""
    compensation, factor = machine.compensation, machine.factor
    rows = (Move(due.block.line), Move(due.block.line))
    for row, start, stop in zip(rows, (compensation.programmed_point(machine), due.end), (due.end, end)):
        row.kind = FEED
        row.start, row.end = ([v * factor for v in point[:3]] for point in (start, stop))
        row.rotary = list(stop[3:])
    feed, machine.feed = machine.feed, due.feed
    for count, row in enumerate(joined(*rows, due.corner.scaled(factor))[:-1]):
        if count:
            machine.feed = due.corner.feed or due.feed
        place = [*(v / factor for v in row.end), *due.end[3:]]
        if row.kind != ARC:
            compensation.straight(machine, Block(due.block.line, motion=LINE), place)
            continue
        start = [0.0] * 3 if machine.arc_absolute else row.start
        centre = {"ijk"[a]: (row.centre[a] - start[a]) / factor for a in compensation.axes[:2]}
        turn = CLOCKWISE if row.clockwise else COUNTERCLOCKWISE
        compensation.arc(machine, Block(due.block.line, words=centre, motion=turn), place)
    machine.feed = feed
