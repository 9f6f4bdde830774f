"""What is known of every cell of a grid: the laws of one configuration at every point, and what follows from them."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from robomill.arguments import asked
from robomill.arrays import BoolArray, FloatArray
from robomill.compliance.components import symmetric
from robomill.kinematics import dexterity
from robomill.kinematics.transforms import pose_from_world
from robomill.lazy import cached_property
from robomill.robot.model import Robot
from robomill.workspace.grid import Grid


@dataclass(frozen=True, eq=False, repr=False)
class SolvedGrid:
    """Every cell of a grid at the tool tilt A, B: joints, Jacobian, joint shares, determinant; NaN where not reached.

    theta (nx, ny, nz, n), reached (nx, ny, nz), J (nx, ny, nz, 6, n), shares (nx, ny, nz, n, 6) m/N: each joint's part
    of C_xx, C_yy, C_zz, C_xy, C_xz, C_yz; det_J (nx, ny, nz).
    """

    robot: Robot
    grid: Grid
    A: float
    B: float
    theta: FloatArray
    reached: BoolArray
    J: FloatArray
    shares: FloatArray
    det_J: FloatArray

    @cached_property
    def total(self) -> FloatArray:
        """(nx, ny, nz, 6) m/N: C_xx, C_yy, C_zz, C_xy, C_xz, C_yz."""
        return self.shares.sum(axis=-2)

    @cached_property
    def singular_values(self) -> FloatArray:
        """(reached cells, r), falling: of the task Jacobian, rows as named by ``dexterity.square_rows``."""
        pose = pose_from_world([0.0, 0.0, 0.0, self.A, self.B])
        task = dexterity.square_matrix(self.robot, pose, self.J[self.reached])
        return np.asarray(np.linalg.svd(task, compute_uv=False), dtype=np.float64)

    @cached_property
    def principal(self) -> FloatArray:
        """(reached cells, 3) m/N, rising: the eigenvalues of C."""
        return np.asarray(np.linalg.eigvalsh(self.C()[self.reached]), dtype=np.float64)

    def C(self) -> FloatArray:
        """Compliance (nx, ny, nz, 3, 3) m/N."""
        return symmetric(self.total)

    def C_joint(self) -> FloatArray:
        """Joint contributions (nx, ny, nz, n, 3, 3) m/N, eq. (14)."""
        return symmetric(self.shares)

    @asked
    def where_reached(self, values: FloatArray) -> FloatArray:
        """(nx, ny, nz) from the values (reached cells,); NaN elsewhere."""
        full = np.full(self.reached.shape, np.nan)
        full[self.reached] = values
        return full
