"""Corners that are rounded or chamfered while cutter compensation is on (G41 with ``,R``, RND= or RND R).

The contour is rounded first, as it is programmed, and then followed beside: a cut waits until the next one is known,
and goes on to the reader of contours with its corner as an arc or a short cut.
"""

from dataclasses import dataclass, replace

from robomill.toolpath.gcode.corners import BETWEEN, Corner, joined
from robomill.toolpath.gcode.machine import Machine
from robomill.toolpath.gcode.program import Move
from robomill.toolpath.gcode.rules.motion_rules import ARC, CLOCKWISE, COUNTERCLOCKWISE, FEED, LINE, is_arc
from robomill.toolpath.gcode.words import Block
from robomill.toolpath.plane import swept


@dataclass
class Due:
    """A cut whose corner waits for the next one: its end (6,) and size in program units, and its feed."""

    block: Block
    end: list[float]
    corner: Corner
    feed: float


def follow(machine: Machine, block: Block, end: list[float]) -> None:
    """G0 to G3 to the programmed point ``end`` (6,) with compensation on, and the corner before or behind it."""
    compensation, corner = machine.compensation, machine.corner
    machine.corner = None
    due, compensation.due = compensation.due, None
    if (corner is not None or due is not None) and not (block.motion == LINE or is_arc(block.motion)):
        raise block.refuse(BETWEEN)
    if due is not None:
        block = _cut_before(machine, due, block, end)
    if corner is None:
        _run(machine, block, end)
    elif compensation.programmed is None:
        raise block.refuse("the move that begins cutter compensation cannot end in such a corner; write one before it.")
    else:
        compensation.due = Due(block, list(end), corner, machine.feed)


def _run(machine: Machine, block: Block, end: list[float]) -> None:
    if is_arc(block.motion):
        machine.compensation.arc(machine, block, end)
    else:
        machine.compensation.straight(machine, block, end)


def _cut_before(machine: Machine, due: Due, block: Block, end: list[float]) -> Block:
    """The cut that is due, and its corner, up to where ``block`` goes on to ``end``; that block as it is from there."""
    compensation, factor = machine.compensation, machine.factor
    rows = (
        _row(machine, due.block, compensation.programmed_point(machine), due.end),
        _row(machine, block, due.end, end),
    )
    feed, machine.feed = machine.feed, due.feed
    *before, then = joined(*rows, due.corner.scaled(factor))
    for count, row in enumerate(before):
        if count:
            machine.feed = due.corner.feed or due.feed
        place = [*(v / factor for v in row.end), *due.end[3:]]
        _run(machine, _block(machine, row, due.block), place)
    machine.feed = feed
    return _block(machine, then, block)


def _row(machine: Machine, block: Block, start: list[float], end: list[float]) -> Move:
    """The cut of a block as it is programmed, from ``start`` to ``end`` (6,) in program units."""
    factor, (u, v, w) = machine.factor, machine.compensation.axes
    row = Move(block.line)
    row.kind, row.plane = FEED, machine.compensation.plane
    row.start, row.end = ([value * factor for value in point[:3]] for point in (start, end))
    row.rotary0, row.rotary = list(start[3:]), list(end[3:])
    if is_arc(block.motion):
        turn = round(block.words.get("p", 1.0)) * (-1 if block.motion == CLOCKWISE else 1)
        centre = machine.compensation.centre_of(machine, block, start, end)
        row.kind, row.turns, row.clockwise = ARC, abs(turn), turn < 0
        row.centre[u], row.centre[v], row.centre[w] = centre[0] * factor, centre[1] * factor, row.end[w]
        row.sweep = swept((start[u], start[v]), (end[u], end[v]), centre, turn)
    return row


def _block(machine: Machine, row: Move, block: Block) -> Block:
    """A cut in words: what its block says beside its form, and its centre."""
    if row.kind != ARC:
        return block
    start = [0.0] * 3 if machine.arc_absolute else row.start
    words = {letter: value for letter, value in block.words.items() if letter not in "ijkr"}
    for axis in machine.compensation.axes[:2]:
        words["ijk"[axis]] = (row.centre[axis] - start[axis]) / machine.factor
    return replace(block, words=words, motion=CLOCKWISE if row.clockwise else COUNTERCLOCKWISE)
