"""A table of nothing but numbers: the cells of an array, and the array of its cells."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import pandas as pd

from robomill.arrays import FloatArray
from robomill.errors import RobomillError
from robomill.ui.entry.box import NumberBox
from robomill.ui.entry.grid import empty


@dataclass(frozen=True)
class Cells:
    """Numbers under ``heads``; ``units`` are one for all, one a column, or (rows, columns) of them."""

    heads: Sequence[str]
    units: Any
    error: type[RobomillError]

    def frame(self, values: FloatArray, **names: Sequence[str]) -> pd.DataFrame:
        """Numbers (r, c) in SI as a table behind columns of ``names``."""
        return pd.DataFrame({**names, **dict(zip(self.heads, np.asarray(values).T, strict=True))})

    def read(self, frame: pd.DataFrame, where: Callable[[int], str]) -> FloatArray:
        """The numbers (r, c) in SI. Raises ``error`` naming row (as ``where`` does) and column of an empty cell."""
        for row in range(len(frame)):
            for head in self.heads:
                if empty(frame[head].iloc[row]):
                    raise self.error(f"{where(row)}: {_label(head)} is missing; type a number.")
        return frame[list(self.heads)].to_numpy(dtype=float)

    def boxes(self) -> Mapping[str, NumberBox | list[NumberBox]]:
        """How each column is typed, or each of its cells where they differ."""
        if np.ndim(self.units) == 2:
            rows = [np.broadcast_to(np.asarray(row, dtype=object), len(self.heads)) for row in self.units]
            return {head: [NumberBox(_label(head), row[j]) for row in rows] for j, head in enumerate(self.heads)}
        units = np.broadcast_to(np.asarray(self.units, dtype=object), len(self.heads))
        return {head: NumberBox(_label(head), unit) for head, unit in zip(self.heads, units, strict=True)}


def _label(head: str) -> str:
    return head.partition(",")[0]
