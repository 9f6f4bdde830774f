"""Which samples of a path have made what a gauge reads: an error goes with the tip there, and with no other.

A surface that is read beside a sample was made by that sample, on the step that leads to it, or by another pass that
comes by and goes deeper. Each straight step moves from the deviation at its begin to that at its end, and a surface
stands off by what lies between: so the step is looked for, nearest first, between whose ends the error lies.
"""

from __future__ import annotations

from dataclasses import fields
from typing import NamedTuple

import numpy as np

from robomill.arrays import BoolArray, FloatArray, IntArray
from robomill.simulation.judging.gauge import ALIKE, Readings
from robomill.simulation.result import SimulationResult

LEVEL = 1e-12  # m: ends that differ by less are off alike


class Made(NamedTuple):
    """Two samples ``by`` (q, 2) of a path, the ends of the step that made each of q readings: with their deviations
    along feed, feed-normal and axis these go by ``way`` (q, 2, 3). ``found`` (q,) is False where no step explains it:
    there it goes with its own sample, and a rest stays."""

    by: IntArray
    way: FloatArray
    found: BoolArray

    def along(self, vectors: FloatArray) -> FloatArray:
        """(q, ...) m: how far the readings go by ``vectors`` (m, 3, ...) m, one a sample."""
        return np.asarray(np.einsum("qbk,qbk...->q...", self.way, vectors[self.by]))


def made(read: Readings, result: SimulationResult) -> Made:
    """Of readings of a run."""
    d = result.delta_in_cut
    by = np.repeat(read.sample[:, None], 2, axis=1)
    way = np.stack([np.zeros_like(read.way), read.way], axis=1)
    found = np.abs(read.error - np.einsum("qi,qi->q", d[read.sample], read.way)) <= ALIKE
    told = Made(by, way, found)
    for after in (0, 1):  # the step to the sample itself and the one on from there are nearest
        q = np.flatnonzero(~found)
        step = np.minimum(read.sample[q] + after, len(d) - 1)
        share, misses, _ = _on_steps(read, result, q, step[:, None])
        some = (misses[:, 0] <= ALIKE) & result.removes[step]
        _write(told, (read, result), q[some], step[some], share[some, 0])
    left = np.flatnonzero(~found)
    samples, of = np.unique(read.sample[left], return_inverse=True)
    for n, steps in enumerate(_steps_near(result, samples)):
        q = left[of == n]
        share, misses, far = _on_steps(read, result, q, np.broadcast_to(steps, (len(q), len(steps))))
        far = np.where(misses <= ALIKE, far, np.inf)
        best, rows = far.argmin(axis=1), np.arange(len(q))
        some = np.isfinite(far[rows, best])
        _write(told, (read, result), q[some], steps[best[some]], share[rows, best][some])
    return told


def _on_steps(
    read: Readings, result: SimulationResult, q: IntArray, steps: IntArray
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """(n, s) where on ``steps`` (n, s) the errors of readings q (n,) lie, 0 to 1; by how many m none of it does,
    infinite where nothing is known; and how far (m) that is from the sample they are read beside."""
    delta, p = result.delta, result.path.p
    i = read.sample[q]
    normal = np.einsum("qji,qi->qj", result.R_MF[i], read.way[q])  # in {M}
    begin, end = (np.einsum("qj,qsj->qs", normal, delta[some]) for some in (steps - 1, steps))
    span, error = end - begin, read.error[q][:, None]
    level = np.abs(span) < LEVEL
    share = np.where(level, 1.0, np.clip((error - begin) / np.where(level, 1.0, span), 0.0, 1.0))
    share = np.nan_to_num(share, nan=1.0)
    misses = np.nan_to_num(np.abs(begin + share * span - error), nan=np.inf)
    at = p[steps - 1] + share[..., None] * (p[steps] - p[steps - 1])
    return share, misses, np.asarray(np.linalg.norm(at - p[i][:, None], axis=-1))


def _write(told: Made, of: tuple[Readings, SimulationResult], q: IntArray, step: IntArray, share: FloatArray) -> None:
    """Into ``told``, that readings q (n,) were made at a ``share`` (n,) of a ``step`` (n,) each."""
    read, result = of
    normal = np.einsum("qji,qi->qj", result.R_MF[read.sample[q]], read.way[q])
    told.by[q] = np.column_stack([step - 1, step])
    ends = np.einsum("qbji,qj->qbi", result.R_MF[told.by[q]], normal)
    told.way[q], told.found[q] = ends * np.column_stack([1.0 - share, share])[..., None], True


def _steps_near(result: SimulationResult, samples: IntArray) -> list[IntArray]:
    """Which steps (by the samples that they lead to) pass so near to samples that one tool reaches both."""
    from scipy.spatial import cKDTree

    path = result.path
    if not len(samples):
        return []
    steps = np.flatnonzero(result.removes)
    middle, half = 0.5 * (path.p[steps] + path.p[steps - 1]), 0.5 * path.step_length[steps].max()
    reach = 2.0 * max(cutter.radius for cutter in result.tooling.cutters) + half
    return [steps[np.array(each, dtype=np.int64)] for each in cKDTree(middle).query_ball_point(path.p[samples], reach)]


def only(read: Readings, keep: BoolArray | IntArray) -> Readings:
    """Some of the readings."""
    return Readings(*(getattr(read, each.name)[keep] for each in fields(read)))
