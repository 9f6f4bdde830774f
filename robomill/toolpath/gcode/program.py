"""What an interpreter makes of a program: canonical moves in the machine frame, as arrays."""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

import numpy as np

from robomill.arrays import BoolArray, FloatArray, IntArray, frozen
from robomill.provenance import Finding
from robomill.toolpath.gcode import arcs
from robomill.toolpath.path import Toolpath

TRAVERSE, FEED, ARC, TAP, PROBE = 0, 1, 2, 3, 4
KINDS = ("traverse", "feed", "arc", "tap", "probe")
PLANES = {17: "XY", 18: "XZ", 19: "YZ"}

_WIDTHS = {
    "line": 1,
    "kind": 1,
    "start": 3,
    "end": 3,
    "rotary0": 3,
    "rotary": 3,
    "plane": 1,
    "centre": 3,
    "turns": 1,
    "clockwise": 1,
    "v_f": 1,
    "n_s": 1,
    "tool": 1,
}


@dataclass(frozen=True, eq=False)
class Program:
    """Canonical moves in order. Work offsets are applied, tool length is not subtracted (tool tip positions).

    line      (m,) int       1-based source line
    kind      (m,) int       0 traverse, 1 feed, 2 arc, 3 tap (down to the end and back); names in ``KINDS``
    start     (m, 3) m       tip at the start: the end before (of a tap: its start)
    end       (m, 3) m       tip at the end (of a tap: its bottom)
    rotary0, rotary (m, 3) rad   A, B, C at the start and at the end
    plane     (m,) int       17, 18, 19 for arcs, 0 otherwise
    centre    (m, 3) m       arc centre, at the start's height; 0 otherwise
    turns     (m,) int       started turns of an arc (1: up to a full circle); 0 otherwise
    clockwise (m,) bool      sense of an arc seen from the positive third axis
    v_f       (m,) m/s       feed rate, 0 for traverses
    n_s       (m,) 1/s       spindle speed, 0 where stopped
    tool      (m,) int       tool number in the spindle
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
    v_f: FloatArray
    n_s: FloatArray
    tool: IntArray
    units: str = ""
    dialect: str = "linuxcnc"
    lines: int = 0
    dwells: int = 0
    dwell_time: float = 0.0
    findings: tuple[Finding, ...] = field(default=(), compare=False)
    messages: tuple[tuple[int, str], ...] = field(default=(), compare=False)

    def __post_init__(self) -> None:
        m = len(self.line)
        for name, width in _WIDTHS.items():
            shape = (m, width) if width > 1 else (m,)
            array = np.broadcast_to(np.asarray(getattr(self, name)), shape)
            if array.flags.writeable:
                array = array.copy()
                array.flags.writeable = False
            object.__setattr__(self, name, array)

    def __len__(self) -> int:
        return len(self.line)

    @property
    def ok(self) -> bool:
        """True if no finding is an error."""
        return not any(f.level == "error" for f in self.findings)

    def is_kind(self, name: str) -> BoolArray:
        """(m,) True for moves of a kind in ``KINDS``."""
        return np.asarray(self.kind == KINDS.index(name))

    def geometry(self, rows: IntArray) -> tuple[Any, ...]:
        """start, end, centre, plane, turns, clockwise of some moves, as the functions of ``arcs`` take them."""
        return (
            self.start[rows],
            self.end[rows],
            self.centre[rows],
            self.plane[rows].astype(np.int64),
            self.turns[rows],
            self.clockwise[rows],
        )

    @cached_property
    def _arc_rows(self) -> IntArray:
        return np.flatnonzero(self.kind == ARC)

    @cached_property
    def sweep(self) -> FloatArray:
        """(m,) rad: signed sweep of arcs (clockwise negative), 0 for straight moves."""
        i = self._arc_rows
        sweep = np.zeros(len(self))
        sweep[i] = arcs.sweeps(*self.geometry(i))[1]
        return frozen(sweep)

    @cached_property
    def length(self) -> FloatArray:
        """(m,) m: true length of each move, arcs by their arc length, taps there and back."""
        length = np.linalg.norm(self.end - self.start, axis=1)
        i = self._arc_rows
        _, sweep, r0, r1 = arcs.sweeps(*self.geometry(i))
        climb = arcs.in_plane(self.plane[i].astype(np.int64), self.end[i] - self.start[i])[2]
        length[i] = arcs.arc_lengths(sweep, r0, r1, climb)
        length[self.kind == TAP] *= 2.0
        return frozen(length)

    @cached_property
    def extents(self) -> tuple[FloatArray, FloatArray] | None:
        """Lowest and highest corner (3,) m of all moves at feed, arcs with their true extremes; None without any."""
        at_feed = (self.kind != TRAVERSE) & (self.kind != PROBE)
        if not at_feed.any():
            return None
        lower, upper = arcs.arc_extents(*self.geometry(self._arc_rows))
        points = [self.start[at_feed], self.end[at_feed], lower, upper]
        return (
            np.min([q.min(axis=0) for q in points if len(q)], axis=0),
            np.max([q.max(axis=0) for q in points if len(q)], axis=0),
        )

    def toolpath(self, chord_error: float = arcs.CHORD_ERROR) -> Toolpath:
        """The moves as straight pieces in {W}, arcs as chords within ``chord_error`` (m); see ``chords``.

        Raises GCodeError if nothing moves.
        """
        from robomill.toolpath.gcode.chords import to_toolpath

        return to_toolpath(self, chord_error)
