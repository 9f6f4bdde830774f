"""Which cutter makes which step of a path."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Self

import numpy as np

from robomill.arrays import BoolArray, FloatArray, IntArray, frozen, sealed
from robomill.cutting.tool import Cutter
from robomill.errors import CuttingError


@dataclass(frozen=True, eq=False)
class Tooling:
    """``cutters`` and which of them (its index, (m,)) makes the move that ends at each point of a path.

    Raises CuttingError for an index without a cutter.
    """

    cutters: tuple[Cutter, ...]
    of_step: IntArray

    def __post_init__(self) -> None:
        object.__setattr__(self, "of_step", frozen(self.of_step, np.int64))
        wrong = (self.of_step < 0) | (self.of_step >= len(self.cutters))
        if wrong.any():
            raise CuttingError(
                f"Tooling: a move asks for cutter {self.of_step[wrong][0]}; expected 0 to {len(self.cutters) - 1}."
            )

    @classmethod
    def single(cls, cutter: Cutter, m: int) -> Self:
        """One cutter for all m steps."""
        return cls((cutter,), np.zeros(m, dtype=np.int64))

    @classmethod
    def of(cls, cutter: Cutter | Tooling, m: int) -> Tooling:
        """The tooling of a path of ``m`` points: the one given, or one cutter for all of them."""
        if isinstance(cutter, Cutter):
            return cls.single(cutter, m)
        if cutter.of_step.shape != (m,):
            raise CuttingError(f"Tooling: it names cutters for {len(cutter.of_step)} moves; the path has {m} points.")
        return cutter

    def at(self, i: int) -> Cutter:
        """The cutter of the move that ends at point i."""
        return self.cutters[int(self.of_step[i])]

    def each(self, name: str) -> FloatArray:
        """A number of every step's cutter, by its name, (m,)."""
        return np.array([float(getattr(cutter, name)) for cutter in self.cutters])[self.of_step]

    @property
    def drills(self) -> BoolArray:
        """(m,) bool: steps that a drill makes."""
        return sealed(np.array([cutter.family.drills for cutter in self.cutters])[self.of_step])

    def steps_of_each(self) -> Iterator[tuple[Cutter, BoolArray]]:
        """Every cutter with the steps (m,) bool that it makes."""
        for n, cutter in enumerate(self.cutters):
            yield cutter, np.asarray(self.of_step == n)
