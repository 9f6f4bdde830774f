"""The force over a revolution: which bits of which teeth are in the material at which instant, with helix lag."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Self

import numpy as np

from robomill.arrays import FloatArray, IntArray
from robomill.cutting.conditions import CutConditions
from robomill.cutting.edge import EdgeTerm, depth_sums
from robomill.cutting.tool import Cutter

#: Pieces of the depth over which the lag of the helix is taken as one.
SLICES = 48
#: Instants of one tooth pitch.
INSTANTS = 120


@dataclass(frozen=True, eq=False)
class Course:
    """Cuts as the teeth pass through them, one a row.

    c     (k,)       feed per tooth across the axis, m
    arc   (k, 2)     first and last angle in the material, rad
    span  (k, s, 2)  where the material begins and ends along the axis in s equal sectors of the half turn, m
    """

    c: FloatArray
    arc: FloatArray
    span: FloatArray

    @classmethod
    def of(cls, conditions: CutConditions, cutter: Cutter, index: IntArray) -> Self:
        """Some steps (k,) of ``conditions``, made by one cutter."""
        c = (conditions.f_z(cutter.flutes) * conditions.across)[index]
        arc = np.clip(np.stack([conditions.phi_st[index], conditions.phi_ex[index]], axis=1), 0.0, np.pi)
        if conditions.part is None:
            span = np.stack([0.0 * c, conditions.a_p[index]], axis=-1)[:, None]
        else:
            span = conditions.part.spans[index].astype(float)
            span = np.where(span[..., :1] <= span[..., 1:], span, 0.0)
        return cls(c, arc, span)

    def at(self, index: IntArray) -> Course:
        """Some of the cuts."""
        return Course(self.c[index], self.arc[index], self.span[index])

    def alike(self, mean: FloatArray) -> tuple[IntArray, IntArray]:
        """One cut of each kind, and the kind (k,) of every cut; alike are those within a thousandth of the largest, in
        their mean force (k, 3) too."""
        numbers = np.concatenate([self.c[:, None], self.arc, self.span.reshape(len(self.c), -1), mean], axis=1)
        scale = np.max(np.abs(numbers), axis=0) * 1e-3
        rounded = np.round(numbers / np.where(scale > 0.0, scale, 1.0))
        _, first, inverse = np.unique(rounded, axis=0, return_index=True, return_inverse=True)
        return first, inverse.ravel()


def force_over_pitch(
    terms: tuple[EdgeTerm, ...], cutter: Cutter, course: Course, instants: int = INSTANTS
) -> FloatArray:
    """Force ON the tool at ``instants`` evenly spread over one tooth pitch, (k, instants, 3) N, with helix lag.

    The depth is cut into ``SLICES``; the edge lags by z tan(helix angle) / R (constant lead). The pattern repeats
    every pitch (teeth alike, no run-out), so its mean is the mean force and its extremes are those of a revolution.
    """
    c, arc, span = course.c[:, None], course.arc, course.span
    mirror = cutter.hand == "left"
    if mirror:  # a left-hand cutter is a right-hand one seen in a mirror along the feed
        arc, span = np.pi - arc[:, ::-1], span[:, ::-1]
    sectors, top = span.shape[1], span[..., 1].max(axis=1)[:, None]
    pitch = 2.0 * np.pi / cutter.flutes
    turn = (np.arange(instants) + 0.5) * (pitch / instants)
    lag_per_depth = math.tan(cutter.helix_angle) / cutter.radius * (cutter.pull or 1)
    force = np.zeros((len(c), instants, 3))
    for i in range(SLICES):
        low, high = top * (i / SLICES), top * ((i + 1) / SLICES)
        middle = 0.5 * (low + high)
        loads = []
        for term in terms:
            above, below = (depth_sums(term, cutter, depth, cutter.pull) for depth in (high, low))
            loads.append([c**term.exponent * (x - y) for x, y in zip(above, below, strict=True)])
        for tooth in range(cutter.flutes):
            phi = (turn + tooth * pitch - middle * lag_per_depth) % (2.0 * np.pi)
            sector = np.minimum(phi * (sectors / np.pi), sectors - 1).astype(np.int64)
            first, last = (np.take_along_axis(span[..., end], sector, axis=1) for end in (0, 1))
            inside = (phi >= arc[:, :1]) & (phi <= arc[:, 1:]) & (middle >= first) & (middle <= last)
            sine, cosine = np.sin(np.minimum(phi, np.pi)), np.cos(phi)
            for term, (tangential, radial, axial) in zip(terms, loads, strict=True):
                power = np.where(inside, np.maximum(sine, 0.0) ** term.exponent, 0.0)
                force[..., 0] -= power * (tangential * cosine + radial * sine)
                force[..., 1] += power * (tangential * sine - radial * cosine)
                force[..., 2] += power * axial
    if mirror:
        force[..., 1] *= -1.0
    return force
