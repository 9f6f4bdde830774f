"""Tables as CSV text: columns in display units, of any value that is a table."""

import csv
import io
import math
from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from robomill.arrays import FloatArray
from robomill.progress import slices

RESIDUE = 1.1e-16  # of the largest number beside it: so much double precision rounds that one


def csv_text(columns: Mapping[str, NDArray[Any]], digits: int = 9, unknown: str = "") -> str:
    """Columns as CSV, numbers ``settled`` and of so many ``digits``, NaN as ``unknown``; a flag is 0 or 1."""
    shown = [settled(column) if column.dtype.kind == "f" else column for column in columns.values()]
    out = io.StringIO()
    rows = csv.writer(out, lineterminator="\n")
    rows.writerow(columns)
    for some in slices(min(map(len, shown), default=0), "Rows"):
        rows.writerows(zip(*([_cell(v, digits, unknown) for v in c[some].tolist()] for c in shown), strict=True))
    return out.getvalue()


def settled(values: ArrayLike) -> FloatArray:
    """``values`` (any shape) without what double precision leaves of a difference: one below ``RESIDUE`` of the largest
    is 0."""
    array = np.array(values, dtype=np.float64)
    size = np.abs(array)
    largest = float(size[np.isfinite(size)].max(initial=0.0))
    array[size < RESIDUE * largest] = 0.0
    return array


def _cell(value: float | str | None, digits: int, unknown: str) -> str:
    if isinstance(value, str):
        return value
    if isinstance(value, int):
        return str(int(value))
    return unknown if value is None or math.isnan(value) else f"{value:.{digits}g}"
