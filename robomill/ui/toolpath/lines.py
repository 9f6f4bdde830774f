"""The table of straight cuts."""

from __future__ import annotations

import pandas as pd
import streamlit as st

from robomill.toolpath.source import LinesSource
from robomill.ui import inputs, parts, state, tables
from robomill.ui.editors import table_editor
from robomill.ui.toolpath.sources import put
from robomill.units import unit_label


def lines_inputs(source: LinesSource, view: state.View) -> None:
    """Starts, ends and feeds, and the spindle."""
    table_editor(
        f"lines:{view.units}",
        lambda: tables.lines_frame(_source(), view.length, view.feed),
        lambda frame: _take(frame, view),
        dynamic=True,
        height=min(36 * (len(source.start) + 2) + 2, 400),
        columns={c: st.column_config.NumberColumn(c, format="%.6g", width=50) for c in tables.LINE_COLUMNS},
    )
    parts.note(
        f"Start x₀ y₀ z₀ and end x₁ y₁ z₁ of each cut in {{W}} ({unit_label(view.length)}), "
        f"feed ({unit_label(view.feed)}). Lines that do not touch are joined by rapids."
    )
    inputs.number("Spindle speed", "source.n_s", "1/min", step=500.0)


def _source() -> LinesSource:
    source = state.project().setup.source
    assert source.kind == "lines"
    return source


def _take(frame: pd.DataFrame, view: state.View) -> None:
    new = tables.lines_from_frame(frame, view.length, view.feed, _source().n_s)
    new.read()
    put(new, "table of lines", from_editor=True)
