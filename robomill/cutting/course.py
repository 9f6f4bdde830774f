"""The force over a revolution: which bits of which teeth are in the material at which instant, with helix lag."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Self

import numpy as np

from robomill.arrays import FloatArray, IntArray
from robomill.cutting.conditions import CutConditions
from robomill.cutting.edge import EdgeTerm, moments, push
from robomill.cutting.engaged import FACING, end_of, nose_of, sector_edges
from robomill.cutting.tool import Cutter
from robomill.progress import slices

#: Pieces of the flank over which the lag of the helix is taken as one.
SLICES = 36
#: Instants of one tooth pitch.
INSTANTS = 120
#: So far before and after the end of an arc a tooth is looked at, rad.
BESIDE = 1e-9
#: Angles of a half turn over which the end face that cuts is averaged.
HALF = 90
#: Cuts that are looked at together, to bound the memory.
CASES = 2048
TEETH = 4 * CASES  # teeth of all of them


@dataclass(frozen=True, eq=False)
class Course:
    """Cuts as the teeth pass through them, one a row.

    c        (k,)       feed per tooth, m
    feed     (k, 2)     the parts of the unit feed across and along the axis
    arc      (k, 2)     first and last angle in the material in the half turn ahead, rad
    sectors  (k, s, 4)  m, what is engaged in each sector of the turn, as in ``EngagedPart``
    """

    c: FloatArray
    feed: FloatArray
    arc: FloatArray
    sectors: FloatArray

    @classmethod
    def of(cls, conditions: CutConditions, cutter: Cutter, index: IntArray) -> Self:
        """Some steps (k,) of ``conditions``, made by one cutter."""
        c = conditions.f_z(cutter.flutes)[index]
        feed = np.stack([conditions.across[index], conditions.along[index]], axis=1)
        arc = np.clip(np.stack([conditions.phi_st[index], conditions.phi_ex[index]], axis=1), 0.0, np.pi)
        if conditions.part is not None:
            return cls(c, feed, arc, _within(conditions.part.sectors[index].astype(float), arc))
        a_p, half = conditions.a_p[index], np.sin((np.arange(HALF) + 0.5) * (np.pi / HALF))
        ends = [end_of(cutter, conditions.sinks[index, None], sine).mean(axis=1) for sine in (half, -half)]
        return cls(c, feed, arc, np.stack([np.stack([a_p, 0.0 * a_p, a_p, end], axis=1) for end in ends], axis=1))

    def at(self, index: IntArray | slice) -> Course:
        """Some of the cuts."""
        return Course(self.c[index], self.feed[index], self.arc[index], self.sectors[index])

    @classmethod
    def kinds(cls, conditions: CutConditions, cutter: Cutter, index: IntArray) -> tuple[Self, IntArray]:
        """One cut of each kind among some steps (k,), and the kind (k,) of each: alike are those of which each number
        is the same to a thousandth of the largest of its own cut, and angles to one of their arc."""
        known: dict[bytes, int] = {}
        kind, sectors = np.empty(len(index), dtype=np.int64), 0
        for some in slices(len(index), "Kinds of cuts", CASES):
            cuts = cls.of(conditions, cutter, index[some])
            sectors = cuts.sectors.shape[1]
            left = np.abs(cuts.arc - [0.0, np.pi])  # of the half turn: nothing stays nothing
            each = (cuts.c[:, None], cuts.feed, left, cuts.sectors.reshape(len(cuts.c), -1))
            largest = [np.abs(x).max(axis=1) for x in each]
            largest[2] = np.diff(cuts.arc, axis=1)[:, 0]
            rows = np.hstack([_to_ten_bits(x, most) for x, most in zip(each, largest, strict=True)]) + 0.0  # one zero
            kind[some] = [known.setdefault(row.tobytes(), len(known)) for row in rows]
        numbers = np.frombuffer(b"".join(known), dtype=np.float64).reshape(len(known), -1)
        c, feed, left, rest = np.split(numbers, np.cumsum([1, 2, 2]), axis=1)
        arc = np.column_stack([left[:, 0], np.pi - left[:, 1]])
        return cls(c[:, 0], feed, arc, rest.reshape(-1, sectors, 4)), kind

    def slices(self, cutter: Cutter) -> Iterator[tuple[FloatArray, FloatArray, FloatArray, FloatArray]]:
        """The cutter from its tip up, in slices of the nose and of the flank: where each begins and ends along the axis
        (k, 1) m, the angle of its normal from the axis, and its length along the profile (k, 1) m."""
        top, end = self.sectors[..., 2].max(axis=1)[:, None], cutter.nose_height
        yield from zip(*nose_of(cutter, top), strict=True)
        step = np.maximum(top - end, 0.0) / SLICES
        for i in range(SLICES if step.any() else 0):
            yield end + i * step, end + (i + 1) * step, np.full(step.shape, 0.5 * np.pi), step


def _to_ten_bits(rows: FloatArray, largest: FloatArray) -> FloatArray:
    """Every number of rows (k, n) to ten bits of the ``largest`` (k,) for its row."""
    quantum = np.exp2(np.floor(np.log2(np.where(largest > 0.0, largest, 1.0))) - 9.0)[:, None]
    return np.asarray(np.round(rows / quantum) * quantum)


def _within(sectors: FloatArray, arc: FloatArray) -> FloatArray:
    """Sectors (k, s, 4) whose means are those of their part within the arc (k, 2), if they lie ahead."""
    edges = sector_edges(sectors.shape[1])
    first, last = (np.clip(end, edges[:-1], edges[1:]) for end in (arc[:, :1], arc[:, 1:]))
    share = np.where(edges[1:] > np.pi + FACING, 1.0, (last - first) / np.diff(edges))
    result = sectors.copy()
    for n in (0, 3):
        np.divide(sectors[..., n], share, out=result[..., n], where=share > 0.0)
    return result


def evenly(cutter: Cutter) -> FloatArray:
    """(1, ``INSTANTS``) rad: the angle of a tooth, spread evenly over a pitch: forces there have the mean force."""
    return np.asarray((np.arange(INSTANTS) + 0.5)[None] / INSTANTS * 2.0 * np.pi / cutter.flutes)


def about_ends(cutter: Cutter, course: Course) -> FloatArray:
    """(k, 8) rad: the angle of a tooth just before and after its edge, at its lower and at its upper end, comes into
    the material or leaves it. There the force changes by a jump (straight edges) or most quickly, and has extremes that
    instants spread ``evenly`` pass by."""
    top = course.sectors[..., 2].max(axis=1)[:, None]
    ends = (course.arc[:, :, None] + np.array([-BESIDE, BESIDE])).reshape(len(course.c), 4)
    sense, base, lag = _turning(cutter)
    return np.hstack([sense * (ends - base) + lag * height for height in (0.0 * top, top)])


def _turning(cutter: Cutter) -> tuple[float, float, float]:
    """How a tooth turns: the sense of its angle in the cut, which is the second number (rad) at an angle of 0, and how
    far it lags behind for each metre up its edge, rad/m."""
    sense = 1.0 if cutter.hand == "right" else -1.0
    lag = math.tan(cutter.helix_angle) / cutter.radius * (cutter.pull or 1)
    return sense, 0.0 if sense > 0.0 else np.pi, lag


def force_at(terms: tuple[EdgeTerm, ...], cutter: Cutter, course: Course, angle: FloatArray) -> FloatArray:
    """Force ON the tool (k, t, 3) N when a tooth stands at each ``angle`` (1 or k, t) rad, with helix lag.

    The edge lags by z tan(helix angle) / R (constant lead); the teeth of the end face do not. The pattern repeats every
    pitch (teeth alike, no run-out), so its mean is the mean force and its extremes are those of a revolution.
    """
    sense, base, lag = _turning(cutter)
    teeth = np.arange(cutter.flutes)[:, None] * (2.0 * np.pi / cutter.flutes)
    turn = (angle[:, None] + teeth).reshape(len(angle), -1)
    force = np.zeros((len(course.c), angle.shape[1], 3))
    sectors = course.sectors
    thick = sectors[..., 2] - sectors[..., 1]
    share = np.divide(sectors[..., 0], thick, out=np.zeros(thick.shape), where=thick > 0.0)
    edges = sector_edges(sectors.shape[1])

    def add(phi: FloatArray, kappa: FloatArray, engaged: FloatArray) -> None:
        """A slice whose normal leans kappa (k, 1), so much of which (k, teeth t) m is engaged as teeth stand at phi."""
        sine, cosine, s, t = np.sin(phi), np.cos(phi), np.sin(kappa), np.cos(kappa)
        facing = course.feed[:, :1] * sine * s - course.feed[:, 1:] * t
        engaged = np.where(facing > FACING, engaged, 0.0)
        h = course.c[:, None] * np.maximum(facing, FACING)
        unit = moments(1.0, s, t, sine, cosine)
        for term in terms:
            load = engaged * h**term.exponent
            for n, share in enumerate(push(term, cutter, unit)):
                force[..., n] += (load * share).reshape(len(phi), cutter.flutes, -1).sum(axis=1)

    def seen(low: FloatArray, high: FloatArray) -> tuple[FloatArray, FloatArray, IntArray]:
        """Of the edges between two heights (k, 1) m: the angles that they are at, the share of them in the material
        there, and the sectors they are in. An edge that is partly in the arc is where the middle of that part is."""
        phi = (base + sense * (turn - 0.5 * (low + high) * lag)) % (2.0 * np.pi)
        phi, inside = _in_arc(phi, np.abs(lag) * (high - low), course.arc)
        sector = np.searchsorted(edges, phi, side="right") - 1
        inside[(sector < sectors.shape[1]) & (phi > np.pi)] = 1.0
        return phi, inside, np.minimum(sector, sectors.shape[1] - 1)

    for low, high, kappa, ds in course.slices(cutter):
        phi, inside, here = seen(low, high)
        start, stop, dense = (np.take_along_axis(q, here, axis=1) for q in (sectors[..., 1], sectors[..., 2], share))
        met = np.clip(np.minimum(stop, high) - np.maximum(start, low), 0.0, None)
        covered = np.divide(met, high - low, out=np.zeros(met.shape), where=high > low)
        add(phi, kappa, inside * dense * covered * ds)
    if sectors[..., 3].any():
        none = np.zeros((len(course.c), 1))
        phi, inside, here = seen(none, none)
        add(phi, none, inside * np.take_along_axis(sectors[..., 3], here, axis=1))
    return force


def _in_arc(phi: FloatArray, wide: FloatArray, arc: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Edges about the angles ``phi`` (k, t) rad that reach over ``wide`` (k, 1) rad: the middle of their part in the
    ``arc`` (k, 2) rad, or of all of them where they have none, and the share that it is."""
    centre, half = arc.mean(axis=1, keepdims=True), 0.5 * np.diff(arc, axis=1)
    off = (phi - centre + np.pi) % (2.0 * np.pi) - np.pi
    first, last = np.maximum(off - 0.5 * wide, -half), np.minimum(off + 0.5 * wide, half)
    met, point = last - first, wide <= 0.0
    share = np.divide(np.maximum(met, 0.0), wide, out=(met >= 0.0).astype(float), where=~point & (met >= 0.0))
    return np.where(share > 0.0, centre + 0.5 * (first + last), phi), share
