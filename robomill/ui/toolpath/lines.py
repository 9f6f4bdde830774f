"""The table of straight cuts."""

import numpy as np
import pandas as pd

from robomill.errors import ToolpathError
from robomill.toolpath.source import LinesSource
from robomill.ui import declared, inputs, pieces, session
from robomill.ui.cells import Cells
from robomill.ui.project import View
from robomill.ui.toolpath.sources import put
from robomill.units import unit_label

COLUMNS = ("x₀", "y₀", "z₀", "x₁", "y₁", "z₁", "feed")


def lines_inputs(source: LinesSource, view: View) -> None:
    """Starts, ends and feeds, and the spindle."""
    inputs.table(
        f"toolpath.lines:{view.units}",
        lambda: lines_frame(_source(), view.length, view.feed),
        lambda frame: _take(frame, view),
        inputs.Sheet(
            columns=_cells(view.length, view.feed).columns(50),
            dynamic=True,
            height=pieces.rows_high(len(source.start) + 1, 400),
        ),
    )
    pieces.note(
        f"Start x₀ y₀ z₀ and end x₁ y₁ z₁ of each cut in {{W}} ({unit_label(view.length)}), "
        f"feed ({unit_label(view.feed)}). Lines that do not touch are joined by rapids."
    )
    declared.field("source.n_s")


def _source() -> LinesSource:
    source = session.project().setup.source
    assert source.kind == "lines"
    return source


def _take(frame: pd.DataFrame, view: View) -> None:
    new = lines_from_frame(frame, view.length, view.feed, _source().n_s)
    new.read()
    put(new, "table of lines", from_editor=True)


def lines_frame(source: LinesSource, unit: str, feed_unit: str) -> pd.DataFrame:
    """Straight cuts as a table in display units."""
    return _cells(unit, feed_unit).frame(np.column_stack([source.start, source.end, source.v_f]))


def lines_from_frame(frame: pd.DataFrame, unit: str, feed_unit: str, n_s: float = 0.0) -> LinesSource:
    """The table's straight cuts as a source. Raises ToolpathError naming row and column of an empty cell."""
    kept = frame.dropna(how="all")
    if len(kept) == 0:
        raise ToolpathError("Table of lines: found no rows; add at least one line.")
    values = _cells(unit, feed_unit).read(kept, lambda row: f"Row {row + 1}")
    return LinesSource(values[:, :3], values[:, 3:6], values[:, 6], n_s)


def _cells(unit: str, feed_unit: str) -> Cells:
    return Cells(COLUMNS, [unit] * 6 + [feed_unit], ToolpathError)
