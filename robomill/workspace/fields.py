"""Compliance, joint shares and dexterity over a grid: the laws of one configuration at every point."""

from dataclasses import dataclass

import numpy as np

from robomill.arrays import FloatArray
from robomill.errors import WorkspaceError
from robomill.robot.model import Robot
from robomill.workspace.cells import SolvedGrid
from robomill.workspace.grid import Grid
from robomill.workspace.quantities import MapQuantity, map_quantity
from robomill.workspace.solve import solve_grid


@dataclass(frozen=True, eq=False)
class Field:
    """One quantity over a grid: values (nx, ny, nz) in SI, NaN in all but the ``reached`` cells."""

    robot: Robot
    grid: Grid
    A: float
    B: float
    quantity: MapQuantity
    values: FloatArray
    reached: int


@dataclass(frozen=True, eq=False)
class ComplianceMap(SolvedGrid):
    """The cells of a grid, asked for any quantity by its name."""

    def values(self, name: str) -> FloatArray:
        """The quantity called ``name`` (see ``quantities``), (nx, ny, nz) in SI, NaN where not reached."""
        return map_quantity(self.robot, name).law(self)

    def field(self, name: str) -> Field:
        """The quantity as a ``Field``."""
        what = map_quantity(self.robot, name)
        return Field(self.robot, self.grid, self.A, self.B, what, what.law(self), int(self.reached.sum()))


def compliance_map(robot: Robot, grid: Grid, A: float = 0.0, B: float = 0.0) -> ComplianceMap:
    """Reach, joints, Jacobian, joint shares and det(J) over ``grid`` with the tool tilted by A, B (rad), in one pass.

    Raises WorkspaceError where the grid needs more memory than the budget, naming the step that fits.
    """
    _finite_tilt(A, B)
    grid.check_budget(8 * (13 * robot.n + 2 + 6) + 1)
    theta, reached, laws = solve_grid(robot, grid, A, B)
    J, shares, det_J = (array.reshape(*grid.shape, *array.shape[1:]) for array in laws)
    theta, reached = theta.reshape(*grid.shape, robot.n), reached.reshape(grid.shape)
    return ComplianceMap(robot, grid, A, B, theta, reached, J, shares, det_J)


def _finite_tilt(A: float, B: float) -> None:
    if not np.isfinite([A, B]).all():
        raise WorkspaceError(f"Tool tilt: A and B must be finite angles, found {A!r} and {B!r}.")
