"""One pass over the points of a grid: inverse kinematics, Jacobian, joint shares, determinant."""

from __future__ import annotations

import numpy as np

from robomill.arrays import BoolArray, FloatArray
from robomill.kinematics.compiled import Kernels
from robomill.kinematics.decoupled import decoupled
from robomill.kinematics.dexterity import square_matrix
from robomill.kinematics.forward import BLOCK, chain_arguments
from robomill.kinematics.inverse import inverse_kinematics
from robomill.kinematics.jacobian import pose_and_jacobian, tilt_axes
from robomill.kinematics.transforms import pose_from_world
from robomill.robot.model import Robot
from robomill.workspace.grid import Grid

Solved = tuple[FloatArray, BoolArray, FloatArray, FloatArray, FloatArray]
PAIRS = ((0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2))


_kernels = Kernels("robomill.workspace.kernels")


def solve_grid(robot: Robot, grid: Grid, A: float, B: float) -> Solved:
    """(theta (..., n), reached (...), J (..., 6, n), shares (..., n, 6), det_J (...)) over the grid.

    NaN where not reached.
    """
    n, m, shape = robot.n, grid.cells, grid.shape
    points = grid.points().reshape(-1, 3)
    pose = pose_from_world([0.0, 0.0, 0.0, A, B])
    out = np.empty((m, n)), np.empty(m, dtype=bool), np.empty((m, 6, n)), np.empty((m, n, 6)), np.empty(m)
    arm = decoupled(robot)
    compiled = _kernels.get(m)
    if compiled is not None and arm is not None and (n == 5 or arm.spindle_on_last_axis):
        R = np.ascontiguousarray(pose[:3, :3])
        tilt = np.ascontiguousarray(tilt_axes(R[:, 2]))
        compiled.solve_points(
            points,
            R,
            arm.packed,
            *chain_arguments(robot.chain),
            robot.limits,
            robot.home,
            n == 6,
            robot.C_theta,
            tilt,
            *out,
        )
    else:
        _solve_in_blocks(robot, points, pose, *out)
    theta, reached, J, shares, det_J = out
    return (
        theta.reshape(*shape, n), reached.reshape(shape), J.reshape(*shape, 6, n),
        shares.reshape(*shape, n, 6), det_J.reshape(shape),
    )  # fmt: skip


def _solve_in_blocks(
    robot: Robot,
    points: FloatArray,
    pose: FloatArray,
    theta: FloatArray,
    reached: BoolArray,
    J: FloatArray,
    shares: FloatArray,
    det_J: FloatArray,
) -> None:
    """The same by NumPy columns, for any arm, block by block into the arrays given."""
    m = len(points)
    T_MT = np.array(np.broadcast_to(pose, (min(m, BLOCK), 4, 4)))
    for start in range(0, m, BLOCK):
        block = slice(start, min(start + BLOCK, m))
        poses = T_MT[: block.stop - start]
        poses[:, :3, 3] = points[block]
        result = inverse_kinematics(robot, poses)
        theta[block], reached[block] = result.theta, result.reached
        found, J_block = pose_and_jacobian(robot, result.theta)
        J_block[~result.reached] = np.nan  # the first axes stand still whatever theta is
        J[block] = J_block
        for c, (i, j) in enumerate(PAIRS):
            shares[block, :, c] = robot.C_theta * J_block[:, i] * J_block[:, j]
        det_J[block] = square_determinant(robot, found, J_block)


def square_determinant(robot: Robot, pose: FloatArray, J: FloatArray) -> FloatArray:
    """det (m,) of the arm's task Jacobian; its size where that is not square (seven joints)."""
    task = square_matrix(robot, pose, J)
    if task.shape[-1] == task.shape[-2]:
        with np.errstate(invalid="ignore"):  # NaN in, NaN out
            return np.linalg.det(task)
    return np.sqrt(np.maximum(np.linalg.det(task @ np.swapaxes(task, -1, -2)), 0.0))
