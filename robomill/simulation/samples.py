"""The path as a run evaluates it: what does not move left out, feed moves in short steps, values at their starts."""

from __future__ import annotations

from dataclasses import fields, replace
from typing import Any

import numpy as np

from robomill.arrays import FloatArray
from robomill.toolpath.path import Toolpath
from robomill.toolpath.sampling import resample

STILL = 1e-7  # m: a block that goes no further, and does not turn the tool, is none


def sampled(path: Toolpath, step: float) -> Toolpath:
    """``path`` in steps no longer than ``step`` (m), see ``resample``; a block that stands still changes nothing."""
    return resample(moving(path), step)


def moving(path: Toolpath) -> Toolpath:
    """``path`` without the blocks that stay within ``STILL`` of where the block before them ended."""
    turned = np.append(True, (path.k[1:] != path.k[:-1]).any(axis=1))
    short = np.flatnonzero((path.step_length <= STILL) & ~turned)
    keep = np.ones(len(path), dtype=bool)
    last = 0
    for i in short:
        last = int(i) - 1 if keep[i - 1] else last
        keep[i] = np.linalg.norm(path.p[i] - path.p[last]) > STILL
    return path if keep.all() else _chosen(path, keep)


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


def _chosen(path: Toolpath, keep: np.ndarray) -> Toolpath:
    """The entries ``keep`` (m,) bool of every array of the path."""
    found: dict[str, Any] = {each.name: getattr(path, each.name) for each in fields(path)}
    arrays = {name: value[keep] for name, value in found.items() if isinstance(value, np.ndarray)}
    owner = np.minimum(np.searchsorted(np.flatnonzero(keep), np.arange(len(path))), keep.sum() - 1)
    arrays["dwell"] = np.bincount(owner, weights=path.dwell, minlength=int(keep.sum()))  # waited before the next move
    return replace(path, **arrays)


def at_starts(path: Toolpath, values: FloatArray) -> FloatArray:
    """``values`` (m, ...) where a step of no length takes those of the next step of its cut that has one.

    Such a step begins a cut, or turns the tool on the spot.
    """
    out = np.array(values)
    still = path.cutting & (path.step_length == 0.0)
    moved = np.where(still, len(path), np.arange(len(path)))
    then = np.minimum.accumulate(moved[::-1])[::-1]
    n = np.flatnonzero(still & (then < len(path)))
    n = n[path.cutting[then[n]]]
    out[n] = out[then[n]]
    return out
