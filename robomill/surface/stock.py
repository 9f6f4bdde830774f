"""The block of material before the cut: a box in {W}, or a solid read from a mesh."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from robomill import budgets
from robomill.arguments import asked
from robomill.arrays import FloatArray, as_floats, frozen
from robomill.cutting.tool import Cutter
from robomill.errors import SurfaceError
from robomill.lazy import cached_property
from robomill.provenance import Finding
from robomill.quantities import quantity, settle
from robomill.spelled import in_units, made
from robomill.toolpath.path import Toolpath
from robomill.units import format_count, format_many, format_short, format_si
from robomill.values import Value

AXES = "XYZ"
BESIDE, BENEATH, ABOVE = 2e-3, 5e-3, 1e-3  # m: what a block round a path has beyond what is cut
LEAST = 0.5e-3  # m: what is smaller was certainly given in another unit
SMALLEST, LARGEST = 2e-3, 5.0  # m: a part outside these was probably given in another unit
WIDEST = 20.0  # m: hardly a part goes as far from its zero: was it meant in mm?


@in_units(SurfaceError, "Stock")
@dataclass(frozen=True, eq=False, repr=False)
class Stock(Value):
    """A block in {W}: ``lower`` and ``upper`` corner, (3,) m, or ``lower_mm`` and ``upper_mm``.

    ``triangles`` (t, 3, 3) m, if given, is a closed mesh inside those corners; its upper skin is the stock's top.
    Raises SurfaceError for corners the wrong way round or a block without extent.

    Examples
    --------
    >>> import robomill as rm
    >>> rm.Stock(lower_mm=(-10, -20, -10), upper_mm=(110, 20, 0))
    <Stock 120.00 x 40.00 x 10.00 mm, lower corner at -10.00, -20.00, -10.00 mm>
    """

    lower: FloatArray = quantity("from", "mm", shape=(3,), axes=AXES, digits=2, slip=WIDEST)
    upper: FloatArray = quantity("to", "mm", shape=(3,), axes=AXES, digits=2, slip=WIDEST)
    triangles: FloatArray | None = None

    if TYPE_CHECKING:

        def __init__(
            self,
            lower: ArrayLike = ...,
            upper: ArrayLike = ...,
            triangles: ArrayLike | None = ...,
            *,
            lower_mm: ArrayLike = ...,
            upper_mm: ArrayLike = ...,
        ) -> None: ...

    def __post_init__(self) -> None:
        settle(self, SurfaceError, "Stock")
        for name, a, b in zip(AXES, self.lower, self.upper, strict=True):
            if not b - a > 1e-9:
                found = f"{format_si(a, 'mm')} to {format_si(b, 'mm')}"
                raise SurfaceError(f"Stock in {name}: found {found}; the upper end must lie above the lower end.")
        if self.triangles is None and self.size.max() < LEAST:
            size = format_many(self.size, "mm", 3, between=" × ")
            raise SurfaceError(
                f"Stock: the block is {size}, less than any part: was it meant in m? Then give lower and upper.",
                where="lower",
            )
        if self.triangles is not None:
            triangles = as_floats(self.triangles, "stock mesh", (None, 3, 3), error=SurfaceError)
            object.__setattr__(self, "triangles", frozen(triangles))

    @classmethod
    @asked
    def around(cls, path: Toolpath, cutter: Cutter) -> Stock:
        """The block around what ``path`` cuts, with a margin beside and beneath.

        Its top is z = 0 if the path goes below (part zero on the top face), else above the highest point.
        """
        low, high = path.extents
        reach = cutter.radius + BESIDE
        top = 0.0 if low[2] < -1e-9 else float(high[2]) + ABOVE
        corners = np.array([*(low[:2] - reach), low[2] - BENEATH]), np.array([*(high[:2] + reach), top])
        return made(cls, dict(zip(("lower", "upper"), corners, strict=True)))

    @cached_property
    def size(self) -> FloatArray:
        """(3,) m."""
        return self.upper - self.lower

    def _said(self) -> str:
        mesh = "" if self.triangles is None else f", solid of {format_count(len(self.triangles), 'triangle')}"
        size, lower = format_many(self.size, "mm", 2, between=" × "), format_many(self.lower, "mm", 2)
        return f"{size}, lower corner at {lower}{mesh}"

    def _facts(self) -> list[tuple[str, str]]:
        corners = (("Lower corner", self.lower), ("Upper corner", self.upper), ("Size", self.size))
        return [(name, format_many(p, "mm", 2)) for name, p in corners]

    @asked
    def warnings(self, cutter: Cutter) -> tuple[Finding, ...]:
        """What is odd about this stock with this cutter."""
        found = []
        longest = float(self.size.max())
        if not SMALLEST <= longest <= LARGEST:
            text = f"Stock: the block is {format_si(longest, 'mm', 2)} long; check the unit of its numbers."
            found.append(Finding("suspicious", text, code="stock-unit"))
        width = float(self.size[:2].min())
        if cutter.diameter > width:
            text = (
                f"Stock: the cutter ({format_si(cutter.diameter, 'mm')}) is wider than the block"
                f" ({format_si(width, 'mm')}); no groove with two walls can be left."
            )
            found.append(Finding("warning", text, code="wide-cutter"))
        return tuple(found)


class Cells(NamedTuple):
    """Cells that fill the plan of a stock exactly: how many, the centre of cell [0, 0] and the size of one, m."""

    nx: int
    ny: int
    x0: float
    y0: float
    dx: float
    dy: float

    @property
    def x(self) -> FloatArray:
        """(nx,) m: centres along X."""
        return frozen(self.x0 + np.arange(self.nx) * self.dx)

    @property
    def y(self) -> FloatArray:
        """(ny,) m: centres along Y."""
        return frozen(self.y0 + np.arange(self.ny) * self.dy)


def stock_grid(stock: Stock, cell: float, budget: int | None = None) -> Cells:
    """Cells of a height map over ``stock``, none larger than ``cell`` (m).

    Raises SurfaceError for a cell size that is not positive, or that needs more than ``budget`` cells (None: what
    the memory holds), naming the size that fits.
    """
    if not (np.isfinite(cell) and cell > 0):
        raise SurfaceError(f"Cell size: found {cell}; expected a length above 0, e.g. 0.1 mm.")
    length, width = float(stock.size[0]), float(stock.size[1])
    along, across = (max(1.0, float(np.ceil(side / cell - 1e-6))) for side in (length, width))
    budget = budgets.cells() if budget is None else budget
    if not along * across <= budget:
        fits, needed = fitting_cell(length, width, budget), along * across
        raise SurfaceError(
            f"Cell size: {format_short(cell, 'mm', 4)} needs {needed / 1e6:.4g} million cells for this stock; at most"
            f" {budget / 1e6:.4g} million fit, so use {format_si(fits, 'mm', 4)} or more."
        )
    nx, ny = int(along), int(across)
    dx, dy = length / nx, width / ny
    return Cells(nx, ny, float(stock.lower[0]) + 0.5 * dx, float(stock.lower[1]) + 0.5 * dy, dx, dy)


def cells_about(cells: Cells, low: FloatArray, high: FloatArray) -> Cells:
    """Those of some cells that lie between two corners in plan, low and high (2,) m, and two more on every side; at
    least one."""
    first, last = (
        np.floor((corner - (cells.x0, cells.y0)) / (cells.dx, cells.dy)).astype(int) + more
        for corner, more in ((low, -1), (high, 2))
    )
    i, j = (int(n) for n in np.clip(first, 0, (cells.nx - 1, cells.ny - 1)))
    a, b = (int(n) for n in np.clip(last, (i, j), (cells.nx - 1, cells.ny - 1)))
    x0, y0 = cells.x0 + i * cells.dx, cells.y0 + j * cells.dy
    return Cells(a - i + 1, b - j + 1, x0, y0, cells.dx, cells.dy)


def fitting_cell(length: float, width: float, budget: int) -> float:
    """The smallest cell (m), rounded up to 0.1 um, whose cells over length x width stay within ``budget``."""
    cell = np.ceil(np.sqrt(length * width / budget) * 1e7) / 1e7
    while np.ceil(length / cell - 1e-6) * np.ceil(width / cell - 1e-6) > budget:
        cell = max(cell * 1.001, cell + 1e-7)
    return float(np.ceil(cell * 1e7 - 1e-3) / 1e7)


def stock_span(stock: Stock, centre: FloatArray, normal: FloatArray) -> tuple[float, float]:
    """Where the line centre + w normal lies over the stock: (low, high) m, low > high if nowhere."""
    low, high = -np.inf, np.inf
    for axis in range(2):
        a, b = stock.lower[axis] - centre[axis], stock.upper[axis] - centre[axis]
        if abs(normal[axis]) < 1e-12:
            if a > 0 or b < 0:
                return 1.0, -1.0
            continue
        a, b = sorted((a / normal[axis], b / normal[axis]))
        low, high = max(low, a), min(high, b)
    return float(low), float(high)
