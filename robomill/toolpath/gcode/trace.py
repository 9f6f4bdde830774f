"""A program line by line as it is executed: which lines, in which order, in which modes, and which moves each makes."""

import re
from dataclasses import dataclass
from typing import Any

import numpy as np

from robomill.arrays import FloatArray, IntArray
from robomill.lazy import cached_property
from robomill.toolpath.gcode.dialects import SAMPLE, choose_dialect
from robomill.toolpath.gcode.interpreter import Interpreter
from robomill.toolpath.gcode.lines import Lines
from robomill.toolpath.gcode.owords import File
from robomill.toolpath.gcode.program import Program, Rows
from robomill.toolpath.gcode.reading import _machine, _program
from robomill.toolpath.gcode.rules import flow_rules
from robomill.toolpath.gcode.rules.motion_rules import INVERSE_TIME, PER_TURN, rotate
from robomill.toolpath.gcode.scan import uncalled
from robomill.toolpath.text import as_plain_bytes
from robomill.toolpath.tools import Tools


@dataclass(frozen=True, eq=False)
class Modes:
    """What says how the words of a line count: ``factor`` m a unit, the origin and its shift (program units and
    degrees), the rotation (deg), steps or places, the plane. ``other`` names what turns words into other places."""

    factor: float
    unit: str
    origin: FloatArray
    shift: FloatArray
    rotation: float
    absolute: bool
    arc_absolute: bool
    plane: int
    inverse_time: bool
    per_turn: bool
    speed: float
    other: tuple[str, ...]

    def words(self, p: FloatArray) -> FloatArray:
        """(3,) program units: what leads to a point p (3,) m of the machine frame."""
        x = p / self.factor - self.origin[:3]
        if self.rotation:
            x[:2] = rotate(float(x[0]), float(x[1]), -self.rotation)
        return np.asarray(x - self.shift[:3])

    def point(self, x: FloatArray) -> FloatArray:
        """(3,) m: where places x (3,) in program units are in the machine frame."""
        y = x + self.shift[:3]
        if self.rotation:
            y[:2] = rotate(float(y[0]), float(y[1]), self.rotation)
        return np.asarray((y + self.origin[:3]) * self.factor)

    def angles(self, rotary: FloatArray) -> FloatArray:
        """(3,) deg: the words of rotary axes at (3,) rad."""
        return np.asarray(np.degrees(rotary) - self.origin[3:] - self.shift[3:])

    def places_as(self, other: "Modes") -> bool:
        """Whether words lead to the same places."""
        same = bool((self.origin == other.origin).all() and (self.shift == other.shift).all())
        return same and all(getattr(self, name) == getattr(other, name) for name in _PLACING)


@dataclass(frozen=True, eq=False)
class Executed:
    """Line ``index`` (0-based, of ``text``), the moves ``first`` to ``last`` (past the last) that were recorded while
    it was executed, and the modes behind it."""

    index: int
    main: bool
    text: str
    first: int
    last: int
    modes: Modes

    @property
    def uncalled(self) -> str:
        """The line without the call beside its other words."""
        return uncalled(self.text)


_SAME_MODES = re.compile(
    rb"\s*(?:N\d+\s*)?(?:G0?[0-3](?![\d.])\s*)?(?:[XYZIJKABCF]\s*[-+]?(?:\d+\.?\d*|\.\d+)\s*)*", re.IGNORECASE
)
"""A line of G-code that changes no ``Modes``: a move in a straight line or an arc, and its feed."""


def _go_on(lines: Lines) -> list[int]:
    """For each line, how many from there on change no modes."""
    starts, count = lines.starts.tolist(), 0
    found = [0] * len(lines)
    for i in range(len(lines) - 1, -1, -1):
        count = count + 1 if _SAME_MODES.fullmatch(lines.data, starts[i], starts[i + 1] - 1) else 0
        found[i] = count
    return found


class _Traced(Interpreter):
    """Executes one line at a time, those of moves alone in stretches, and writes down each."""

    executed: list[Executed]
    together: list[tuple[int, int]]  # where in ``executed`` a stretch begins and ends whose moves are still one lot
    modes: Modes | None = None

    def _run_stretch(self) -> bool:
        index, file, before = self.pc, self.file, len(self.machine.recorder)
        structure = self.file.structure or self.no_words
        most = self._alike[index] if file is self.main and index < len(self._alike) else 0
        if most > 1:
            done, self.pc, _ = self.stretches.run(file.lines, structure, index, self.steps, most)
            self._count(done, max(self.pc - 1, 0))
            if done:
                begin, modes, last = len(self.executed), self._modes_now(), len(self.machine.recorder)
                text = file.lines[index : index + done]
                self.executed += [Executed(index + n, True, text[n], before, last, modes) for n in range(done)]
                self.together.append((begin, begin + done))
            return bool(done)
        written = Rows(self.machine)
        store, text, flow = self.machine.store.arrays, self.file.lines.plain_text, structure.plain
        done, self.pc = flow_rules.run(self.machine, store, text, flow, (self.pc, 1), written)
        written.keep()
        self._count(done, max(self.pc - 1, 0))
        if done:
            self._write(index, file, before)
        return bool(done)

    @cached_property
    def _alike(self) -> list[int]:
        return _go_on(self.main.lines)

    def apart(self, line: IntArray) -> list[Executed]:
        """What was executed, each line with its own moves, those of the program being of lines ``line`` (m,)."""
        for begin, end in self.together:
            some = self.executed[begin:end]
            first, last = some[0].first, some[0].last
            own = some[0].index + 1 + np.arange(end - begin)
            begins, ends = (first + np.searchsorted(line[first:last], own, side) for side in ("left", "right"))
            self.executed[begin:end] = [
                Executed(each.index, each.main, each.text, a, b, each.modes)
                for each, a, b in zip(some, begins.tolist(), ends.tolist(), strict=True)
            ]
        return self.executed

    def step(self, index: int) -> None:
        file, before = self.file, len(self.machine.recorder)
        super().step(index)
        self._write(index, file, before)

    def _write(self, index: int, file: File, before: int) -> None:
        last, modes = len(self.machine.recorder), self._modes_now()
        self.executed.append(Executed(index, file is self.main, file.lines[index], before, last, modes))

    def _modes_now(self) -> Modes:
        found = _modes(self.machine)
        if self.modes is None or not _same(self.modes, found):
            self.modes = found
        return self.modes


def trace(text: str, dialect: str = "auto", tools: Tools | None = None) -> tuple[Program, list[Executed], str]:
    """The moves of a program, its lines as they are executed, and its dialect. Raises GCodeError as ``interpret``."""
    data = as_plain_bytes(text.encode("utf-8", "surrogateescape"))
    lines = Lines(data)
    chosen = choose_dialect(data[:SAMPLE].decode("utf-8", "replace"), dialect)
    machine = _machine(tools, chosen, lines)
    reader = _Traced(machine, File("program", lines), chosen)
    reader.executed, reader.together = [], []
    reader.run()
    program = _program(machine, chosen.name, len(lines) - (lines[-1] == ""))
    return program, reader.apart(program.line), chosen.name


def _modes(machine: object) -> Modes:
    m: Any = machine
    compensation = m.compensation is not None and m.compensation.radius > 0.0
    other = [
        name
        for name, on in (
            ("cutter compensation (G41, G42)", compensation),
            ("scaling (G51)", m.scale is not None),
            ("polar words (G16)", m.polar_words),
            ("diameters (G7)", m.diameter_mode),
        )
        if on
    ]
    return Modes(
        m.factor,
        m.unit,
        np.array(m.g5x),
        np.array(m.g92),
        m.rotation,
        m.absolute,
        m.arc_absolute,
        m.plane,
        m.feed_mode == INVERSE_TIME,
        m.feed_mode == PER_TURN,
        m.speed,
        tuple(other),
    )


def _same(a: Modes, b: Modes) -> bool:
    arrays = (a.origin == b.origin).all() and (a.shift == b.shift).all()
    rest = all(getattr(a, name) == getattr(b, name) for name in _PLAIN)
    return bool(arrays and rest)


_PLACING = ("factor", "rotation", "plane", "absolute")
_PLAIN = ("factor", "rotation", "absolute", "arc_absolute", "plane", "inverse_time", "per_turn", "speed", "other")
