"""Which samples of a corrected program stand at the sharp corners of the path that it was corrected for.

At a corner a corrected cut ends where its own deflection is undone, a little before the corner or beyond it, and the
next one begins where that is undone; a short link leads across. All three belong to the corner, and are known by their
directions: what comes before goes the way of the one cut, what follows that of the other, and the link any way.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from robomill.arrays import BoolArray, FloatArray, IntArray
from robomill.toolpath.sampling import CORNER
from robomill.vectors import across, angle_between

SAME = 1e-6  # m: steps that go no further stay at one place
FARTHEST = 2e-3  # m: no corrected program goes further beside its path, and none leaves out more of it: an arm that is
# pushed further off is not predicted by its springs at rest
LINKED = 0.05  # of its length: what a link costs; a step of a cut costs as much as it leads aside
UPRIGHT = 1e-2  # of its length: what a step along the tool's axis costs in a cut across it, and half of it in a link
ON_THE_SPOT = 0.3  # of the length that a line lacks to lead on by half of it: what it costs in a cut
STEEP = 0.5  # of a step, and less, leads across the tool where it is on the way down or up


@dataclass(frozen=True, eq=False)
class Ways:
    """The steps of a cut that go anywhere: where they end, s (n,) m along it and p (n, 3) m, and their ways (n, 3)
    across the tool, 0 on the way down or up; ``corners`` are those behind which it turns sharply."""

    s: FloatArray
    p: FloatArray
    way: FloatArray
    corners: IntArray

    @classmethod
    def of(cls, p: FloatArray, k: FloatArray) -> Ways:
        """Of a cut p (m, 3) m with tool axes k (m, 3)."""
        step = np.diff(p, axis=0)
        length = np.linalg.norm(step, axis=1)
        moving = np.flatnonzero(length >= SAME)
        s, step, length = np.cumsum(length)[moving], step[moving], length[moving]
        flat = across(step, k[moving + 1])
        size = np.linalg.norm(flat, axis=1)
        level = size > STEEP * length
        way = np.where(level[:, None], flat / np.where(size > 0.0, size, 1.0)[:, None], 0.0)
        turns = np.where(level[:, None], way, step)
        sharp = (level[:-1] | level[1:]) & (angle_between(turns[:-1], turns[1:]) >= CORNER)
        return cls(s, p[moving + 1], way, np.flatnonzero(sharp))


def at_corners(q: FloatArray, k: FloatArray, line: IntArray, s: FloatArray, cut: Ways) -> tuple[FloatArray, BoolArray]:
    """(n,) m along a ``cut``: s (n,), where samples q (n, 3) m with tool axes k (n, 3), of a ``line`` (n,) each, are
    nearest to it, with those that belong to its corners there, what comes before them no later, and what follows no
    earlier; and (n,) those at which one cut ends and the next begins."""
    s, meets = s.copy(), np.zeros(len(s), dtype=bool)
    ends = np.append(line[1:] != line[:-1], True)
    places = np.concatenate([[0.0], cut.s[cut.corners], cut.s[-1:]])
    for n, corner in enumerate(cut.corners.tolist()):
        at = places[n + 1]
        low, high = (
            max(0.5 * (places[n] + at), at - 2.0 * FARTHEST),
            min(0.5 * (at + places[n + 2]), at + 2.0 * FARTHEST),
        )
        some = np.flatnonzero((s >= low) & (s <= high))
        if not len(some):
            continue
        some = np.arange(some[0], some[-1] + 1)
        near = np.linalg.norm(across(q[some] - cut.p[corner], k[some]), axis=1) <= FARTHEST
        if not (near & ends[some]).any():
            continue
        first, last = _link(q[some], k[some], np.flatnonzero(near & ends[some]), s[some], (cut, corner))
        s[some[:first]] = np.minimum(s[some[:first]], at)
        s[some[first : last + 1]] = at
        meets[some[[first, last]]] = True
        s[some[last + 1 :]] = np.maximum(s[some[last + 1 :]], at)
    return s, meets


def _link(q: FloatArray, k: FloatArray, ends: IntArray, s: FloatArray, where: tuple[Ways, int]) -> tuple[int, int]:
    """The samples of q (n, 3) m, about s (n,) m along a cut, at which it ends at a corner and begins anew: two of the
    ``ends`` of lines with one line between them, or the same where no link leads across."""
    cut, corner = where
    of = np.minimum(np.searchsorted(cut.s, s[1:] - SAME), len(cut.s) - 1)
    step = np.diff(q, axis=0)
    flat = across(step, k[1:])
    up = np.linalg.norm(step - flat, axis=1)
    one = _summed(_aside(flat, up, cut.way[np.minimum(of, corner)]))
    other = _summed(_aside(flat, up, cut.way[np.maximum(of, corner + 1)]))
    a, b = ends[:-1], ends[1:]
    length, height = np.linalg.norm(across(q[b] - q[a], k[b]), axis=1), np.diff(_summed(0.5 * UPRIGHT * up)[ends])
    off = across(q[ends] - cut.p[corner], k[ends])
    to, on = np.minimum(off @ cut.way[corner], 0.0), np.maximum(off @ cut.way[corner + 1], 0.0)
    lacking = [_summed(ON_THE_SPOT * np.maximum(0.5 * length - np.diff(gone), 0.0)) for gone in (to, on)]
    before, after = one[ends] + lacking[0], other[-1] - other[ends] + lacking[1][-1] - lacking[1]
    alone, linked = before + after, before[:-1] + LINKED * length + height + after[1:]
    if len(linked) and linked.min() < alone.min():
        n = int(np.argmin(linked))
        return int(a[n]), int(b[n])
    n = int(np.argmin(alone))
    return int(ends[n]), int(ends[n])


def _aside(flat: FloatArray, up: FloatArray, way: FloatArray) -> FloatArray:
    """(n,) m: how far steps ``flat`` (n, 3) m across the tool, ``up`` (n,) m along it, lead aside of their ways (n, 3)
    or against them; those that hardly lead across it cost a little on a level one, and no more than a link does on the
    way down or up, along which a correction fades."""
    size, along = np.linalg.norm(flat, axis=1), np.einsum("ni,ni->n", flat, way)
    aside = np.where(along > 0.0, np.sqrt(np.maximum(size**2 - along**2, 0.0)), size)
    level, upright = way.any(axis=1), size < 0.1 * up
    aside = np.where(upright & ~level, LINKED * size, aside)
    return np.asarray(aside + np.where(level & upright, UPRIGHT * up, 0.0))


def _summed(cost: FloatArray) -> FloatArray:
    return np.append(0.0, np.cumsum(cost))
