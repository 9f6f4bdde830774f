"""The path as a run evaluates it: what does not move left out, feed moves in short steps, the way at every sample."""

from collections.abc import Callable
from dataclasses import fields, replace
from typing import Any

import numpy as np

from robomill.arrays import FloatArray, IntArray
from robomill.cutting.tool import DISH, PRESSED
from robomill.progress import checkpoint
from robomill.surface.passes import moves_of
from robomill.toolpath.path import Toolpath
from robomill.toolpath.sampling import CORNER, resample

STILL = 1e-7  # m: a block that goes no further, and does not turn the tool, is none


def sampled(path: Toolpath, step: float, seen: Callable[[Toolpath], FloatArray] | None = None) -> Toolpath:
    """``path`` in steps no longer than ``step`` (m), see ``resample``; a block that stands still changes nothing.
    ``seen`` says of every move (m,) how long its steps may be at most, m."""
    moves = moving(path)
    return resample(moves, step if seen is None else np.minimum(seen(moves), step), (PRESSED, DISH))


def moving(path: Toolpath) -> Toolpath:
    """``path`` without the blocks that stay within ``STILL`` of where the block before them ended."""
    turned = np.append(True, (path.k[1:] != path.k[:-1]).any(axis=1))
    short = np.flatnonzero((path.step_length <= STILL) & ~turned)
    keep = np.ones(len(path), dtype=bool)
    last = 0
    for i in short:
        last = int(i) - 1 if keep[i - 1] else last
        keep[i] = np.linalg.norm(path.p[i] - path.p[last]) > STILL
    return path if keep.all() else chosen(path, keep)


def clock(path: Toolpath, rapid_rate: float | None) -> FloatArray:
    """(m,) s since the first cut began: at feed, through dwells, and through rapids at ``rapid_rate`` (m/s).

    After a rapid that takes an unknown time (no rate) it is NaN.
    """
    with np.errstate(divide="ignore", invalid="ignore"):
        feed = np.where(path.v_f > 0.0, path.step_length / path.v_f, 0.0)
        rapid = path.step_length / rapid_rate if rapid_rate else np.where(path.step_length > 0.0, np.nan, 0.0)
    took = np.where(path.cutting, feed, rapid) + path.dwell
    cuts = np.flatnonzero(path.cutting)
    if len(cuts):
        took[: cuts[0]] = 0.0
        took[cuts[0]] -= path.dwell[cuts[0]]
    return np.asarray(np.cumsum(took))


def arrivals(path: Toolpath) -> IntArray:
    """Samples at which a rapid arrives where a cut begins, which is the next one's place."""
    begins = path.cutting[1:] & (path.step_length[1:] == 0.0)
    return np.flatnonzero(~path.cutting[:-1] & begins)


def chosen(path: Toolpath, keep: np.ndarray) -> Toolpath:
    """The entries ``keep`` (m,) bool of every array of the path."""
    found: dict[str, Any] = {each.name: getattr(path, each.name) for each in fields(path)}
    arrays = {name: value[keep] for name, value in found.items() if isinstance(value, np.ndarray)}
    owner = np.minimum(np.searchsorted(np.flatnonzero(keep), np.arange(len(path))), keep.sum() - 1)
    arrays["dwell"] = np.bincount(owner, weights=path.dwell, minlength=int(keep.sum()))  # waited before the next move
    return replace(path, **arrays)


def ways(path: Toolpath) -> FloatArray:
    """(m, 3) unit vectors: which way the tool goes through every sample; 0 where nothing moves.

    That of the move that ends there; of the next one where a step of no length begins a cut or turns the tool on the
    spot; and where moves of one block are the chords of a curve, that of the curve: between two chords their mean, at
    its ends as much on the other side of the chord (as on a circle).
    """
    length, d = path.step_length[:, None], np.diff(path.p, axis=0, prepend=path.p[:1])
    d = np.divide(d, length, out=np.zeros_like(d), where=length > 0.0)
    checkpoint()
    move = moves_of(path.step_length == 0.0, path.cutting)
    at_feed = path.cutting & (path.step_length > 0.0)
    on = at_feed[:-1] & at_feed[1:] & (path.block[:-1] == path.block[1:])
    on = np.append(on & (np.einsum("mi,mi->m", d[:-1], d[1:]) > np.cos(CORNER)), False)
    checkpoint()
    way = np.where(on[:, None], d + np.roll(d, -1, axis=0), d)
    way /= np.where(on, np.linalg.norm(way, axis=1), 1.0)[:, None]
    end = np.flatnonzero(~on & np.append(False, on[:-1]))
    way[end] = _mirrored(way[end - 1], d[end])
    start = np.flatnonzero((move != np.arange(len(move))) & (move >= 0))
    way[start] = _mirrored(way[move[start]], d[move[start]])
    return way


def _mirrored(way: FloatArray, d: FloatArray) -> FloatArray:
    """Directions (n, 3) as far on the other side of unit vectors d (n, 3)."""
    return np.asarray(2.0 * np.einsum("ni,ni->n", way, d)[:, None] * d - way)
