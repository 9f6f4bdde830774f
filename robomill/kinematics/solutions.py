"""The closed-form solutions of a decoupled arm, compiled where that is ready, by NumPy columns until then."""

from __future__ import annotations

import numpy as np

from robomill.arrays import BoolArray, FloatArray
from robomill.kinematics.compiled import Kernels
from robomill.kinematics.decoupled import Decoupled, solution_columns
from robomill.kinematics.forward import SMALL, chain_arguments
from robomill.robot.model import Robot

kernels = Kernels("robomill.kinematics.kernels_inverse")
UNCHECKED = -1.0


def solutions(robot: Robot, arm: Decoupled, T_MT: FloatArray) -> tuple[FloatArray, BoolArray]:
    """(theta (m, 8, n), possible (m, 8)) of poses T_MT (m, 4, 4), as ``decoupled.solution_columns`` gives them."""
    found = compiled_solutions(robot, arm, T_MT, UNCHECKED)
    return solution_columns(arm, T_MT) if found is None else found


def compiled_solutions(
    robot: Robot, arm: Decoupled, T_MT: FloatArray, tolerance: float
) -> tuple[FloatArray, BoolArray] | None:
    """The same by the compiled kernel, checked by forward kinematics to ``tolerance`` (m, rad) if that is not negative.

    None where the kernel is not ready or the batch too small to gain.
    """
    m = len(T_MT)
    compiled = kernels.get(m) if m >= SMALL else None
    if compiled is None:
        return None
    theta, sound = np.empty((m, 8, arm.n)), np.empty((m, 8), dtype=bool)
    compiled.all_solutions(
        np.ascontiguousarray(T_MT), arm.packed, *chain_arguments(robot.chain), tolerance, theta, sound
    )
    return theta, sound
