"""The program's inputs: a file, its dialect, its text with findings in place, and what was refused."""

import dataclasses
from dataclasses import dataclass
from pathlib import Path

import streamlit as st

from robomill.arrays import digest
from robomill.errors import GCodeError, RobomillError, ToolpathError
from robomill.io.programs import program_from_bytes
from robomill.provenance import Finding
from robomill.toolpath.gcode.dialects import NAMES, choose_dialect
from robomill.toolpath.path import ROTARY_ASKED, TABLES, Toolpath
from robomill.toolpath.source import LEANS, GCodeSource
from robomill.toolpath.text import SUFFIXES
from robomill.ui import pieces, session
from robomill.ui.entry import inputs, typed
from robomill.ui.entry.box import NumberBox
from robomill.ui.toolpath import reading
from robomill.ui.toolpath.details import DIALECTS
from robomill.ui.toolpath.program_view import program_view, select_line, selected_line
from robomill.ui.toolpath.sources import put, put_dropped
from robomill.units import format_count

EDITABLE_CHARACTERS = 200_000
TEXT, MODE, REFUSED, DROPPED = (f"toolpath.{name}" for name in ("text", "mode", "refused", "dropped"))
MODES = {"code": "Code", "edit": "Edit"}
ROTARY = {"": "Not said", LEANS: "Leans the tool"} | {
    each: f"{each[-1]} turns the part{', the other way round' * (each[0] == '-')}" for each in TABLES if each
}
"""What is said of rotary axes that turn far."""


@dataclass(frozen=True)
class Refused:
    """A program that was not taken, and why; ``tools`` is the digest of the table that it was read with."""

    source: GCodeSource
    reason: str
    line: int
    tools: str


def program_inputs(source: GCodeSource, path: Toolpath | None, dark: bool) -> None:
    """Dialect and text."""
    if session.kept(REFUSED) is not None:
        return
    _dialect(source)
    if source.table or (path is not None and any(each.code == ROTARY_ASKED for each in path.findings)):
        inputs.choice("Rotary axis", "toolpath.rotary", ROTARY, source.table, _take_rotary, inputs.LISTED)
    _text(source, path, dark)


def brought(dark: bool) -> None:
    """A program that is being read, and one that was not taken: it is read again when the tool table is another."""
    reading.reading_inputs(_accept, _refuse)
    refused: Refused | None = session.kept(REFUSED)
    if refused is None:
        return
    if refused.tools != _tools():
        _try(refused.source)
        st.rerun()
    _show_refused(refused, dark)


def _tools() -> str:
    return digest(session.project().setup.tools)


def _dialect(source: GCodeSource) -> None:
    inputs.choice("Dialect", "toolpath.dialect", DIALECTS, source.dialect, _take_dialect, inputs.LISTED)
    pieces.note(dialect_words(source))


def dialect_words(source: GCodeSource) -> str:
    """As what the program is read, and who said so."""
    chosen = choose_dialect(source.text, source.dialect)
    said = "guessed from how it looks" if chosen.guessed else "as you chose"
    return f"Read as {DIALECTS[chosen.name]} code, {said}."


def _take_rotary(table: str) -> None:
    source = session.project().setup.source
    assert source.kind == "program"
    changed = dataclasses.replace(source, table=table)
    if reading.read(changed):
        put(changed, f"program {source.name}")


def _take_dialect(name: str) -> None:
    assert name == "auto" or name in NAMES
    source = session.project().setup.source
    assert source.kind == "program"
    changed = dataclasses.replace(source, dialect=name)
    if reading.read(changed):
        put(changed, f"program {source.name}")


def _text(source: GCodeSource, path: Toolpath | None, dark: bool) -> None:
    count = len(source.block_texts())
    with typed.said_below(), st.container(horizontal=True, vertical_alignment="bottom", gap="small"):
        with st.container(width=114):
            mode = inputs.pick("Program", MODE, MODES, look=inputs.HIDDEN)
        if mode == "code":
            box = NumberBox("Go to line", low=1, high=count, whole=True, optional=True, placeholder="none")
            with st.container(width=130):
                line = min(selected_line(), count) or None
                inputs.value("toolpath.go-to", box, line, lambda new: select_line(new or 0))
            st.caption(f"of {format_count(count)} lines")
    if mode == "code":
        height = min(max(22 * count + 24, 130), 420)
        program_view(source.text, path.findings if path is not None else (), dark, height)
    elif len(source.text) > EDITABLE_CHARACTERS:
        pieces.note(
            f"{format_count(count)} lines are too many for this box: change them in their own file and drop it here."
        )
    else:
        inputs.text("Program text", TEXT, source.text, _take_text, lines=2, height=420, label_visibility="collapsed")


def take_program(data: bytes, name: str) -> None:
    """A dropped file: read at once, or beside the page where it is big. Raises the refusal of what is no program."""
    _leave()
    suffix = Path(name).suffix.lower()
    if suffix and suffix not in SUFFIXES and not suffix[1:].isdigit():
        raise ToolpathError(
            f"{name}: expected a program ({', '.join(SUFFIXES)}, a number or no ending), points (.csv, .parquet) or a "
            "drawing (.dxf, .svg)."
        )
    source = program_from_bytes(data, name)
    _try(source)


def _try(source: GCodeSource) -> None:
    _leave()
    session.keep(DROPPED, source)
    try:
        if reading.read(source):
            _accept(source)
    except GCodeError as exc:
        _refuse(source, exc)


def _accept(source: GCodeSource) -> None:
    if session.drop(DROPPED) is source:
        put_dropped(source)
    else:
        put(source, f"program {source.name}")
    inputs.accept(TEXT)
    session.keep(MODE, "code")


def _refuse(source: GCodeSource, exc: RobomillError) -> None:
    session.keep(REFUSED, Refused(source, str(exc), int(getattr(exc, "line", 0)), _tools()))


def _show_refused(refused: Refused, dark: bool) -> None:
    """A program that cannot be read is shown at the line that is at fault; the one before it stays in force."""
    pieces.error(f"{refused.source.name} was not taken. {refused.reason}")
    with st.container(horizontal=True, gap="small"):
        long = len(refused.source.text) > EDITABLE_CHARACTERS or session.project().setup.source.kind != "program"
        inputs.button("Mend it here", "toolpath.mend", "edit", _mend, refused, disabled=long)
        inputs.button("Leave it", "toolpath.leave", "close", _leave, type="tertiary")
    level = (Finding("error", refused.reason, refused.line),) if refused.line else ()
    program_view(refused.source.text, level, dark, fixed=refused.line)


def _mend(refused: Refused) -> None:
    _leave()
    session.keep(MODE, "edit")
    typed.refuse(TEXT, refused.source.text, refused.reason)


def _leave() -> None:
    session.drop(REFUSED)


def _take_text(text: str) -> None:
    old = session.project().setup.source
    if not text.strip():
        raise ToolpathError("The program is empty; type at least one G1 move.")
    source = dataclasses.replace(old, text=text) if old.kind == "program" else GCodeSource(text)
    if reading.read(source):
        put(source, f"program {source.name}, edited")
