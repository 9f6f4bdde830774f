"""The two ways in: ``interpret`` for canonical moves, ``read_gcode`` for a toolpath."""

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from robomill.arrays import FloatArray, frozen
from robomill.errors import GCodeError
from robomill.provenance import Level
from robomill.toolpath.gcode.arcs import CHORD_ERROR
from robomill.toolpath.gcode.chords import to_toolpath
from robomill.toolpath.gcode.dialects import SAMPLE, choose_dialect
from robomill.toolpath.gcode.findings import NO_UNITS
from robomill.toolpath.gcode.interpreter import Interpreter
from robomill.toolpath.gcode.lines import Lines
from robomill.toolpath.gcode.machine import Machine
from robomill.toolpath.gcode.owords import File
from robomill.toolpath.gcode.program import Program
from robomill.toolpath.path import NO_SPINDLE, Toolpath
from robomill.toolpath.text import Source, read_source
from robomill.toolpath.tools import Tools
from robomill.units import format_si, to_si

LIKELY = (0.008, 3.0)
"""m: parts smaller or larger than this are doubted."""
MOST_SAID = 1000
LONG_DWELL = 60.0  # s, on average over a program: so long none waits, so the number is in another unit
"""Stretches of a program that one finding counts."""


def read_gcode(
    path_or_text: Source,
    *,
    chord_error: float = CHORD_ERROR,
    dialect: str = "auto",
    tools: Tools | None = None,
) -> Toolpath:
    """The toolpath of a program in {W}: arcs as chords within ``chord_error`` (m), findings attached.

    Raises GCodeError naming the line that is refused, or if nothing moves.
    """
    program = interpret(path_or_text, dialect=dialect, tools=tools)
    return to_toolpath(program, chord_error)


def interpret(
    source: Source,
    *,
    dialect: str = "auto",
    tools: Tools | None = None,
    partial: bool = False,
) -> Program:
    """Canonical moves of a program: a path, the text itself, or its bytes (see ``read_source``).

    ``tools`` is a tool table by number; without one every tool is accepted, of unknown size. Raises
    GCodeError naming the line that is refused; with ``partial`` the moves before it are returned instead, and the
    refusal is an error among the findings.
    """
    data, name = read_source(source)
    lines = Lines(data)
    chosen = choose_dialect(data[:SAMPLE].decode("utf-8", "replace"), dialect)
    machine = Machine(tools)
    is_file = isinstance(source, Path) or (isinstance(source, str) and name != "program")
    folder = Path(source).parent if isinstance(source, str | Path) and is_file else None
    interpreter = Interpreter(machine, File(name, lines, folder), chosen)
    try:
        interpreter.run()
    except GCodeError as exc:
        if not partial:
            raise
        machine.findings.add("refused", "error", exc.line, str(exc))
    if chosen.guessed and chosen.name != "linuxcnc":
        machine.findings.add(
            "dialect-guessed", "info", 0, f"read as {chosen.name} code; this is a guess from how it looks"
        )
    return _program(machine, chosen.name, len(lines) - (lines[-1] == ""))


def _program(machine: Machine, dialect: str, lines: int) -> Program:
    columns: dict[str, Any] = machine.recorder.columns()
    if not np.isfinite(columns["end"]).all() or not np.isfinite(columns["centre"]).all():
        bad = int(columns["line"][np.flatnonzero(~np.isfinite(columns["end"]).all(axis=1))[:1]].sum())
        raise GCodeError.at(bad, "a coordinate is too large; expected finite lengths.")
    if not machine.unit_said and len(columns["line"]):
        machine.findings.add(NO_UNITS, "suspicious", 0, "no G20 or G21: lengths are taken as mm")
    program = Program(
        **columns,
        lift=_lift(machine, columns),
        units=machine.unit_said,
        dialect=dialect,
        lines=lines,
        dwells=machine.dwells,
        dwell_time=machine.dwell_time,
        messages=tuple(machine.messages),
    )
    if machine.dwell_time > LONG_DWELL * machine.dwells:
        text = (
            f"the program waits {machine.dwell_time:g} s in {machine.dwells} dwells, as P counts seconds here; where "
            "it counts milliseconds (Fanuc, without a point) choose that dialect."
        )
        machine.findings.add("long-dwell", "suspicious", 0, text)
    _doubt_length(machine, program)
    _doubt_spindle(machine, program)
    _doubt_size(machine, program)
    _doubt_spin(machine, program)
    return replace(program, findings=machine.findings.freeze())


def _lift(machine: Machine, columns: dict[str, Any]) -> FloatArray:
    """(m, 3) m: how far each move's tip stands from where it is told to go."""
    count = len(columns["line"])
    if not machine.lifts:
        return np.broadcast_to(np.zeros(3), (count, 3))
    lift = np.zeros((count, 3))
    for first, value in machine.lifts:
        lift[first:] = value
    return frozen(lift)


def _doubt_length(machine: Machine, program: Program) -> None:
    """Warn of cuts with the length of another tool."""
    wrong = np.flatnonzero(program.lift.any(axis=1) & program.at_feed) if machine.lifts else np.zeros(0, dtype=np.int64)
    for tool in np.unique(program.tool[wrong]):
        row = int(wrong[program.tool[wrong] == tool][0])
        lifted = float(program.lift[row, 2])
        off = f"{format_si(abs(lifted), 'mm')} {'higher' if lifted > 0.0 else 'lower'}"
        message = f"tool {tool} cuts with the length of another tool (G43): its tip goes {off} than is said"
        machine.findings.add("wrong-length", "warning", int(program.line[row]), message)


def _doubt_spindle(machine: Machine, program: Program) -> None:
    """Note cuts with a spindle that stands still, and tools that are chosen and never changed to."""
    still = np.flatnonzero(program.at_feed & (program.n_s == 0.0))
    if len(still) and program.n_s.any():
        message = "cuts with the spindle stopped; start it with S and M3 or M4 before"
        for line in program.line[still[np.append(True, np.diff(still) > 1)]][:MOST_SAID]:
            machine.findings.add("spindle-stopped", "warning", int(line), message)
    elif len(still):
        machine.findings.add(NO_SPINDLE, "info", 0, "the spindle never turns: no S with M3 or M4")
    if machine.selected and not program.tool.any() and program.at_feed.any():
        message = f"T{machine.selected} is chosen, but no M6 changes to it: the cuts are taken as made without a number"
        machine.findings.add("no-change", "warning", 0, message)


def _doubt_spin(machine: Machine, program: Program) -> None:
    """Say how C is read where a cut has one: a machine whose table or head swivels by C stands otherwise."""
    spun = np.flatnonzero(program.at_feed & (program.rotary[:, 2] != 0.0))
    leans = spun[program.rotary[spun, :2].any(axis=1)]
    if len(spun):
        message = (
            "C is read as a turn of the tool about its own axis, which changes no cut; a machine whose table or head "
            "swivels by C stands otherwise: post the program with the tool's lean in A and B"
        )
        level: Level = "warning" if len(leans) else "info"
        machine.findings.add("c-spins", level, int(program.line[(leans if len(leans) else spun)[0]]), message)


def _doubt_size(machine: Machine, program: Program) -> None:
    """Note a part that would have a likelier size in the other unit, 25.4 times off."""
    if program.extents is None:
        return
    size = float(np.subtract(*program.extents[::-1]).max())
    inch = to_si(1.0, "in") / to_si(1.0, "mm")
    shown = format_si(size, "mm", 1)
    if machine.unit_said != "in" and 0.0 < size < LIKELY[0]:
        other = format_si(size * inch, "mm", 1)
        machine.findings.add(
            "size-doubt", "suspicious", 0, f"the part is {shown} across; if the program means inches, it is {other}"
        )
    elif size > LIKELY[1]:
        other = format_si(size / inch, "mm", 1)
        machine.findings.add(
            "size-doubt", "suspicious", 0, f"the part is {shown} across; a unit taken wrongly would make it {other}"
        )
