"""Pieces of a move as the machine is told to make them."""

from dataclasses import dataclass

import numpy as np

from robomill.arrays import FloatArray
from robomill.toolpath.fitting import Piece
from robomill.toolpath.gcode.program import ARC, Program


@dataclass(frozen=True, eq=False)
class Leg:
    """A piece of a ``move`` with the G code that makes it; ``end`` and ``centre`` (3,) m are as the machine is told."""

    move: int
    piece: Piece
    code: str
    program: Program

    @property
    def end(self) -> FloatArray:
        return np.asarray(self.piece.end - self.program.lift[self.move])

    @property
    def centre(self) -> FloatArray | None:
        return None if self.piece.centre is None else self.piece.centre - self.program.lift[self.move]

    @property
    def plane(self) -> int:
        return int(self.program.plane[self.move]) if self.program.kind[self.move] == ARC else 17

    @property
    def rotary0(self) -> FloatArray:
        return self._turned(self.piece.f0)

    @property
    def rotary(self) -> FloatArray:
        return self._turned(self.piece.f1)

    def _turned(self, share: float) -> FloatArray:
        begin, end = self.program.rotary0[self.move], self.program.rotary[self.move]
        return np.asarray(begin + share * (end - begin))
