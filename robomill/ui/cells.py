"""A table of numbers that is edited: from SI to its cells and back, the one way of every such table."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import pandas as pd
import streamlit as st

from robomill.arrays import FloatArray
from robomill.errors import RobomillError
from robomill.ui.inputs import empty
from robomill.units import from_si, to_si


@dataclass(frozen=True)
class Cells:
    """Numbers under ``heads``; ``units`` are one for all, one a column, or (rows, columns) of them."""

    heads: Sequence[str]
    units: Any
    error: type[RobomillError]

    def frame(self, values: FloatArray, **names: Sequence[str]) -> pd.DataFrame:
        """Numbers (r, c) in SI as cells, without the last bits of the conversion, behind columns of ``names``."""
        shown = np.round(self._each(from_si, values), 9) + 0.0  # no minus before a zero
        return pd.DataFrame({**names, **dict(zip(self.heads, shown.T, strict=True))})

    def read(self, frame: pd.DataFrame, where: Callable[[int], str]) -> FloatArray:
        """The numbers (r, c) in SI. Raises ``error`` naming row (as ``where`` does) and column of an empty cell."""
        for row in range(len(frame)):
            for head in self.heads:
                if empty(frame[head].iloc[row]):
                    raise self.error(f"{where(row)}: {head.partition(',')[0]} is missing; type a number.")
        return self._each(to_si, frame[list(self.heads)].to_numpy(dtype=float))

    def columns(self, width: int | None = None) -> dict[str, Any]:
        """How the columns are shown."""
        return {head: st.column_config.NumberColumn(head, format="%.6g", width=width) for head in self.heads}

    def _each(self, convert: Callable[[float, str], float], values: FloatArray) -> FloatArray:
        units = np.broadcast_to(np.asarray(self.units, dtype=object), values.shape)
        cells = [convert(float(v), unit) for v, unit in zip(values.flat, units.flat, strict=True)]
        return np.array(cells).reshape(values.shape)
