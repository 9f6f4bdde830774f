"""Compliance, joint shares and dexterity over a grid: the laws of one configuration at every point."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from robomill.arrays import BoolArray, FloatArray
from robomill.errors import WorkspaceError
from robomill.kinematics import dexterity
from robomill.kinematics.transforms import pose_from_world
from robomill.robot.model import Robot
from robomill.workspace.grid import Grid
from robomill.workspace.quantities import COMPONENTS, Quantity, quantity
from robomill.workspace.solve import solve_grid


@dataclass(frozen=True, eq=False)
class Field:
    """One quantity over a grid: values (nx, ny, nz) in SI, NaN where the pose is not reached."""

    robot: Robot
    grid: Grid
    A: float
    B: float
    quantity: Quantity
    values: FloatArray

    @property
    def reached(self) -> int:
        """How many cells are reached."""
        return int(np.isfinite(self.values).sum()) if self.quantity.name != "reach" else int(self.values.sum())


@dataclass(frozen=True, eq=False)
class ComplianceField:
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

    def C(self) -> FloatArray:
        """Compliance (nx, ny, nz, 3, 3) m/N."""
        return symmetric(self.total)

    def C_joint(self) -> FloatArray:
        """Joint contributions (nx, ny, nz, n, 3, 3) m/N, eq. (14)."""
        return symmetric(self.shares)

    def values(self, name: str) -> FloatArray:
        """The quantity called ``name`` (see ``quantities``), (nx, ny, nz) in SI, NaN where not reached."""
        return _evaluate(self, quantity(self.robot, name))

    def field(self, name: str) -> Field:
        """The quantity as a ``Field``."""
        return Field(self.robot, self.grid, self.A, self.B, quantity(self.robot, name), self.values(name))


def symmetric(six: FloatArray) -> FloatArray:
    """(..., 3, 3) from the six components xx, yy, zz, xy, xz, yz (..., 6)."""
    return six[..., [[0, 3, 4], [3, 1, 5], [4, 5, 2]]]


def compliance_field(robot: Robot, grid: Grid, A: float = 0.0, B: float = 0.0) -> ComplianceField:
    """Reach, joints, Jacobian, joint shares and det(J) over ``grid`` with the tool tilted by A, B (rad), in one pass.

    Raises WorkspaceError where the grid needs more memory than the budget, naming the step that fits.
    """
    _finite_tilt(A, B)
    grid.check_budget(8 * (13 * robot.n + 2 + 6) + 1)
    theta, reached, J, shares, det_J = solve_grid(robot, grid, A, B)
    return ComplianceField(robot, grid, A, B, theta, reached, J, shares, det_J)


def compute_field(robot: Robot, grid: Grid, name: str, A: float = 0.0, B: float = 0.0) -> Field:
    """One quantity by name over a plane or box at the tilt A, B (rad). Raises WorkspaceError."""
    quantity(robot, name)
    return compliance_field(robot, grid, A, B).field(name)


def _finite_tilt(A: float, B: float) -> None:
    if not np.isfinite([A, B]).all():
        raise WorkspaceError(f"Tool tilt: A and B must be finite angles, found {A!r} and {B!r}.")


def _evaluate(field: ComplianceField, what: Quantity) -> FloatArray:
    if what.name == "reach":
        return field.reached.astype(np.float64)
    if what.name == "det_J":
        return field.det_J
    if what.name == "manipulability":
        return np.abs(field.det_J)
    if what.name == "limit_distance":
        return _where_reached(field, dexterity.limit_distance(field.robot, field.theta[field.reached]))
    if what.name == "smallest_singular_value":
        return _where_reached(field, field.singular_values[:, -1])
    if what.name == "inverse_condition":
        return _where_reached(field, field.singular_values[:, -1] / field.singular_values[:, 0])
    if what.name in ("C_soft", "C_stiff"):
        pick = -1 if what.name == "C_soft" else 0
        values: FloatArray = np.linalg.eigvalsh(field.C()[field.reached]).astype(np.float64)
        return _where_reached(field, values[:, pick])
    if what.name == "dominant":
        return _dominant(field, field.shares[..., :3].sum(axis=-1))
    index = COMPONENTS.index(what.component)
    if what.name.startswith("dominant"):
        return _dominant(field, np.abs(field.shares[..., index]))
    if what.joint < 0:
        return field.total[..., index]
    part = field.shares[..., what.joint, index]
    if what.name.startswith("share"):
        whole = np.abs(field.shares[..., index]).sum(axis=-1)
        return np.divide(part, whole, out=np.where(field.reached, 0.0, np.nan), where=whole > 0)
    return part


def _where_reached(field: ComplianceField, values: FloatArray) -> FloatArray:
    full = np.full(field.reached.shape, np.nan)
    full[field.reached] = values
    return full


def _dominant(field: ComplianceField, size: FloatArray) -> FloatArray:
    """Number (as in the robot's table) of the joint with the largest ``size`` (..., n)."""
    numbers = np.array(field.robot.joint_numbers, dtype=np.float64)
    best = numbers[np.argmax(np.where(np.isnan(size), -1.0, size), axis=-1)]
    return np.where(field.reached, best, np.nan)
