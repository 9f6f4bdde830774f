"""How much of the cutter is in the material, step by step, from the stock as it stands before each step.

Angles count clockwise from the feed-normal +y (left of the feed), seen from above with x along the feed: 0 is the
left side, 90 degrees straight ahead, 180 the right side, as in the mean-force formulas. A step's engagement is
taken at its middle, so the path should be resampled first. The material is looked up just ahead of the rim, a
little inside its sides; the error is of the order of one cell across the feed.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from robomill.arrays import FloatArray, as_floats, frozen
from robomill.cutting.tool import Cutter
from robomill.errors import SurfaceError
from robomill.surface.passes import check_rise, leaning, moves_at_feed, tool_axes
from robomill.surface.raster import stock_heights
from robomill.surface.stock import Stock, stock_grid


@dataclass(frozen=True)
class Engagement:
    """Engagement of each step (m,); entry i belongs to the move p[i-1] -> p[i]; all zero in air, on rapids and
    where the feed is along the tool axis: there is no arc then.

    phi_st, phi_ex  rad  where the arc in contact begins and ends
    a_p             m    axial depth, the mean over that arc (gaps in it count as zero)
    a_e             m    radial width: the part of the cutter's width that meets material
    """

    phi_st: FloatArray
    phi_ex: FloatArray
    a_p: FloatArray
    a_e: FloatArray


def engage(
    stock: Stock,
    cell: float,
    cutter: Cutter,
    p: ArrayLike,
    k: ArrayLike | None = None,
    cutting: ArrayLike | None = None,
) -> Engagement:
    """March a path p (m, 3) m through the stock and return the engagement of each step.

    k (3,) or (m, 3) unit tool axis (default: upright), cutting (m,) bool. Steps with an end that is not finite cut
    nothing. Raises SurfaceError for a cell size that does not fit and a tool axis too close to level.
    """
    from robomill.surface.cells_kernels import Heights, Hidden
    from robomill.surface.engagement_kernels import engage_moves
    from robomill.surface.envelope_kernels import cutter_shape
    from robomill.surface.tilt_kernels import TiltedMoves, plan_boxes

    cells = stock_grid(stock, cell)
    points = as_floats(p, "toolpath points", (None, 3), error=SurfaceError, finite=False)
    axes, result = tool_axes(k, len(points)), np.zeros((len(points), 4))
    used = moves_at_feed(points, cutting)
    used[1:] &= np.isfinite(points[1:]).all(axis=1) & np.isfinite(points[:-1]).all(axis=1)
    n = np.flatnonzero(used)
    check_rise(axes[n])
    ends, middle = np.hstack([points[n - 1], points[n]]), axes[n - 1] + axes[n]
    middle /= np.linalg.norm(middle, axis=1, keepdims=True)
    z = np.empty((cells.nx, cells.ny))
    z[...] = stock_heights(stock, cells.x, cells.y)
    boxes, found = np.empty((len(n), 4)), np.zeros((len(n), 4))
    plan_boxes(cutter.radius, ends, middle, float(z.max()), boxes)
    voids = z.shape if leaning(middle).any() else (1, 1)
    hidden = Hidden(np.full(voids, np.inf), np.full(voids, -np.inf))
    tile = Heights(z, cells.x0, cells.y0, cells.dx, cells.dy)
    engage_moves(cutter_shape(cutter), TiltedMoves(ends, middle, boxes), tile, hidden, float(stock.lower[2]), found)
    result[n] = found
    return Engagement(*(frozen(result[:, column]) for column in range(4)))
