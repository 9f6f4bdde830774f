"""What an interpreter makes of a program: canonical moves in the machine frame, recorded one by one, kept as arrays."""

import sys
from collections.abc import Callable
from dataclasses import dataclass, field
from itertools import product
from operator import attrgetter
from typing import Any

import numpy as np

from robomill.arrays import BoolArray, FloatArray, IntArray, frozen
from robomill.errors import GCodeError
from robomill.lazy import cached_property
from robomill.provenance import Finding
from robomill.toolpath import arcs
from robomill.toolpath.gcode.rules.motion_rules import ARC, FEED, PROBE, TAP, TRAVERSE
from robomill.toolpath.gcode.rules.records import MOVE

__all__ = ["ARC", "FEED", "KINDS", "PLANES", "PROBE", "TAP", "TRAVERSE", "Move", "Program", "Recorder", "Rows"]

KINDS = ("traverse", "feed", "arc", "tap", "probe")
PLANES = {17: "XY", 18: "XZ", 19: "YZ"}
MAX_MOVES = 6_000_000
LOOPED_MOVES, MOVES_A_LINE = 200_000, 20
"""So many moves a program may make, and so many more for each of its lines: what makes more has a loop without end."""
FLUSH = 16_384

_COLUMNS: tuple[str, ...] = MOVE.names or ()


def most_moves(lines: int) -> int:
    """How many moves a program of so many lines may make."""
    return min(MAX_MOVES, LOOPED_MOVES + MOVES_A_LINE * lines)


@dataclass(frozen=True, eq=False)
class Program:
    """Canonical moves in order, as the machine is told: where the tip of the tool goes whose length is in force.

    Work offsets are applied. ``lift`` is how far the tip of the tool in the spindle stands from there: 0, unless a tool
    cuts with the length of another one (G43 with that one's H).

    line      (m,) int       1-based source line
    kind      (m,) int       0 traverse, 1 feed, 2 arc, 3 tap (down to the end and back); names in ``KINDS``
    start     (m, 3) m       tip at the start: the end before (of a tap: its start)
    end       (m, 3) m       tip at the end (of a tap: its bottom)
    rotary0, rotary (m, 3) rad   A, B, C at the start and at the end
    plane     (m,) int       17, 18, 19 for arcs, 0 otherwise
    centre    (m, 3) m       arc centre, at the start's height; 0 otherwise
    turns     (m,) int       started turns of an arc (1: up to a full circle); 0 otherwise
    clockwise (m,) bool      sense of an arc seen from the positive third axis
    sweep     (m,) rad       signed sweep of arcs (clockwise negative), 0 for straight moves
    v_f       (m,) m/s       feed rate, 0 for traverses
    n_s       (m,) 1/s       spindle speed, 0 where stopped, NaN where it follows the diameter (G96)
    ccw       (m,) bool      the spindle turns counter-clockwise (M4)
    thread    (m,) bool      in step with the spindle, to cut a thread: G33, G33.1, G74, G76, G84
    dwell     (m,) s         stood still before the move
    tool      (m,) int       tool number in the spindle
    lift      (m, 3) m       from the programmed point to the tip of the tool that is there
    away      (m, 3) bool    where the move ends along x, y, z is known to the machine alone (G28, G30, G53)
    planes                   tilted planes (``tilted``; None: upright), each with the first move that stands in it as if
                             it were upright
    """

    line: IntArray
    kind: IntArray
    start: FloatArray
    end: FloatArray
    rotary0: FloatArray
    rotary: FloatArray
    plane: IntArray
    centre: FloatArray
    turns: IntArray
    clockwise: BoolArray
    sweep: FloatArray
    v_f: FloatArray
    n_s: FloatArray
    ccw: BoolArray
    thread: BoolArray
    dwell: FloatArray
    tool: IntArray
    lift: FloatArray
    away: BoolArray
    units: str
    dialect: str
    lines: int
    dwells: int
    dwell_time: float
    findings: tuple[Finding, ...] = field(default=(), compare=False)
    planes: tuple[tuple[int, Any], ...] = ()
    messages: tuple[tuple[int, str], ...] = field(default=(), compare=False)

    def __len__(self) -> int:
        return len(self.line)

    @property
    def ok(self) -> bool:
        """True if no finding is an error."""
        return not any(f.level == "error" for f in self.findings)

    def is_kind(self, name: str) -> BoolArray:
        """(m,) True for moves of a kind in ``KINDS``."""
        return np.asarray(self.kind == KINDS.index(name))

    def arcs_of(self, rows: IntArray) -> arcs.Arcs:
        """Some moves that are arcs, of the tip."""
        start, end, centre = (q[rows] + self.lift[rows] for q in (self.start, self.end, self.centre))
        return arcs.Arcs(start, end, centre, self.plane[rows].astype(np.int64), self.sweep[rows])

    @cached_property
    def at_feed(self) -> BoolArray:
        """(m,) True for moves that cut: all but traverses, probes, those whose place is not known, and those that go
        nowhere before any other: a G1 with a feed alone says nothing of where the tool is."""
        cuts = (self.kind != TRAVERSE) & (self.kind != PROBE) & ~self.unplaced
        cuts[: self.still] = False
        return frozen(cuts, bool)

    @cached_property
    def still(self) -> int:
        """How many straight moves go nowhere, and wait for nothing, before any other: they stand at the zero that the
        tool is taken to come from."""
        if not len(self) or (self.end[0] != self.start[0]).any():
            return 0
        stays = (self.end == self.start).all(axis=1) & (self.rotary == self.rotary0).all(axis=1)
        stays &= (self.kind <= FEED) & (self.dwell == 0.0) & ~self.lift.any(axis=1) & ~self.away.any(axis=1)
        return len(self) if stays.all() else int(np.argmin(stays))

    @cached_property
    def unplaced(self) -> BoolArray:
        """(m,) True for moves that end or come from where only the machine knows; straight down from there is known."""
        if not self.away.any():
            return np.zeros(1, dtype=bool)
        before = np.vstack([np.zeros((1, 3), dtype=bool), self.away[:-1]])
        sideways = before[:, :2].any(axis=1) | (before.any(axis=1) & (self.kind == ARC))
        return np.asarray(self.away.any(axis=1) | sideways)

    @cached_property
    def length(self) -> FloatArray:
        """(m,) m: true length of each move, arcs by their arc length, taps there and back."""
        length = np.linalg.norm(self.end - self.start, axis=1)
        rows = np.flatnonzero(self.kind == ARC)
        length[rows] = self.arcs_of(rows).length
        length[self.kind == TAP] *= 2.0
        return frozen(length)

    @cached_property
    def extents(self) -> tuple[FloatArray, FloatArray] | None:
        """Lowest and highest corner (3,) m of the tip at feed, arcs with their true extremes; None without any."""
        at_feed = self.at_feed
        if not at_feed.any():
            return None
        lower, upper = np.full(3, np.inf), np.full(3, -np.inf)
        for points, axis in product((self.start, self.end), range(3)):  # one after the other, for little memory
            along = points[at_feed, axis] + self.lift[at_feed, axis]
            lower[axis], upper[axis] = min(lower[axis], along.min()), max(upper[axis], along.max())
        if self.planes:
            return self._extents_in_part()
        rows = np.flatnonzero(self.kind == ARC)
        wide = self.arcs_of(rows[self.arcs_of(rows).may_leave(lower, upper)])
        if len(wide):
            lower = np.minimum(lower, wide.extents[0].min(axis=0))
            upper = np.maximum(upper, wide.extents[1].max(axis=0))
        return lower, upper

    def _extents_in_part(self) -> tuple[FloatArray, FloatArray]:
        """``extents`` of a program that tilts its plane, arcs by chords within ``arcs.CHORD_ERROR``."""
        found = []
        bounds = [0, *(row for row, _ in self.planes), len(self)]
        for plane, begin, end in zip([None, *(plane for _, plane in self.planes)], bounds, bounds[1:]):
            rows = begin + np.flatnonzero(self.at_feed[begin:end])
            turns = self.arcs_of(rows[self.kind[rows] == ARC])
            chords = turns.chords(turns.whole(arcs.CHORD_ERROR))
            points = np.vstack([*(q[rows] + self.lift[rows] for q in (self.start, self.end)), chords])
            found.append(points if plane is None else plane.in_part(points))
        every = np.vstack(found)
        return every.min(axis=0), every.max(axis=0)


class Move:
    """A move that the rules of ``motion_rules`` write, as a row of ``MOVE`` in plain Python."""

    __slots__ = _COLUMNS

    def __init__(self, line: int = 0) -> None:
        self.line = line
        self.kind = self.plane = self.turns = self.tool = 0
        self.clockwise = self.ccw = self.thread = False
        self.sweep = self.v_f = self.n_s = self.dwell = 0.0
        self.start, self.end, self.centre = [0.0] * 3, [0.0] * 3, [0.0] * 3
        self.rotary0, self.rotary = [0.0] * 3, [0.0] * 3


class Rows:
    """Rows for rules in plain Python, however many: one is recorded as soon as ``machine.moves`` counts it."""

    def __init__(self, machine: Any) -> None:
        self._machine, self._row, self._kept = machine, Move(), 0
        machine.moves = 0

    def __len__(self) -> int:
        return sys.maxsize

    def __getitem__(self, index: int) -> Move:
        self.keep()
        return self._row

    def keep(self) -> None:
        """Record what has been written."""
        if self._machine.moves > self._kept:
            self._machine.recorder.add(self._row)
            self._kept += 1


_row_of = attrgetter(*_COLUMNS)


class Recorder:
    """Collects moves: the last ones as rows of ``MOVE``, those before as columns."""

    def __init__(self, join: Callable[[Move, Move, Any], list[Move]] | None = None) -> None:
        self.join = join
        self.held: tuple[Move, tuple[str, float]] | None = None
        self.count, self.most = 0, MAX_MOVES
        self._rows = np.zeros(FLUSH, MOVE)
        self._taken = 0
        self._columns: dict[str, np.ndarray] = {}

    def __len__(self) -> int:
        return self.count + self._taken

    def add(self, move: Move, corner: Any = None) -> None:
        """A move, and the corner that its end shall have once the next one is known. Raises GCodeError if too many."""
        if self.held is not None and self.join is not None:
            (first, size), self.held = self.held, None
            *before, move = self.join(first, move, size)
            for each in before:
                self._add(each)
        if corner is not None:
            self.held = move, corner
            return
        self._add(move)

    def _add(self, move: Move) -> None:
        self._rows[self._taken] = _row_of(move)
        self.take(self._taken + 1)

    def last(self) -> np.void | None:
        """The row of the last move; None before the first."""
        return self._rows[self._taken - 1] if len(self) else None

    def free(self) -> tuple[np.ndarray, int]:
        """Rows to be written, and how many of them are taken already: not all."""
        return self._rows, self._taken

    def take(self, taken: int) -> None:
        """So many rows are written. Raises GCodeError if there are too many moves."""
        self._taken = taken
        if taken == FLUSH:
            self._flush()

    def _flush(self) -> None:
        self._keep(self._rows[: self._taken])
        self._taken = 0

    def _keep(self, rows: np.ndarray) -> None:
        """Copy ``rows`` into the columns; one that is 0 throughout takes no room."""
        after = self.count + len(rows)
        if after > self.most:
            line = int(rows["line"][-1])
            raise GCodeError.at(line, f"the program makes more than {self.most} moves; end its loops, or split it.")
        for name in _COLUMNS:
            if name in self._columns or rows[name].any():
                self._with_room(name, after)[self.count : after] = rows[name]
        self.count = after

    def _with_room(self, name: str, count: int) -> np.ndarray:
        """A column with room for at least ``count`` moves; what is not written yet costs no memory."""
        column = self._columns.get(name)
        if column is None or len(column) < count:
            grown = np.zeros((2 * count, *MOVE[name].shape), MOVE[name].base)
            if column is not None:
                grown[: self.count] = column[: self.count]
            self._columns[name] = column = grown
        return column

    def settle(self) -> None:
        """No move comes that would have a corner with the last one."""
        if self.held is not None:
            (last, _), self.held = self.held, None
            self._add(last)

    def columns(self) -> dict[str, Any]:
        """All moves as read-only arrays by column name."""
        self.settle()
        self._flush()
        out: dict[str, Any] = {}
        for name in _COLUMNS:
            if name in self._columns:
                out[name] = self._columns[name][: self.count]
                out[name].flags.writeable = False
            else:
                out[name] = np.broadcast_to(np.zeros(1, MOVE[name].base), (self.count, *MOVE[name].shape))
        return out
