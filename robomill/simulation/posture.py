"""What a run says of an arm with more axes than its pose needs: one posture of many was taken."""

import numpy as np

from robomill.arrays import FloatArray
from robomill.compliance.deflection import displacement
from robomill.compliance.posture import over_posture
from robomill.provenance import Finding
from robomill.robot.model import Robot
from robomill.units import format_many


def posture_notes(robot: Robot, T_MT: FloatArray, F: FloatArray) -> tuple[Finding, ...]:
    """How far the joints' deflection under F (3,) N ranges over the postures that hold the tool at T_MT (4, 4)."""
    if robot.n <= 6 or not np.isfinite(F).all():
        return ()
    found = over_posture(robot, T_MT)
    if not len(found):
        return ()
    size = np.linalg.norm(displacement(found, F), axis=1)
    text = (
        f"The arm has {robot.n} axes, so one posture of many was taken: at the worst point the deflection "
        f"ranges over {format_many((size.min(), size.max()), 'mm', 3, ' to ')} ({len(found)} postures looked at)."
    )
    return (Finding("info", text, code="posture"),)
