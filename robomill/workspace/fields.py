"""Compliance, joint shares and dexterity over a grid: the laws of one configuration at every point."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from robomill.arguments import asked, made_by
from robomill.arrays import FloatArray, as_floats, digest, of_kind
from robomill.errors import WorkspaceError
from robomill.frames import Columns, data_array, data_set
from robomill.lazy import cached_property
from robomill.robot.model import Robot, check_robot
from robomill.units import format_count, format_many, from_si, si_unit
from robomill.values import Tabled
from robomill.workspace.cells import SolvedGrid
from robomill.workspace.grid import Grid
from robomill.workspace.quantities import MapQuantity, map_quantities, map_quantity
from robomill.workspace.solve import solve_grid

if TYPE_CHECKING:
    from robomill.frames import DataArray, Dataset


@made_by('rm.compliance_map(robot, grid).field("C_yy")')
@dataclass(frozen=True, eq=False, repr=False)
class Field(Tabled):
    """One quantity over a grid: values (nx, ny, nz) in SI, NaN in all but the ``reached`` cells.

    Examples
    --------
    >>> import robomill as rm
    >>> grid = rm.Grid(x_mm=[0, 200], y_mm=-1300, z_mm=0)
    >>> field = rm.compliance_map(rm.load_robot("slavkovic_5r"), grid).field("C_yy")
    >>> list(field.columns()), (field.values * 1e6).ravel().round(3).tolist()
    (['X_mm', 'Y_mm', 'Z_mm', 'C_yy_um/N'], [2.295, 2.259])
    """

    robot: Robot
    grid: Grid
    A: float
    B: float
    quantity: MapQuantity
    values: FloatArray
    reached: int

    def columns(self) -> Columns:
        """One row a cell, x slowest, z fastest: X, Y, Z and the quantity; NaN where the pose is not reached."""
        return map_columns([self])

    @asked
    def to_xarray(self) -> DataArray:
        """The quantity as an xarray DataArray, in SI.

        Returns
        -------
        xarray.DataArray
            (x, y, z) with these coordinates in m, and the tool tilt A, B in rad; ``attrs`` tell its unit, what it means
            and whose it is. NaN where the pose is not reached.

        Raises
        ------
        MissingExtraError
            Where xarray is not installed: ``pip install "robomill[data]"`` brings it.
        """
        what = self.quantity
        said = {"units": si_unit(what.unit), "long_name": what.title, "description": what.meaning}
        coordinates = _coordinates(self.grid, self.A, self.B)
        return data_array(self.values, coordinates, "xyz", what.name, said | _whose(self.robot))

    @cached_property
    def _digest(self) -> str:
        return digest((self.robot.digest(), self.grid.digest(), self.A, self.B, self.quantity.name, self.values))

    def __reduce__(self) -> Any:
        state = (self.robot, self.grid, self.A, self.B, self.quantity.name, self.values, self.reached)
        return _field, state  # a law does not pickle; its name says it

    def _said(self) -> str:
        return f"{self.quantity.name} of {self.robot.name}: {self._ends}"

    @property
    def _ends(self) -> str:
        """From where to where its values go, and over what."""
        known = self.values[np.isfinite(self.values)]
        ends = format_many((known.min(), known.max()), self.quantity.unit, between=" to ") if known.size else ""
        return f"{ends or 'nothing reached'} over {self.grid._said()}"


def _field(robot: Robot, grid: Grid, A: float, B: float, name: str, *found: Any) -> Field:
    return Field(robot, grid, A, B, map_quantity(robot, name), *found)


@made_by("rm.compliance_map(robot, grid)")
@dataclass(frozen=True, eq=False, repr=False)
class ComplianceMap(SolvedGrid, Tabled):
    """The cells of a grid, asked for any quantity by its name.

    Examples
    --------
    >>> import robomill as rm
    >>> found = rm.compliance_map(rm.load_robot("slavkovic_5r"), rm.Grid(x_mm=[0, 200], y_mm=-1300, z_mm=0))
    >>> found
    <ComplianceMap slavkovic_5r: 2 x 1 x 1 cells at X, Y, Z = 0 to 200 mm; -1300 mm; 0 mm, tilt A, B 0.0, 0.0 deg, ...>
    """

    @asked
    def values(self, name: str) -> FloatArray:
        """The quantity called ``name`` (see ``quantities``), (nx, ny, nz) in SI, NaN where not reached."""
        return map_quantity(self.robot, name).law(self)

    @asked
    def field(self, name: str) -> Field:
        """The quantity as a ``Field``."""
        what = map_quantity(self.robot, name)
        return Field(self.robot, self.grid, self.A, self.B, what, what.law(self), int(self.reached.sum()))

    @asked
    def fields(self, names: Sequence[str] | None = None) -> list[Field]:
        """The quantities called ``names``; None: every one that the robot has."""
        return [self.field(name) for name in (map_quantities(self.robot) if names is None else names)]

    def columns(self) -> Columns:
        """One row a cell, x slowest, z fastest: X, Y, Z and every quantity; NaN where the pose is not reached."""
        return map_columns(self.fields())

    @asked
    def to_xarray(self, names: Sequence[str] | None = None) -> Dataset:
        """Quantities as an xarray Dataset, in SI; of one alone ``field(name).to_xarray()`` is the DataArray.

        Parameters
        ----------
        names : sequence of str, optional
            Which quantities, e.g. ``["C_yy", "reach"]``; None: every one that the robot has.

        Returns
        -------
        xarray.Dataset
            Variables (x, y, z) by the names of the quantities, as ``Field.to_xarray`` gives them.

        Raises
        ------
        WorkspaceError
            For a name that is no quantity.
        MissingExtraError
            Where xarray is not installed: ``pip install "robomill[data]"`` brings it.
        """
        return data_set([field.to_xarray() for field in self.fields(names)], _whose(self.robot))

    @cached_property
    def _digest(self) -> str:
        return digest((self.robot.digest(), self.grid.digest(), self.A, self.B, self.theta, self.shares))

    def _said(self) -> str:
        tilt = format_many((self.A, self.B), "deg", 1)
        reached = format_count(int(self.reached.sum()))
        return f"{self.robot.name}: {self.grid._said()}, tilt A, B {tilt}, {reached} reached"

    def _facts(self) -> list[tuple[str, str]]:
        direct = [self.field(f"C_{axis}{axis}") for axis in "xyz"]
        return [(field.quantity.title, field._ends) for field in direct]


def map_columns(fields: Sequence[Field]) -> Columns:
    """Quantities over one grid as columns (cells,) in display units, x slowest, z fastest."""
    points = fields[0].grid.points().reshape(-1, 3)
    columns: Columns = {f"{axis}_mm": from_si(points[:, i], "mm") for i, axis in enumerate("XYZ")}
    for field in fields:
        columns[field.quantity.column] = from_si(field.values.ravel(), field.quantity.unit)
    return columns


def _coordinates(grid: Grid, A: float, B: float) -> dict[str, Any]:
    """Of each coordinate its dims, values and attributes."""
    axes = {name: ((name,), getattr(grid, name), _axis(name.upper(), "m")) for name in "xyz"}
    return {**axes, "A": ((), A, _axis("tool tilt A", "rad")), "B": ((), B, _axis("tool tilt B", "rad"))}


def _axis(name: str, unit: str) -> dict[str, str]:
    return {"units": unit, "long_name": name}


def _whose(robot: Robot) -> dict[str, str]:
    return {"robot": robot.name, "compliance_set": robot.compliance_set, "robot_digest": robot.digest()}


@asked
def compliance_map(robot: Robot, grid: Grid, A: float = 0.0, B: float = 0.0) -> ComplianceMap:
    """Reach, joints, Jacobian and joint shares of the compliance over a grid, in one pass.

    Parameters
    ----------
    robot : Robot
        The arm.
    grid : Grid
        Points in {M}, m.
    A, B : float
        Tilt of the tool, rad.

    Returns
    -------
    ComplianceMap
        Asked for any quantity by its name (``map_quantities``); NaN where a point is not reached. Eqs. (8) to (14).

    Raises
    ------
    WorkspaceError
        Where the grid needs more memory than the budget (the step that fits is named), or the tilt is not finite.

    Examples
    --------
    >>> import robomill as rm
    >>> grid = rm.Grid(x_mm=[-200, 0, 200], y_mm=-1300, z_mm=0)
    >>> found = rm.compliance_map(rm.load_robot("slavkovic_5r"), grid)
    >>> (found.values("C_yy").ravel() * 1e6).round(3).tolist()
    [2.259, 2.295, 2.259]
    """
    check_robot(robot)
    of_kind(grid, Grid, "grid", "rm.Grid(x_mm=..., y_mm=..., z_mm=...), rm.plane_grid or rm.box_grid", WorkspaceError)
    _finite_tilt(A, B)
    grid.check_budget(8 * (13 * robot.n + 2 + 6) + 1)
    theta, reached, laws = solve_grid(robot, grid, A, B)
    J, shares, det_J = (array.reshape(*grid.shape, *array.shape[1:]) for array in laws)
    theta, reached = theta.reshape(*grid.shape, robot.n), reached.reshape(grid.shape)
    return ComplianceMap(robot, grid, A, B, theta, reached, J, shares, det_J)


def _finite_tilt(A: float, B: float) -> None:
    if not np.isfinite(as_floats([A, B], "Tool tilt A, B (rad)", (2,), error=WorkspaceError, finite=False)).all():
        raise WorkspaceError(f"Tool tilt: A and B must be finite angles, found {A!r} and {B!r}.")
