"""What an interpreter makes of a program: canonical moves in the machine frame, as arrays."""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

import numpy as np

from robomill.arrays import BoolArray, FloatArray, IntArray, frozen
from robomill.errors import GCodeError
from robomill.toolpath.gcode import arcs
from robomill.toolpath.path import Finding, Toolpath

TRAVERSE, FEED, ARC, TAP, PROBE = 0, 1, 2, 3, 4
KINDS = ("traverse", "feed", "arc", "tap", "probe")
PLANES = {17: "XY", 18: "XZ", 19: "YZ"}

_WIDTHS = {
    "line": 1, "kind": 1, "start": 3, "end": 3, "rotary0": 3, "rotary": 3, "plane": 1, "centre": 3, "turns": 1,
    "clockwise": 1, "v_f": 1, "n_s": 1, "tool": 1,
}  # fmt: skip


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

    def _arcs(self) -> tuple[IntArray, tuple[Any, ...]]:
        i = np.flatnonzero(self.kind == ARC)
        return i, (self.start[i], self.end[i], self.centre[i], self.plane[i], self.turns[i], self.clockwise[i])

    @cached_property
    def sweep(self) -> FloatArray:
        """(m,) rad: signed sweep of arcs (clockwise negative), 0 for straight moves."""
        i, geometry = self._arcs()
        sweep = np.zeros(len(self))
        sweep[i] = arcs.sweeps(*geometry)[1]
        return frozen(sweep)

    @cached_property
    def length(self) -> FloatArray:
        """(m,) m: true length of each move, arcs by their arc length, taps there and back."""
        length = np.linalg.norm(self.end - self.start, axis=1)
        i, geometry = self._arcs()
        _, sweep, r0, r1 = arcs.sweeps(*geometry)
        climb = arcs.in_plane(self.plane[i], self.end[i] - self.start[i])[2]
        length[i] = arcs.arc_lengths(sweep, r0, r1, climb)
        length[self.kind == TAP] *= 2.0
        return frozen(length)

    @cached_property
    def extents(self) -> tuple[FloatArray, FloatArray] | None:
        """Lowest and highest corner (3,) m of all moves at feed, arcs with their true extremes; None without any."""
        at_feed = (self.kind != TRAVERSE) & (self.kind != PROBE)
        if not at_feed.any():
            return None
        i, geometry = self._arcs()
        lower, upper = arcs.arc_extents(*geometry)
        points = [self.start[at_feed], self.end[at_feed], lower, upper]
        return (
            np.min([q.min(axis=0) for q in points if len(q)], axis=0),
            np.max([q.max(axis=0) for q in points if len(q)], axis=0),
        )

    def toolpath(self, chord_error: float = arcs.CHORD_ERROR) -> Toolpath:
        """The moves as straight pieces in {W}, arcs as chords within ``chord_error`` (m).

        Raises GCodeError if nothing moves, or if a finding is an error.
        """
        if len(self) == 0:
            raise GCodeError("Program: found no motion; expected at least one G0, G1, G2 or G3 move.")
        counts = np.ones(len(self), dtype=np.int64)
        i, geometry = self._arcs()
        _, sweep, r0, r1 = arcs.sweeps(*geometry)
        counts[i] = arcs.chord_counts(sweep, np.maximum(r0, r1), chord_error)
        tilt = np.abs(self.rotary - self.rotary0).max(axis=1)
        counts = np.maximum(counts, np.ceil(tilt / arcs.MAX_TILT_STEP - 1e-9).astype(np.int64))
        if counts.sum() > arcs.MAX_POINTS:
            raise GCodeError(f"Program: the path would need {counts.sum()} points; at most {arcs.MAX_POINTS} fit.")
        owner = np.repeat(np.arange(len(self)), counts)
        first = np.repeat(np.cumsum(counts) - counts, counts)
        fraction = ((np.arange(len(owner)) - first + 1) / counts[owner])[:, None]
        p = self.start[owner] + fraction * (self.end - self.start)[owner]
        last = np.cumsum(counts) - 1
        p[last] = self.end
        is_arc = self.kind[owner] == ARC
        if len(i):
            p[is_arc] = arcs.chord_points(*geometry, counts[i])
        angles = self.rotary0[owner] + fraction * (self.rotary - self.rotary0)[owner]
        rows = self._with_returns(p, tool_axis(angles), owner, last - counts + 1)
        return Toolpath(findings=self.findings, units=self.units or "mm", **rows)

    def _with_returns(self, p: FloatArray, k: FloatArray, owner: IntArray, first: IntArray) -> dict[str, Any]:
        """Rows of a Toolpath: the start in front, and after each tap the way back."""
        taps = np.flatnonzero(self.kind == TAP)
        at = np.concatenate([[0], first[taps] + 1])
        moves = np.concatenate([[0], taps])
        cutting = np.arange(len(at)) > 0
        inserted = np.zeros(len(p) + len(at), dtype=bool)
        inserted[at + np.arange(len(at))] = True

        def merge(values: Any, extra: Any) -> Any:
            out = np.empty((len(inserted), *values.shape[1:]), dtype=values.dtype)
            out[~inserted], out[inserted] = values, extra
            return out

        feeds = (self.kind != TRAVERSE) & (self.kind != PROBE)
        return {
            "p": merge(p, self.start[moves]), "k": merge(k, tool_axis(self.rotary0[moves])),
            "cutting": merge(feeds[owner], cutting),
            "v_f": merge(np.where(feeds, self.v_f, 0.0)[owner], np.where(cutting, self.v_f[moves], 0.0)),
            "block": merge(self.line[owner], self.line[moves]), "n_s": merge(self.n_s[owner], self.n_s[moves]),
            "tool": merge(self.tool[owner], self.tool[moves]),
        }  # fmt: skip


def tool_axis(angles: FloatArray) -> FloatArray:
    """k (..., 3) for rotations A, B, C (..., 3) rad: k = (sin B, -sin A cos B, cos A cos B); C spins about k."""
    a, b = angles[..., 0], angles[..., 1]
    return np.stack([np.sin(b), -np.sin(a) * np.cos(b), np.cos(a) * np.cos(b)], axis=-1)
