"""How much of a cut must be judged before a number may stand for it: the rule is stated here, once.

A reading comes from samples that cut. Where part of a cut has no number, a tool that goes once more along what that
part should have left meets nothing, is not pushed and reads 0.00: that is no reading, since what is left there is not
known. What few samples say is a place and not the cut, so below ``FEW`` nothing is read at all. That a cut keeps its
tolerance is said of all of it: with a part unknown it may be said of the rest ("where it is judged") only where that is
``MOST`` of it. That it does not keep its tolerance is said wherever there is a number: one place is enough.
"""

import numpy as np

from robomill.arrays import BoolArray
from robomill.simulation.judging.seen import Run

FEW = 0.1
"""Of the length that cuts: where less is judged, no number stands for the cut (stated, not derived)."""
MOST = 0.5
"""Of the length that cuts: where less is judged, nobody says that the cut is within its tolerance."""


def counted(result: Run, known: BoolArray) -> BoolArray:
    """(m,) samples whose numbers count, of those at which one is ``known`` (m,): all, where nothing is unjudged; else
    those that cut, and none where they are too few."""
    if not result.not_judged.any():
        return known
    cuts = known & result.conditions.engaged
    return cuts if _share(result, cuts) >= FEW else np.zeros_like(cuts)


def mostly_judged(result: Run) -> bool:
    """Whether what is judged is most of what cuts."""
    return not result.not_judged.any() or _share(result, result.judged & result.conditions.engaged) >= MOST


def _share(result: Run, cuts: BoolArray) -> float:
    """``cuts`` (m,) of the length that cuts, or would: by samples where none has a length, as when a cut is one
    plunge."""
    every = cuts | (result.not_judged & result.conditions.engaged & result.over_stock)
    length = np.where(every, result.path.step_length, 0.0)
    weight = length if length.sum() > 0.0 else every.astype(float)
    return float(weight[cuts].sum() / weight.sum()) if every.any() else 0.0
