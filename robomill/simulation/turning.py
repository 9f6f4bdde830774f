"""Where the tool's axis turns while it cuts: rim and flanks then move otherwise than the tip.

A point at r from the tip moves by w x r beside it, where the axis turns by w (rad per m of the tip's way); the chip is
that of its own way. Where rim and highest place go up to 2 degrees otherwise than the tip, the force of a run is
within 5 % of brute force (slots and shoulders, flat, ball and bull-nose cutters, turning ahead and aside). Beyond, it
has not been looked at, and is not judged; nor is a full slot that is only stated, from where hollow end teeth cut.
"""

import math

import numpy as np

from robomill.arrays import FloatArray
from robomill.cutting.conditions import CutConditions
from robomill.cutting.tool import DISH
from robomill.cutting.unjudged import Unjudged
from robomill.toolpath.path import Toolpath
from robomill.units import to_si
from robomill.vectors import angle_between

AXIS_TURNS = "axis-turns"
MOST = math.sin(to_si(2.05, "deg"))  # of a feed: a change of its direction that is judged


def turn_rate(path: Toolpath) -> FloatArray:
    """(m,) rad/m: how far the tool's axis turns per length of the tip's way; infinite where it turns on the spot.

    A sample at the start of a move has that of the move.
    """
    turn, length = np.append(0.0, angle_between(path.k[:-1], path.k[1:])), path.step_length
    with np.errstate(divide="ignore", invalid="ignore"):
        rate = np.where(turn > 0.0, turn / length, 0.0)
    starts = (length == 0.0) & (turn == 0.0) & path.cutting
    return np.asarray(np.where(starts, np.append(rate[1:], 0.0), rate))


def turns_in_cut(path: Toolpath, conditions: CutConditions) -> tuple[Unjudged, ...]:
    """Steps in the material at which the axis turns too fast for a force from the material."""
    assert conditions.tooling is not None
    share = turn_rate(path) * np.maximum(conditions.tooling.each("radius"), conditions.highest)
    where = conditions.engaged & (share > (DISH if conditions.part is None else MOST))
    why = "the tool's axis turns so fast while it cuts that its teeth go otherwise than its tip: no force is known."
    return Unjudged.at(AXIS_TURNS, where, why)
