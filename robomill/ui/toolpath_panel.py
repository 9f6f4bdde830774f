"""The toolpath page's inputs, tiles and findings."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pandas as pd
import streamlit as st

from robomill.errors import ToolpathError
from robomill.io.programs import program_from_bytes
from robomill.io.workpiece import part_frame
from robomill.simulation.result import SimulationResult
from robomill.toolpath.path import Toolpath
from robomill.toolpath.source import GCodeSource, LinesSource
from robomill.ui import inputs, parts, state, tables
from robomill.ui.editors import table_editor
from robomill.units import format_si, from_si, to_si, unit_label

SUFFIXES = ("nc", "ngc", "tap", "gcode", "cnc", "txt")
MAX_PROGRAM_MB = 100
EDITABLE_CHARACTERS = 60_000
QUANTITIES = {"deviation": "Deviation", "limits": "Distance to the joint limits"}
LEVELS = {"error": "Error", "warning": "Warning", "suspicious": "Look here", "ignored": "Ignored", "info": "Note"}


def source_inputs(project: state.Project) -> None:
    """A program by file or paste, or a table of lines."""
    source = project.setup.source
    kind = "program" if isinstance(source, GCodeSource) else "lines"
    inputs.choice("Path from", "source.kind", {"program": "Program", "lines": "Table of lines"}, kind, _switch)
    if isinstance(source, GCodeSource):
        _program(source)
    else:
        _lines(source, project.view)


def _program(source: GCodeSource) -> None:
    revision = state.store().revision
    key = f"program:file:{revision}"
    # Any name is let in and judged here, so that upper case and odd endings get a sentence and not a grey refusal.
    st.file_uploader(
        f"Program ({', '.join(SUFFIXES)}; upper or lower case)", key=key, max_upload_size=MAX_PROGRAM_MB,
        on_change=lambda: _take_file(st.session_state.get(key)),
    )  # fmt: skip
    inputs.sentence("program:file")
    if len(source.text) > EDITABLE_CHARACTERS:
        lines = source.text.splitlines()
        st.code("\n".join(lines[:200]), language=None, height=320, line_numbers=True)
        parts.note(f"Showing 200 of {len(lines):,} lines. Programs of this size are changed in their own file.")
        return
    box = "program:text"
    inputs.seed(box, source.text)
    st.text_area(
        "Program text", key=box, height=320, on_change=lambda: inputs.attempt(
            box, st.session_state[box], lambda: _take_text(st.session_state[box])),
    )  # fmt: skip
    inputs.sentence(box)


def _take_file(file: object) -> None:
    if file is None:
        inputs.accept("program:file")
        return
    name = str(getattr(file, "name", "program"))

    def take() -> None:
        if Path(name).suffix.lower().lstrip(".") not in SUFFIXES:
            raise ToolpathError(f"{name}: expected a program ending in {', '.join(SUFFIXES)} (any case).")
        source = program_from_bytes(file.getvalue(), name)  # type: ignore[attr-defined]
        source.read()
        state.change(source=source)
        inputs.accept("program:text")

    inputs.attempt("program:file", None, take)


def _take_text(text: str) -> None:
    old = state.project().setup.source
    name = old.name if isinstance(old, GCodeSource) else "program.nc"
    if not text.strip():
        raise ToolpathError("The program is empty; type at least one G1 move.")
    source = GCodeSource(text, name)
    source.read()
    state.change(source=source)


def _lines(source: LinesSource, view: state.View) -> None:
    table_editor(
        f"lines:{view.units}",
        lambda: tables.lines_frame(_line_source(), view.length, view.feed),
        lambda frame: _take_lines(frame, view),
        columns={
            **{c: st.column_config.NumberColumn(f"{c}", format="%.6g", width="small")
               for c in tables.LINE_COLUMNS[:6]},
            "feed": st.column_config.NumberColumn("feed", format="%.6g", width="small"),
        },
        dynamic=True,
    )  # fmt: skip
    parts.note(
        f"Start x₀ y₀ z₀ and end x₁ y₁ z₁ in {unit_label(view.length)} in {{W}}, feed in {unit_label(view.feed)}. "
        "Lines that do not touch are joined by rapids."
    )
    inputs.number("Spindle speed", "source.n_s", "1/min", step=500.0)


def _line_source() -> LinesSource:
    source = state.project().setup.source
    assert isinstance(source, LinesSource)
    return source


def _take_lines(frame: pd.DataFrame, view: state.View) -> None:
    new = tables.lines_from_frame(frame, view.length, view.feed, _line_source().n_s)
    new.read()
    state.change(source=new, from_editor=True)


def _switch(kind: str) -> None:
    setup = state.project().setup
    if kind == "lines" and isinstance(setup.source, GCodeSource):
        path = setup.source.read()
        i = np.flatnonzero(path.cutting & (path.step_length > 0))
        if len(i) > 200:
            raise ToolpathError(f"The program has {len(i)} cuts; a table holds at most 200. It stays a program.")
        n_s = float(path.n_s[i].max()) if len(i) else 0.0
        state.change(source=LinesSource(path.p[i - 1], path.p[i], path.v_f[i], n_s))
    elif kind == "program" and isinstance(setup.source, LinesSource):
        from robomill.io.gcode_out import write_gcode

        state.change(source=GCodeSource(write_gcode(setup.toolpath), "from-table.nc"))


def part_zero(unit: str) -> None:
    """Where the part zero {W} lies in {M}."""
    st.markdown("**Part zero {W} in {M}**")
    for i, (column, axis) in enumerate(zip(st.columns(3), "XYZ", strict=True)):
        with column:
            inputs.number(axis, f"T_MW[{i},3]", unit, step=10.0 if unit == "mm" else 1.0, digits=2)
    T_MW = state.project().setup.T_MW
    turn = float(np.round(from_si(np.arctan2(T_MW[1, 0], T_MW[0, 0]), "deg"), 9))
    key = "part.rotation"
    inputs.seed(key, turn)
    st.number_input(
        "Turn about Z, °", key=key, step=5.0, format="%.2f",
        on_change=lambda: state.change(
            T_MW=part_frame(state.project().setup.T_MW[:3, 3], to_si(float(st.session_state[key] or 0.0), "deg"))
        ),
    )  # fmt: skip


def quantity() -> str:
    """What the path is coloured by."""
    key = "plan:quantity"
    if key not in st.session_state:
        st.session_state[key] = "deviation"
    picked = st.segmented_control(
        "Colour", list(QUANTITIES), key=key, format_func=lambda k: QUANTITIES[k], required=True,
        label_visibility="collapsed",
    )  # fmt: skip
    return str(picked or "deviation")


def sentence(path: Toolpath | None, result: SimulationResult | None, unit: str) -> str:
    """What was read and whether it can be reached."""
    if path is None:
        return "This path cannot be read."
    low, high = path.extents
    size = " × ".join(format_si(float(v), unit, 1).partition(" ")[0] for v in high - low)
    cuts = int(path.cutting.sum())
    text = f"{cuts} cut{'s' if cuts != 1 else ''} within {size} {unit_label(unit)}"
    if result is None:
        return text + "."
    missed = int((result.path.cutting & ~result.reached).sum())
    return f"{text}, {'all of it in reach' if not missed else f'{missed} points out of reach'}."


def tiles(path: Toolpath | None, result: SimulationResult | None, unit: str) -> list[parts.Tile]:
    """Moves, length and time, reach, findings."""
    if path is None:
        return [parts.Tile(label, "none") for label in ("Moves", "Length at feed", "Reach", "Findings")]
    moves, cuts = len(path) - 1, int(path.cutting.sum())
    levels = [f.level for f in path.findings]
    count = sum(f.count for f in path.findings)
    alarming = sum(level in ("error", "warning", "suspicious") for level in levels)
    if result is not None:
        lost = result.path.cutting & ~result.reached
        share = 1.0 - lost.sum() / max(int(result.path.cutting.sum()), 1)
        lines = sorted(set(result.path.block[lost].tolist()))
        reach = parts.Tile(
            "Reach", f"{share:.0%}", "of the cut within the joint limits" if not lines else
            "lines " + ", ".join(map(str, lines[:4])) + (" …" if len(lines) > 4 else ""),
            tone="ok" if not lines else "out",
        )  # fmt: skip
    else:
        reach = parts.Tile("Reach", "not computed")
    return [
        parts.Tile("Moves", f"{moves}", f"{cuts} at feed, {moves - cuts} rapid · written in {path.units or 'mm'}"),
        parts.Tile("Length at feed", format_si(float(path.s[-1]), unit, 1), format_si(float(path.t[-1]), "s", 1)),
        reach,
        parts.Tile("Findings", f"{count}", f"{alarming} to look at" if alarming else "nothing to worry about",
                   tone="tight" if alarming else ""),
    ]  # fmt: skip


def findings(path: Toolpath | None) -> None:
    """What the reader noticed, worst first."""
    st.markdown("**What was read**")
    if path is None or not path.findings:
        parts.note("Every word of the program was understood; nothing was skipped or guessed.")
        return
    order = list(LEVELS)
    found = sorted(path.findings, key=lambda f: (order.index(f.level), f.line))
    frame = pd.DataFrame({
        "": [LEVELS[f.level] for f in found], "line": [str(f.line) if f.line else "all" for f in found],
        "what": [f.message for f in found], "times": [f.count for f in found],
    })  # fmt: skip
    st.dataframe(frame, hide_index=True, height=min(38 * (len(frame) + 1), 320))
