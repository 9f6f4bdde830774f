"""Moves that must not cut and do: made in the order of the program, each meets what the feed moves before it left."""

from typing import NamedTuple

import numpy as np

from robomill.arrays import BoolArray
from robomill.cutting.tooling import Tooling
from robomill.progress import slices
from robomill.surface.passes import Passes, at_one_axis
from robomill.surface.raster import stock_heights
from robomill.surface.removal import rows_of_tile, tiles
from robomill.surface.stock import Stock, stock_grid


class Met(NamedTuple):
    """Which moves (n,) bool run through material: what no move at feed before them removed, and what none ever does."""

    early: BoolArray
    never: BoolArray


def collisions(stock: Stock, cell: float, tooling: Tooling, moves: Passes, made: tuple[BoolArray, BoolArray]) -> Met:
    """What ``moves`` (n,) meet that are not meant to cut.

    ``made`` is (feed, asked), (n,) bool each: those that cut, and those that are asked about; others are not made.
    Ends and axes finite. ``tooling`` says which cutter makes each. Told at the centres of cells of about ``cell`` m,
    where heights are exact.
    """
    from robomill.surface.cells_kernels import Heights
    from robomill.surface.collision_kernels import Program, make_in_order
    from robomill.surface.tilt_kernels import TiltedMoves, plan_boxes

    n = np.flatnonzero(made[0] | made[1])
    widest, top = max(cutter.radius for cutter in tooling.cutters), float(stock.upper[2])
    ends, axes, owner = at_one_axis(Passes(moves.ends[n], moves.axes[n]), widest, cell)
    boxes = np.empty((len(ends), 4))
    plan_boxes(widest, ends, axes, top, boxes)
    feed = made[0][n][owner]
    deepest = np.minimum(ends[:, 2], ends[:, 5]) - widest * np.hypot(axes[:, 0], axes[:, 1])
    over = (boxes[:, ::2] <= stock.upper[:2]).all(axis=1) & (boxes[:, 1::2] >= stock.lower[:2]).all(axis=1)
    if feed[over & (deepest < top)].all():
        return Met(*np.zeros((2, len(made[0])), dtype=bool))
    cells = stock_grid(stock, cell)
    z = np.empty((cells.nx, cells.ny))
    z[...] = stock_heights(stock, cells.x, cells.y)
    shapes = np.array([cutter.solid for cutter in tooling.cutters], dtype=np.float64)
    program = Program(shapes, np.array(tooling.of_step[n][owner]), feed.astype(np.int64))
    tilted = TiltedMoves(ends, axes, boxes)
    early, left = np.zeros((2, len(owner)), dtype=np.int64)
    for i, chosen in tiles(z.shape, cells, boxes[:, 0], boxes[:, 1]):
        if feed[chosen].all():
            continue
        tile = Heights(z[i : i + rows_of_tile(z.shape)], cells.x0 + i * cells.dx, cells.y0, cells.dx, cells.dy)
        for some in slices(len(chosen), "Rapids"):
            make_in_order(program, tilted, chosen[some], tile, early)
        # Once more, when all is cut.
        make_in_order(program, tilted, chosen[early[chosen] > 0], tile, left)
    return Met(*(np.isin(np.arange(len(made[0])), n[owner[met > 0]]) for met in (early, left)))
