"""The closed-form solutions of a decoupled arm, compiled where that is ready, by NumPy columns until then."""

from __future__ import annotations

import numpy as np

from robomill.arrays import BoolArray, FloatArray, IntArray
from robomill.kinematics.compiled import Kernels
from robomill.kinematics.decoupled import Decoupled, solution_columns
from robomill.kinematics.forward import SMALL, chain_arguments
from robomill.robot.model import Robot

kernels = Kernels("robomill.kinematics.kernels_inverse")
UNCHECKED = -1.0
ANY_BRANCH = np.ones(8, dtype=bool)
# Outputs the kernel does not touch.
NOT_EVERY = (np.empty((0, 8, 0)), np.empty((0, 8), dtype=bool))
NOT_NEAR = (np.empty((0, 0)), np.empty(0, dtype=np.int64), np.empty((0, 3)))


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
    compiled.solve(
        np.ascontiguousarray(T_MT),
        arm.packed,
        *chain_arguments(robot.chain),
        robot.limits,
        robot.home[None],
        False,
        ANY_BRANCH,
        False,
        0,
        tolerance,
        True,
        theta,
        sound,
        *NOT_NEAR,
    )
    return theta, sound


def nearest_solutions(
    robot: Robot, arm: Decoupled, T_MT: FloatArray, goal: FloatArray, wanted: BoolArray, arm_first: bool, spins: int
) -> tuple[FloatArray, IntArray, FloatArray] | None:
    """(theta (m, n), index (m,), fit (m, 3)) as ``choice.choose_spin`` (``spins`` > 0) or ``choice.choose`` choose.

    goal (1 or m, n); fit: spin rad, residual m, residual angle rad by forward kinematics, of the whole rotation for six
    axes with a given spin, else of the tool axis. None where the kernel is not ready or the batch too small to gain.
    """
    m = len(T_MT)
    compiled = kernels.get(m) if m >= SMALL else None
    if compiled is None:
        return None
    theta, index, fit = np.empty((m, robot.n)), np.empty(m, dtype=np.int64), np.empty((m, 3))
    whole = 1.0 if robot.n == 6 and spins == 0 else UNCHECKED
    last_free = spins > 0 and arm.spindle_on_last_axis
    compiled.solve(
        np.ascontiguousarray(T_MT),
        arm.packed,
        *chain_arguments(robot.chain),
        robot.limits,
        np.ascontiguousarray(goal),
        arm_first,
        wanted,
        last_free,
        0 if last_free else spins,
        whole,
        False,
        *NOT_EVERY,
        theta,
        index,
        fit,
    )
    return theta, index, fit
