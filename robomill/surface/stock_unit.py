"""A stock in another unit than the program: suspected where the path lies outside of it and fits it in that unit."""

import numpy as np
from numpy.typing import ArrayLike

from robomill.arrays import BoolArray, FloatArray
from robomill.provenance import Finding
from robomill.surface.stock import Stock
from robomill.units import format_si, to_si

NAMES = {"mm": "millimetres", "m": "metres", "in": "inches", "cm": "centimetres"}
MISREAD = (("mm", "m"), ("mm", "in"), ("mm", "cm"), ("cm", "mm"), ("in", "mm"), ("m", "mm"))  # meant, read as
TIMES = {to_si(1.0, meant) / to_si(1.0, read): f"{NAMES[meant]} read as {NAMES[read]}" for meant, read in MISREAD}
HELD, LOST = 0.9, 0.5
"""Shares of the path within the block: so much is a part that is cut, less than this one that is missed."""
HARDLY, OVERRUN = 0.1, 0.6
"""Shares of the path: with so little of it in the block as it is, so much within another unit's is enough."""
OUTSIDE = "stock-outside"  # code of the finding by which what is cut rests on a unit that hardly was meant
PLACES = 1000  # of the path that are looked at, evenly along it
TOO_LARGE = 20.0
LIKELY = 5.0
"""times: a block so much wider than all that is cut in it was hardly meant; one up to so much may have been."""


def unit_doubt(stock: Stock, p: ArrayLike, cutting: ArrayLike) -> tuple[Finding, ...]:
    """Whether the stock seems to be in another unit than the path, with its extents in both.

    p (m, 3) m in {W}, cutting (m,) bool for the move that ends at p[i].
    """
    ends = _along(np.asarray(p, dtype=np.float64), np.asarray(cutting, dtype=bool))
    if not len(ends):
        return ()
    now, span = _held(stock, ends, 1.0), float(np.ptp(ends[:, :2], axis=0).max())
    large = now >= HELD and float(stock.size[:2].min()) > TOO_LARGE * max(span, 1e-3)
    if now >= LOST and not large:
        return ()
    enough = OVERRUN if now < HARDLY else HELD
    for times, what in TIMES.items():
        fits = float(stock.size[:2].max()) * times <= LIKELY * span and _held(stock, ends, times) >= enough
        if (times < 1.0) == large and fits:
            found = "most of the path lies outside of it" if not large else "the path needs a small part of it"
            held = "most of" if _held(stock, ends, times) < HELD else "all of"
            text = (
                f"Stock: it is {_size(stock.size)} and {found}; were its numbers {what}, it would be "
                f"{_size(stock.size * times)} and hold {held} the path: check the unit."
            )
            return (Finding("suspicious", text, code="stock-size" if large else OUTSIDE),)
    return ()


def _along(points: FloatArray, used: BoolArray) -> FloatArray:
    """(q, 3) m: places evenly along the moves of a path that cut."""
    span = np.diff(points, axis=0)
    length = np.where(used[1:], np.linalg.norm(span, axis=1), 0.0)
    end = np.cumsum(np.nan_to_num(length))
    if not len(end) or end[-1] <= 0.0:
        return np.zeros((0, 3))
    s = (np.arange(PLACES) + 0.5) * (end[-1] / PLACES)
    n = np.searchsorted(end, s)
    back = ((end[n] - s) / length[n])[:, None]
    return np.asarray(points[n + 1] - back * span[n])


def _held(stock: Stock, ends: FloatArray, times: float) -> float:
    """Share of points (m, 3) that lie in plan within the block grown ``times`` about the part zero."""
    lower, upper = stock.lower[:2] * times, stock.upper[:2] * times
    return float(((ends[:, :2] >= lower) & (ends[:, :2] <= upper)).all(axis=1).mean())


def _size(size: FloatArray) -> str:
    return " x ".join(format_si(float(v), "mm", 1).removesuffix(" mm") for v in size) + " mm"
