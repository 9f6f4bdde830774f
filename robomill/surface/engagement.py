"""How much of the cutter is in the material, step by step, from the stock as it stands before each step.

Angles count clockwise from the feed-normal +y (left of the feed), seen from above with x along the feed: 0 is the
left side, 90 degrees straight ahead, 180 the right side, as in the mean-force formulas. A step's engagement is
taken at its middle, so the path should be resampled first. The material is looked up just ahead of the rim, a
little inside its sides; the error is of the order of one cell across the feed.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from robomill.arrays import BoolArray, FloatArray, as_floats, frozen
from robomill.cutting.tool import Cutter
from robomill.errors import SurfaceError
from robomill.surface import envelope, tilted
from robomill.surface.compiler import Engine, kernels
from robomill.surface.envelope import Shape, cutter_shape
from robomill.surface.raster import stock_heights
from robomill.surface.removal import Cancel, Grid, Progress, Watch, box_of, numpy_seconds
from robomill.surface.stock import Stock, stock_grid

ANGLES = 180
ALONG_AXIS = 0.98
UPRIGHT = 1e-9
CHUNK = 2_000


@dataclass(frozen=True)
class Engagement:
    """Engagement of each step (m,); entry i belongs to the move p[i-1] -> p[i]; all zero in air and on rapids.

    phi_st, phi_ex  rad  where the arc in contact begins and ends
    a_p             m    axial depth, the mean over that arc (gaps in it count as zero)
    a_e             m    radial width: the part of the cutter's width that meets material
    plunge          bool feed along the tool axis: there is no arc, the side-milling formulas do not hold
    """

    phi_st: FloatArray
    phi_ex: FloatArray
    a_p: FloatArray
    a_e: FloatArray
    plunge: BoolArray


def engage(
    stock: Stock,
    cell: float,
    cutter: Cutter,
    p: ArrayLike,
    k: ArrayLike | None = None,
    cutting: ArrayLike | None = None,
    *,
    progress: Progress | None = None,
    cancel: Cancel | None = None,
    engine: Engine = "auto",
) -> Engagement:
    """March a path p (m, 3) m through the stock and return the engagement of each step.

    k (3,) or (m, 3) unit tool axis (default: upright), cutting (m,) bool. Steps with an end that is not finite cut
    nothing. Raises SurfaceError for a cell size that does not fit or a cancelled run.
    """
    nx, ny, dx, dy = stock_grid(stock, cell)
    grid = Grid(float(stock.lower[0]) + 0.5 * dx, float(stock.lower[1]) + 0.5 * dy, dx, dy)
    points = as_floats(p, "toolpath points", (None, 3), error=SurfaceError, finite=False)
    m = len(points)
    axes = tilted.tool_axes(k, m)
    used = np.ones(m, dtype=bool) if cutting is None else np.array(cutting, dtype=bool)
    used[0] = False
    used[1:] &= np.isfinite(points[1:]).all(axis=1) & np.isfinite(points[:-1]).all(axis=1)
    if (axes[used, 2] < tilted.SMALLEST_RISE).any():
        raise SurfaceError(f"Tool axis: its upward part must be at least {tilted.SMALLEST_RISE} for a height map.")
    z = np.empty((nx, ny))
    x, y = frozen(grid.x0 + np.arange(nx) * dx), frozen(grid.y0 + np.arange(ny) * dy)
    z[...] = stock_heights(stock, x, y)
    result = np.zeros((m, 5))
    shape, bottom = cutter_shape(cutter), float(stock.lower[2])
    steps = np.hstack([points[:-1], points[1:]])[used[1:]]
    leaning = bool((np.hypot(axes[:, 0], axes[:, 1]) > UPRIGHT).any())
    module = kernels(engine, 3e-4 * len(steps) + numpy_seconds(steps, shape.R, grid, leaning))
    watch = Watch(m, progress, cancel)
    for start in range(0, m, CHUNK):
        stop = min(m, start + CHUNK)
        if module is None:
            _march(shape, points, axes, used, grid, z, bottom, result, start, stop)
        else:
            module.engage_moves(tuple(shape), points, axes, used, tuple(grid), z, bottom, ANGLES, result, start, stop)
        watch.advance(stop - start)
    phi_st, phi_ex, a_p, a_e = (frozen(result[:, n]) for n in range(4))
    return Engagement(phi_st, phi_ex, a_p, a_e, frozen(result[:, 4] > 0.0, bool))


def _march(
    shape: Shape,
    points: FloatArray,
    axes: FloatArray,
    used: BoolArray,
    grid: Grid,
    z: FloatArray,
    bottom: float,
    result: FloatArray,
    start: int,
    stop: int,
) -> None:
    for n in range(max(start, 1), stop):
        if used[n]:
            axis = axes[n - 1] + axes[n]
            axis = axis / np.linalg.norm(axis)
            result[n] = step_engagement(shape, points[n - 1], points[n], axis, grid, z, bottom)
            cut_centres(shape, points[n - 1], points[n], axis, grid, z, bottom)


def step_engagement(
    shape: Shape, a: FloatArray, b: FloatArray, k: FloatArray, grid: Grid, z: FloatArray, bottom: float
) -> tuple[float, float, float, float, float]:
    """(phi_st, phi_ex, a_p, a_e, plunge) of one step a -> b with tool axis k in the heights z."""
    feed = b - a
    length = float(np.linalg.norm(feed))
    along = float(feed @ k)
    if length == 0.0 or abs(along) >= ALONG_AXIS * length:
        return 0.0, 0.0, 0.0, 0.0, float(length > 0.0)
    e_x = feed - along * k
    e_x /= np.linalg.norm(e_x)
    e_y = np.cross(k, e_x)
    middle = 0.5 * (a + b)
    look = 0.75 * max(grid.dx, grid.dy)
    phi = (np.arange(ANGLES) + 0.5) * (math.pi / ANGLES)
    r = shape.R
    if shape.kind != envelope.FLAT:
        depth = max(
            float(
                depth_ahead(
                    middle, e_x, e_y, k, radius * np.sin(phi) + look, radius * np.cos(phi), grid, z, bottom
                ).max()
            )
            for radius in (shape.R, 0.5 * shape.R, 0.0)
        )
        if depth <= 0.0:
            return 0.0, 0.0, 0.0, 0.0, 0.0
        r = radius_at(shape, 0.98 * depth)
    aside = (r - look if r > look else 0.0) * np.cos(phi)
    inner = np.maximum(np.abs(aside) - look, 0.0)
    ahead = np.sqrt(np.maximum(r * r - inner * inner, 0.0)) + look
    depth_at = depth_ahead(middle, e_x, e_y, k, ahead, aside, grid, z, bottom)
    touching = np.flatnonzero(depth_at > float(envelope.profile(shape, np.array(r))) + 1e-12)
    if len(touching) == 0:
        return 0.0, 0.0, 0.0, 0.0, 0.0
    first, last = touching[0], touching[-1] + 1
    edges = np.arange(ANGLES + 1) * (math.pi / ANGLES)
    width = r * (np.cos(edges[:-1]) - np.cos(edges[1:]))
    a_p = float(depth_at[touching].sum()) / (last - first)
    return float(edges[first]), float(edges[last]), a_p, float(width[touching].sum()), 0.0


def radius_at(shape: Shape, height: float) -> float:
    """Radius of the cutter ``height`` > 0 above its tip, m."""
    if shape.kind == envelope.FLAT:
        return shape.R
    if shape.kind == envelope.CHAMFER:
        return min(shape.R, shape.r0 + height / shape.slope)
    h = min(height, shape.rc)
    return shape.r0 + math.sqrt(max(0.0, h * (2.0 * shape.rc - h)))


def depth_ahead(
    middle: FloatArray,
    e_x: FloatArray,
    e_y: FloatArray,
    k: FloatArray,
    ahead: FloatArray,
    aside: FloatArray,
    grid: Grid,
    z: FloatArray,
    bottom: float,
) -> FloatArray:
    """Material above points of the tool's tip plane, along the tool axis, m; 0 outside the stock."""
    point = middle + ahead[:, None] * e_x + aside[:, None] * e_y
    i = np.floor((point[:, 0] - grid.x0) / grid.dx + 0.5).astype(int)
    j = np.floor((point[:, 1] - grid.y0) / grid.dy + 0.5).astype(int)
    inside = (i >= 0) & (i < z.shape[0]) & (j >= 0) & (j < z.shape[1])
    height = z[np.where(inside, i, 0), np.where(inside, j, 0)]
    solid = inside & (height > bottom)
    return np.where(solid, np.maximum(height - np.maximum(point[:, 2], bottom), 0.0) / k[2], 0.0)


def cut_centres(
    shape: Shape, a: FloatArray, b: FloatArray, k: FloatArray, grid: Grid, z: FloatArray, bottom: float
) -> None:
    """Cut one step into the heights z at cell centres, in place."""
    if math.hypot(k[0], k[1]) > UPRIGHT:
        moves = tilted.tilted_moves(shape, np.concatenate([a, b])[None], k[None], float(z.max()))
        hidden = np.full(z.shape, np.inf), np.full(z.shape, -np.inf)
        tilted.cut_tilted_move(shape, moves, 0, grid, z, *hidden)
        return
    move = envelope.move_of(a, b)
    box = box_of(z.shape, grid, move, shape.R)
    if box is None:
        return
    rows, columns = box
    x = (grid.x0 + np.arange(rows.start, rows.stop) * grid.dx)[:, None]
    y = (grid.y0 + np.arange(columns.start, columns.stop) * grid.dy)[None, :]
    height, d = envelope.swept_height(shape, move, x, y)
    view = z[rows, columns]
    view[...] = np.where(d >= 0.0, np.minimum(view, np.maximum(height, bottom)), view)
