"""The compiled twin of ``engagement.py``: one step at a time through the heights."""

from __future__ import annotations

import math

from numba import njit

from robomill.surface.kernels import (
    CHAMFER,
    FLAT,
    inverse_direction,
    move_of,
    profile,
    row_interval,
    swept_height,
)
from robomill.surface.tilted_kernels import tilted_interval


@njit(cache=True, nogil=True)
def radius_at(shape, height):  # type: ignore[no-untyped-def]
    """Radius of the cutter ``height`` > 0 above its tip."""
    kind, R, r0, rc, slope = shape
    if kind == FLAT:
        return R
    if kind == CHAMFER:
        return min(R, r0 + height / slope)
    h = min(height, rc)
    return r0 + math.sqrt(max(0.0, h * (2.0 * rc - h)))


@njit(cache=True, nogil=True)
def depth_ahead(frame, ahead, aside, grid, z, bottom):  # type: ignore[no-untyped-def]
    """Material above a point of the tip plane, along the tool axis; frame = middle, e_x, e_y, rise of the axis."""
    mx, my, mz, xx, xy, xz, yx, yy, yz, rise = frame
    x0, y0, dx, dy = grid
    i = math.floor((mx + ahead * xx + aside * yx - x0) / dx + 0.5)
    j = math.floor((my + ahead * xy + aside * yy - y0) / dy + 0.5)
    if i < 0 or j < 0 or i >= z.shape[0] or j >= z.shape[1]:
        return 0.0
    height = z[i, j]
    if height <= bottom:
        return 0.0
    return max(height - max(mz + ahead * xz + aside * yz, bottom), 0.0) / rise


@njit(cache=True, nogil=True)
def step_engagement(shape, frame, look, angles, grid, z, bottom):  # type: ignore[no-untyped-def]
    """(phi_st, phi_ex, a_p, a_e) of one step."""
    step = math.pi / angles
    r = shape[1]
    if shape[0] != FLAT:
        depth = 0.0
        for radius in (shape[1], 0.5 * shape[1], 0.0):
            for n in range(angles):
                phi = (n + 0.5) * step
                ahead, aside = radius * math.sin(phi) + look, radius * math.cos(phi)
                depth = max(depth, depth_ahead(frame, ahead, aside, grid, z, bottom))
        if depth <= 0.0:
            return 0.0, 0.0, 0.0, 0.0
        r = radius_at(shape, 0.98 * depth)
    least = profile(shape, r) + 1e-12
    lateral = r - look if r > look else 0.0
    first, last, total, width = -1, -1, 0.0, 0.0
    for n in range(angles):
        aside = lateral * math.cos((n + 0.5) * step)
        inner = max(abs(aside) - look, 0.0)
        depth = depth_ahead(frame, math.sqrt(max(r * r - inner * inner, 0.0)) + look, aside, grid, z, bottom)
        if depth > least:
            if first < 0:
                first = n
            last = n
            total += depth
            width += r * (math.cos(n * step) - math.cos((n + 1) * step))
    if first < 0:
        return 0.0, 0.0, 0.0, 0.0
    return first * step, (last + 1) * step, total / (last + 1 - first), width


@njit(cache=True, nogil=True)
def cut_centres(shape, move, grid, z, bottom):  # type: ignore[no-untyped-def]
    """Cut one move of an upright cutter into the heights at cell centres."""
    x0, y0, dx, dy = grid
    ax, ay, az, ux, uy, length, m = move
    R = shape[1]
    level = m == 0.0 and shape[0] == FLAT
    floor = max(az, bottom)
    inverse = inverse_direction(move)
    first = max(0, math.ceil((ax + min(0.0, length * ux) - R - x0) / dx))
    last = min(z.shape[0] - 1, math.floor((ax + max(0.0, length * ux) + R - x0) / dx))
    for i in range(first, last + 1):
        x = x0 + i * dx
        low, high = row_interval(move, inverse, R, x)
        if low > high:
            continue
        for j in range(max(0, math.ceil((low - y0) / dy)), min(z.shape[1] - 1, math.floor((high - y0) / dy)) + 1):
            if z[i, j] > floor:
                height = floor if level else max(bottom, swept_height(shape, move, x, y0 + j * dy))
                z[i, j] = min(z[i, j], height)


@njit(cache=True, nogil=True)
def cut_centres_tilted(shape, a, b, k, grid, z):  # type: ignore[no-untyped-def]
    """Cut one move of a tilted cutter into the heights at cell centres."""
    x0, y0, dx, dy = grid
    sine = math.hypot(k[0], k[1])
    e1x, e1y = -k[1] / sine, k[0] / sine
    e2x, e2y = -k[2] * e1y, k[2] * e1x
    move = move_of(
        a[0] * e1x + a[1] * e1y,
        a[0] * e2x + a[1] * e2y + a[2] * sine,
        a[0] * k[0] + a[1] * k[1] + a[2] * k[2],
        b[0] * e1x + b[1] * e1y,
        b[0] * e2x + b[1] * e2y + b[2] * sine,
        b[0] * k[0] + b[1] * k[1] + b[2] * k[2],
    )
    R = shape[1]
    up = max(0.0, z.max() - min(a[2], b[2]) + R * sine) / k[2]
    x_low, x_high = min(a[0], b[0]) + min(0.0, up * k[0]) - R, max(a[0], b[0]) + max(0.0, up * k[0]) + R
    y_low, y_high = min(a[1], b[1]) + min(0.0, up * k[1]) - R, max(a[1], b[1]) + max(0.0, up * k[1]) + R
    for i in range(max(0, math.ceil((x_low - x0) / dx)), min(z.shape[0] - 1, math.floor((x_high - x0) / dx)) + 1):
        x = x0 + i * dx
        for j in range(max(0, math.ceil((y_low - y0) / dy)), min(z.shape[1] - 1, math.floor((y_high - y0) / dy)) + 1):
            y = y0 + j * dy
            X, Y0, h0 = x * e1x + y * e1y, x * e2x + y * e2y, x * k[0] + y * k[1]
            low, high = tilted_interval(shape, move, X, Y0, h0, (sine, k[2]), z[i, j])
            if low < high and high >= z[i, j]:
                z[i, j] = low


@njit(cache=True, nogil=True)
def engage_moves(shape, p, axes, used, grid, z, bottom, angles, result, start, stop):  # type: ignore[no-untyped-def]
    """Engagement of steps start..stop into result (m, 5), cutting each into z."""
    look = 0.75 * max(grid[2], grid[3])
    for n in range(max(start, 1), stop):
        if not used[n]:
            continue
        a, b = p[n - 1], p[n]
        kx, ky, kz = axes[n - 1, 0] + axes[n, 0], axes[n - 1, 1] + axes[n, 1], axes[n - 1, 2] + axes[n, 2]
        norm = math.sqrt(kx * kx + ky * ky + kz * kz)
        kx, ky, kz = kx / norm, ky / norm, kz / norm
        fx, fy, fz = b[0] - a[0], b[1] - a[1], b[2] - a[2]
        length = math.sqrt(fx * fx + fy * fy + fz * fz)
        along = fx * kx + fy * ky + fz * kz
        if length == 0.0 or abs(along) >= 0.98 * length:
            result[n, 4] = 1.0 if length > 0.0 else 0.0
        else:
            fx, fy, fz = fx - along * kx, fy - along * ky, fz - along * kz
            norm = math.sqrt(fx * fx + fy * fy + fz * fz)
            fx, fy, fz = fx / norm, fy / norm, fz / norm
            frame = (
                0.5 * (a[0] + b[0]),
                0.5 * (a[1] + b[1]),
                0.5 * (a[2] + b[2]),
                fx,
                fy,
                fz,
                ky * fz - kz * fy,
                kz * fx - kx * fz,
                kx * fy - ky * fx,
                kz,
            )
            phi_st, phi_ex, a_p, a_e = step_engagement(shape, frame, look, angles, grid, z, bottom)
            result[n, 0], result[n, 1], result[n, 2], result[n, 3] = phi_st, phi_ex, a_p, a_e
        if math.hypot(kx, ky) > 1e-9:
            cut_centres_tilted(shape, a, b, (kx, ky, kz), grid, z)
        else:
            move = move_of(a[0], a[1], a[2], b[0], b[1], b[2])
            cut_centres(shape, move, grid, z, bottom)
