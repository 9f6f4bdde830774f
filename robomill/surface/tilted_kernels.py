"""The compiled twin of ``tilt.py`` and ``tilted.py``: vertical lines through the body swept by a tilted cutter."""

from __future__ import annotations

import math

from numba import njit

from robomill.surface.kernels import inverse_direction, row_interval, swept_height


@njit(cache=True, nogil=True)
def hull_gap(shape, move, X, Y0, h0, tilt, z):  # type: ignore[no-untyped-def]
    """Height of the swept surface over a point of a vertical line, along the tool axis; <= 0 inside the body."""
    sine, cosine = tilt
    return swept_height(shape, move, X, Y0 + z * sine) - (h0 + z * cosine)


@njit(cache=True, nogil=True)
def tilted_interval(shape, move, X, Y0, h0, tilt, ceiling):  # type: ignore[no-untyped-def]
    """Heights (low, high) of a vertical line inside the body swept by a tilted cutter, up to ``ceiling``.

    ``move`` and the line are given in the tool's own frame; low > high if the line misses it.
    """
    sine, _ = tilt
    low, high = row_interval(move, inverse_direction(move), shape[1], X)
    low, high = (low - Y0) / sine, min((high - Y0) / sine, ceiling)
    if low >= high:
        return math.inf, -math.inf
    inside = low
    if hull_gap(shape, move, X, Y0, h0, tilt, low) > 0.0:
        a, b = low, high
        inside = math.inf
        golden = 0.6180339887498949
        c, d = b - golden * (b - a), a + golden * (b - a)
        gap_c, gap_d = hull_gap(shape, move, X, Y0, h0, tilt, c), hull_gap(shape, move, X, Y0, h0, tilt, d)
        if hull_gap(shape, move, X, Y0, h0, tilt, high) <= 0.0:
            inside = high
        for _ in range(64):
            if inside < math.inf:
                break
            if gap_c <= 0.0:
                inside = c
            elif gap_d <= 0.0:
                inside = d
            elif gap_c < gap_d:
                b, d, gap_d = d, c, gap_c
                c = b - golden * (b - a)
                gap_c = hull_gap(shape, move, X, Y0, h0, tilt, c)
            else:
                a, c, gap_c = c, d, gap_d
                d = a + golden * (b - a)
                gap_d = hull_gap(shape, move, X, Y0, h0, tilt, d)
        if inside == math.inf:
            return math.inf, -math.inf
        a, b = low, inside
        for _ in range(48):
            middle = 0.5 * (a + b)
            if hull_gap(shape, move, X, Y0, h0, tilt, middle) > 0.0:
                a = middle
            else:
                b = middle
        low = b
    if hull_gap(shape, move, X, Y0, h0, tilt, high) > 0.0:
        a, b = inside, high
        for _ in range(48):
            middle = 0.5 * (a + b)
            if hull_gap(shape, move, X, Y0, h0, tilt, middle) > 0.0:
                b = middle
            else:
                a = middle
        high = a
    return low, high


@njit(cache=True, nogil=True)
def cut_tilted(shape, moves, frames, boxes, chosen, grid, z, hidden_low, hidden_high):  # type: ignore[no-untyped-def]
    """Cut moves of a tilted cutter into a tile: z is the material seen from above, hidden_* what was cut below it.

    moves (n, 7) in the tool's frame, frames (n, 8) = e1 (x, y), e2 (x, y), k (x, y), sine, cosine of the tilt,
    boxes (n, 4) plan limits in {W}.
    """
    x0, y0, dx, dy = grid
    nx, ny = z.shape
    for n in chosen:
        move = (moves[n, 0], moves[n, 1], moves[n, 2], moves[n, 3], moves[n, 4], moves[n, 5], moves[n, 6])
        tilt = (frames[n, 6], frames[n, 7])
        for i in range(
            max(0, math.ceil((boxes[n, 0] - x0) / dx)), min(nx - 1, math.floor((boxes[n, 1] - x0) / dx)) + 1
        ):
            x = x0 + i * dx
            for j in range(
                max(0, math.ceil((boxes[n, 2] - y0) / dy)), min(ny - 1, math.floor((boxes[n, 3] - y0) / dy)) + 1
            ):
                y = y0 + j * dy
                X = x * frames[n, 0] + y * frames[n, 1]
                Y0 = x * frames[n, 2] + y * frames[n, 3]
                h0 = x * frames[n, 4] + y * frames[n, 5]
                low, high = tilted_interval(shape, move, X, Y0, h0, tilt, z[i, j])
                if low >= high:
                    continue
                if high >= z[i, j]:
                    z[i, j] = low
                else:
                    hidden_low[i, j] = min(hidden_low[i, j], low)
                    hidden_high[i, j] = max(hidden_high[i, j], high)
