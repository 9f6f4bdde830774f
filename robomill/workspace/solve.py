"""One pass over the points of a grid: inverse kinematics, Jacobian, joint shares, determinant."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial

import numpy as np

from robomill.arrays import BoolArray, FloatArray
from robomill.kinematics.compiled import Kernels
from robomill.kinematics.dexterity import square_matrix
from robomill.kinematics.forward import BLOCK, chain_arguments
from robomill.kinematics.inverse import inverse_kinematics
from robomill.kinematics.jacobian import pose_and_jacobian, tilt_axes
from robomill.kinematics.transforms import pose_from_world
from robomill.robot.model import Robot
from robomill.workspace.grid import Grid

Law = Callable[[FloatArray, FloatArray, FloatArray, FloatArray], None]
Solved = tuple[FloatArray, BoolArray, FloatArray, FloatArray, FloatArray]
PAIRS = ((0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2))


_kernels = Kernels("robomill.workspace.kernels")


def solve_grid(robot: Robot, grid: Grid, A: float, B: float) -> Solved:
    """(theta (..., n), reached (...), J (..., 6, n), shares (..., n, 6), det_J (...)) over the grid.

    NaN where not reached. Block by block, so that what one block needs stays in the cache.
    """
    n, m, shape = robot.n, grid.cells, grid.shape
    points = grid.points().reshape(-1, 3)
    pose = pose_from_world([0.0, 0.0, 0.0, A, B])
    theta, reached = np.empty((m, n)), np.empty(m, dtype=bool)
    J, shares, det_J = np.empty((m, 6, n)), np.empty((m, n, 6)), np.empty(m)
    evaluate = _compiled_law(robot, pose, m) or partial(_columns, robot)
    poses = np.array(np.broadcast_to(pose, (min(m, BLOCK), 4, 4)))
    for start in range(0, m, BLOCK):
        block = slice(start, min(start + BLOCK, m))
        T_MT = poses[: block.stop - start]
        T_MT[:, :3, 3] = points[block]
        result = inverse_kinematics(robot, T_MT)
        theta[block], reached[block] = result.theta, result.reached
        evaluate(theta[block], J[block], shares[block], det_J[block])
    return (
        theta.reshape(*shape, n),
        reached.reshape(shape),
        J.reshape(*shape, 6, n),
        shares.reshape(*shape, n, 6),
        det_J.reshape(shape),
    )


def _compiled_law(robot: Robot, pose: FloatArray, size: int) -> Law | None:
    """``_columns`` by the compiled kernel; None where it is not ready or the arm has not five or six joints."""
    compiled = _kernels.get(size)
    if compiled is None or robot.n not in (5, 6):
        return None
    tilt = np.ascontiguousarray(tilt_axes(pose[:3, 2]))
    arguments = (*chain_arguments(robot.chain), robot.C_theta, tilt)
    room = np.empty((BLOCK, 4, 4))

    def law(theta: FloatArray, J: FloatArray, shares: FloatArray, det_J: FloatArray) -> None:
        compiled.evaluate(theta, *arguments, room, J, shares, det_J)

    return law


def _columns(robot: Robot, theta: FloatArray, J: FloatArray, shares: FloatArray, det_J: FloatArray) -> None:
    """J (m, 6, n), shares (m, n, 6) and det_J (m,) at theta (m, n) into the arrays given."""
    found, J[:] = pose_and_jacobian(robot, theta)
    J[np.isnan(theta[:, 0])] = np.nan  # the first axes stand still whatever theta is
    for c, (i, j) in enumerate(PAIRS):
        shares[..., c] = robot.C_theta * J[:, i] * J[:, j]
    det_J[:] = square_determinant(robot, found, J)


def square_determinant(robot: Robot, pose: FloatArray, J: FloatArray) -> FloatArray:
    """det (m,) of the arm's task Jacobian; its size where that is not square (seven joints)."""
    task = square_matrix(robot, pose, J)
    if task.shape[-1] == task.shape[-2]:
        with np.errstate(invalid="ignore"):  # NaN in, NaN out
            return np.linalg.det(task)
    return np.sqrt(np.maximum(np.linalg.det(task @ np.swapaxes(task, -1, -2)), 0.0))
