"""Where a cut comes out along the side of the stock: no wall can stand there, and none is judged."""

import numpy as np

from robomill.arrays import BoolArray, FloatArray
from robomill.provenance import Finding
from robomill.simulation.setup import SimulationSetup
from robomill.simulation.tools import tooling
from robomill.toolpath.path import Toolpath
from robomill.units import format_count, format_si, to_si

NO_WALL = "no-wall-at-edge"
AT_EDGE = to_si(0.1, "mm")
"""So near a side of the stock, within it or beyond, a cutter's rim meets it. A cut that is meant to go out over the
side goes further, and one that should leave a wall leaves a thicker one (stated, not derived)."""
LONG = 2.0  # diameters: so far a cut must go along a side, without a break, before it is said
STRAIGHT = 0.999  # cosine of what the feed may differ from the direction of the side, and the tool from upright
SIDES = ((0, -1.0), (0, 1.0), (1, -1.0), (1, 1.0))  # axis of a side's normal, and which way that points


def edge_notes(setup: SimulationSetup, path: Toolpath) -> tuple[Finding, ...]:
    """The longest way along a side of the stock on which an upright cutter's rim meets that side from within; none
    where each is shorter than ``LONG`` diameters. A stock that is a solid has no such sides."""
    if setup.stock_block.triangles is not None:
        return ()
    least = LONG * tooling(setup, path).each("diameter")
    runs = np.stack([_along(setup, path, axis, way) for axis, way in SIDES])
    long = (runs >= least).any(axis=1)
    if not long.any():
        return ()
    side, i = np.unravel_index(int(np.argmax(np.where(runs >= least, runs, 0.0))), runs.shape)
    text = (
        f"the cutter comes out along {format_count(int(long.sum()), 'side')} of the stock, for up to "
        f"{format_si(runs[side, i], 'mm', 1)}: no wall can stand there, and none is judged. Give a larger stock, or "
        "one around the path, if a wall should be left."
    )
    return (Finding("warning", text, int(path.block[i]), code=NO_WALL),)


def _along(setup: SimulationSetup, path: Toolpath, axis: int, way: float) -> FloatArray:
    """(m,) m: how far the cutter's rim has gone along one side of the stock, without a break, at each sample."""
    stock, other = setup.stock_block, 1 - axis
    wall = stock.upper[axis] if way > 0.0 else stock.lower[axis]
    rim = path.p[:, axis] + way * _rim(setup, path)
    step = np.diff(path.p, axis=0, prepend=path.p[:1])
    length = np.linalg.norm(step, axis=1)
    at = np.clip(path.p[:, other], stock.lower[other], stock.upper[other])
    beside = np.abs(np.diff(at, prepend=at[:1]))  # what of a step goes past either end of the side counts nothing
    meets = path.cutting & (path.p[:, 2] < stock.upper[2]) & (path.k[:, 2] >= STRAIGHT) & (beside > 0.0)
    meets &= (np.abs(rim - wall) <= AT_EDGE) & (np.abs(step[:, other]) >= STRAIGHT * length)
    return _unbroken(beside, meets)


def _rim(setup: SimulationSetup, path: Toolpath) -> FloatArray:
    """(m,) m: the radius of each sample's cutter at the top of the stock, where it is widest in the material."""
    deep, rim = np.maximum(setup.stock_block.upper[2] - path.p[:, 2], 0.0), np.zeros(len(path))
    for cutter, made in tooling(setup, path).steps_of_each():
        rim[made] = cutter.radius_at(deep[made])
    return rim


def _unbroken(length: FloatArray, goes_on: BoolArray) -> FloatArray:
    """(m,) sums of ``length`` (m,) since ``goes_on`` (m,) was last False; 0 there."""
    total = np.cumsum(length)
    return np.asarray(total - np.maximum.accumulate(np.where(goes_on, 0.0, total)))
