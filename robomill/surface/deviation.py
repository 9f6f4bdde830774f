"""Machined against ideal: a signed error field, + where material was left (excess), - where too much went (gouge)."""

from dataclasses import dataclass

import numpy as np

from robomill.arrays import BoolArray, FloatArray, frozen
from robomill.errors import SurfaceError
from robomill.lazy import cached_property
from robomill.progress import checkpoint
from robomill.surface.zmap import ZMap
from robomill.units import format_si
from robomill.values import Value


@dataclass(frozen=True, eq=False, repr=False)
class Deviation(Value):
    """Error of a machined surface against the ideal one on the same grid.

    error (nx, ny) m         signed distance to the ideal surface: machined minus ideal height, or the way sideways to
                             the ideal wall where that is shorter (to one cell); NaN where neither surface was cut
    cut (nx, ny) bool        cells cut in either
    excess_volume, gouge_volume  m^3, from the mean heights of the cells; their difference knows sub-cell walls, and
                             each by itself is right to first order in the cell size
    """

    x: FloatArray
    y: FloatArray
    error: FloatArray
    cut: BoolArray
    excess_volume: float
    gouge_volume: float

    @cached_property
    def values(self) -> FloatArray:
        """(q,) m: the error of every cell that was cut."""
        return frozen(self.error[self.cut])

    def _said(self) -> str:
        most, least = (format_si(each, "mm", sign=True) for each in self.worst)
        return f"{least} to {most}, root mean square {format_si(self.rms, 'mm')}"

    @property
    def worst(self) -> tuple[float, float]:
        """(largest excess, largest gouge) m, the second negative or zero."""
        if self.values.size == 0:
            return 0.0, 0.0
        return max(0.0, float(self.values.max())), min(0.0, float(self.values.min()))

    @property
    def rms(self) -> float:
        """Root mean square error over the cut cells, m."""
        return float(np.sqrt(np.mean(self.values**2))) if self.values.size else 0.0


def deviation(ideal: ZMap, machined: ZMap, *, reach: float = 1e-3) -> Deviation:
    """Compare two height maps of one grid.

    ``reach`` (m): how far sideways the ideal wall is looked for; further away the height error stands as it is.
    Raises SurfaceError if the grids differ.
    """
    same = ideal.z.shape == machined.z.shape and np.array_equal(ideal.x, machined.x)
    if not (same and np.array_equal(ideal.y, machined.y)):
        raise SurfaceError(
            f"Comparison: the surfaces have different grids ({ideal.z.shape} and {machined.z.shape} cells);"
            " cut both from the same stock with the same cell size."
        )
    height_error = machined.z - ideal.z
    was_cut = ideal.cut_mask | machined.cut_mask
    error = surface_error(ideal, machined, reach)
    error[~was_cut] = np.nan
    for array in (error, was_cut):  # large, and nobody else's: no copy
        array.flags.writeable = False
    excess, gouge = _volumes(height_error, ideal, machined)
    return Deviation(ideal.x, ideal.y, error, was_cut, excess, gouge)


def _volumes(height_error: FloatArray, ideal: ZMap, machined: ZMap) -> tuple[float, float]:
    """Excess and gouge, m^3, from the difference of the cells' mean heights."""
    difference = height_error.reshape(-1).copy()
    for surface, sign in ((machined, 1.0), (ideal, -1.0)):
        cells = surface.edge.index
        difference[cells] += sign * (surface.edge.mean - surface.z.reshape(-1)[cells])
    area = ideal.dx * ideal.dy
    return float(difference.sum(where=difference > 0)) * area, -float(difference.sum(where=difference < 0)) * area


def surface_error(ideal: ZMap, machined: ZMap, reach: float) -> FloatArray:
    """Signed distance (nx, ny) m of the machined surface to the ideal one; see Deviation.error.

    Around each cell whose height error exceeds a cell the nearest ideal column is sought: sideways to it (half a
    cell less, where its wall passes) and, if its ideal height does not reach the machined one, the rest in height.
    """
    error = machined.z - ideal.z
    size = min(ideal.dx, ideal.dy)
    i, j = np.nonzero(np.abs(error) > size)
    if len(i) == 0:
        return error
    sign, height = np.sign(error[i, j]), machined.z[i, j]
    best = np.abs(error[i, j])
    offsets = _offsets(ideal.dx, ideal.dy, min(reach, float(best.max())))
    for n, (di, dj, distance) in enumerate(offsets):
        checkpoint(n / len(offsets), "Error of the surface")
        open_ = np.flatnonzero(best > distance)
        if len(open_) == 0:
            break
        a, b = i[open_] + di, j[open_] + dj
        inside = (a >= 0) & (a < error.shape[0]) & (b >= 0) & (b < error.shape[1])
        open_, a, b = open_[inside], a[inside], b[inside]
        still = np.maximum(0.0, sign[open_] * (height[open_] - ideal.z[a, b]))
        best[open_] = np.minimum(best[open_], np.hypot(distance, still))
    result = error.copy()
    result[i, j] = sign * best
    return result


def _offsets(dx: float, dy: float, reach: float) -> list[tuple[int, int, float]]:
    """Cells around a cell, nearest first, with the distance to the border half a cell short of their centre."""
    n, m = int(reach / dx) + 1, int(reach / dy) + 1
    around = [(i, j) for i in range(-n, n + 1) for j in range(-m, m + 1) if (i, j) != (0, 0)]
    short = 0.5 * min(dx, dy)
    spans = [(i, j, float(np.hypot(i * dx, j * dy)) - short) for i, j in around]
    return sorted((s for s in spans if s[2] <= reach), key=lambda s: s[2])
