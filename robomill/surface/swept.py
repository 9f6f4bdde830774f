"""The feed moves of a path as one swept body that can be asked for the height it leaves along a line in plan."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from robomill.arrays import BoolArray, FloatArray, IntArray
from robomill.cutting.tool import Cutter
from robomill.cutting.tooling import Tooling
from robomill.errors import SurfaceError
from robomill.progress import checkpoint
from robomill.spelled import beside
from robomill.surface.passes import feed_passes
from robomill.surface.raster import skin_on_line
from robomill.surface.stock import Stock
from robomill.units import format_plain, format_short, format_si, to_si

Heights = Callable[[FloatArray], FloatArray]


@dataclass(frozen=True, eq=False)
class CutPath:
    """A path as commanded and as it was really run: tool tips p, p_machined (m, 3) m in {W} (not finite where not
    reached, not judged), cutting (m,) bool, unit tool axes k (3,) or (m, 3) (None: upright), source lines block (m,);
    ``why`` (m,) says in words why a point that is not finite is not.
    """

    p: FloatArray
    p_machined: FloatArray
    cutting: BoolArray
    k: FloatArray | None = None
    block: IntArray | None = None
    why: Sequence[str] | None = None


@dataclass(frozen=True)
class Body:
    """Feed moves of one cutter: ends (n, 6) m, axes (n, 3)."""

    cutter: Cutter
    ends: FloatArray
    axes: FloatArray

    def near(self, line: tuple[FloatArray, FloatArray, float], top: float) -> tuple[FloatArray, FloatArray]:
        """Ends and axes of the moves whose track may meet the line (centre, normal, reach) below ``top``, m."""
        centre, normal, reach = line
        lean = np.hypot(self.axes[:, 0], self.axes[:, 1])
        rise = np.maximum(top - np.minimum(self.ends[:, 2], self.ends[:, 5]), 0.0) + self.cutter.radius
        limit = self.cutter.radius + rise * lean / self.axes[:, 2]
        feed = np.array([normal[1], -normal[0]])
        a, b = self.ends[:, :2] - centre[:2], self.ends[:, 3:5] - centre[:2]
        along, across = np.stack([a @ feed, b @ feed]), np.stack([a @ normal[:2], b @ normal[:2]])
        meets = (
            (along.min(axis=0) <= limit)
            & (along.max(axis=0) >= -limit)
            & (across.min(axis=0) - limit <= reach)
            & (across.max(axis=0) + limit >= -reach)
        )
        return self.ends[meets], self.axes[meets]


@dataclass(frozen=True)
class SweptPath:
    """Feed moves of cutters through a stock, to be asked for the height they leave on a line in plan."""

    stock: Stock
    bodies: tuple[Body, ...]

    def meeting(self, centre: FloatArray, normal: FloatArray, reach: float) -> int:
        """How many moves may meet the line centre + w normal, |w| <= reach, within the stock."""
        line, top = (centre, normal, reach), float(self.stock.upper[2])
        return sum(len(body.near(line, top)[0]) for body in self.bodies)

    def heights(self, centre: FloatArray, normal: FloatArray, reach: float) -> Heights:
        """Function w (q,) -> height left (q,) on the line centre + w normal, |w| <= reach, before any clipping."""
        from robomill.surface.cells_kernels import lower_along

        stock_top, top = skin_on_line(self.stock, centre, normal), float(self.stock.upper[2])
        near = [(body.cutter.solid, *body.near((centre, normal, reach), top)) for body in self.bodies]

        def height(w: FloatArray) -> FloatArray:
            checkpoint()
            z = stock_top(w)
            for shape, ends, axes in near:
                lower_along(shape, ends, axes, centre[0] + w * normal[0], centre[1] + w * normal[1], z)
            return z

        return height


def swept_path(stock: Stock, tooling: Tooling, p: FloatArray, k: ArrayLike | None, cutting: BoolArray) -> SweptPath:
    """The feed moves of a path p (m, 3) m with tool axes k; moves with an end that is not finite are left out."""
    bodies = []
    for cutter, made in tooling.steps_of_each():
        checkpoint()
        moves, _ = feed_passes(p, k, cutting & made)
        middle = moves.axes[:, :3] + moves.axes[:, 3:]
        bodies.append(Body(cutter, moves.ends, middle / np.linalg.norm(middle, axis=1, keepdims=True)))
    return SweptPath(stock, tuple(bodies))


@dataclass(frozen=True)
class Station:
    """A place on the commanded feed path: entry i of the path, the fraction along its move, tip and feed-normal."""

    station: float
    entry: int
    fraction: float
    centre: FloatArray
    normal: FloatArray | None


def station_at(p: FloatArray, cutting: BoolArray, station: float) -> Station:
    """Where path length ``station`` (m) lies on the feed moves. Raises SurfaceError beyond either end."""
    steps = np.where(cutting[1:], np.linalg.norm(np.diff(p, axis=0), axis=1), 0.0)
    s = np.concatenate([[0.0], np.cumsum(steps)])
    if not s[-1] > 0:
        raise SurfaceError("Section: the path has no feed move with a length, so it leaves no groove to measure.")
    if not -1e-12 <= station <= s[-1] + 1e-12:
        meant = to_si(station, "mm")
        slip = f": a station is in m; if {format_plain(station, 6)} mm is meant, give {meant:.6g}"
        slip = slip if 0.0 <= meant <= s[-1] and not beside() else ""
        raise SurfaceError(
            f"Section at {format_short(station, 'mm')}: the feed path runs from 0 to {format_si(s[-1], 'mm', 2)}{slip}."
        )
    entry = int(np.searchsorted(s, station, side="left"))
    entry = int(np.flatnonzero(steps > 0)[0]) + 1 if entry == 0 else entry
    fraction = float((station - s[entry - 1]) / steps[entry - 1])
    span = p[entry] - p[entry - 1]
    plan = np.hypot(span[0], span[1])
    normal = None if plan < 1e-9 * steps[entry - 1] else np.array([-span[1], span[0], 0.0]) / plan
    return Station(station, entry, fraction, p[entry - 1] + fraction * span, normal)
