"""Arms with more axes than a pose needs: what the tip gives in the many postures that hold the tool in one place."""

import numpy as np

from robomill.arrays import FloatArray
from robomill.compliance.cartesian import cartesian_compliance
from robomill.kinematics.extent import drawn
from robomill.kinematics.numeric import solve_numerically
from robomill.kinematics.spin import spin_matters
from robomill.provenance import Finding
from robomill.robot.model import Robot

POSTURES = 96  # starts, drawn over the joint limits from a fixed seed


def over_posture(robot: Robot, T_MT: FloatArray) -> FloatArray:
    """C (k, 3, 3) m/N of the postures found that bring the tip and the tool axis to T_MT (4, 4), within the limits.

    The spin about the tool axis is free as in milling. Arms of up to six axes have no posture to choose beside their
    branches and the spin: (0, 3, 3).
    """
    if robot.n <= 6:
        return np.empty((0, 3, 3))
    poses = np.array(np.broadcast_to(T_MT, (POSTURES, 4, 4)))
    theta, found = solve_numerically(robot, poses, drawn(robot, POSTURES), "axis")
    return cartesian_compliance(robot, theta[found])


def posture_notes(robot: Robot) -> tuple[Finding, ...]:
    """That a map of an arm holds for one way of many to stand in each place; none of arms that have no choice."""
    if robot.n > 6:
        text = f"This arm has {robot.n} axes and holds a place in many postures: a map shows one of them."
    elif spin_matters(robot):
        text = (
            "The tool may be turned about its own axis, which changes how this arm stands and gives: a map shows the "
            "turn that moves the joints least from home, in each place its own."
        )
    else:
        return ()
    return (Finding("info", text, code="map-posture"),)
