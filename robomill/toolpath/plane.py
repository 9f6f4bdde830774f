"""Turns, places and circles in a plane: each law of them once, for G-code, tables, sketches and drawings.

Plain Python on numbers, angles in rad, counter-clockwise; a place is (u, v). The rules of G-code are compiled with what
they use of it, so nothing here may use more of Python than numba knows.
"""

import math
from collections.abc import Sequence
from typing import Any

from robomill.arrays import FloatArray

Place = Sequence[float] | FloatArray
FULL_TURN = 1e-8
"""rad: an arc that would sweep less than this is a full turn, as an arc back to its start is."""
ORIGIN = -0.0
"""What changes no number it is added to, the sign of a zero included, so that compilers leave it out."""
_TURN = 2.0 * math.pi


# --- planes of a machine
def axes(plane: Any) -> tuple[Any, Any, Any]:
    """First, second and third axis of G17 (x, y, z), G18 (z, x, y) or G19 (y, z, x), or of an array of planes.

    A positive turn leads from the first to the second, a helix climbs along the third.
    """
    third = 19 - plane
    return (third + 1) % 3, (third + 2) % 3, third


def from_plane(plane: int, u: float, v: float, w: float) -> tuple[float, float, float]:
    """(x, y, z) of a point at ``u``, ``v`` along the first two axes of a plane and ``w`` along the third."""
    if plane == 17:
        return u, v, w
    return (v, w, u) if plane == 18 else (w, u, v)


# --- places
def turned(x: float, y: float, angle: float, u: float = ORIGIN, v: float = ORIGIN) -> tuple[float, float]:
    """(x, y) turned by ``angle``, from the place (u, v) on."""
    return u + x * math.cos(angle) - y * math.sin(angle), v + x * math.sin(angle) + y * math.cos(angle)


def polar(radius: float, angle: float, u: float = ORIGIN, v: float = ORIGIN) -> tuple[float, float]:
    """The place at ``radius`` and ``angle`` from (u, v)."""
    return u + radius * math.cos(angle), v + radius * math.sin(angle)


# --- circles
def swept(start: Place, end: Place, centre: Place, turn: int, least: float = FULL_TURN) -> float:
    """Signed angle from ``start`` to ``end`` about ``centre`` in ``turn`` started turns, negative for clockwise.

    A part of a turn that is not more than ``least``, or within it of a turn, is a full turn.
    """
    part = math.atan2(end[1] - centre[1], end[0] - centre[0]) - math.atan2(start[1] - centre[1], start[0] - centre[0])
    if turn < 0:
        part = -part
    if part <= 0.0:
        part += _TURN
    if part <= least or _TURN - part < least:
        part = _TURN
    part += (abs(turn) - 1) * _TURN
    return part if turn > 0 else -part


def centre_by_radius(start: Place, end: Place, radius: float, turn: int) -> tuple[float, float]:
    """The centre of the arc from ``start`` to another place ``end``, in the sense of ``turn``.

    A radius above 0 is the arc of at most half a turn, below 0 the other one about the mirrored centre; where it does
    not reach, the centre is the middle of the two.
    """
    size, half = abs(radius), 0.5 * math.hypot(end[0] - start[0], end[1] - start[1])
    share = 1.0 if size == 0.0 or half / size > 1.0 - 1e-12 else half / size
    side = 1.0 if (turn > 0) == (radius > 0.0) else -1.0
    towards = math.atan2(end[1] - start[1], end[0] - start[0]) + side * math.pi / 2.0
    away = size * math.cos(math.asin(share))
    return polar(away, towards, (end[0] + start[0]) / 2.0, (end[1] + start[1]) / 2.0)


def doubled_area(a: Place, b: Place, c: Place) -> float:
    """Twice the area of a triangle: above 0 where its corners turn counter-clockwise, 0 where they are on a line."""
    return float((b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]))


def through(a: Place, b: Place, c: Place) -> tuple[float, float]:
    """The centre of the circle through three places, which are not on a line."""
    bx, by, cx, cy = b[0] - a[0], b[1] - a[1], c[0] - a[0], c[1] - a[1]
    twice, bb, cc = 2.0 * doubled_area(a, b, c), bx * bx + by * by, cx * cx + cy * cy
    return a[0] + (cy * bb - by * cc) / twice, a[1] + (bx * cc - cx * bb) / twice
