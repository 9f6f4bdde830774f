"""A line of a drawing, open or closed, in {W}."""

from dataclasses import dataclass

import numpy as np

from robomill.arrays import FloatArray, frozen
from robomill.toolpath.sketch import Shape, outline
from robomill.units import format_many, format_si
from robomill.values import Said, Value

CLOSED: tuple[Shape, ...] = ("polygon", "rectangle", "circle")


@dataclass(frozen=True, eq=False, repr=False)
class Contour(Said, Value):
    """A line of a drawing: its ``layer``, and ``shape`` and ``points`` (r, 2) m in {W} as an Element has them."""

    layer: str
    shape: Shape
    points: FloatArray

    def _said(self) -> str:
        return (
            f"{self.shape} on {self.layer}, {'closed' if self.closed else 'open'}, {format_si(self.length, 'mm')} long"
        )

    def __post_init__(self) -> None:
        object.__setattr__(self, "points", frozen(self.points))

    @property
    def closed(self) -> bool:
        """Whether it ends where it begins."""
        return self.shape in CLOSED

    def outline(self) -> FloatArray:
        """(q, 2) m: its corners in order, arcs as chords; a closed one ends where it begins."""
        return outline(self.shape, self.points)

    @property
    def length(self) -> float:
        """m, of its chords."""
        return float(np.linalg.norm(np.diff(self.outline(), axis=0), axis=1).sum())

    @property
    def place(self) -> str:
        """Where it begins, in words."""
        return f"the {'closed' if self.closed else 'open'} line at {format_many(self.outline()[0], 'mm', 2)}"
