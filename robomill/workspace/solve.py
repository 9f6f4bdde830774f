"""One pass over the points of a grid: inverse kinematics, Jacobian, joint shares, determinant."""

import numpy as np

from robomill.arrays import BoolArray, FloatArray
from robomill.kinematics.dexterity import square_matrix
from robomill.kinematics.forward import BLOCK
from robomill.kinematics.inverse import inverse_kinematics
from robomill.kinematics.transforms import pose_from_world
from robomill.progress import checkpoint
from robomill.robot.model import Robot
from robomill.workspace.grid import Grid
from robomill.workspace.laws import Laws


def solve_grid(robot: Robot, grid: Grid, A: float, B: float) -> tuple[FloatArray, BoolArray, Laws]:
    """(theta (m, n), reached (m,), laws) over the m points of the grid, NaN where not reached.

    Block by block, so that what one block needs stays in the cache.
    """
    from robomill.workspace import kernels

    n, m = robot.n, grid.cells
    points = grid.points().reshape(-1, 3)
    pose = pose_from_world([0.0, 0.0, 0.0, A, B])
    task = np.ascontiguousarray(square_matrix(robot, pose, np.eye(6)))
    theta, reached = np.empty((m, n)), np.empty(m, dtype=bool)
    laws = Laws(np.empty((m, 6, n)), np.empty((m, n, 6)), np.empty(m))
    poses = np.array(np.broadcast_to(pose, (min(m, BLOCK), 4, 4)))
    for start in range(0, m, BLOCK):
        checkpoint(start / m, "Map")
        block = slice(start, min(start + BLOCK, m))
        T_MT = poses[: block.stop - start]
        T_MT[:, :3, 3] = points[block]
        result = inverse_kinematics(robot, T_MT)
        theta[block], reached[block] = result.theta, result.reached
        kernels.evaluate(theta[block], robot.chain, robot.C_theta, task, Laws(*(part[block] for part in laws)))
    return theta, reached, laws
