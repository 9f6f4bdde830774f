"""The compiled path of the surface: ``envelope.py`` for one cell at a time, and the loops over cells.

Imported only through ``compiler.py``, since importing it loads numba. One thread, without the interpreter lock.
A move is (ax, ay, az, ux, uy, length, m), a shape (kind, R, r0, rc, slope) as in ``envelope.py``.
"""

from __future__ import annotations

import math

from numba import njit

FLAT, BALL, BULL, CHAMFER = 0, 1, 2, 3
SAME_EDGE = 0.5


@njit(cache=True, nogil=True, inline="always")
def clip(value, low, high):  # type: ignore[no-untyped-def]
    """Value held between low and high."""
    return min(max(value, low), high)


@njit(cache=True, nogil=True)
def profile(shape, r):  # type: ignore[no-untyped-def]
    """Height of the cutting surface above the tip at radius r <= R."""
    kind, _, r0, rc, slope = shape
    if kind == FLAT or r <= r0:
        return 0.0
    if kind == CHAMFER:
        return slope * (r - r0)
    e = r - r0
    return rc - math.sqrt(max(rc * rc - e * e, 0.0))


@njit(cache=True, nogil=True)
def contact_lag(shape, m, v2):  # type: ignore[no-untyped-def]
    """How far behind a point the cutter stands when it cuts lowest there."""
    kind, R, r0, rc, slope = shape
    if m == 0.0:
        return 0.0
    widest = math.sqrt(max(R * R - v2, 0.0))
    if kind == FLAT:
        return widest
    if kind == BALL:
        return widest * (m / math.sqrt(1.0 + m * m))
    kink = math.sqrt(max(r0 * r0 - v2, 0.0))
    if kind == CHAMFER:
        if m >= slope:
            return widest
        return min(max(math.sqrt(v2) * (m / math.sqrt(slope * slope - m * m)), kink), widest)
    # Newton on e w = m r sqrt(rc^2 - e^2), held in a bracket: the height is stationary at the root, so a rough
    # root is exact enough.
    low, high, w = kink, widest, kink
    for _ in range(40):
        r = math.sqrt(w * w + v2)
        e = max(r - r0, 0.0)
        root = math.sqrt(max(rc * rc - e * e, 0.0))
        f = e * w - m * r * root
        if abs(f) < 1e-7 * R * R * m or high - low < 1e-7 * R:
            break
        if f < 0.0:
            low = w
        else:
            high = w
        rise = w / r if r > 0.0 else 1.0
        slope_f = e + w * rise - m * rise * root + (m * r * e * rise / root if root > 0.0 else math.inf)
        w = w - f / slope_f if slope_f > 0.0 else high
        if not low < w < high:
            w = 0.5 * (low + high)
    return w


@njit(cache=True, nogil=True)
def swept_height(shape, move, x, y):  # type: ignore[no-untyped-def]
    """Lowest height cut at (x, y) by an upright cutter."""
    ax, ay, az, ux, uy, length, m = move
    X, Y = x - ax, y - ay
    s = X * ux + Y * uy
    v = Y * ux - X * uy
    v2 = v * v
    t = clip(s - contact_lag(shape, m, v2), 0.0, length)
    if shape[0] == FLAT:
        return az + m * t
    return az + m * t + profile(shape, math.sqrt((s - t) ** 2 + v2))


@njit(cache=True, nogil=True)
def move_of(ax, ay, az, bx, by, bz):  # type: ignore[no-untyped-def]
    """The move between two points, from its lower end."""
    if bz < az:
        ax, ay, az, bx, by, bz = bx, by, bz, ax, ay, az
    length = math.hypot(bx - ax, by - ay)
    if length < 1e-12:
        return (ax, ay, az, 1.0, 0.0, 0.0, 0.0)
    return (ax, ay, az, (bx - ax) / length, (by - ay) / length, length, (bz - az) / length)


@njit(cache=True, nogil=True)
def inverse_direction(move):  # type: ignore[no-untyped-def]
    """1 / ux and 1 / uy of a move, 0 where the component is 0: divisions are dear in a loop over rows."""
    ux, uy = move[3], move[4]
    return (1.0 / ux if ux != 0.0 else 0.0, 1.0 / uy if uy != 0.0 else 0.0)


@njit(cache=True, nogil=True)
def row_interval(move, inverse, R, x):  # type: ignore[no-untyped-def]
    """Where the line at ``x`` parallel to y lies inside the track of radius R; low > high if nowhere."""
    ax, ay, _, ux, uy, length, _ = move
    inverse_x, inverse_y = inverse
    low, high = math.inf, -math.inf
    X = x - ax
    w2 = R * R - X * X
    if w2 >= 0.0:
        w = math.sqrt(w2)
        low, high = -w, w
    if length > 0.0:
        cy = length * uy
        w2 = R * R - (X - length * ux) ** 2
        if w2 >= 0.0:
            w = math.sqrt(w2)
            low = cy - w if cy - w < low else low
            high = cy + w if cy + w > high else high
        a, b = -math.inf, math.inf
        if uy == 0.0:
            if X * ux < 0.0 or X * ux > length:
                a = math.inf
        else:
            a, b = -X * ux * inverse_y, (length - X * ux) * inverse_y
            if a > b:
                a, b = b, a
        if ux == 0.0:
            if abs(X * uy) > R:
                a = math.inf
        else:
            c, d = (X * uy - R) * inverse_x, (X * uy + R) * inverse_x
            if c > d:
                c, d = d, c
            a = c if c > a else a
            b = d if d < b else b
        if a <= b:
            low = a if a < low else low
            high = b if b > high else high
    return low + ay, high + ay


@njit(cache=True, nogil=True)
def covered_share(d, nx, ny, dx, dy):  # type: ignore[no-untyped-def]
    """Share of a cell on the inner side of a straight edge."""
    a, b = abs(nx) * dx, abs(ny) * dy
    if a < b:
        a, b = b, a
    p = clip(d + 0.5 * (a + b), 0.0, a + b)
    if p < b:
        return p * p / (2.0 * a * b)
    if p <= a:
        return (p - 0.5 * b) / a
    return 1.0 - (a + b - p) ** 2 / (2.0 * a * b)


@njit(cache=True, nogil=True)
def note_share(record, covered, ex, ey):  # type: ignore[no-untyped-def]
    """Note what an edge with normal (ex, ey) covers of a cell; see ``envelope.note_share``."""
    if record[2] == 0.0 and record[3] == 0.0:
        record[0], record[2], record[3] = covered, ex, ey
        return
    turn = ex * record[2] + ey * record[3]
    if turn > SAME_EDGE:
        record[0] = max(record[0], covered)
    elif covered > record[1]:
        record[1], record[4] = covered, turn


@njit(cache=True, nogil=True)
def cut_edge_cells(shape, move, grid, i, runs, tile):  # type: ignore[no-untyped-def]
    """Cells of row i that the edge of the track may cross (two runs of columns): each full, or a share of it."""
    z, z_centre, z_low, share, edges, count = tile
    x0, y0, dx, dy = grid
    ax, ay, az, ux, uy, length, m = move
    flat = shape[0] == FLAT and m == 0.0
    x = x0 + i * dx
    X = x - ax
    j, left_to, right_from, right_to = runs
    height = az
    while True:
        if j == left_to:
            j = right_from
        if j >= right_to:
            break
        column, j = j, j + 1
        if z[i, column] <= az:
            continue
        y = y0 + column * dy
        Y = y - ay
        near = clip(X * ux + Y * uy, 0.0, length)
        ex, ey = X - near * ux, Y - near * uy
        distance = math.sqrt(ex * ex + ey * ey)
        d = shape[1] - distance
        if distance > 0.0:
            ex, ey = ex / distance, ey / distance
        else:
            ex, ey = 1.0, 0.0
        half = 0.5 * (abs(ex) * dx + abs(ey) * dy)
        if d <= -half:
            continue
        if not flat:
            shift = 0.0 if d >= 0.0 else 0.5 * (half - d)
            height = swept_height(shape, move, x - shift * ex, y - shift * ey)
        if height >= z[i, column]:
            continue
        if d >= half:
            z[i, column] = height
            continue
        if z_low[i, column] == math.inf:
            edges[count[0]] = i * z.shape[1] + column
            count[0] += 1
        if d >= 0.0:
            z_centre[i, column] = min(z_centre[i, column], height)
        z_low[i, column] = min(z_low[i, column], height)
        note_share(share[i, column], covered_share(d, ex, ey, dx, dy), ex, ey)


@njit(cache=True, nogil=True)
def any_above(row, height):  # type: ignore[no-untyped-def]
    """True if any cell of a row is still above a height: spares the dearer look at its edge cells."""
    for j in range(row.size):  # noqa: SIM110 (compiled code has no any())
        if row[j] > height:
            return True
    return False


@njit(cache=True, nogil=True)
def cut_upright(shape, move, grid, tile):  # type: ignore[no-untyped-def]
    """Cut one move of an upright cutter into a tile; grid (x0, y0, dx, dy) locates cell [0, 0] of the tile."""
    z = tile[0]
    x0, y0, dx, dy = grid
    ax, _, az, ux, _, length, m = move
    nx, ny = z.shape
    inverse = inverse_direction(move)
    R = shape[1]
    half = 0.5 * math.sqrt(dx * dx + dy * dy)
    reach_low, reach_high = min(0.0, length * ux) - R - half, max(0.0, length * ux) + R + half
    first = max(0, math.ceil((ax + reach_low - x0) / dx))
    last = min(nx - 1, math.floor((ax + reach_high - x0) / dx))
    for i in range(first, last + 1):
        x = x0 + i * dx
        low, high = row_interval(move, inverse, R + half, x)
        if low > high:
            continue
        j_low = max(0, math.ceil((low - y0) / dy))
        j_high = min(ny - 1, math.floor((high - y0) / dy))
        full_low, full_high = row_interval(move, inverse, R - half, x)
        full_from, full_to = j_high + 1, j_high + 1
        if full_low <= full_high:
            full_from = min(max(j_low, math.ceil((full_low - y0) / dy)), j_high + 1)
            full_to = max(min(j_high, math.floor((full_high - y0) / dy)) + 1, full_from)
        if any_above(z[i, j_low:full_from], az) or any_above(z[i, full_to : j_high + 1], az):
            cut_edge_cells(shape, move, grid, i, (j_low, full_from, full_to, j_high + 1), tile)
        cut_full_cells(shape, move, x, y0 + full_from * dy, dy, z[i, full_from:full_to])


@njit(cache=True, nogil=True)
def cut_full_cells(shape, move, x, y, dy, row):  # type: ignore[no-untyped-def]
    """Cells of a row that lie wholly inside the track; the first two loops are plain so that they vectorise."""
    kind, R, _, _, _ = shape
    ax, ay, az, ux, uy, length, m = move
    X = x - ax
    R2 = R * R
    if kind == FLAT and m == 0.0:
        for j in range(row.size):
            now = row[j]
            row[j] = az if az < now else now
    elif kind <= BALL:
        lag = 1.0 if kind == FLAT else m / math.sqrt(1.0 + m * m)
        nose = 0.0 if kind == FLAT else 1.0
        for j in range(row.size):
            Y = y + j * dy - ay
            s, v = X * ux + Y * uy, Y * ux - X * uy
            left = R2 - v * v
            t = s - lag * math.sqrt(left if left > 0.0 else 0.0)
            t = t if t > 0.0 else 0.0
            t = t if t < length else length
            left -= (s - t) * (s - t)
            height = az + m * t + nose * (R - math.sqrt(left if left > 0.0 else 0.0))
            now = row[j]
            row[j] = height if height < now else now
    else:
        for j in range(row.size):
            if row[j] > az:
                row[j] = min(row[j], swept_height(shape, move, x, y + j * dy))


@njit(cache=True, nogil=True)
def cut_moves(shape, ends, chosen, grid, tile):  # type: ignore[no-untyped-def]
    """Cut the chosen rows of ``ends`` (n, 6) into a tile."""
    for n in chosen:
        move = move_of(ends[n, 0], ends[n, 1], ends[n, 2], ends[n, 3], ends[n, 4], ends[n, 5])
        cut_upright(shape, move, grid, tile)
