"""Long stretches of plain G0, G1, G2 and G3 lines, interpreted as arrays; the result is the interpreter's own."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from robomill.arrays import BoolArray, FloatArray, IntArray
from robomill.toolpath.gcode import motion
from robomill.toolpath.gcode.arcs import AXES
from robomill.toolpath.gcode.machine import Machine
from robomill.toolpath.gcode.program import ARC, FEED, TRAVERSE
from robomill.toolpath.gcode.tokens import Lines, read_lines
from robomill.toolpath.gcode.words import Block

if TYPE_CHECKING:
    from robomill.toolpath.gcode.interpreter import Interpreter

MIN_LINES = 4000
"""Programs shorter than this are interpreted line by line."""
MIN_RUN = 48
CHUNK = 1 << 16
_MOTIONS = (0, 10, 20, 30)


class FastPath:
    """Reads the program in chunks of lines and takes over where a run of plain lines begins."""

    def __init__(self, data: bytes, lines: int) -> None:
        self.data = data
        ends = np.flatnonzero(np.frombuffer(data, np.uint8) == 10)
        self.ends = ends if len(ends) >= lines else np.append(ends, len(data))
        self.first = -1
        self.chunk: Lines | None = None
        self.wait = 0

    def run(self, interpreter: Interpreter) -> None:
        """Execute plain lines from ``interpreter.pc`` on, if there are enough of them, and move it on."""
        while self.wait <= interpreter.pc < len(self.ends):
            pc = interpreter.pc
            chunk = self._chunk(pc)
            at = pc - self.first
            end = int(chunk.run_end[at])
            if end - at < MIN_RUN or not _is_plain(interpreter.machine):
                self.wait = pc + 1 if end > at else self.first + max(end, at) + 1
                return
            done = _Run(interpreter.machine, chunk, at, end, pc).execute()
            interpreter.advance(done)
            if at + done < len(chunk):
                self.wait = interpreter.pc + 1
                return

    def _chunk(self, pc: int) -> Lines:
        first = pc - pc % CHUNK
        if self.chunk is None or first != self.first:
            last = min(first + CHUNK, len(self.ends))
            begin = int(self.ends[first - 1]) + 1 if first else 0
            self.first, self.chunk = first, read_lines(self.data[begin : int(self.ends[last - 1])] + b"\n")
        return self.chunk


def _is_plain(machine: Machine) -> bool:
    return (
        machine.compensation is None
        and machine.rotation == 0
        and machine.feed_mode == 940
        and machine.motion in _MOTIONS
        and not machine.arc_not_allowed
        and not machine.diameter_mode
    )


def _filled(values: FloatArray, before: float) -> FloatArray:
    """Each value that is not given is the one before it."""
    given = ~np.isnan(values)
    index = np.maximum.accumulate(np.where(given, np.arange(1, len(values) + 1), 0))
    return np.concatenate([[before], values])[index]


class _Run:
    """Plain lines ``at`` to ``end`` of a chunk, on a machine; ``pc`` is the index of the first in the program."""

    def __init__(self, machine: Machine, chunk: Lines, at: int, end: int, pc: int) -> None:
        self.machine = machine
        self.pc = pc
        self.words = {letter: values[at:end] for letter, values in chunk.values.items()}
        self.given = {letter: ~np.isnan(values) for letter, values in self.words.items()}

    def execute(self) -> int:
        """Interpret the lines up to the first that is not as simple as it looked; how many there were."""
        machine, words, given = self.machine, self.words, self.given
        code = _filled(words["G"], machine.motion / 10.0)
        feed = _filled(words["F"], machine.feed)
        axes = np.logical_or.reduce([given[letter] for letter in "XYZABC"])
        centre = given["I"] | given["J"] | given["K"]
        arc = code >= 2
        moves = given["G"] | axes | (centre & arc)
        p = [self._coordinate(axis, letter) for axis, letter in enumerate("XYZABC")]
        bad = (centre | given["R"]) & ~(arc & moves)
        bad |= moves & (code >= 1) & (feed == 0.0)
        bad |= moves & arc & (centre == given["R"])
        middle = self._centres(p, arc & moves, bad)
        first_bad = int(np.argmax(bad)) if bad.any() else len(bad)
        if first_bad < len(bad):
            cut = slice(0, first_bad)
            self.words = {k: v[cut] for k, v in words.items()}
            p, code, feed, moves, middle = (
                [q[: first_bad + 1] for q in p],
                code[cut],
                feed[cut],
                moves[cut],
                middle[cut],
            )
        if first_bad:
            self._record(p, code, feed, moves, middle)
        return first_bad

    def _coordinate(self, axis: int, letter: str) -> FloatArray:
        """(n + 1,) values before the first line and after each."""
        values, before = self.words[letter], self.machine.p[axis]
        if self.machine.absolute:
            return np.concatenate([[before], _filled(values, before)])
        return np.add.accumulate(np.concatenate([[before], np.where(np.isnan(values), 0.0, values)]))

    def _centres(self, p: list[FloatArray], arc: BoolArray, bad: BoolArray) -> FloatArray:
        """(n, 2) centres in the plane; lines whose arc is wrong are marked in ``bad``."""
        machine, words, given = self.machine, self.words, self.given
        out = np.zeros((len(arc), 2))
        rows = np.flatnonzero(arc & ~bad)
        if len(rows) == 0:
            return out
        first, second, third = AXES[machine.plane]
        bad[rows] |= given["IJK"[third]][rows]
        x, y, end_x, end_y = p[first][rows], p[second][rows], p[first][rows + 1], p[second][rows + 1]
        centre = np.stack([words["IJK"[first]][rows], words["IJK"[second]][rows]], axis=1)
        by_radius = given["R"][rows]
        if machine.arc_absolute:
            bad[rows] |= np.isnan(centre).any(axis=1) & ~by_radius
        else:
            centre = np.stack([x, y], axis=1) + np.where(np.isnan(centre), 0.0, centre)
        out[rows] = centre
        self._check_radii(
            rows[~by_radius],
            (x - centre[:, 0])[~by_radius],
            (y - centre[:, 1])[~by_radius],
            (end_x - centre[:, 0])[~by_radius],
            (end_y - centre[:, 1])[~by_radius],
            bad,
        )
        for i in np.flatnonzero(by_radius & ~bad[rows]):
            row = int(rows[i])
            if not (given["XYZ"[first]][row] or given["XYZ"[second]][row]):
                bad[row] = True
                continue
            block = Block(
                self.pc + row + 1, {"r": float(words["R"][row])}, motion=20 if self._is_clockwise(row) else 30
            )
            try:
                out[row] = motion.arc_centre(machine, block, float(x[i]), float(y[i]), float(end_x[i]), float(end_y[i]))
            except ValueError:
                bad[row] = True
        return out

    def _is_clockwise(self, row: int) -> bool:
        known = self.words["G"][: row + 1]
        known = known[~np.isnan(known)]
        return bool(known[-1] == 2) if len(known) else self.machine.motion == 20

    def _check_radii(
        self, rows: IntArray, dx: FloatArray, dy: FloatArray, ex: FloatArray, ey: FloatArray, bad: BoolArray
    ) -> None:
        unit = self.machine.unit
        r_start, r_end = np.hypot(dx, dy), np.hypot(ex, ey)
        tolerance = motion.SPIRAL_TOLERANCE[unit]
        allowed = np.minimum(np.maximum(tolerance, motion.SPIRAL_SHARE * np.maximum(r_start, r_end)), 100.0 * tolerance)
        # A hair less than allowed: what is on the edge is judged by the interpreter itself.
        good = (np.minimum(r_start, r_end) > motion.RADIUS_TOLERANCE[unit] * (1 + 1e-9)) & (
            np.abs(r_start - r_end) < allowed * (1 - 1e-9)
        )
        bad[rows[~good]] = True

    def _record(
        self, p: list[FloatArray], code: FloatArray, feed: FloatArray, moves: BoolArray, middle: FloatArray
    ) -> None:
        machine, recorder = self.machine, self.machine.recorder
        speed = _filled(self.words["S"], machine.speed)
        rows = np.flatnonzero(moves)
        after = [q[1:][rows] for q in p]
        end = np.stack([self._frame(axis, after[axis]) for axis in range(3)], axis=1)
        kind = np.where(code[rows] >= 2, ARC, np.where(code[rows] >= 1, FEED, TRAVERSE)).astype(np.int8)
        per_second = 1.0 / 60.0
        columns: dict[str, Any] = {
            "line": (rows + (self.pc + 1)).astype(np.int32),
            "kind": kind,
            "end": end,
            "start": np.concatenate([[recorder.at], end[:-1]]) if len(rows) else end,
            "v_f": np.where(kind == TRAVERSE, 0.0, feed[rows] * machine.factor * per_second),
        }
        if machine.spindle and machine.spindle_mode == 970:
            columns["n_s"] = speed[rows] / 60.0
        if recorder.tool:
            columns["tool"] = np.full(len(rows), recorder.tool, np.int32)
        self._record_rotary(after, columns)
        self._record_arcs(p, code, rows, middle, columns)
        self._settle(p, code, feed, speed, rows, kind)
        if len(rows):
            recorder.extend(columns)
            recorder.at = (float(end[-1, 0]), float(end[-1, 1]), float(end[-1, 2]))

    def _frame(self, axis: int, values: FloatArray) -> FloatArray:
        machine = self.machine
        return (values + machine.g92[axis] + machine.g5x[axis]) * machine.factor

    def _record_rotary(self, after: list[FloatArray], columns: dict[str, Any]) -> None:
        machine, recorder = self.machine, self.machine.recorder
        offsets = [machine.g92[axis] + machine.g5x[axis] for axis in range(3, 6)]
        if not any(recorder.turned) and not any(offsets) and not any(values.any() for values in after[3:]):
            return
        turned = np.stack(
            [np.radians(after[axis] + machine.g92[axis] + machine.g5x[axis]) for axis in range(3, 6)], axis=1
        )
        columns["rotary"] = turned
        if len(turned):
            columns["rotary0"] = np.concatenate([[recorder.turned], turned[:-1]])
            recorder.turned = (float(turned[-1, 0]), float(turned[-1, 1]), float(turned[-1, 2]))

    def _record_arcs(
        self, p: list[FloatArray], code: FloatArray, rows: IntArray, middle: FloatArray, columns: dict[str, Any]
    ) -> None:
        arcs = np.flatnonzero(code[rows] >= 2)
        if len(arcs) == 0:
            return
        first, second, third = AXES[self.machine.plane]
        centre = np.zeros((len(rows), 3))
        centre[arcs, first] = self._frame(first, middle[rows[arcs], 0])
        centre[arcs, second] = self._frame(second, middle[rows[arcs], 1])
        centre[arcs, third] = self._frame(third, p[third][rows[arcs]])
        columns["centre"] = centre
        columns["plane"] = np.where(code[rows] >= 2, self.machine.plane, 0).astype(np.int8)
        columns["turns"] = (code[rows] >= 2).astype(np.int32)
        columns["clockwise"] = code[rows] == 2

    def _settle(
        self,
        p: list[FloatArray],
        code: FloatArray,
        feed: FloatArray,
        speed: FloatArray,
        rows: IntArray,
        kind: Any,
    ) -> None:
        """Leave the machine as the last line leaves it."""
        machine = self.machine
        machine.p = [float(q[-1]) for q in p]
        machine.feed, machine.speed = float(feed[-1]), float(speed[-1])
        if len(rows) == 0:
            return
        machine.motion = int(code[rows[-1]]) * 10
        machine.initial_level = None
        straight = np.flatnonzero(kind != ARC)
        if len(straight):
            row = int(rows[straight[-1]])
            machine.sent = [float(q[row + 1]) for q in p]
