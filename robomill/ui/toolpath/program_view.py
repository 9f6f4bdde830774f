"""A program with line numbers and findings in place; the line pointed at is shared by code, list and picture."""

from collections.abc import Sequence
from typing import Any

import streamlit as st

from robomill.arrays import digest
from robomill.provenance import Finding
from robomill.toolpath.text import split_lines
from robomill.ui import session
from robomill.ui.component import component
from robomill.viz.theme import palette

KEY = "toolpath.program"
LINE = "toolpath.line"
WHOLE = 1500
AROUND = 400
LONGEST = 400
LEVELS = {"error": "Error", "warning": "Warning", "suspicious": "Look here", "ignored": "Ignored", "info": "Note"}


_component = component(
    "robomill_program_view",
    __file__,
    html='<div class="code" tabindex="0" role="listbox" aria-label="Program, line by line"></div>',
)


def selected_line() -> int:
    """The source line (row of a table, shape of a sketch) that is pointed at; 0 for none."""
    return int(session.kept(LINE, 0))


def select_line(line: int) -> None:
    """Point at ``line``; 0 points at none."""
    session.keep(LINE, int(line))


def program_view(
    text: str, findings: Sequence[Finding], dark: bool, height: int = 420, *, fixed: int | None = None
) -> None:
    """The program's lines around the selected one; a click selects a line.

    ``fixed`` shows a program that is not in force, around that line; clicks then point at nothing.
    """
    lines = split_lines(text)
    selected = min(selected_line() if fixed is None else fixed, len(lines))
    first, shown = window(lines, selected)
    marks: dict[str, dict[str, str]] = {}
    for f in findings:
        if first <= f.line < first + len(shown) and str(f.line) not in marks:
            marks[str(f.line)] = {"level": f.level, "words": f.message + (f" ({f.count} times)" if f.count > 1 else "")}
    p = palette(dark)
    tones = {"error": p.bad, "warning": p.caution, "suspicious": p.caution, "ignored": p.muted, "info": p.accent}
    data: dict[str, Any] = {
        "lines": shown,
        "first": first,
        "total": len(lines),
        "marks": marks,
        "selected": selected,
        "height": height,
        "tones": tones,
        "rev": digest((shown, first, marks, dark))[:16],
    }
    if fixed is None:
        _component(key=KEY, data=data, on_line_change=_take)
    else:
        _component(key="toolpath.refused-program", data=data, on_line_change=lambda: None)


def window(lines: Sequence[str], selected: int) -> tuple[int, list[str]]:
    """First line number and the lines that are sent: all of a short program, else those around the selected line."""
    if len(lines) <= WHOLE:
        first, last = 1, len(lines)
    else:
        # The window moves in steps, so that pointing at lines near each other does not send it again.
        middle = max(selected, 1) // AROUND * AROUND
        first, last = max(1, middle - AROUND), min(len(lines), middle + 2 * AROUND)
    shown = [line if len(line) <= LONGEST else line[:LONGEST] + " …" for line in lines[first - 1 : last]]
    return first, shown


def _take() -> None:
    # The component's own state: Streamlit puts there what the browser sends.
    sent = st.session_state[KEY].get("line")
    if sent:
        select_line(int(sent["line"]))
