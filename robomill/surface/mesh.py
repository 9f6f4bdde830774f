"""A height map as a closed solid: its skin with upright walls where they are, four skirts and a bottom.

The skin joins cell centres. Where a wall passes between two of them, the side that joins them gets two points in the
wall's exact place, one at the height of either end; so a slice through the solid shows walls where the cutter left
them, whatever the size of the cells.
"""

from typing import NamedTuple

import numpy as np

from robomill.arrays import FloatArray, IntArray
from robomill.progress import checkpoint, slices
from robomill.surface.zmap import ZMap

NEAREST = 2e-3  # share of a side: a wall point keeps this far from its ends, so that no triangle vanishes
PLACES = ((0.5, 0), (0.51, 0), (1.5, -1), (1.5, 1))
"""Where a cell's wall may cross a side, best first: within the cell, beyond it by rounding, or (along the rim, where
sides are drawn out) in the side next to it; in cells from the centre, and in sides from the one met."""
STEP = 0.01
"""Of a cell: ends of a side closer in height have a slope between them, no wall. Where the tool sinks on its way, the
rear edge of each move crosses a floor that has no step there."""
ALIKE = 0.5  # of the highest of four walls that meet in a square: others that high are no lesser ones


class Mesh(NamedTuple):
    """vertices (v, 3) m in {W}, faces (f, 3) vertex numbers, outward; ``skin`` is the number of cell centres in it.

    These come first, row by row as in the (possibly thinned) height map of shape ``shape``. ``owner`` (v,) is the cell
    centre that a vertex belongs to; -1 on the bottom.
    """

    vertices: FloatArray
    faces: IntArray
    skin: int
    shape: tuple[int, int]
    owner: IntArray


class _Skin(NamedTuple):
    """Kept centres: coordinates x (nx,), y (ny,), heights z (nx, ny) m, and their vertex numbers (nx, ny)."""

    x: FloatArray
    y: FloatArray
    z: FloatArray
    number: IntArray


class _Sides(NamedTuple):
    """Sides between neighbours along X (nx - 1, ny) or Y (nx, ny - 1): the vertex in the wall at the height of the
    first end, -1 without a wall; the one at the height of the second end has the next number."""

    along_x: IntArray
    along_y: IntArray


def to_mesh(zmap: ZMap, *, max_faces: int = 2_000_000) -> Mesh:
    """A watertight solid from the skin (its rim drawn out to the stock's sides) down to the bottom.

    Rows and columns are thinned evenly if the solid would have more than about ``max_faces`` triangles.
    """
    i, j = kept_cells(zmap.z.shape, max_faces)
    x, y = zmap.x[i].copy(), zmap.y[j].copy()
    x[[0, -1]] = zmap.x[0] - 0.5 * zmap.dx, zmap.x[-1] + 0.5 * zmap.dx
    y[[0, -1]] = zmap.y[0] - 0.5 * zmap.dy, zmap.y[-1] + 0.5 * zmap.dy
    z = zmap.z[np.ix_(i, j)]
    nx, ny = z.shape
    skin = _Skin(x, y, z, np.arange(nx * ny).reshape(nx, ny))
    top = np.column_stack([np.repeat(x, ny), np.tile(y, nx), z.ravel()])
    checkpoint(0.0, "Solid")
    sides, walls, owner = _wall_points(skin, *_crossings(zmap, skin, i, j))
    checkpoint(0.3, "Solid")
    vertices = np.concatenate([top, walls])
    owners = np.concatenate([skin.number.ravel(), owner])
    faces = _skin_faces(skin.number, sides, vertices[:, 2])
    checkpoint(0.8, "Solid")
    around, feet = _around(skin, sides)
    low = len(vertices) + feet
    foot = np.zeros((feet[-1] + 1, 3))
    foot[feet] = vertices[around]
    foot[:, 2] = zmap.bottom
    hub = len(vertices) + len(foot)
    after, low_after = np.roll(around, -1), np.roll(low, -1)
    moves = low != low_after
    skirt = [
        np.column_stack([around, low, after])[~moves],
        np.column_stack([around, low, low_after])[moves],
        np.column_stack([around, low_after, after])[moves],
    ]
    base = np.column_stack([low_after, low, np.full(len(low), hub)])[moves]
    ground = np.concatenate([foot, [[x.mean(), y.mean(), zmap.bottom]]])
    checkpoint(0.9, "Solid")
    return Mesh(
        np.concatenate([vertices, ground]),
        np.concatenate([faces, *skirt, base]),
        len(top),
        (nx, ny),
        np.concatenate([owners, np.full(len(ground), -1)]),
    )


def kept_cells(shape: tuple[int, ...], max_faces: int) -> tuple[IntArray, IntArray]:
    """Rows and columns to keep, ends included and at least two, so that the skin has about ``max_faces`` triangles."""
    stride = max(1.0, np.sqrt(2.0 * shape[0] * shape[1] / max_faces))
    i, j = (np.unique(np.linspace(0, n - 1, max(2, int(np.ceil(n / stride)))).round().astype(int)) for n in shape)
    return (np.array([0, 0]) if len(i) < 2 else i), (np.array([0, 0]) if len(j) < 2 else j)


def _crossings(zmap: ZMap, skin: _Skin, i: IntArray, j: IntArray) -> tuple[FloatArray, FloatArray]:
    """Where walls cross the sides along X (nx - 1, ny) and along Y (nx, ny - 1), as a share of each; NaN: nowhere."""
    row, column = np.divmod(zmap.edge.index, zmap.z.shape[1])
    centre = np.column_stack([zmap.x[row], zmap.y[column]])
    centre, wall = np.repeat(centre, 2, axis=0), zmap.edge.wall.reshape(-1, 3)
    row, column = np.repeat(row, 2), np.repeat(column, 2)
    along_x = _crossed((skin.x, skin.y, skin.z), (j, column), centre, wall, (zmap.dx, zmap.dy))
    along_y = _crossed((skin.y, skin.x, skin.z.T), (i, row), centre[:, ::-1], wall[:, [1, 0, 2]], (zmap.dy, zmap.dx))
    return along_x, along_y.T


def _crossed(
    grid: tuple[FloatArray, FloatArray, FloatArray],
    lines: tuple[IntArray, IntArray],
    centre: FloatArray,
    wall: FloatArray,
    size: tuple[float, float],
) -> FloatArray:
    """Where walls cross the sides along the first axis of ``grid`` (places u, v and heights), as shares of them.

    ``lines``: the kept ones among the lines v, and the line that each wall's cell lies in. ``centre`` (e, 2) and
    ``wall`` (e, 3) are those of the walls, ``size`` that of a cell along u and v. Of two walls that cross one side
    the one that leaves less material holds.
    """
    u, v, z = grid
    kept, line = lines
    at = np.minimum(np.searchsorted(kept, line), len(kept) - 1)
    with np.errstate(divide="ignore", invalid="ignore"):
        off = (wall[:, 2] - (v[at] - centre[:, 1]) * wall[:, 1]) / wall[:, 0]
    found = np.full((len(u) - 1, len(v)), np.nan)
    for reach, shift in PLACES:
        checkpoint()
        rows = np.flatnonzero((kept[at] == line) & (np.abs(off) <= reach * size[0]))
        place = centre[rows, 0] + off[rows]
        side = np.clip(np.searchsorted(u, place) - 1 + shift, 0, len(u) - 2)
        column = at[rows]
        rise = z[side + 1, column] - z[side, column]
        good = (np.abs(rise) > STEP * min(size)) & (rise * wall[rows, 0] > 0.0) & np.isnan(found[side, column])
        side, column, up = side[good], column[good], rise[good] > 0.0
        width = u[side + 1] - u[side]
        share = np.clip((place[good] - u[side]) / np.where(width > 0.0, width, 1.0), NEAREST, 1.0 - NEAREST)
        farthest = np.zeros(found.shape)
        np.maximum.at(farthest, (side, column), np.where(up, share, 1.0 - share))
        found[side, column] = np.where(up, farthest[side, column], 1.0 - farthest[side, column])
    return found


def _wall_points(skin: _Skin, x_share: FloatArray, y_share: FloatArray) -> tuple[_Sides, FloatArray, IntArray]:
    """The sides that walls cross, the points in the walls (w, 3), two a crossing, and their owners (w,)."""
    count = skin.number.size
    sides, points, owners = [], [], []
    for share, (di, dj) in ((x_share, (1, 0)), (y_share, (0, 1))):
        checkpoint()
        i, j = np.nonzero(np.isfinite(share))
        t = share[i, j]
        x = skin.x[i] + t * (skin.x[i + di] - skin.x[i])
        y = skin.y[j] + t * (skin.y[j + dj] - skin.y[j])
        ends = np.stack([skin.number[i, j], skin.number[i + di, j + dj]], axis=1)
        numbers = np.full(share.shape, -1)
        numbers[i, j] = count + 2 * np.arange(len(i))
        count += 2 * len(i)
        sides.append(numbers)
        points.append(np.column_stack([np.repeat(x, 2), np.repeat(y, 2), skin.z.ravel()[ends].ravel()]))
        owners.append(ends.ravel())
    return _Sides(*sides), np.concatenate(points), np.concatenate(owners)


def _skin_faces(n: IntArray, sides: _Sides, height: FloatArray) -> IntArray:
    """Triangles of the skin, from the numbers ``n`` (nx, ny) of the centres and the ``height`` (v,) m of all vertices.

    The corners of a square run a b c d seen from above; ``near`` and ``far`` are the wall's points on the side that
    leaves a corner, at the height of this corner and of the next one (-1: no wall there).
    """
    corner = np.stack([q.ravel() for q in (n[:-1, :-1], n[1:, :-1], n[1:, 1:], n[:-1, 1:])], axis=1)
    x_side, y_side = sides
    first = np.stack([q.ravel() for q in (x_side[:, :-1], y_side[1:], x_side[:, 1:], y_side[:-1])], axis=1)
    checkpoint(0.4, "Solid")
    crossed = first >= 0
    forward = np.array([0, 0, 1, 1])  # the third and fourth side run against their axis
    near, far = np.where(crossed, first + forward, -1), np.where(crossed, first + 1 - forward, -1)
    how_many = crossed.sum(axis=1)
    checkpoint(0.5, "Solid")
    a, b, c, d = corner[how_many == 0].T
    faces = [np.column_stack([a, b, c]), np.column_stack([a, c, d])]
    two = how_many == 2
    for apart in (1, 2):
        checkpoint()
        starts = crossed & np.roll(crossed, -apart, axis=1) & two[:, None]
        starts[:, 2:] &= apart == 1  # of two opposite sides either could be the first
        square, start = np.nonzero(starts)
        turned = (start[:, None] + np.arange(4)) % 4
        q, p, f = (np.take_along_axis(part[square], turned, axis=1).T for part in (corner, near, far))
        faces += _two_sided(q, p, f, apart)
    odd = np.flatnonzero((how_many == 1) | (how_many > 2))
    rise = np.where(crossed[odd], np.abs(height[near[odd]] - height[far[odd]]), -1.0)
    around = np.stack([corner[odd], near[odd], far[odd]], axis=2).reshape(-1, 12)
    for some in slices(len(odd), "Corners of walls"):
        for row in zip(around[some], rise[some], height[corner[odd[some]]], strict=True):
            faces += [np.column_stack([np.full(len(q) - 2, q[0]), q[1:-1], q[2:]]) for q in _parted(*row)]
    return np.concatenate(faces)


def _parted(around: IntArray, rise: FloatArray, height: FloatArray) -> list[IntArray]:
    """Floors, tops and upright walls, as loops of vertices, of a square that walls meet on one, three or four sides.

    ``around`` (12,) are its corners, each with the near and the far point on the side that leaves it, ``rise`` (4,) m
    how high the wall on that side is, below 0 without one, ``height`` (4,) m of the corners. The two highest are one
    wall, which goes through; lower ones, and one alone, run out. Of four alike two are a wall each, with a rib between.
    """

    def part(first: int, last: int) -> IntArray:
        loop = np.roll(around, -first)[: (last - first) % 12 + 1]
        return loop[loop >= 0]

    first, second, _, least = np.argsort(-rise, kind="stable")
    if rise[second] < 0.0:
        return [part(3 * first + 1, 3 * first)]
    through = [(first, second)]
    if rise[least] >= ALIKE * rise[first]:  # around the two lower corners: from the side that leads there to the next
        low = int(height[1] + height[3] < height[0] + height[2])
        through = [((low + 3) % 4, low), (low + 1, low + 2)]
    walls = [around[[3 * p + 1, 3 * p + 2, 3 * q + 1, 3 * q + 2]] for p, q in through]
    beyond = [part(3 * p + 2, 3 * q + 1) for p, q in through]
    rest = [part(3 * q + 2, 3 * p + 1) for (_, q), (p, _) in zip(through, through[::-1], strict=True)]
    return [*walls, *beyond, np.concatenate(rest)]


def _two_sided(q: IntArray, near: IntArray, far: IntArray, apart: int) -> list[IntArray]:
    """A square that a wall crosses from its first side to its second (``apart`` 1) or third side: floor, top, wall."""
    if apart == 1:
        one, other = [far[0], q[1], near[1]], [q[0], near[0], far[1], q[2], q[3]]
    else:
        one, other = [far[0], q[1], q[2], near[2]], [q[0], near[0], far[2], q[3]]
    wall = [near[0], far[0], near[apart], far[apart]]
    return [
        np.column_stack([loop[0], loop[k], loop[k + 1]]) for loop in (one, other, wall) for k in range(1, len(loop) - 1)
    ]


def _around(skin: _Skin, sides: _Sides) -> tuple[IntArray, IntArray]:
    """The rim's vertices in their order (l,), and the number of the foot below each: two points of a wall share one."""
    n, x_side, y_side = skin.number, *sides
    borders = (
        (n[:-1, 0], x_side[:, 0], 0),
        (n[-1, :-1], y_side[-1], 0),
        (n[:0:-1, -1], x_side[::-1, -1], 1),
        (n[0, :0:-1], y_side[0, ::-1], 1),
    )
    rows = []
    for start, first, back in borders:
        crossed = first >= 0
        near, far = np.where(crossed, first + back, -1), np.where(crossed, first + 1 - back, -1)
        rows.append(np.column_stack([start, near, far]))
    loop = np.concatenate(rows)
    stands = np.broadcast_to([1, 1, 0], loop.shape)[loop >= 0]
    return loop[loop >= 0], np.cumsum(stands) - 1
