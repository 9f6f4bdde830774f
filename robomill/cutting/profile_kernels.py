"""The profile of a cutter: the one place that knows the lines of flat, ball, bull-nose and cone.

A cutter is the solid above its profile, ``h >= profile(r)``, ``r <= R``; every profile here is convex. It is asked by
radius, by height, by its arc length (the end face, then the nose, then the flank), for its normal, for where it touches
a slope, and for what an edge along it adds up to. Functions of one place are compiled into kernels; a ``Cutter`` asks
them for arrays. A cutter of another profile is a kind of ``Shape`` here, and a family in ``tool``.
"""

from __future__ import annotations

import math
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from robomill.arrays import FloatArray
from robomill.compiled import In1, Out1, Out3, kernel, part
from robomill.cutting.sines import sine_integral

FLAT, BALL, BULL, CHAMFER = range(4)
END, NOSE, FLANK = range(3)  # the stretches of the profile
ROUGH = 1e-7  # of the radius: the height is stationary at the contact, so a rough one gives it to rounding
STEPS = 40
GAUSS = 0.5 - math.sqrt(3.0) / 6.0  # first node of Gauss' rule of two points on 0..1
NOSE_PIECE = 0.13  # rad of a round nose between such nodes


class Shape(NamedTuple):
    """A convex profile in numbers (m): flat out to r0, then a corner of radius rc or a cone rising by ``slope``."""

    kind: int
    R: float
    r0: float
    rc: float
    slope: float


class Place(NamedTuple):
    """A place on a stretch of the profile: how far along it, its radius and height (m), and the sine and cosine of the
    angle between the axis and the normal there."""

    s: float
    radius: float
    height: float
    sine: float
    cosine: float


def round_nosed(R: float, corner: float) -> Shape:
    """A flat end out to R less the radius of the corner (m): without a corner a flat mill, with a full one a ball."""
    r0 = max(R - corner, 0.0)
    if r0 >= R:
        return Shape(FLAT, R, R, 0.0, 0.0)
    return Shape(BALL if r0 <= 0.0 else BULL, R, r0, R - r0, 0.0)


def conical(R: float, r0: float, half_angle: float) -> Shape:
    """A cone from a flat of radius r0 (m) up to R, ``half_angle`` rad between its flank and the axis."""
    return Shape(CHAMFER, R, r0, 0.0, 1.0 / math.tan(half_angle))


@part
def shape_of(numbers: FloatArray) -> Shape:
    """The shape whose numbers these (5,) are, first of a longer row or alone."""
    return Shape(int(numbers[0]), numbers[1], numbers[2], numbers[3], numbers[4])


@part
def clip(value: float, low: float, high: float) -> float:
    """Value held between low and high."""
    return min(max(value, low), high)


@part
def profile(shape: Shape, r: float) -> float:
    """Height of the cutting surface above the tip at radius r <= R, m."""
    e = max(r - shape.r0, 0.0)
    if shape.kind == FLAT:
        return 0.0
    if shape.kind == CHAMFER:
        return shape.slope * e
    return shape.rc - math.sqrt(max(shape.rc**2 - e * e, 0.0))


@part
def profile_within(shape: Shape, square: float) -> float:
    """Height of the cutting surface above the tip where the squared radius is so much, m; a ball's and that of a flat
    end without its root."""
    if square <= shape.r0 * shape.r0:
        return 0.0
    if shape.kind == BALL:
        return shape.rc - math.sqrt(max(shape.rc**2 - square, 0.0))
    return profile(shape, math.sqrt(square))


@part
def radius_at(shape: Shape, height: float) -> float:
    """Radius of the cutter ``height`` > 0 above its tip, m: the inverse of its profile."""
    if shape.kind == FLAT:
        return shape.R
    if shape.kind == CHAMFER:
        return min(shape.R, shape.r0 + height / shape.slope)
    h = min(height, shape.rc)
    return shape.r0 + math.sqrt(h * (2.0 * shape.rc - h))


@part
def upright_part(shape: Shape, r: float) -> float:
    """Part along the axis of the normal of a cutter's surface at radius r: 1 on its flat."""
    e = max(r - shape.r0, 0.0)
    if e == 0.0 or shape.kind == FLAT:
        return 1.0
    if shape.kind == CHAMFER:
        return 1.0 / math.sqrt(1.0 + shape.slope * shape.slope)
    return math.sqrt(max(shape.rc * shape.rc - e * e, 0.0)) / shape.rc


def valley(shape: Shape, size: float) -> float:
    """How deep a valley the nose leaves between places ``size`` (m) apart, at most, m."""
    if shape.kind == CHAMFER:
        return 0.5 * size * shape.slope
    return size**2 / shape.rc if shape.rc > 0.0 else 0.0


@part
def contact_lag(shape: Shape, m: float, v2: float) -> float:
    """How far behind a point (along the move) the cutter stands when it cuts lowest there, m.

    m >= 0: rise of the move per length in plan; v2: squared distance of the point from the move's line, <= R^2.
    It solves ``m = profile'(r) w / r`` with ``r^2 = w^2 + v^2``; a level move gives 0.
    """
    if m == 0.0:
        return 0.0
    widest = math.sqrt(max(shape.R**2 - v2, 0.0))
    if shape.kind == FLAT:
        return widest
    if shape.kind == BALL:
        return widest * m / math.sqrt(1.0 + m * m)
    kink = math.sqrt(max(shape.r0**2 - v2, 0.0))
    if shape.kind == CHAMFER:
        if m >= shape.slope:
            return widest
        return clip(math.sqrt(v2) * m / math.sqrt(shape.slope**2 - m * m), kink, widest)
    # Newton's steps on f(w) = e w - m r sqrt(rc^2 - e^2), which rises from f(kink) <= 0, held in a bracket
    low, high, w = kink, widest, kink
    for _ in range(STEPS):
        r = math.sqrt(w * w + v2)
        e = max(r - shape.r0, 0.0)
        root = math.sqrt(max(shape.rc**2 - e * e, 0.0))
        f = e * w - m * r * root
        low, high = (w, high) if f < 0.0 else (low, w)
        if abs(f) < ROUGH * m * shape.R**2 or high - low < ROUGH * shape.R:
            break
        w -= f / (e + w / r * (w - m * root + m * r * e / root))
        if not low < w < high:
            w = 0.5 * (low + high)
    return w


@part
def on_profile(shape: Shape, stretch: int, s: float) -> Place:
    """The place ``s`` m along a stretch of the profile (0 end, 1 nose, 2 flank)."""
    if stretch == END:
        return Place(s, s, 0.0, 0.0, 1.0)
    if stretch == FLANK:
        return Place(s, shape.R, s, 1.0, 0.0)
    if shape.kind == CHAMFER:
        slant = math.sqrt(1.0 + shape.slope**2)
        return Place(s, shape.r0 + s / slant, s * shape.slope / slant, shape.slope / slant, 1.0 / slant)
    sine, cosine = math.sin(s / shape.rc), math.cos(s / shape.rc)
    return Place(s, shape.r0 + shape.rc * sine, shape.rc * (1.0 - cosine), sine, cosine)


@part
def beside_place(shape: Shape, stretch: int, near: Place, s: float) -> Place:
    """The place ``s`` m along a stretch of the profile, known one so near that its normal is turned by less than 0.1
    rad: on a round nose by the series of the small angle between them."""
    if stretch != NOSE:
        return on_profile(shape, stretch, s)
    if shape.kind == CHAMFER:
        return Place(s, shape.r0 + s * near.cosine, s * near.sine, near.sine, near.cosine)
    turn = (s - near.s) / shape.rc
    q = turn * turn
    c = 1.0 - q * (1.0 / 2.0) * (1.0 - q * (1.0 / 12.0) * (1.0 - q * (1.0 / 30.0) * (1.0 - q * (1.0 / 56.0))))
    d = 1.0 - q * (1.0 / 6.0) * (1.0 - q * (1.0 / 20.0) * (1.0 - q * (1.0 / 42.0) * (1.0 - q * (1.0 / 72.0))))
    d *= turn
    sine, cosine = near.sine * c + near.cosine * d, near.cosine * c - near.sine * d
    return Place(s, shape.r0 + shape.rc * sine, shape.rc * (1.0 - cosine), sine, cosine)


@part
def stretch_ends(shape: Shape, stretch: int, reach: float) -> tuple[float, float]:
    """(from, to) m of a stretch of the profile, up to height ``reach`` above the tip."""
    nose = profile(shape, shape.R)
    if stretch == END:
        return 0.0, shape.r0
    if stretch == FLANK:
        return nose, max(nose, reach)
    if shape.kind == CHAMFER:
        return 0.0, min(nose, max(reach, 0.0)) / shape.slope * math.sqrt(1.0 + shape.slope**2)
    if shape.kind == FLAT or reach <= 0.0:
        return 0.0, 0.0
    return 0.0, shape.rc * (math.acos(1.0 - reach / shape.rc) if reach < shape.rc else 0.5 * math.pi)


@part
def facing_part(shape: Shape, stretch: int, faces: tuple[float, float]) -> tuple[float, float]:
    """From where to where on a stretch of the profile, m, its surface faces the feed: where a sin(kappa) is more than
    b cos(kappa), with ``faces`` (a, b)."""
    a, b = faces
    if stretch == NOSE and shape.kind != CHAMFER:
        turn = math.atan2(b, a) if b != 0.0 else 0.0 if a > 0.0 else math.pi
        return shape.rc * turn, shape.rc * (turn + math.pi)
    at = on_profile(shape, stretch, 0.0)
    return (-math.inf, math.inf) if a * at.sine > b * at.cosine else (math.inf, -math.inf)


@part
def heel(radius: Any, sinks: Any, sine: Any) -> Any:
    """Radius from which on the flat end of a mill cuts, m, at an angle of this ``sine`` on a slope that is ``sinks`` (0
    to 1) times as steep as its teeth are ground hollow; ``radius`` (m), where the end ends, or more: it cuts nowhere.

    A place r of the hollow end is higher than its rim by (radius - r) tan(dish). The rim has passed it, as far ahead as
    it lies on the way, higher by that way times the slope: material stands where that is more, which is beyond an
    ellipse with its focus in the axis. On the level it touches the rim behind, at the dish it has shrunk to the axis.
    """
    return radius * (1.0 - sinks * sinks) / (1.0 - 2.0 * sinks * sine + sinks * sinks + 1e-300)


@part
def power(facing: float, exponent: float) -> float:
    """Chip thickness of a place that faces the feed by so much, as a force law's term has it, for a unit of feed."""
    if exponent == 1.0:
        return facing
    return 1.0 if exponent == 0.0 else max(facing, 0.0) ** exponent


@part
def edge_sums(
    shape: Shape, ends: tuple[Place, Place], faces: tuple[float, float], exponent: float
) -> tuple[float, float, float]:
    """Integrals of facing^exponent times 1, sin(kappa) and cos(kappa) over a stretch of the profile from one place on
    it to another.

    facing = a sin(kappa) - b cos(kappa) with ``faces`` (a, b). Straight stretches and the exponents 0 and 1 in closed
    form; other exponents over a round nose by Gauss' rule of two points.
    """
    (a, b), (start, end) = faces, ends
    length, s, c, s_end, c_end = end.s - start.s, start.sine, start.cosine, end.sine, end.cosine
    if s == s_end:
        load = length * power(a * s - b * c, exponent)
        return load, load * s, load * c
    if exponent == 0.0:
        return length, shape.rc * (c - c_end), shape.rc * (s_end - s)
    if exponent == 1.0:
        twice, mixed = shape.rc * (s_end * c_end - s * c), 0.5 * shape.rc * (s_end * s_end - s * s)
        upright, lying = 0.5 * (length - twice), 0.5 * (length + twice)
        plain = shape.rc * (a * (c - c_end) - b * (s_end - s))
        return plain, a * upright - b * mixed, a * mixed - b * lying
    pieces = int(length / (NOSE_PIECE * shape.rc)) + 1
    plain = up = lying = 0.0
    for n in range(2 * pieces):
        within = n // 2 + (GAUSS if n % 2 == 0 else 1.0 - GAUSS)
        kappa = (start.s + within / pieces * length) / shape.rc
        s, c = math.sin(kappa), math.cos(kappa)
        load = 0.5 * length / pieces * power(a * s - b * c, exponent)
        plain, up, lying = plain + load, up + load * s, lying + load * c
    return plain, up, lying


def depth_moment(shape: Shape, depth: ArrayLike, p: float, q: int) -> FloatArray:
    """Integral over z from the tip to ``depth`` (...,) m of sin^p(kappa) cos^q(kappa), q = 0 or 1; p > -2 on a nose."""
    a, top = np.asarray(depth, dtype=np.float64), profile(shape, shape.R)
    nose = np.minimum(a, top)
    side = (a - nose) if q == 0 else np.zeros_like(a)
    if top == 0.0:
        return side
    if shape.kind == CHAMFER:
        half = math.atan(1.0 / shape.slope)
        return side + nose * math.cos(half) ** p * math.sin(half) ** q
    kappa = 2.0 * np.arcsin(np.sqrt(np.clip(nose / (2.0 * shape.rc), 0.0, 0.5)))
    if q == 0:
        return side + shape.rc * sine_integral(p + 1.0, kappa)
    return side + shape.rc * np.sin(kappa) ** (p + 2.0) / (p + 2.0)


@kernel(few=64)
def heights(r: In1, shape: Shape, height: Out1) -> None:
    """Height of the profile at radii (n,) m."""
    for n in range(len(r)):
        height[n] = profile(shape, r[n])


@kernel(few=64)
def radii(height: In1, shape: Shape, radius: Out1) -> None:
    """Radius of the cutter at heights (n,) m above its tip."""
    for n in range(len(height)):
        radius[n] = radius_at(shape, height[n])


@kernel(few=64)
def nose_pieces(top: In1, shape: Shape, pieces: Out3) -> None:
    """The nose up to heights (n,) m in equal pieces, (4, q, n): where each begins and ends above the tip, the angle
    between the axis and its normal, and its length."""
    count = pieces.shape[1]
    for n in range(len(top)):
        _, end = stretch_ends(shape, NOSE, top[n])
        for q in range(count):
            middle = on_profile(shape, NOSE, end * (q + 0.5) / count)
            pieces[0, q, n] = on_profile(shape, NOSE, end * q / count).height
            pieces[1, q, n] = on_profile(shape, NOSE, end * (q + 1) / count).height
            pieces[2, q, n], pieces[3, q, n] = math.atan2(middle.sine, middle.cosine), end / count
