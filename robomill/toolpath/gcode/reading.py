"""The two ways in: ``interpret`` for canonical moves, ``read_gcode`` for a toolpath."""

import math
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from robomill.arguments import asked
from robomill.arrays import frozen
from robomill.errors import GCodeError
from robomill.toolpath.arcs import CHORD_ERROR
from robomill.toolpath.findings import NO_UNITS
from robomill.toolpath.gcode.chords import to_toolpath
from robomill.toolpath.gcode.cutters import never_changes
from robomill.toolpath.gcode.dialects import SAMPLE, Dialect, choose_dialect
from robomill.toolpath.gcode.doubts import (
    doubt,
    doubt_all_points,
    doubt_fanuc,
    doubt_lathe,
    doubt_points,
    doubt_second_table,
)
from robomill.toolpath.gcode.fanuc.macro_calls import begin_empty
from robomill.toolpath.gcode.foreign import language_of
from robomill.toolpath.gcode.grbl import check_grbl
from robomill.toolpath.gcode.interpreter import Interpreter
from robomill.toolpath.gcode.lines import Lines
from robomill.toolpath.gcode.machine import Machine
from robomill.toolpath.gcode.owords import File
from robomill.toolpath.gcode.program import Program, most_moves
from robomill.toolpath.gcode.sinumerik.lines import chooses_zeros
from robomill.toolpath.gcode.tilted import check_rotary, drop_positioning
from robomill.toolpath.path import TABLES, Toolpath, far_off
from robomill.toolpath.text import Source, is_apt, named_as_file, read_source
from robomill.toolpath.tools import Tools


@asked
def read_gcode(
    path_or_text: Source,
    *,
    chord_error: float = CHORD_ERROR,
    dialect: str = "auto",
    tools: Tools | None = None,
    table: str = "",
) -> Toolpath:
    r"""The toolpath of a G-code program.

    Parameters
    ----------
    path_or_text : str, Path or bytes
        A file, or the program itself (a text with a line break).
    chord_error : float
        m: arcs become chords no farther than this from them.
    dialect : str
        "auto" guesses and says so; "linuxcnc", "fanuc", "grbl", "sinumerik" or "heidenhain".
    tools : mapping, optional
        The table that T, H and D words mean, by tool number.
    table : str
        The rotary axis that turns the part: "A", "-A", "B", ... ; "" where the tool leans.

    Returns
    -------
    Toolpath
        In {W}, m and m/s; what was noticed is in ``findings``.

    Raises
    ------
    GCodeError
        Naming the line that is refused, or where nothing moves.

    Examples
    --------
    >>> import robomill as rm
    >>> path = rm.read_gcode("G21 G90 G1 X0 Y0 Z-2 F600\nG1 X50\n")
    >>> float(path.s[-1]), float(path.v_f[-1])
    (0.052000000000000005, 0.01)
    """
    try:
        program = interpret(path_or_text, dialect=dialect, tools=tools)
    except GCodeError as refused:
        raise named_as_file(refused, path_or_text) from None
    if table and table in TABLES:
        program = replace(program, findings=doubt_second_table(program, table))
    elif table:
        raise GCodeError(f"Rotary table: found {table!r}; expected one of {', '.join(TABLES[1:])}.")
    return to_toolpath(program, chord_error, table)


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
    if is_apt(data):
        shown = "part.apt" if name == "program" else name
        raise GCodeError(
            f'this is APT (cutter locations), no G-code; rm.read_program("{shown}").read() gives its path.'
        )
    lines = Lines(data)
    sample = data[:SAMPLE].decode("utf-8", "replace")
    chosen = choose_dialect(sample, dialect)
    if chosen.guessed and (foreign := language_of(sample)):
        raise GCodeError.at(*foreign)
    machine = _machine(tools, chosen, lines)
    is_file = isinstance(source, Path) or (isinstance(source, str) and name != "program")
    folder = Path(source).parent if isinstance(source, str | Path) and is_file else None
    file = File(name, lines, folder)
    try:
        if chosen.name == "grbl":
            check_grbl(data, not chosen.guessed, machine.findings)
        Interpreter(machine, file, chosen).run()
    except GCodeError as refused:
        if not partial:  # held by no name: what was read would live until the garbage collector runs
            raise _offered(refused, machine, tools, file, chosen) from None
        said = _offered(refused, machine, tools, file, chosen)
        machine.findings.add("refused", "error", said.line, str(said))
        del said
    if chosen.guessed and chosen.name != "linuxcnc":
        machine.findings.add(
            "dialect-guessed", "info", 0, f"read as {chosen.name} code; this is a guess from how it looks"
        )
    if chosen.has_macros:
        doubt_points(machine.findings, data, chosen.name == "fanuc")
    program = _program(machine, chosen.name, len(lines) - (lines[-1] == ""))
    if chosen.name == "fanuc":
        doubt_all_points(machine.findings, data, program)
        doubt_lathe(machine.findings, data, program)
        doubt_fanuc(machine.findings, data, program)
        return replace(program, findings=machine.findings.freeze())
    return program


def _machine(tools: Tools | None, dialect: Dialect, lines: Lines) -> Machine:
    machine = Machine(tools)
    machine.recorder.most = most_moves(len(lines))
    machine.strict = dialect.strict
    machine.keeps_heights = dialect.keeps_heights
    machine.feed_in_block = dialect.name in ("grbl", "sinumerik", "fanuc")
    machine.other_control = dialect.name in ("fanuc", "sinumerik", "heidenhain")
    if machine.other_control:
        machine.store.cut_towards_zero()
    if dialect.name == "sinumerik":
        machine.further, machine.feeds_unsure, machine.keeps_frame = "G5{:02}", not dialect.marked, True
        machine.zero_ended = False if chooses_zeros(lines.data) else None
        machine.t_changes = never_changes(lines.data)
    if dialect.name == "fanuc":
        begin_empty(machine)
        machine.retract_r = False  # these controls begin in G98
    return machine


def _offered(refused: GCodeError, machine: Machine, tools: Tools | None, file: File, dialect: Dialect) -> GCodeError:
    """What a program is refused with; of an arc off its circle also whether all arcs fit with absolute centres."""
    if not machine.arc_refused:
        return refused
    again = _machine(tools, dialect, file.lines)
    again.arc_absolute = True
    try:
        Interpreter(again, File(file.name, file.lines, file.folder), dialect).run()
    except GCodeError:
        return refused
    said = f"{str(refused).rstrip('.')}. As absolute centres all arcs fit: write G90.1 on the first line."
    return GCodeError.at(refused.line, said.removeprefix(f"Line {refused.line}: "))


def _program(machine: Machine, dialect: str, lines: int) -> Program:
    columns: dict[str, Any] = machine.recorder.columns()
    _check_sizes(columns)
    if any(plane is not None for _, plane in machine.planes):
        drop_positioning(machine.planes, columns)
    if not machine.unit_said and len(columns["line"]):
        words = "G70 or G71" if dialect == "sinumerik" else "G20 or G21"
        machine.findings.add(NO_UNITS, "suspicious", 0, f"no {words}: lengths are taken as mm")
    program = Program(
        **columns,
        lift=_since(machine.lifts, len(columns["line"]), np.zeros(3)),
        away=_since(machine.aways, len(columns["line"]), np.zeros(3, dtype=bool)),
        units=machine.unit_said,
        dialect=dialect,
        lines=lines,
        dwells=machine.dwells,
        dwell_time=machine.dwell_time,
        messages=tuple(machine.messages),
        planes=tuple(machine.planes) if any(plane is not None for _, plane in machine.planes) else (),
    )
    check_rotary(program.planes, columns)
    doubt(machine, program)
    return replace(program, findings=machine.findings.freeze())


_MOST = {
    "rotary": (2e5 * math.pi, "an axis turns more than 100 000 times"),
    "centre": (1e9, "the centre of an arc lies more than 1 000 000 km from part zero"),
    "v_f": (1e3, "a feed is above 60 000 000 mm/min"),
    "n_s": (1e5, "a spindle turns faster than 6 000 000 1/min"),
    "dwell": (1e8, "a dwell takes more than three years"),
}
"""What no machine does, by column of moves (SI), and what is said of it."""


def _check_sizes(columns: dict[str, Any]) -> None:
    """Raise GCodeError at the first move that leads beyond any machine, or that has a number no machine has."""
    if far := far_off(columns["end"], columns["line"]):
        raise GCodeError.at(*far)
    for name, (most, what) in _MOST.items():
        above = np.abs(columns[name]) > most  # False for NaN, a speed that is not known (G96)
        beyond = np.flatnonzero(above.any(axis=1) if above.ndim == 2 else above)
        if len(beyond):
            raise GCodeError.at(int(columns["line"][beyond[0]]), f"{what}; mend the number, or the unit it is in.")


def _since(changes: list[tuple[int, Any]], count: int, first: Any) -> Any:
    """(m, 3): for each move what holds since the last change at or before it; ``first`` before all."""
    if not changes:
        return np.broadcast_to(first, (count, 3))
    out = np.zeros((count, 3), first.dtype)
    for row, value in changes:
        out[row:] = value
    return frozen(out, out.dtype)
