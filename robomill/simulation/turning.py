"""Where the tool's axis turns while it cuts: rim and flanks then move otherwise than the tip.

The laws of the force take the feed of the tip for that of every tooth. A point at r from the tip moves by w x r beside
it, where the axis turns by w (rad per m of the tip's way). On the rim or at the highest place that cuts this share of
the feed is a change of its direction; below that at which hollow end teeth begin to cut it changes forces by less than
5 % (by brute force, slots and shoulders, flat, ball and bull-nose cutters), above it by up to as much again.
"""

import numpy as np

from robomill.arrays import FloatArray
from robomill.cutting.conditions import CutConditions
from robomill.cutting.tool import DISH
from robomill.cutting.unjudged import Unjudged
from robomill.toolpath.path import Toolpath
from robomill.vectors import angle_between

AXIS_TURNS = "axis-turns"


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
    where = conditions.engaged & (share > DISH)
    why = "the tool's axis turns while it cuts, and its teeth do not move as its tip does: no force is known there."
    return Unjudged.at(AXIS_TURNS, where, why)
