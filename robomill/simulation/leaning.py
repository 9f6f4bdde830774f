"""Arms of up to four joints bring the tip to its place, with the tool as it happens to stand: told where it leans."""

import numpy as np

from robomill.cutting.unjudged import Unjudged
from robomill.kinematics.result import IKResult, misfit, task_mode
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
    if not where.any():
        return ()
    why = (
        f"an arm of {format_count(ik.robot.n, 'joint')} brings the tip to its place, but the tool then stands up to "
        f"{format_si(angle.max(), 'deg', 1)} off the axis of the path: give an arm of five joints or more, or a path "
        "along the axis that this one holds"
    )
    return (Unjudged("leaning", where, why),)
