"""Steps whose force has no model: they are said, counted, and never green."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from robomill.arrays import BoolArray
from robomill.cutting.conditions import CutConditions
from robomill.cutting.tooling import Tooling


@dataclass(frozen=True, eq=False)
class Unjudged:
    """Steps ``where`` (m,) that are not judged, for one reason: its ``code``, and ``why`` in words for people.

    ``names`` are the numbers that are not given, as files call them; any one kind of them would do.
    """

    code: str
    where: BoolArray
    why: str
    names: tuple[str, ...] = ()

    @classmethod
    def at(cls, code: str, where: BoolArray, why: str, names: tuple[str, ...] = ()) -> tuple[Unjudged, ...]:
        """The one of ``where``; none where that is nowhere."""
        return (cls(code, where, why, names),) if where.any() else ()


def against_hand(conditions: CutConditions, tooling: Tooling) -> tuple[Unjudged, ...]:
    """Steps in the material at which the spindle turns against the hand of its cutter: such teeth rub on their backs,
    whatever force is stated. A spindle of which nothing is said turns with the cutter."""
    left = np.array([cutter.hand == "left" for cutter in tooling.cutters])[tooling.of_step]
    where = conditions.engaged & (conditions.ccw != left) & (conditions.n_s != 0.0)
    why = "the spindle turns against the cutter's hand: it does not cut"
    return Unjudged.at("spindle_sense", where, why)
