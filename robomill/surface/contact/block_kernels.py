"""Moves that lie together in one box, so that most are passed over at once: at fine steps thousands come by a place,
and but a few of them make its wall or floor. Compiled.

A box tells how far its moves can reach at most; where that changes nothing none of them is looked at. What is found is
what all of them would have given.
"""

from __future__ import annotations

import math
from typing import NamedTuple

from robomill.compiled import In1, Out2, OutInt1, part

NOTHING = 1e-12  # m: what would be found beyond by no more is rounding


class Blocks(NamedTuple):
    """Moves of a square that follow one another, as told and as left: the first block of each square (nx ny + 1,), the
    first move of each block (b + 1,), and boxes (b, 7) round their ends: middle, half the size, largest radius, m."""

    of_square: OutInt1
    first: OutInt1
    told: Out2
    left: Out2


class Box(NamedTuple):
    """A box seen from a place, m: its span along u, how near it comes to the line along u, its lowest height above the
    tip, and the largest radius of its cutters."""

    u_low: float
    u_high: float
    aside: float
    low: float
    R: float


@part
def seen_box(place: In1, box: In1) -> Box:
    """A box in the axes of a place (c, k, u, ...)."""
    kx, ky, kz, ux, uy, uz = place[3], place[4], place[5], place[6], place[7], place[8]
    vx, vy, vz = ky * uz - kz * uy, kz * ux - kx * uz, kx * uy - ky * ux
    x, y, z = box[0] - place[0], box[1] - place[1], box[2] - place[2]
    u, du = x * ux + y * uy + z * uz, box[3] * abs(ux) + box[4] * abs(uy) + box[5] * abs(uz)
    v, dv = x * vx + y * vy + z * vz, box[3] * abs(vx) + box[4] * abs(vy) + box[5] * abs(vz)
    h, dh = x * kx + y * ky + z * kz, box[3] * abs(kx) + box[4] * abs(ky) + box[5] * abs(kz)
    return Box(u - du, u + du, max(abs(v) - dv, 0.0), h - dh, box[6])


@part
def span(box: Box) -> tuple[float, float]:
    """How far at most tracks of the moves in a box cover the line along u, m: (from, to), from > to if nowhere."""
    if box.aside > box.R:
        return math.inf, -math.inf
    half = math.sqrt(box.R * box.R - box.aside * box.aside)
    return box.u_low - half, box.u_high + half


@part
def depth_in(box: Box, out: float) -> float:
    """How deep (m) the point ``out`` along u can lie in a track of the moves in a box, < 0 outside of all."""
    return box.R - math.hypot(max(box.u_low - out, out - box.u_high, 0.0), box.aside)
