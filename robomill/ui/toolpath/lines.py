"""The table of straight cuts."""

import numpy as np
import pandas as pd

from robomill.errors import ToolpathError
from robomill.toolpath.source import LinesSource
from robomill.ui import pieces, session
from robomill.ui.entry import declared, grid
from robomill.ui.entry.cells import Cells
from robomill.ui.project import View
from robomill.ui.toolpath.sources import put
from robomill.units import unit_label

COLUMNS = ("x₀", "y₀", "z₀", "x₁", "y₁", "z₁", "feed")


def lines_inputs(source: LinesSource, view: View) -> None:
    """Starts, ends and feeds, and the spindle."""
    height = pieces.rows_high(len(source.start) + 1, 400)
    sheet = grid.Sheet(_cells(view.length, view.feed).boxes(), width=50, dynamic=True, height=height)
    grid.table(f"toolpath.lines:{view.units}", lambda: lines_frame(_source()), _take, sheet)
    pieces.note(
        f"Start x₀ y₀ z₀ and end x₁ y₁ z₁ of each cut in {{W}} ({unit_label(view.length)}), "
        f"feed ({unit_label(view.feed)}). Lines that do not touch are joined by rapids."
    )
    declared.field("source.n_s")


def _source() -> LinesSource:
    source = session.project().setup.source
    assert source.kind == "lines"
    return source


def _take(frame: pd.DataFrame) -> None:
    new = lines_from_frame(frame, _source().n_s)
    new.read()
    put(new, "table of lines", from_editor=True)


def lines_frame(source: LinesSource) -> pd.DataFrame:
    """Straight cuts as a table."""
    return _cells().frame(np.column_stack([source.start, source.end, source.v_f]))


def lines_from_frame(frame: pd.DataFrame, n_s: float = 0.0) -> LinesSource:
    """The table's straight cuts as a source. Raises ToolpathError naming row and column of an empty cell."""
    kept = frame.dropna(how="all")
    if len(kept) == 0:
        raise ToolpathError("Table of lines: found no rows; add at least one line.")
    values = _cells().read(kept, lambda row: f"Row {row + 1}")
    return LinesSource(values[:, :3], values[:, 3:6], values[:, 6], n_s)


def _cells(unit: str = "mm", feed_unit: str = "mm/min") -> Cells:
    return Cells(COLUMNS, [unit] * 6 + [feed_unit], ToolpathError)
