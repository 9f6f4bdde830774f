"""A program line by line as it is executed: which lines, in which order, in which modes, and which moves each makes."""

from dataclasses import dataclass
from typing import Any

import numpy as np

from robomill.arrays import FloatArray
from robomill.toolpath.gcode import flow_rules
from robomill.toolpath.gcode.dialects import SAMPLE, choose_dialect
from robomill.toolpath.gcode.interpreter import Interpreter
from robomill.toolpath.gcode.lines import Lines
from robomill.toolpath.gcode.motion_rules import INVERSE_TIME, PER_TURN, rotate
from robomill.toolpath.gcode.owords import File
from robomill.toolpath.gcode.program import Program, Rows
from robomill.toolpath.gcode.reading import _machine, _program
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


class _Traced(Interpreter):
    """Executes one line at a time and writes down each."""

    executed: list[Executed]
    modes: Modes | None = None

    def _run_stretch(self) -> bool:
        index, file, before = self.pc, self.file, len(self.machine.recorder)
        structure = self.file.structure or self.no_words
        written = Rows(self.machine)
        store, text, flow = self.machine.store.arrays, self.file.lines.plain_text, structure.plain
        done, self.pc = flow_rules.run(self.machine, store, text, flow, self.pc, 1, written)
        written.keep()
        self._count(done, max(self.pc - 1, 0))
        if done:
            self._write(index, file, before)
        return bool(done)

    def step(self, index: int) -> None:
        file, before = self.file, len(self.machine.recorder)
        super().step(index)
        self._write(index, file, before)

    def _write(self, index: int, file: File, before: int) -> None:
        found = _modes(self.machine)
        if self.modes is None or not _same(self.modes, found):
            self.modes = found
        last = len(self.machine.recorder)
        self.executed.append(Executed(index, file is self.main, file.lines[index], before, last, self.modes))


def trace(text: str, dialect: str = "auto", tools: Tools | None = None) -> tuple[Program, list[Executed], str]:
    """The moves of a program, its lines as they are executed, and its dialect. Raises GCodeError as ``interpret``."""
    data = as_plain_bytes(text.encode("utf-8", "surrogateescape"))
    lines = Lines(data)
    chosen = choose_dialect(data[:SAMPLE].decode("utf-8", "replace"), dialect)
    machine = _machine(tools, chosen, len(lines))
    reader = _Traced(machine, File("program", lines), chosen)
    reader.executed = []
    reader.run()
    return _program(machine, chosen.name, len(lines) - (lines[-1] == "")), reader.executed, chosen.name


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
