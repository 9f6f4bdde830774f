"""Grids of points in {M}: planes and boxes, with a budget that refuses what memory cannot hold."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike

from robomill import budgets
from robomill.arguments import asked
from robomill.arrays import FloatArray, as_floats, frozen
from robomill.errors import WorkspaceError
from robomill.paper import BOX, BOX_SIZE
from robomill.quantities import quantity
from robomill.spelled import in_units
from robomill.units import format_count, format_many, format_si, to_si
from robomill.values import Value

PAPER_BOX = (frozen(BOX[0]), frozen(BOX[1]))
PAPER_BOX_SIZE = frozen(BOX_SIZE)
LARGEST_AXIS = 100_000
SLIPPED = 10.0  # times the longest side of a box: such a step was meant in mm


FARTHEST = 200.0  # m: no robot reaches as far: was it meant in mm?
NEAREST = 2e-3  # m: nobody maps as little about the middle of a robot's foot: was it meant in m?


@in_units(WorkspaceError, "Grid")
@dataclass(frozen=True, eq=False, repr=False)
class Grid(Value):
    """Points x (nx,), y (ny,), z (nz,) m in {M}, or x_mm, y_mm, z_mm; fields over it are (nx, ny, nz).

    A plane has one axis of one number: ``Grid(x_mm=range(-600, 601, 50), y_mm=range(-1600, -999, 50), z_mm=0)``.

    Raises
    ------
    WorkspaceError
        For coordinates that do not rise, and for numbers that were meant in another unit.

    Examples
    --------
    >>> import robomill as rm
    >>> rm.Grid(x_mm=range(-600, 601, 50), y_mm=range(-1600, -999, 50), z_mm=0)
    <Grid 25 x 13 x 1 cells at X, Y, Z = -600 to 600 mm; -1600 to -1000 mm; 0 mm>
    """

    x: FloatArray = quantity("axis x", "mm", shape=(None,), slip=FARTHEST, tiny=NEAREST, extent=True)
    y: FloatArray = quantity("axis y", "mm", shape=(None,), slip=FARTHEST, tiny=NEAREST, extent=True)
    z: FloatArray = quantity("axis z", "mm", shape=(None,), slip=FARTHEST, tiny=NEAREST, extent=True)

    if TYPE_CHECKING:

        def __init__(
            self,
            x: ArrayLike = ...,
            y: ArrayLike = ...,
            z: ArrayLike = ...,
            *,
            x_mm: ArrayLike = ...,
            y_mm: ArrayLike = ...,
            z_mm: ArrayLike = ...,
        ) -> None: ...

    def __post_init__(self) -> None:
        for name in ("x", "y", "z"):
            axis = np.atleast_1d(as_floats(getattr(self, name), f"Grid axis {name}", (), error=WorkspaceError))
            if axis.ndim != 1 or len(axis) == 0:
                raise WorkspaceError(f"Grid: axis {name} needs at least one coordinate.")
            if float(np.abs(axis).max()) > FARTHEST:
                ends = f"{format_si(float(np.abs(axis).max()), 'm', 0)} off; expected {FARTHEST:g} m at most"
                raise WorkspaceError(f"Grid: a point of axis {name} lies {ends}.")
            if (np.diff(axis) <= 0).any():
                raise WorkspaceError(f"Grid: the coordinates of axis {name} must rise.")
            object.__setattr__(self, name, frozen(axis))

    @property
    def shape(self) -> tuple[int, int, int]:
        """(nx, ny, nz)."""
        return len(self.x), len(self.y), len(self.z)

    @property
    def cells(self) -> int:
        """How many points it has."""
        return len(self.x) * len(self.y) * len(self.z)

    def points(self) -> FloatArray:
        """(nx, ny, nz, 3) m."""
        return np.stack(np.meshgrid(self.x, self.y, self.z, indexing="ij"), axis=-1)

    def _said(self) -> str:
        ends = (format_many(dict.fromkeys((axis[0], axis[-1])), "mm", 0, " to ") for axis in (self.x, self.y, self.z))
        return f"{' × '.join(map(str, self.shape))} cells at X, Y, Z = {'; '.join(ends)}"

    @property
    def step(self) -> float:
        """The smallest spacing of an axis that has one, m; 0 for a single point."""
        steps = [float(np.diff(axis).min()) for axis in (self.x, self.y, self.z) if len(axis) > 1]
        return min(steps, default=0.0)

    def check_budget(self, bytes_per_cell: int) -> None:
        """Raises WorkspaceError, naming the step that fits, where a map would need more than the budget."""
        fits = budgets.map_bytes() // bytes_per_cell
        if self.cells <= fits:
            return
        axes = sum(size > 1 for size in self.shape)
        step = self.step * (self.cells / fits) ** (1.0 / axes)
        raise WorkspaceError(
            f"Grid of {' x '.join(map(str, self.shape))} = {format_count(self.cells)} cells needs "
            f"{self.cells * bytes_per_cell / 2**30:.1f} GiB; "
            f"{format_count(fits)} cells fit, so use a step of {format_si(np.ceil(step * 1e4) / 1e4, 'mm', 1)} or more."
        )


@asked
def box_grid(lower: ArrayLike, upper: ArrayLike, step: float) -> Grid:
    """A grid of points over a box.

    Parameters
    ----------
    lower, upper : array_like, (3,)
        Corners of the box, m, in {M}; an axis of zero length has one point.
    step : float
        Spacing of the points, m.

    Returns
    -------
    Grid
        Points lower, lower + step, ... up to upper.

    Raises
    ------
    WorkspaceError
        For corners the wrong way round, or a step that is not above zero, makes too many points or was meant in mm.

    Examples
    --------
    >>> import robomill as rm
    >>> rm.box_grid([-0.6, -1.6, 0.0], [0.6, -1.0, 0.0], 0.1).shape
    (13, 7, 1)
    """
    step = float(as_floats(step, "Grid, step (m)", (), error=WorkspaceError, finite=False, one=True))
    low = as_floats(lower, "Box, lower corner", (3,), error=WorkspaceError, one=True)
    high = as_floats(upper, "Box, upper corner", (3,), error=WorkspaceError, one=True)
    longest = float(np.abs(high - low).max())
    if longest > 0.0 and step > SLIPPED * longest:
        raise WorkspaceError(
            f"Grid: a step of {step:g} m is far longer than the box ({longest:g} m): lengths are in m; {step:g} mm are "
            f"{to_si(step, 'mm'):g}."
        )
    return Grid(*(axis_points(low[i], high[i], step, "xyz"[i]) for i in range(3)))


@asked
def plane_grid(normal: str, at: float, lower: ArrayLike, upper: ArrayLike, step: float) -> Grid:
    """A grid of points over a plane across an axis of {M}.

    Parameters
    ----------
    normal : str
        "x", "y" or "z".
    at : float
        Where the plane lies along its normal, m.
    lower, upper : array_like, (3,)
        Corners of the box that the plane is cut from, m.
    step : float
        Spacing of the points, m.

    Returns
    -------
    Grid
        With one point along ``normal``.

    Raises
    ------
    WorkspaceError
        For another normal, and as ``box_grid``.

    Examples
    --------
    >>> import robomill as rm
    >>> rm.plane_grid("z", 0.0, [-0.6, -1.6, 0.0], [0.6, -1.0, 0.5], 0.1).shape
    (13, 7, 1)
    """
    if normal not in ("x", "y", "z"):
        raise WorkspaceError(f"Plane: the normal is {normal!r}; expected 'x', 'y' or 'z'.")
    low = np.array(as_floats(lower, "Plane, lower corner", (3,), error=WorkspaceError, one=True))
    high = np.array(as_floats(upper, "Plane, upper corner", (3,), error=WorkspaceError, one=True))
    at = float(as_floats(at, "Plane, at (m)", (), error=WorkspaceError, one=True))
    low["xyz".index(normal)] = high["xyz".index(normal)] = at
    return box_grid(low, high, step)


def axis_points(low: float, high: float, step: float, name: str = "") -> FloatArray:
    """Coordinates low, low + step, ... up to high (included where it falls on a step)."""
    if not np.isfinite([low, high, step]).all() or step <= 0:
        raise WorkspaceError(
            f"Grid: axis {name} needs finite ends and a step above zero, found {low:g}:{high:g}:{step:g}."
        )
    if high < low:
        raise WorkspaceError(f"Grid: axis {name} ends ({high:g}) before it begins ({low:g}).")
    count = int(np.floor((high - low) / step + 1e-9)) + 1
    if count > LARGEST_AXIS:
        raise WorkspaceError(
            f"Grid: axis {name} would have {format_count(count)} points; at most "
            f"{format_count(LARGEST_AXIS)}, so use a larger step."
        )
    return low + step * np.arange(count, dtype=np.float64)
