"""Tools that stand otherwise than a cut can be judged with: off the path's axis, or not upright over the part."""

import numpy as np

from robomill.arrays import BoolArray
from robomill.cutting.unjudged import Unjudged
from robomill.kinematics.result import IKResult, misfit, task_mode
from robomill.surface.passes import SMALLEST_RISE
from robomill.toolpath.path import Toolpath
from robomill.units import format_count, format_si, to_si

NOTICED = to_si(0.1, "deg")
"""Stated, not derived: an 8 mm flat mill that leans by more leaves a floor that is off by more than 7 um."""


def leaning(path: Toolpath, ik: IKResult) -> tuple[Unjudged, ...]:
    """Steps at feed at which the tool stands off the axis of the path: forces and surfaces are those of the path's."""
    if task_mode(ik.robot) != "position":
        return ()
    angle = np.zeros(len(path))
    there = ik.reached & path.cutting
    angle[there] = misfit(ik.robot, ik.theta[there], ik.T_MT[there], "axis")[1]
    where = angle > NOTICED
    why = (
        f"an arm of {format_count(ik.robot.n, 'joint')} brings the tip to its place, but the tool then stands up to "
        f"{format_si(angle.max(), 'deg', 1)} off the axis of the path: give an arm of five joints or more, or a path "
        "along the axis that this one holds"
    )
    return Unjudged.at("leaning", where, why)


def lies(path: Toolpath) -> BoolArray:
    """(m,) steps at feed at which the tool is too close to level for a surface seen from above, or points
    downwards."""
    return np.asarray(path.cutting & (path.k[:, 2] < SMALLEST_RISE))


def lying(path: Toolpath) -> tuple[Unjudged, ...]:
    """Steps at feed at which the tool lies or points upwards: the part is cut from above, so such a cut has no wall and
    no floor that could be read, however far the tip is off."""
    where = lies(path)
    if not where.any():
        return ()
    least = path.k[where, 2].min()
    why = (
        f"the tool lies there, or comes from below (the upward part of its axis is {least:.2f}; a surface "
        f"is judged from {SMALLEST_RISE} on): turn the part, or give the axis from the tip to the spindle"
    )
    return (Unjudged("tool-lies", where, why),)
