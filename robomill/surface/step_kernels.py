"""A step as the cutter sees it, and the places of the cutter's profile, compiled."""

from __future__ import annotations

import math
from typing import NamedTuple

from robomill.arrays import FloatArray
from robomill.compiled import part
from robomill.cutting.engaged import FACING
from robomill.surface.envelope_kernels import CHAMFER, FLAT, Shape

END, NOSE, FLANK = range(3)  # the stretches of the profile
GAUSS = 0.5 - math.sqrt(3.0) / 6.0  # first node of Gauss' rule of two points on 0..1
NOSE_PIECE = 0.13  # rad of a round nose between such nodes


class Step(NamedTuple):
    """A step seen by the cutter, in {W}: tip (m), unit vectors of the feed across the axis, to its left, and the axis,
    the parts of the unit feed across and along the axis, and the run it belongs to."""

    x: float
    y: float
    z: float
    fx: float
    fy: float
    fz: float
    lx: float
    ly: float
    lz: float
    kx: float
    ky: float
    kz: float
    across: float
    along: float
    run: int


class Piece(NamedTuple):
    """A piece of the profile, from a place on one of its stretches to another: whether it is of a round nose, how far
    along it the two are and how high (m), its radius at the end, and the sine and cosine of the normals' angle there.
    """

    arc: bool
    start: float
    end: float
    low: float
    high: float
    radius: float
    sine: float
    cosine: float
    sine_end: float
    cosine_end: float


@part
def step_at(tip: FloatArray, k: FloatArray, v: FloatArray, heading: FloatArray, run: int) -> Step:
    """A tool along k (3,) with its ``tip`` (3,) m, fed along a unit v (3,); fed straight along its axis, its angles are
    counted from ``heading`` (3,), a unit vector across k."""
    along = v[0] * k[0] + v[1] * k[1] + v[2] * k[2]
    fx, fy, fz = v[0] - along * k[0], v[1] - along * k[1], v[2] - along * k[2]
    across = math.sqrt(fx * fx + fy * fy + fz * fz)
    if across < FACING:
        across = 0.0
        fx, fy, fz = heading[0], heading[1], heading[2]
    size = math.sqrt(fx * fx + fy * fy + fz * fz)
    fx, fy, fz = fx / size, fy / size, fz / size
    return Step(
        tip[0],
        tip[1],
        tip[2],
        fx,
        fy,
        fz,
        k[1] * fz - k[2] * fy,
        k[2] * fx - k[0] * fz,
        k[0] * fy - k[1] * fx,
        k[0],
        k[1],
        k[2],
        across,
        along,
        run,
    )


@part
def on_profile(shape: Shape, stretch: int, s: float) -> tuple[float, float, float, float]:
    """A point of a stretch of the profile (0 end, 1 nose, 2 flank), s m along it: radius, height, sine and cosine of
    the angle between the axis and the normal."""
    if stretch == END:
        return s, 0.0, 0.0, 1.0
    if stretch == FLANK:
        return shape.R, s, 1.0, 0.0
    if shape.kind == CHAMFER:
        slant = math.sqrt(1.0 + shape.slope**2)
        return shape.r0 + s / slant, s * shape.slope / slant, shape.slope / slant, 1.0 / slant
    sine, cosine = math.sin(s / shape.rc), math.cos(s / shape.rc)
    return shape.r0 + shape.rc * sine, shape.rc * (1.0 - cosine), sine, cosine


@part
def piece_between(shape: Shape, stretch: int, start: float, end: float) -> Piece:
    """The piece of a stretch of the profile between two places on it, m."""
    _, low, sine, cosine = on_profile(shape, stretch, start)
    radius, high, sine_end, cosine_end = on_profile(shape, stretch, end)
    arc = stretch == NOSE and shape.kind != CHAMFER
    return Piece(arc, start, end, low, high, radius, sine, cosine, sine_end, cosine_end)


@part
def stretch_ends(shape: Shape, stretch: int, reach: float) -> tuple[float, float]:
    """(from, to) m of a stretch of the profile, up to height ``reach`` above the tip."""
    nose = 0.0
    if shape.kind == CHAMFER:
        nose = shape.slope * (shape.R - shape.r0)
    elif shape.kind != FLAT:
        nose = shape.rc
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
def power(facing: float, exponent: float) -> float:
    """Chip thickness of a place that faces the feed by so much, as a force law's term has it, for a unit of feed."""
    if exponent == 1.0:
        return facing
    return 1.0 if exponent == 0.0 else max(facing, 0.0) ** exponent


@part
def edge_sums(shape: Shape, piece: Piece, faces: tuple[float, float], exponent: float) -> tuple[float, float, float]:
    """Integrals of facing^exponent times 1, sin(kappa) and cos(kappa) over a piece of the profile.

    facing = a sin(kappa) - b cos(kappa) with ``faces`` (a, b). Straight stretches and the exponents 0 and 1 in closed
    form; other exponents over a round nose by Gauss' rule of two points.
    """
    a, b = faces
    length, s, c, s_end, c_end = piece.end - piece.start, piece.sine, piece.cosine, piece.sine_end, piece.cosine_end
    if not piece.arc:
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
        kappa = (piece.start + within / pieces * length) / shape.rc
        s, c = math.sin(kappa), math.cos(kappa)
        load = 0.5 * length / pieces * power(a * s - b * c, exponent)
        plain, up, lying = plain + load, up + load * s, lying + load * c
    return plain, up, lying
