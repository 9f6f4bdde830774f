"""How much of the cutter is in the material on one step, and the march of a path through the stock, compiled."""

from __future__ import annotations

import math
from typing import NamedTuple

from robomill.compiled import Out2, kernel, part
from robomill.surface.cells_kernels import Heights, Hidden, cut_centres, cut_tilted
from robomill.surface.envelope_kernels import FLAT, Shape, move_between, profile, radius_at
from robomill.surface.tilt_kernels import UPRIGHT, TiltedMoves

ANGLES = 180  # sectors of the half turn ahead of the tool
ALONG_AXIS = 0.98  # a step that goes this much along the tool axis (cosine) has no arc of engagement
LOOK = 0.75  # cells: how far ahead of the rim, and inside its sides, material is looked up
NEAR_TOP = 0.98  # of the depth in the material: where a rounded or pointed cutter's radius is taken
TOUCH = 1e-12  # m: material this high above the cutter's edge is rounding


class Heading(NamedTuple):
    """A step seen from the tool: its middle, unit vectors along the feed (x) and to its left (y) in the tool's tip
    plane, and the part of the tool axis along z_W; all in {W}, m."""

    mx: float
    my: float
    mz: float
    xx: float
    xy: float
    xz: float
    yx: float
    yy: float
    yz: float
    rise: float


@part
def depth_ahead(heading: Heading, ahead: float, aside: float, tile: Heights, bottom: float) -> float:
    """Material above a point of the tip plane, along the tool axis, m; 0 outside the stock."""
    x = heading.mx + ahead * heading.xx + aside * heading.yx
    y = heading.my + ahead * heading.xy + aside * heading.yy
    z = heading.mz + ahead * heading.xz + aside * heading.yz
    i, j = math.floor((x - tile.x0) / tile.dx + 0.5), math.floor((y - tile.y0) / tile.dy + 0.5)
    if i < 0 or j < 0 or i >= tile.z.shape[0] or j >= tile.z.shape[1] or tile.z[i, j] <= bottom:
        return 0.0
    return max(tile.z[i, j] - max(z, bottom), 0.0) / heading.rise


@part
def cutting_radius(shape: Shape, heading: Heading, look: float, tile: Heights, bottom: float) -> float:
    """Radius at which the cutter meets the material: near the top of the deepest material ahead; 0 in air, m."""
    if shape.kind == FLAT:
        return shape.R
    depth = 0.0
    for ring in range(3):
        for n in range(ANGLES):
            phi, r = (n + 0.5) * math.pi / ANGLES, 0.5 * ring * shape.R
            depth = max(depth, depth_ahead(heading, r * math.sin(phi) + look, r * math.cos(phi), tile, bottom))
    return radius_at(shape, NEAR_TOP * depth) if depth > 0.0 else 0.0


@part
def arc_of(shape: Shape, heading: Heading, tile: Heights, bottom: float) -> tuple[float, float, float, float]:
    """(phi_st, phi_ex, a_p, a_e) of one step; see ``engagement.Engagement``."""
    look = LOOK * max(tile.dx, tile.dy)
    r = cutting_radius(shape, heading, look, tile, bottom)
    if r == 0.0:
        return 0.0, 0.0, 0.0, 0.0
    least, lateral, step = profile(shape, r) + TOUCH, max(r - look, 0.0), math.pi / ANGLES
    first, last, total, width = -1, -1, 0.0, 0.0
    for n in range(ANGLES):
        aside = lateral * math.cos((n + 0.5) * step)
        inner = max(abs(aside) - look, 0.0)
        depth = depth_ahead(heading, math.sqrt(r * r - inner * inner) + look, aside, tile, bottom)
        if depth > least:
            first = n if first < 0 else first
            last = n
            total += depth
            width += r * (math.cos(n * step) - math.cos((n + 1) * step))
    if first < 0:
        return 0.0, 0.0, 0.0, 0.0
    return first * step, (last + 1) * step, total / (last + 1 - first), width


@kernel
def engage_moves(shape: Shape, moves: TiltedMoves, tile: Heights, hidden: Hidden, bottom: float, result: Out2) -> None:
    """Engagement (phi_st, phi_ex, a_p, a_e) of moves into result (n, 4), cutting each into the heights."""
    for n in range(len(moves.ends)):
        ax, ay, az, bx, by, bz = moves.ends[n]
        kx, ky, kz = moves.axes[n]
        fx, fy, fz = bx - ax, by - ay, bz - az
        length = math.sqrt(fx * fx + fy * fy + fz * fz)
        along = fx * kx + fy * ky + fz * kz
        if abs(along) < ALONG_AXIS * length:
            across = math.sqrt(length * length - along * along)
            fx, fy, fz = (fx - along * kx) / across, (fy - along * ky) / across, (fz - along * kz) / across
            heading = Heading(
                0.5 * (ax + bx),
                0.5 * (ay + by),
                0.5 * (az + bz),
                fx,
                fy,
                fz,
                ky * fz - kz * fy,
                kz * fx - kx * fz,
                kx * fy - ky * fx,
                kz,
            )
            result[n, 0], result[n, 1], result[n, 2], result[n, 3] = arc_of(shape, heading, tile, bottom)
        if math.hypot(kx, ky) > UPRIGHT:
            cut_tilted(shape, moves.ends[n], moves.axes[n], moves.boxes[n], tile, hidden)
        else:
            cut_centres(shape, move_between(ax, ay, az, bx, by, bz), tile)
