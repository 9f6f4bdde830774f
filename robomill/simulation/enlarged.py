"""The machined surface as a picture needs it: the displacement enlarged, the error told truly, the cut so far."""

from dataclasses import dataclass, replace

import numpy as np

from robomill.arrays import BoolArray, FloatArray, IntArray
from robomill.cutting.tooling import Tooling
from robomill.simulation.result import SimulationResult
from robomill.surface.stock import stock_grid
from robomill.surface.zmap import ZMap, cut

PICTURE_CELLS = 160_000


@dataclass(frozen=True, eq=False)
class Enlarged:
    """The machined surface with the deflection enlarged ``times`` times, beside the ideal one, on a grid for pictures.

    ``error`` (nx, ny) m is the true signed error at each cell: of a floor in height, of a wall sideways. NaN where
    nothing was cut.
    """

    ideal: ZMap
    drawn: ZMap
    error: FloatArray
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

    def at(factor: float) -> ZMap:
        p = tips(result, factor)
        touches = must_touch and factor == 0.0 and bool(result.removes.any()) and not result.not_judged.any()
        return cut(setup.stock_block, cell, result.tooling, p, path.k, result.removes, must_touch=touches)

    stock_grid(setup.stock_block, setup.cell)  # the surface itself must fit, not just its picture
    ideal, drawn = at(0.0), at(times)
    error = _true_error(result, ideal, drawn, times or 1.0)
    return Enlarged(ideal, drawn, np.where(ideal.cut_mask | drawn.cut_mask, error, np.nan), times)


def _true_error(result: SimulationResult, ideal: ZMap, drawn: ZMap, times: float) -> FloatArray:
    """True signed error (nx, ny) m, told by a picture, enlarged or not: one law of colour at every exaggeration.

    Where the heights differ by no more than the enlarged path rises or sinks it is an error of height. Where they
    differ by more a wall has moved, by as much as the tip did sideways at the nearest sample: material is left beside
    the commanded path (+) and cut away beside the deflected one (-). Where the enlarged path leaves the stock, the
    floor is as much too high as the nearest sample.
    """
    from scipy.spatial import cKDTree

    error = (drawn.z - ideal.z) / times
    i = np.flatnonzero(result.judged)
    if not len(i):
        return error
    told, moved = result.path.p[i], (result.p_machined - result.path.p)[i]
    aside, slack = np.linalg.norm(moved[:, :2], axis=1), drawn.cell / times
    far = (error > 1.02 * max(moved[:, 2].max(), 0.0) + slack) | (error < 1.02 * min(moved[:, 2].min(), 0.0) - slack)
    x, y = np.meshgrid(drawn.x, drawn.y, indexing="ij")

    def nearest(cells: BoolArray, points: FloatArray) -> IntArray:
        return np.asarray(cKDTree(points[:, :2]).query(np.column_stack([x[cells], y[cells]]))[1])

    for sign, points in ((1.0, told), (-1.0, told + times * moved)):
        cells = far & (np.sign(error) == sign)
        if cells.any():
            error[cells] = sign * aside[nearest(cells, points)]
    out = ideal.cut_mask & ~drawn.cut_mask
    if out.any():
        up = moved[nearest(out, told), 2]
        error[out] = np.where(times * up > (drawn.z - ideal.z)[out], up, error[out])
    return error


def so_far(result: SimulationResult, shown: Enlarged, index: int) -> Enlarged:
    """``shown`` as it stands once sample ``index`` is reached; what is not cut yet carries no error."""
    setup, path = result.setup, result.path
    if index < 1 or not result.removes[1 : index + 1].any():
        heights = np.broadcast_to(shown.ideal.z_stock, shown.ideal.z.shape)
        return replace(shown, drawn=replace(shown.drawn, z=heights), error=np.full(heights.shape, np.nan))
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
    return replace(shown, drawn=drawn, error=np.where(done, shown.error, np.nan))


def tips(result: SimulationResult, times: float) -> FloatArray:
    """(m, 3) m in {W}: where the tip goes with its displacement ``times`` times enlarged; NaN where it is not known."""
    return np.asarray(result.path.p + times * (result.p_machined - result.path.p))


def tip_drawn(result: SimulationResult, shown: Enlarged, index: int) -> FloatArray:
    """(3,) m in {W}: the tool's tip at sample ``index`` as the picture shows it, its displacement enlarged."""
    p = result.path.p[index]
    moved = shown.times * (result.p_machined[index] - p)
    return np.asarray(p + np.where(np.isfinite(moved), moved, 0.0))
