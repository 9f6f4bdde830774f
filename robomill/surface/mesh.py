"""A height map as a closed solid: its skin, four skirts and a bottom, ready for a file or a picture."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from robomill.arrays import FloatArray, IntArray
from robomill.surface.zmap import ZMap


class Mesh(NamedTuple):
    """vertices (v, 3) m in {W}, faces (f, 3) vertex numbers, outward; ``skin`` is the number of skin vertices.

    The skin's vertices come first, row by row as in the (possibly thinned) height map of shape ``shape``.
    """

    vertices: FloatArray
    faces: IntArray
    skin: int
    shape: tuple[int, int]


def to_mesh(zmap: ZMap, *, max_faces: int = 2_000_000) -> Mesh:
    """A watertight solid from the skin at cell centres (its rim drawn out to the stock's sides) down to the bottom.

    Rows and columns are thinned evenly if the solid would have more than ``max_faces`` triangles.
    """
    i, j = kept_cells(zmap.z.shape, max_faces)
    x, y = zmap.x[i].copy(), zmap.y[j].copy()
    x[[0, -1]] = zmap.x[0] - 0.5 * zmap.dx, zmap.x[-1] + 0.5 * zmap.dx
    y[[0, -1]] = zmap.y[0] - 0.5 * zmap.dy, zmap.y[-1] + 0.5 * zmap.dy
    z = zmap.z[np.ix_(i, j)]
    nx, ny = z.shape
    top = np.column_stack([np.repeat(x, ny), np.tile(y, nx), z.ravel()])
    number = np.arange(nx * ny).reshape(nx, ny)
    a, b, c, d = (q.ravel() for q in (number[:-1, :-1], number[1:, :-1], number[1:, 1:], number[:-1, 1:]))
    skin = np.concatenate([np.column_stack([a, b, c]), np.column_stack([a, c, d])])
    rim = np.concatenate([number[:-1, 0], number[-1, :-1], number[:0:-1, -1], number[0, :0:-1]])
    low = len(top) + np.arange(len(rim))
    foot = top[rim].copy()
    foot[:, 2] = zmap.bottom
    centre = np.array([[x.mean(), y.mean(), zmap.bottom]])
    after, low_after = np.roll(rim, -1), np.roll(low, -1)
    skirt = np.concatenate([np.column_stack([rim, low, low_after]), np.column_stack([rim, low_after, after])])
    base = np.column_stack([low_after, low, np.full(len(rim), len(top) + len(rim))])
    return Mesh(np.concatenate([top, foot, centre]), np.concatenate([skin, skirt, base]), len(top), (nx, ny))


def kept_cells(shape: tuple[int, ...], max_faces: int) -> tuple[IntArray, IntArray]:
    """Rows and columns to keep, ends included and at least two, so that the skin has about ``max_faces`` triangles."""
    stride = max(1.0, np.sqrt(2.0 * shape[0] * shape[1] / max_faces))
    i, j = (np.unique(np.linspace(0, n - 1, max(2, int(np.ceil(n / stride)))).round().astype(int)) for n in shape)
    return (np.array([0, 0]) if len(i) < 2 else i), (np.array([0, 0]) if len(j) < 2 else j)
