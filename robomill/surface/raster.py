"""Heights of a closed mesh over a grid: its upper skin, and how many layers lie above each point."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from robomill.arrays import FloatArray, IntArray
from robomill.surface.stock import Stock


def stock_heights(stock: Stock, x: FloatArray, y: FloatArray) -> FloatArray:
    """Height of the stock before the cut, m: one number (0-d) for a block, (nx, ny) for a mesh.

    Where a mesh has no material the height is the stock's lower face.
    """
    if stock.triangles is None:
        return np.array(float(stock.upper[2]))
    top, _ = skin(stock.triangles, x, y)
    return np.where(np.isfinite(top), top, float(stock.lower[2]))


def skin(triangles: FloatArray, x: FloatArray, y: FloatArray) -> tuple[FloatArray, IntArray]:
    """Upper skin (nx, ny) m of triangles (t, 3, 3) over grid points, -inf where there is none, and layers crossed.

    A point on an edge shared by two triangles counts for one of them only (points are nudged off the edges).
    """
    top = np.full((len(x), len(y)), -np.inf)
    layers = np.zeros(top.shape, dtype=np.int64)
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
        inside = (u >= 0) & (v >= 0) & (u + v <= 1)
        height = triangles[n, 0, 2] + u * e1[n, 2] + v * e2[n, 2]
        top[rows, columns] = np.where(inside, np.maximum(top[rows, columns], height), top[rows, columns])
        layers[rows, columns] += inside
    return top, layers


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
