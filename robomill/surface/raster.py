"""Heights of a closed mesh over a grid: its upper skin, and how many layers lie above each point."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING

import numpy as np

from robomill.arrays import FloatArray, IntArray
from robomill.surface.stock import Cells, Stock

if TYPE_CHECKING:
    from robomill.surface.contact.material_kernels import Facets
    from robomill.surface.contact.relief_kernels import Relief

SQUARES = 64  # along the longer side of a mesh
RELIEF, MARGIN = 0.2, 0.12  # of the radius: the side of a square of the relief, and how far about it its bounds hold
MOST_OF_RELIEF = 1000  # squares along a side


def stock_heights(stock: Stock, x: FloatArray, y: FloatArray) -> FloatArray:
    """Height of the stock before the cut, m: one number (0-d) for a block, (nx, ny) for a mesh.

    Where a mesh has no material the height is the stock's lower face.
    """
    if stock.triangles is None:
        return np.array(float(stock.upper[2]))
    top, _ = skin(stock.triangles, x, y)
    return np.where(np.isfinite(top), top, float(stock.lower[2]))


def skin(triangles: FloatArray, x: FloatArray, y: FloatArray) -> tuple[FloatArray, IntArray]:
    """Upper skin (nx, ny) m of triangles (t, 3, 3) over grid points, -inf where there is none, and layers crossed."""
    top = np.full(len(x) * len(y), -np.inf)
    cell, z = crossings(triangles, x, y)
    np.maximum.at(top, cell, z)
    layers = np.bincount(cell, minlength=len(top))
    return top.reshape(len(x), len(y)), layers.reshape(len(x), len(y))


def crossings(triangles: FloatArray, x: FloatArray, y: FloatArray) -> tuple[IntArray, FloatArray]:
    """Where upright lines through grid points cross triangles (t, 3, 3): flat cell numbers (c,) and heights (c,) m.

    A point on an edge shared by two triangles counts for one of them only (points are nudged off the edges).
    """
    cells, heights = [np.zeros(0, dtype=np.int64)], [np.zeros(0)]
    nudge = 1e-9
    x, y = x + nudge * 0.7548776662466927, y + nudge * 0.5698402909980532
    low, high = triangles[:, :, :2].min(axis=1), triangles[:, :, :2].max(axis=1)
    i_low, i_high = np.searchsorted(x, low[:, 0]), np.searchsorted(x, high[:, 0], side="right")
    j_low, j_high = np.searchsorted(y, low[:, 1]), np.searchsorted(y, high[:, 1], side="right")
    e1, e2 = triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0]
    area = e1[:, 0] * e2[:, 1] - e1[:, 1] * e2[:, 0]
    for n in np.flatnonzero((i_high > i_low) & (j_high > j_low) & (area != 0.0)):
        rows, columns = slice(i_low[n], i_high[n]), slice(j_low[n], j_high[n])
        X, Y = (x[rows] - triangles[n, 0, 0])[:, None], (y[columns] - triangles[n, 0, 1])[None, :]
        u = (X * e2[n, 1] - Y * e2[n, 0]) / area[n]
        v = (Y * e1[n, 0] - X * e1[n, 1]) / area[n]
        i, j = np.nonzero((u >= 0) & (v >= 0) & (u + v <= 1))
        cells.append((i + i_low[n]) * len(y) + j + j_low[n])
        heights.append(triangles[n, 0, 2] + u[i, j] * e1[n, 2] + v[i, j] * e2[n, 2])
    return np.concatenate(cells), np.concatenate(heights)


def stock_layers(stock: Stock, cells: Cells, spare: int = 0) -> tuple[FloatArray, Facets]:
    """The material of a stock over cells and its mesh: heights (nx, ny, n) m where it begins and ends, top down.

    A block is one layer down to its bottom, and needs no lower end if no room for others is wanted (``spare`` layers);
    -inf and inf where there are no more layers. Crossings of a mesh that do not pair (an open mesh) reach down to the
    bottom.
    """
    from robomill.surface.contact.material_kernels import Facets

    shape, bottom = (cells.nx, cells.ny), float(stock.lower[2])
    if stock.triangles is None:
        ends = [float(stock.upper[2]), bottom, *[-np.inf, np.inf] * spare] if spare else [float(stock.upper[2])]
        heights = np.full((*shape, len(ends)), ends)
        nothing = np.zeros(0, dtype=np.int64)
        return heights, Facets(np.zeros((0, 3, 3)), nothing, nothing, 1.0)
    cell, z = crossings(stock.triangles, cells.x, cells.y)
    order = np.lexsort((-z, cell))
    cell, z = cell[order], z[order]
    number = np.arange(len(cell)) - np.searchsorted(cell, cell)
    layers = max(1, (int(number.max(initial=0)) + 2) // 2) + spare
    heights = np.full((cells.nx * cells.ny, 2 * layers), [-np.inf, np.inf] * layers)
    heights[cell[number % 2 == 0], number[number % 2 == 0] + 1] = bottom
    heights[cell, number] = z
    return heights.reshape(*shape, -1), binned(stock)


def relief_of(stock: Stock, radius: float) -> Relief:
    """Squares over a stock for cutters of up to this ``radius`` m: a block is full up to its top, of a mesh it is known
    only that nothing stands above it."""
    from robomill.surface.contact.relief_kernels import Relief

    many = np.clip(np.round(stock.size[:2] / (RELIEF * radius)), 1, MOST_OF_RELIEF).astype(np.int64)
    top = float(stock.upper[2])
    tops = np.full((*many, 3), [top if stock.triangles is None else -np.inf, top, 0.0])
    (x, y, bottom), (per_x, per_y) = map(float, stock.lower), map(float, many / stock.size[:2])
    return Relief(tops, x, y, per_x, per_y, MARGIN * radius, bottom)


def binned(stock: Stock) -> Facets:
    """A mesh with its triangles sorted into squares of its plan, so that few are asked of one point."""
    from robomill.surface.contact.material_kernels import Facets

    triangles = np.array(stock.triangles)
    size = float(stock.size[:2].max()) / SQUARES
    rows, columns = (int(side / size) + 1 for side in stock.size[:2])
    low, high = (
        np.floor((ends - stock.lower[:2]) / size).astype(np.int64).clip(0, [rows - 1, columns - 1])
        for ends in (triangles[:, :, :2].min(axis=1) - 1e-9, triangles[:, :, :2].max(axis=1) + 1e-9)
    )
    squares: list[list[int]] = [[] for _ in range(rows * columns)]
    for n, ((i, j), (i_end, j_end)) in enumerate(zip(low, high, strict=True)):
        for a in range(i, i_end + 1):
            for b in range(a * columns + j, a * columns + j_end + 1):
                squares[b].append(n)
    first = np.cumsum([0, *map(len, squares)], dtype=np.int64)
    return Facets(triangles, first, np.array([n for square in squares for n in square], dtype=np.int64), size)


def skin_on_line(stock: Stock, centre: FloatArray, normal: FloatArray) -> Callable[[FloatArray], FloatArray]:
    """Function w (q,) -> height of the stock before the cut (q,) m over the line centre + w normal in plan.

    A vertical plane cuts each triangle of a mesh in a straight piece; the skin is the highest of them.
    """
    bottom = float(stock.lower[2])
    if stock.triangles is None:
        top = float(stock.upper[2])
        return lambda w: np.full(np.shape(w), top)
    feed = np.array([normal[1], -normal[0]])
    plan = stock.triangles[:, :, :2] - centre[:2]
    side, along = plan @ feed, plan @ normal[:2]
    crossed = (side.min(axis=1) <= 0) & (side.max(axis=1) > 0)
    side, along, z = side[crossed], along[crossed], stock.triangles[crossed, :, 2]
    ends = []
    for i, j in ((0, 1), (1, 2), (2, 0)):
        meets = (side[:, i] <= 0) != (side[:, j] <= 0)
        share = np.where(meets, side[:, i] / np.where(meets, side[:, i] - side[:, j], 1.0), np.nan)
        ends.append(np.stack([q[:, i] + share * (q[:, j] - q[:, i]) for q in (along, z)], axis=1))
    pieces = np.stack(ends, axis=1)
    w_low, w_high = np.nanmin(pieces[:, :, 0], axis=1), np.nanmax(pieces[:, :, 0], axis=1)
    order = np.argsort(np.where(np.isnan(pieces[:, :, 0]), np.inf, pieces[:, :, 0]), axis=1)
    z_low, z_high = (np.take_along_axis(pieces[:, :, 1], order[:, n : n + 1], axis=1)[:, 0] for n in (0, 1))
    upright = w_high - w_low < 1e-12
    span = np.where(upright, 1.0, w_high - w_low)

    def height(w: FloatArray) -> FloatArray:
        inside = (w >= w_low[:, None]) & (w <= w_high[:, None])
        slope = np.where(upright, 0.0, (z_high - z_low) / span)[:, None]
        level = np.where(upright, np.maximum(z_low, z_high), z_low)[:, None]
        return np.where(inside, level + slope * (w - w_low[:, None]), bottom).max(axis=0, initial=bottom)

    return height
