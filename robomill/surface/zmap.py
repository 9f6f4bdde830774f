"""The part after the cut as a height map: exact heights at cell centres, exact shares of cells at walls."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import ArrayLike

from robomill.arguments import made_by
from robomill.arrays import BoolArray, FloatArray, digest, frozen
from robomill.cutting.tool import Cutter
from robomill.cutting.tooling import Tooling
from robomill.errors import SurfaceError
from robomill.lazy import cached_property
from robomill.provenance import Finding
from robomill.surface.passes import Passes, at_one_axis, feed_passes, leaning, moves_at_feed
from robomill.surface.raster import crossings, stock_heights
from robomill.surface.removal import EdgeCells, cut_tilted, cut_upright
from robomill.surface.stock import AXES, Cells, Stock, stock_grid
from robomill.units import format_many, format_si
from robomill.values import Value

JUST_ABOVE = 1e-12  # m: so far cells at walls are raised to see which a later cutter reaches, too
NO_EDGE = EdgeCells(np.zeros(0, dtype=np.int64), np.zeros(0), np.zeros((0, 6)))


@made_by("rm.simulate(setup)")
@dataclass(frozen=True, eq=False, repr=False)
class ZMap(Value):
    """Heights of the part over a grid in {W}.

    x (nx,), y (ny,) m    cell centres; ``cell`` m is the size asked for, ``dx``, ``dy`` the sizes that fill the stock
    z (nx, ny) m          height of the material at each centre, seen from above
    edge                  cells crossed by a wall, with their mean height
    z_stock               height of the stock before the cut: one number for a block, (nx, ny) for a mesh
    bottom                the stock's lower face, m
    overhang              number of cells where a tilted cutter left material over a void, which z cannot show
    leaning               whether a tilted cutter cut: the places of its walls are not kept
    skipped               feed moves left out because one of their ends is not a number (not reached)
    below                 True where the cutter would have gone through the bottom
    void                  m^3 of no material between the stock's top and what was cut (cavities, undercuts of a mesh)
    filled                m^3 of no material below what is seen from above, which z cannot show

    Examples
    --------
    >>> import robomill as rm
    >>> rm.simulate(rm.load_setup("paper_flute")).ideal
    <ZMap 1100 x 400 cells of 0.100 x 0.100 mm, 1586 mm^3 removed>
    """

    x: FloatArray
    y: FloatArray
    cell: float
    z: FloatArray
    edge: EdgeCells
    z_stock: FloatArray
    bottom: float
    overhang: int = 0
    skipped: int = 0
    below: bool = False
    void: float = 0.0
    filled: float = 0.0
    leaning: bool = False

    @property
    def dx(self) -> float:
        """Cell size along X, m."""
        return float(self.x[1] - self.x[0]) if len(self.x) > 1 else self.cell

    @property
    def dy(self) -> float:
        """Cell size along Y, m."""
        return float(self.y[1] - self.y[0]) if len(self.y) > 1 else self.cell

    @cached_property
    def mean(self) -> FloatArray:
        """(nx, ny) m: mean height of the material in each cell (differs from z at walls only)."""
        mean = self.z.copy()
        mean.reshape(-1)[self.edge.index] = self.edge.mean
        return mean

    @cached_property
    def removed_volume(self) -> float:
        """Material cut away, m^3."""
        heights = float(self.z.sum()) + float((self.edge.mean - self.z.reshape(-1)[self.edge.index]).sum())
        before = float(self.z_stock) * self.z.size if self.z_stock.ndim == 0 else float(self.z_stock.sum())
        return (before - heights) * self.dx * self.dy - self.void

    @cached_property
    def cut_mask(self) -> BoolArray:
        """(nx, ny) bool: cells whose centre was cut."""
        return np.asarray(self.z < self.z_stock)

    @cached_property
    def _digest(self) -> str:
        return digest((self.x, self.y, self.z, self.edge.index, self.edge.mean, self.bottom))

    def _said(self) -> str:
        size = format_many((self.dx, self.dy), "mm", 3, between=" × ")
        return f"{len(self.x)} × {len(self.y)} cells of {size}, {format_si(self.removed_volume, 'mm3', 0)} removed"

    def notes(self) -> tuple[Finding, ...]:
        """What a reader must know about this surface."""
        found = []
        if self.overhang:
            text = (
                f"Surface: in {self.overhang} cells the tilted cutter undercuts the material; a height map shows"
                " what is seen from above, not the void below it."
            )
            found.append(Finding("warning", text, code="undercut"))
        if self.leaning:
            text = (
                "Surface: where a tilted cutter cut, walls slope over up to a cell in pictures and exported solids; "
                "sections are exact."
            )
            found.append(Finding("info", text, code="walls-to-a-cell"))
        if self.skipped:
            text = f"Surface: {self.skipped} feed moves have an end that is not reached and were not cut."
            found.append(Finding("warning", text, code="not-cut"))
        if self.below:
            text = "Surface: the cutter goes through the bottom of the stock; heights end at its lower face."
            found.append(Finding("warning", text, code="through-bottom"))
        if self.filled > self.dx * self.dy * self.cell:
            text = (
                f"Surface: the stock has voids of {format_si(self.filled, 'mm3', 0)} below what is seen from above; a "
                "height map has none, so pictures and exported solids are filled there."
            )
            found.append(Finding("warning", text, code="void-filled"))
        return tuple(found)


def cut(
    stock: Stock,
    cell: float,
    cutter: Cutter | Tooling,
    p: ArrayLike,
    k: ArrayLike | None = None,
    cutting: ArrayLike | None = None,
    *,
    must_touch: bool = True,
) -> ZMap:
    """The stock after the feed moves of a path have been cut.

    p (m, 3) m tool tip in {W}; k (3,) or (m, 3) unit tool axis (default: upright); cutting (m,) bool, entry i for
    the move p[i-1] -> p[i] (default: all); ``cutter`` is one for all, or says which makes which. Moves with an end that
    is not finite are left out and counted. Raises SurfaceError for a cell size that does not fit, a tool axis too close
    to level and (``must_touch``) a path that misses the stock.
    """
    cells, points = stock_grid(stock, cell), np.asarray(p, dtype=np.float64)
    x, y = cells.x, cells.y
    z_stock = stock_heights(stock, x, y)
    z = np.empty((cells.nx, cells.ny))
    z[...] = z_stock
    ends, edge, overhang, skipped, leans = np.zeros((0, 6)), NO_EDGE, 0, 0, False
    for each, made in Tooling.of(cutter, len(points)).steps_of_each():
        moves, lost = feed_passes(points, k, moves_at_feed(points, cutting) & made)
        ends, skipped = np.vstack([ends, moves.ends]), skipped + lost
        edge, over, tilted = _cut_with(each, moves, (z, cells, cell), edge)
        overhang, leans = overhang + over, leans or tilted
    if must_touch and len(ends) + skipped == 0:
        raise SurfaceError("Cut: the path has no feed move; it needs at least two points with a cut between them.")
    bottom = float(stock.lower[2])
    below = bool((z < bottom).any())
    if below:
        np.maximum(z, bottom, out=z)
    edge = EdgeCells(frozen(edge.index, np.int64), frozen(np.maximum(edge.mean, bottom)), frozen(edge.wall))
    z.flags.writeable = False
    result = ZMap(x, y, cell, z, edge, frozen(z_stock), bottom, overhang, skipped, below, leaning=leans)
    if stock.triangles is not None:
        void, filled = _voids(result, stock.triangles)
        result = replace(result, void=void, filled=filled)
    if must_touch and result.removed_volume <= 0.0:
        raise SurfaceError(_misses(stock, ends))
    return result


def _voids(surface: ZMap, triangles: FloatArray) -> tuple[float, float]:
    """Volumes (m^3) between the old top and the new one, and below the new one, where the mesh holds nothing: every
    other piece of a line downwards, from its top, is material."""
    new, old = surface.mean.reshape(-1), surface.z_stock.reshape(-1)
    cell, height = crossings(triangles, surface.x, surface.y)
    order = np.lexsort((height, cell))
    cell, height = cell[order], height[order]
    count = np.bincount(cell, minlength=len(new))
    from_top = np.cumsum(count)[cell] - 1 - np.arange(len(cell))
    sign, closed = np.where(from_top % 2 == 0, 1.0, -1.0), (count > 0) & (count % 2 == 0)

    def metal(above: FloatArray) -> FloatArray:
        thick = np.bincount(cell, np.maximum(height - above[cell], 0.0) * sign, minlength=len(new))
        return np.asarray(thick, dtype=np.float64)

    over = metal(new)
    below = metal(np.full(len(new), surface.bottom)) - over
    void = np.sum(np.maximum(old - new, 0.0) - over, where=closed & (new < old))
    filled = np.sum(new - surface.bottom - below, where=closed)
    return float(void) * surface.dx * surface.dy, float(filled) * surface.dx * surface.dy


def _cut_with(
    cutter: Cutter, moves: Passes, grid: tuple[FloatArray, Cells, float], edge: EdgeCells
) -> tuple[EdgeCells, int, bool]:
    """Cut the moves of one cutter into the heights of ``grid``: the cells at walls, after those of the cutters before,
    how many cells are undercut, and whether the cutter leans."""
    z, cells, cell = grid
    flat = z.reshape(-1)
    ends, axes, _ = at_one_axis(moves, cutter.radius, cell)
    leans = leaning(axes)
    before = flat[edge.index]
    flat[edge.index] = before + JUST_ABOVE
    fresh = cut_upright(z, cells, cutter, ends[~leans])
    reached = flat[edge.index] <= before
    flat[edge.index] = np.minimum(flat[edge.index], before)
    if len(edge.index):
        covered = reached & ~np.isin(edge.index, fresh.index)
        edge = _joined(edge, (flat[edge.index] == before) & ~covered, fresh)
    else:
        edge = fresh
    overhang = 0
    if leans.any():
        before = flat[edge.index]
        overhang = int(cut_tilted(z, cells, cutter, (ends[leans], axes[leans])).sum())
        kept = flat[edge.index] == before
        edge = EdgeCells(edge.index[kept], edge.mean[kept], edge.wall[kept])
    return edge, overhang, bool(leans.any())


def _joined(old: EdgeCells, kept: BoolArray, fresh: EdgeCells) -> EdgeCells:
    """Walls of earlier cutters where they still stand (``kept``), with those of a later one, which stay where both do
    unless the earlier cut more of the cell."""
    index = np.concatenate([old.index[kept], fresh.index])
    mean, wall = np.concatenate([old.mean[kept], fresh.mean]), np.vstack([old.wall[kept], fresh.wall])
    order = np.lexsort((mean, index))
    first = order[np.append(True, np.diff(index[order]) > 0)] if len(order) else order
    return EdgeCells(index[first], mean[first], wall[first])


def _misses(stock: Stock, ends: FloatArray) -> str:
    if len(ends) == 0:
        return "Cut: no feed move of the path is reached, so nothing is cut."
    points = ends.reshape(-1, 3)
    low, high = points.min(axis=0), points.max(axis=0)
    spans = [
        f"{axis} {format_si(low[i], 'mm', 1)} to {format_si(high[i], 'mm', 1)} (stock"
        f" {format_si(stock.lower[i], 'mm', 1)} to {format_si(stock.upper[i], 'mm', 1)})"
        for i, axis in enumerate(AXES)
    ]
    return f"Stock: the path never touches it; the feed moves span {', '.join(spans)}: move the stock or the path."
