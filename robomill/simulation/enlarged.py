"""The machined surface as a picture needs it: the displacement enlarged, the error told truly, the cut so far."""

from dataclasses import dataclass, replace

import numpy as np

from robomill.arrays import FloatArray
from robomill.cutting.tooling import Tooling
from robomill.simulation.painted import true_error, wall_error
from robomill.simulation.result import SimulationResult
from robomill.surface.stock import stock_grid
from robomill.surface.zmap import ZMap, cut

PICTURE_CELLS = 160_000


@dataclass(frozen=True, eq=False)
class Enlarged:
    """The machined surface with the deflection enlarged ``times`` times, beside the ideal one, on a grid for pictures.

    ``error`` (nx, ny) m is the true signed error at each cell: of a floor in height, of a wall sideways. NaN where
    nothing was cut. ``wall`` (nx, ny) m is that of the wall which a cell stands beside, above it or below; NaN where
    none stands.
    """

    ideal: ZMap
    drawn: ZMap
    error: FloatArray
    wall: FloatArray
    times: float


def enlarged(
    result: SimulationResult, times: float, cells: int = PICTURE_CELLS, *, must_touch: bool = True
) -> Enlarged:
    """Cut again with the tip ``times`` times as far off its path; ``times`` = 1 is the machined surface itself.

    The grid has about ``cells`` cells, or those of the set-up where these are fewer. Raises SurfaceError for a cell
    size that does not fit and (``must_touch``) for a path that misses the stock.
    """
    setup, path = result.setup, result.path
    size = setup.stock_block.upper - setup.stock_block.lower
    cell = max(setup.cell, float(np.sqrt(size[0] * size[1] / cells)))

    def at(p: FloatArray, touches: bool = False) -> ZMap:
        return cut(setup.stock_block, cell, result.tooling, p, path.k, result.removes, must_touch=touches)

    stock_grid(setup.stock_block, setup.cell)  # the surface itself must fit, not just its picture
    touches = must_touch and bool(result.removes.any()) and not result.not_judged.any()
    ideal, drawn = at(path.p, touches), at(tips(result, times))
    aside = at(np.column_stack([tips(result, times)[:, :2], path.p[:, 2]]))
    error = true_error(result, ideal, drawn, aside, times or 1.0)
    error = np.where(ideal.cut_mask | drawn.cut_mask, error, np.nan)
    return Enlarged(ideal, drawn, error, wall_error(result, drawn, times), times)


def so_far(result: SimulationResult, shown: Enlarged, index: int) -> Enlarged:
    """``shown`` as it stands once sample ``index`` is reached; what is not cut yet carries no error."""
    setup, path = result.setup, result.path
    if index < 1 or not result.removes[1 : index + 1].any():
        heights = np.broadcast_to(shown.ideal.z_stock, shown.ideal.z.shape)
        nothing = np.full(heights.shape, np.nan)
        return replace(shown, drawn=replace(shown.drawn, z=heights), error=nothing, wall=nothing)
    upto = slice(0, index + 1)

    def at(p: FloatArray) -> ZMap:
        return cut(
            setup.stock_block,
            shown.drawn.cell,
            Tooling(result.tooling.cutters, result.tooling.of_step[upto]),
            p[upto],
            path.k[upto],
            result.removes[upto],
            must_touch=False,
        )

    drawn, told = at(tips(result, shown.times)), at(path.p)
    done = (drawn.z == shown.drawn.z) & (told.z == shown.ideal.z)
    error, wall = (np.where(done, each, np.nan) for each in (shown.error, shown.wall))
    return replace(shown, drawn=drawn, error=error, wall=wall)


def tips(result: SimulationResult, times: float) -> FloatArray:
    """(m, 3) m in {W}: where the tip goes with its displacement ``times`` times enlarged; NaN where it is not known."""
    return np.asarray(result.path.p + times * (result.p_machined - result.path.p))


def tip_drawn(result: SimulationResult, shown: Enlarged, index: int) -> FloatArray:
    """(3,) m in {W}: the tool's tip at sample ``index`` as the picture shows it, its displacement enlarged."""
    p = result.path.p[index]
    moved = shown.times * (result.p_machined[index] - p)
    return np.asarray(p + np.where(np.isfinite(moved), moved, 0.0))
