"""Which cutter makes which step of a path."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Self

import numpy as np

from robomill.arrays import IntArray, frozen
from robomill.cutting.tool import Cutter


@dataclass(frozen=True, eq=False)
class Tooling:
    """``cutters`` and which of them (its index, (m,)) makes the move that ends at each point of a path."""

    cutters: tuple[Cutter, ...]
    of_step: IntArray

    def __post_init__(self) -> None:
        object.__setattr__(self, "of_step", frozen(self.of_step, np.int64))

    @classmethod
    def single(cls, cutter: Cutter, m: int) -> Self:
        """One cutter for all m steps."""
        return cls((cutter,), np.zeros(m, dtype=np.int64))
