"""What some lessons compare: the places beside a pose, and a cut that mills up with one that mills down."""

from __future__ import annotations

import numpy as np

from robomill.arrays import FloatArray
from robomill.compliance.at_pose import PoseReport
from robomill.compliance.deflection import displacement
from robomill.cutting.conditions import CutConditions
from robomill.cutting.forces.mechanistic import MechanisticForce, MechanisticRow
from robomill.cutting.tool import Cutter
from robomill.io.materials import load_material
from robomill.kinematics.inverse import inverse_kinematics
from robomill.units import format_si

STEP = 0.15  # m: to the neighbours
ROW, DIAMETER_MM, FLUTES, DEPTH, FEED, SPEED, WIDTH = "al7075_t6_carbide_ref190", 8.0, 3, 2e-3, 0.05e-3, 200.0, 2e-3


def neighbours(pose: PoseReport) -> tuple[tuple[str, ...], FloatArray, FloatArray]:
    """(names, p (k, 3) m, theta (k, n)): here and the places ``STEP`` along X and Y that the arm reaches alike."""
    here = pose.T_MT
    shifts = np.array([[0, 0, 0], [1, 0, 0], [-1, 0, 0], [0, 1, 0], [0, -1, 0]]) * STEP
    T = np.repeat(here[None], len(shifts), axis=0)
    T[:, :3, 3] += shifts
    solved = inverse_kinematics(pose.robot, T, near=pose.theta)
    step = format_si(STEP, "mm", 0)
    names = ("Here", *(f"{step} towards {way}" for way in ("+X", "−X", "+Y", "−Y")))
    reached = solved.reached.copy()
    reached[0] = True
    theta = solved.theta.copy()
    theta[0] = pose.theta
    kept = np.flatnonzero(reached)
    return tuple(names[i] for i in kept), T[kept, :3, 3], theta[kept]


def side_cut(pose: PoseReport, up: bool) -> tuple[FloatArray, float]:
    """(F (3,) N in {M}, shift of the tip into the wall, m) of a cut along +X that leaves a wall.

    The cutter turns clockwise seen from above: milling up, its wall is on the left of the feed, else on the right.
    """
    row = load_material(ROW)
    assert isinstance(row, MechanisticRow)
    angle = float(np.arccos(1.0 - 2.0 * WIDTH / (DIAMETER_MM * 1e-3)))
    arc = (0.0, angle) if up else (np.pi - angle, np.pi)
    steady = CutConditions.steady([FEED * FLUTES * SPEED], [SPEED], [DEPTH], arc=arc)
    model = MechanisticForce(Cutter("flat", diameter_mm=DIAMETER_MM, flutes=FLUTES), row)
    F = np.array(model.components(steady)[0])  # feed along +X, its left along +Y, axis along +Z of {M}
    delta = displacement(pose.C, F)
    return F, float(delta[1] if up else -delta[1])
