"""The path in detail: what was found while it was read, its extents, lengths and feeds, and one line of it in words."""

from collections.abc import Sequence

import numpy as np
import pandas as pd
import streamlit as st

from robomill.provenance import Finding
from robomill.simulation.reach import PathReach
from robomill.simulation.result import SimulationResult
from robomill.simulation.setup import SimulationSetup
from robomill.ui import pieces
from robomill.ui.toolpath.program_view import LEVELS, select_line, selected_line
from robomill.ui.toolpath.summary import move_words, path_summary, worst_first, written_in
from robomill.units import format_count, format_duration, format_many, format_si, in_lengths

DIALECTS = {
    "auto": "Guess",
    "linuxcnc": "LinuxCNC",
    "fanuc": "Fanuc-like",
    "grbl": "grbl",
    "sinumerik": "Sinumerik",
    "heidenhain": "Heidenhain",
}


def findings_list(findings: Sequence[Finding]) -> None:
    """What the reader noticed, worst first; a click on a row points at its line."""
    st.markdown("**What was read**")
    if not findings:
        pieces.note("Every word was understood, and none was left out.")
        return
    found = worst_first(findings)
    shown = found[:500]
    frame = pd.DataFrame(
        {
            "level": [LEVELS[f.level] for f in shown],
            "line": [str(f.line) if f.line else "all" for f in shown],
            "what": [f.message + (f" ({format_count(f.count)} times)" if f.count > 1 else "") for f in shown],
        }
    )

    def take() -> None:
        # The table's own state: Streamlit says there which row was clicked.
        rows = st.session_state["toolpath.findings"]["selection"]["rows"]
        if rows:
            select_line(shown[rows[0]].line)

    st.dataframe(
        frame,
        hide_index=True,
        height=pieces.rows_high(len(frame), 290),
        key="toolpath.findings",
        on_select=take,
        selection_mode="single-row",
        row_height=pieces.ROW,
        column_config={
            "level": st.column_config.TextColumn("level", width=86),
            "line": st.column_config.TextColumn("line", width=60),
            "what": st.column_config.TextColumn("what", width="large"),
        },
    )
    hidden = len(found) - len(shown)
    pieces.note(
        "Click a row to see its line and its place."
        + (f" {format_count(hidden)} more are not listed." if hidden else "")
    )


def path_facts(setup: SimulationSetup, unit: str) -> None:
    """Extents, lengths, time and feeds in the units of the shop floor."""
    path = setup.toolpath
    summary = path_summary(path)
    low, high = summary.low, summary.high
    rows: list[tuple[str, str, str]] = [
        (
            pieces.subscripts(f"{axis}_W"),
            *_extent(float(low[i]), float(high[i]), unit),
        )
        for i, axis in enumerate("xyz")
    ]
    rows.append(
        ("Length", f"{format_si(float(path.s[-1]), unit, 1)} at feed", f"{format_si(summary.rapids, unit, 1)} rapid")
    )
    rows.append(("Time at feed", format_duration(float(path.t[-1])), "without rapids, pauses and tool changes"))
    if summary.feeds:
        minute, second = (_range(summary.feeds, in_lengths(each, unit)) for each in ("mm/min", "mm/s"))
        rows.append(("Feed", minute, second))
    if summary.spindles:
        rows.append(("Spindle", _range(summary.spindles, "1/min"), ""))
    if setup.source.kind == "program":
        tools = summary.tools
        words = "tool " + ", ".join(map(str, tools)) if tools else "no tool named"
        rows.append(("Written in", written_in(setup.source, path, long=True), words))
        rows.append(("Moves", move_words(path), ""))
    pieces.table(rows, "qv ")


def _extent(low: float, high: float, unit: str) -> tuple[str, str]:
    """From where to where the path goes along an axis, and how long that is."""
    if format_si(low, unit, 2) == format_si(high, unit, 2):
        return format_si(low, unit, 2), "all along"
    return format_many((low, high), unit, 2, between=" … "), f"{format_si(high - low, unit, 2)} from end to end"


def _range(values: tuple[float, float], unit: str) -> str:
    low, high = values
    return format_si(high, unit) if np.isclose(low, high) else format_many(values, unit, between=" … ")


def line_words(setup: SimulationSetup, reach: PathReach | None, result: SimulationResult | None, unit: str) -> str:
    """The selected line in words: its text, its move, its reach and deviation; "" where none is selected."""
    line = selected_line()
    if not line:
        return ""
    path = setup.toolpath
    text = ""
    if setup.source.kind == "program":
        lines = setup.source.block_texts()
        text = lines[line - 1].strip()[:80] if line <= len(lines) else ""
    words = [f"{setup.source.block_name.capitalize()} {line}" + (f": {text}" if text else "")]
    i = np.flatnonzero(path.block == line)
    i = i[path.step_length[i] > 0]
    if len(i) == 0:
        return words[0] + ". It moves nothing."
    at_feed = i[path.cutting[i]]
    moves = f"{format_count(len(i), 'move')}, {format_si(float(path.step_length[i].sum()), unit, 2)}"
    if len(at_feed):
        feeds = (float(path.v_f[at_feed].min()), float(path.v_f[at_feed].max()))
        moves += f" at {_range(feeds, 'mm/min')} ({_range(feeds, 'mm/s')})"
    else:
        moves += " as a rapid"
    words.append(moves)
    if reach is not None and (reach.missed & (reach.path.block == line)).any():
        words.append(f"out of reach: {reach.reason}")
    elif result is not None:
        of_line = result.judged & (result.path.block == line)
        if of_line.any():
            largest = float(result.deviation[of_line].max())
            words.append(f"deviation up to {format_si(largest, unit)}")
    return f"{words[0]} — {'; '.join(words[1:])}."


def support_table() -> None:
    """Which words are read, left out or refused; every row has its test."""
    from robomill.toolpath.gcode.support import DIFFERENCES, SUPPORT

    statuses = {"read": "read", "ignored": "left out, counted", "refused": "refused"}
    with st.expander("What is supported", icon=":material/fact_check:"):
        frame = pd.DataFrame(
            {
                "words": [row.words for row in SUPPORT],
                "meaning": [row.meaning for row in SUPPORT],
                "": [statuses[row.status] for row in SUPPORT],
                "dialect": ["all" if row.dialect == "linuxcnc" else DIALECTS[row.dialect] for row in SUPPORT],
            }
        )
        st.dataframe(
            frame,
            hide_index=True,
            height=330,
            column_config={
                "words": st.column_config.TextColumn(width=150),
                "meaning": st.column_config.TextColumn(width="medium"),
                "": st.column_config.TextColumn(width=110),
                "dialect": st.column_config.TextColumn(width=80),
            },
        )
        st.caption("Where reading differs from LinuxCNC:\n" + "".join(f"\n- {said}" for said in DIFFERENCES))
        pieces.note("Unknown motion is refused at its line, unknown words that move nothing are counted as ignored.")
