"""What a run says of how the arm holds the tool: one posture of many was taken, or the tool's axis is turned round."""

import numpy as np

from robomill.arrays import FloatArray
from robomill.compliance.deflection import displacement
from robomill.compliance.posture import over_posture
from robomill.kinematics.inverse import inverse_kinematics
from robomill.kinematics.transforms import rotation_x, transform
from robomill.provenance import Finding
from robomill.robot.model import Robot
from robomill.units import format_many

OTHER_SPIN, TURNED = "other-spin", "tool-turned"  # codes of why nothing of a cut is reached


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


def unreached_notes(robot: Robot, T_MT: FloatArray) -> tuple[Finding, ...]:
    """Why a pose (4, 4) is not reached: at another spin it would be, or with the tool turned round. {T} of a robot
    description often points away from the flange, z_T of a cut to the spindle."""
    if inverse_kinematics(robot, T_MT).reached:  # at some spin: the tool frame is as it should be
        text = "The cut would be reached at another spin about the tool axis: choose one, or that of least motion."
        return (Finding("suspicious", text, code=OTHER_SPIN),)
    turned = robot.replace(T_tool=robot.T_tool @ transform(rotation_x(np.pi), np.zeros(3)))
    if not inverse_kinematics(turned, T_MT).reached:
        return ()
    text = (
        "The cut would be reached with the tool's axis turned round: z_T points from the tip to the spindle, that of a "
        "URDF's flange often the other way; turn the robot's tool frame about its x by 180°."
    )
    return (Finding("suspicious", text, code=TURNED),)
