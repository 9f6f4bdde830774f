"""What a gauge reads of walls, floors and ends where the tip goes otherwise: each reading moved by what has made it."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from robomill.arrays import BoolArray, FloatArray, IntArray
from robomill.improve.makers import Made, made, only
from robomill.simulation.judging.gauge import ALIKE, Readings
from robomill.simulation.result import SimulationResult

SMALL = 1e-9  # m: less is none


class Surfaces(NamedTuple):
    """What a gauge reads of walls, floors or ends, as far as it moves with the tip: beside sample ``at`` (q,) of a
    screen, made by samples ``by`` (q, 2) that move it ``toward`` (q, 2, 3); (``low``, ``high``) (q,) m is what the
    readings were more than that. NaN where another pass had made the surface: there the sample counts besides as far as
    it goes deeper, which is the way of ``toward``."""

    at: IntArray
    by: IntArray
    toward: FloatArray
    low: FloatArray
    high: FloatArray

    def largest(self, d: FloatArray) -> FloatArray:
        """(k,) m with deviations d (k, s, 3) m; NaN without a reading."""
        return np.asarray(self._each(d).max(axis=-1)) if len(self.at) else np.full(len(d), np.nan)

    def by_sample(self, d: FloatArray) -> FloatArray:
        """(k, s) m with deviations d (k, s, 3) m; 0 where a sample has no reading."""
        found = np.zeros((d.shape[1], d.shape[0]))
        np.fmax.at(found, self.at, self._each(d).T)
        return found.T

    def _each(self, d: FloatArray) -> FloatArray:
        """(k, q) m."""
        two = np.flatnonzero(self.toward[:, 0].any(axis=-1))
        own = np.einsum("kqi,qi->kq", d[:, self.by[:, 1]], self.toward[:, 1])
        own[:, two] += np.einsum("kqi,qi->kq", d[:, self.by[two, 0]], self.toward[two, 0])
        made = np.maximum(np.abs(own + self.low), np.abs(own + self.high))
        return np.asarray(np.where(np.isnan(self.low), np.maximum(own, 0.0), made))


def surfaces(read: Readings, result: SimulationResult, at: IntArray) -> Surfaces:
    """Of readings of a run those beside samples ``at``, made by such."""
    read = only(read, np.isin(read.sample, at))
    by, way, _ = _with_rest(made(read, result), read, result)
    there = np.flatnonzero(np.isin(by, at).all(axis=1))
    read, by, way = only(read, there), by[there], way[there]
    more = read.error - Made(by, way, np.ones(len(there), dtype=bool)).along(result.delta_in_cut)
    first = _alike(read.sample, by, way)
    low, high = np.full(len(first[0]), np.inf), np.full(len(first[0]), -np.inf)
    np.minimum.at(low, first[1], more)
    np.maximum.at(high, first[1], more)
    parts = [(read.sample[first[0]], by[first[0]], way[first[0]], low, high), _deeper(read, result)]
    sample, by, toward, low, high = map(np.concatenate, zip(*parts, strict=True))
    return Surfaces(np.searchsorted(at, sample), np.searchsorted(at, by), toward, low, high)


def _with_rest(told: Made, read: Readings, result: SimulationResult) -> Made:
    """Where no step explains a reading, what is more than its own sample has made goes with the deviation there, as
    much as there is of that; with the largest, where nothing pushes."""
    lost = np.flatnonzero(~told.found)
    if not len(lost):
        return told
    d, by, way = result.delta_in_cut, told.by.copy(), told.way.copy()
    rest = (read.error - told.along(d))[lost]
    i = read.sample[lost]
    by[lost, 0] = np.where(d[i].any(axis=1), i, max(result.worst, 0))
    most = d[by[lost, 0]]
    size = np.einsum("qi,qi->q", most, most)
    way[lost, 0] = (rest / np.where(size > 0.0, size, np.inf))[:, None] * most
    return Made(by, way, told.found)


def _at_samples(read: Readings, result: SimulationResult) -> BoolArray:
    """(q,) bool: readings beside samples themselves, not between one and the one before."""
    own = np.einsum("qi,qi->q", result.delta_in_cut[read.sample], read.way)
    return np.asarray(np.abs(own - read.own) < SMALL)


def _deeper(read: Readings, result: SimulationResult) -> tuple[IntArray, IntArray, FloatArray, FloatArray, FloatArray]:
    """Columns of ``Surfaces`` for samples beside which another pass has made the surface."""
    more = read.error - read.own
    other = (np.abs(more) > ALIKE) & _at_samples(read, result)
    sample, way = read.sample[other], read.way[other] * np.sign(more[other])[:, None]
    by, toward = np.repeat(sample[:, None], 2, axis=1), np.stack([np.zeros_like(way), way], axis=1)
    first = _alike(sample, by, toward)[0]
    none = np.full(len(first), np.nan)
    return sample[first], by[first], toward[first], none, none


def _alike(sample: IntArray, by: IntArray, way: FloatArray) -> tuple[IntArray, IntArray]:
    """The first of readings that go alike, and which of them each one is."""
    key = np.column_stack([sample, by, np.round(way.reshape(len(way), 6), 9)])
    _, first, which = np.unique(key, axis=0, return_index=True, return_inverse=True)
    return first, which.ravel()
