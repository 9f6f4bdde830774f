"""Results as CSV text: columns in display units, of any value that is a table."""

import math
from collections.abc import Mapping
from typing import Any

from numpy.typing import NDArray

from robomill.progress import slices
from robomill.report.settled import settled


def csv_text(columns: Mapping[str, NDArray[Any]]) -> str:
    """Columns as CSV, those of numbers ``settled``; NaN is an empty cell, a flag 0 or 1."""
    shown = [settled(column) if column.dtype.kind == "f" else column for column in columns.values()]
    lines = [",".join(columns)]
    for some in slices(min(map(len, shown), default=0), "Rows"):
        cells = [[_cell(v) for v in column[some].tolist()] for column in shown]
        lines += [",".join(row) for row in zip(*cells, strict=True)]
    return "\n".join(lines) + "\n"


def _cell(value: float | str) -> str:
    if isinstance(value, str):
        return value
    if isinstance(value, int):
        return str(int(value))
    return "" if math.isnan(value) else f"{value:.9g}"
