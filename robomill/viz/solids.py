"""Triangle meshes for 3-D figures: tubes, cones, boxes and coordinate frames, as plotly traces.

Points in m, in the frame of the figure. What is opaque goes into one trace and so do the words: the browser prepares
each trace by itself, and thirty of them take it a second.
"""

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from robomill.arrays import FloatArray
from robomill.viz.chart import QUIET, Trace, drawn, xyz
from robomill.viz.theme import axis_colours

Triangles = tuple[FloatArray, FloatArray]  # vertices (v, 3), faces (f, 3)
Painted = tuple[Triangles, str]  # a mesh in its colour
Said = tuple[FloatArray, str, str]  # where (3,), the word, its colour
# The corners of a box, and its six faces: axis, side, and the corners of the face in the order of a rectangle.
CORNERS = np.array([[i, j, k] for i in (0, 1) for j in (0, 1) for k in (0, 1)])
FACES = {
    (0, 0): (0, 1, 3, 2),
    (0, 1): (4, 6, 7, 5),
    (1, 0): (0, 4, 5, 1),
    (1, 1): (2, 3, 7, 6),
    (2, 0): (0, 2, 6, 4),
    (2, 1): (1, 5, 7, 3),
}
LIGHTING = {"ambient": 0.74, "diffuse": 0.55, "specular": 0.18, "roughness": 0.55, "fresnel": 0.08}


def revolution(radius: FloatArray, height: FloatArray, base: FloatArray, axis: FloatArray, sides: int) -> Triangles:
    """A closed solid of revolution from its outline, radius (q,) over height (q,) above ``base`` along ``axis``."""
    helper = np.array([0.0, 0.0, 1.0]) if abs(axis[2]) < 0.9 else np.array([1.0, 0.0, 0.0])
    u = np.cross(axis, helper)
    u /= np.linalg.norm(u)
    angle = np.linspace(0.0, 2.0 * np.pi, sides, endpoint=False)
    ring = np.cos(angle)[:, None] * u + np.sin(angle)[:, None] * np.cross(axis, u)
    points = base + radius[:, None, None] * ring + height[:, None, None] * axis
    ends = base + height[[0, -1], None] * axis
    q = len(radius)
    number = np.arange(q * sides).reshape(q, sides)
    beside = np.roll(number, -1, axis=1)
    a, b, c, d = (side.ravel() for side in (number[:-1], beside[:-1], number[1:], beside[1:]))
    faces = [np.stack([a, b, c], axis=1), np.stack([b, d, c], axis=1)]
    faces.append(np.stack([beside[0], number[0], np.full(sides, q * sides)], axis=1))
    faces.append(np.stack([number[-1], beside[-1], np.full(sides, q * sides + 1)], axis=1))
    return np.vstack([points.reshape(-1, 3), ends]), np.vstack(faces).astype(float)


def tube(
    start: ArrayLike, end: ArrayLike, radius: float, end_radius: float | None = None, sides: int = 22
) -> Triangles:
    """A closed tube (a cone where the radii differ) between two points."""
    a, axis = np.asarray(start, dtype=float), np.asarray(end, dtype=float) - np.asarray(start, dtype=float)
    length = float(np.linalg.norm(axis))
    axis = axis / length if length > 1e-12 else np.array([0.0, 0.0, 1.0])
    radii = np.array([radius, radius if end_radius is None else end_radius])
    return revolution(radii, np.array([0.0, length]), a, axis, sides)


def yardstick(frames: FloatArray) -> float:
    """Sum of the link lengths, m, of an arm with ``frames`` (n+1, 4, 4): the measure of tube radii and arrows."""
    return max(float(np.linalg.norm(np.diff(frames[:, :3, 3], axis=0), axis=1).sum()), 1e-3)


def limbs(frames: FloatArray) -> tuple[list[Triangles], list[Triangles]]:
    """(links, joints) of an arm: a link first runs along its joint's axis, then across to the next joint."""
    size, n = yardstick(frames), len(frames) - 1
    links, joints = [], []
    for i in range(n):
        radius = 0.034 * size * (1.0 - 0.45 * i / max(n - 1, 1))
        start, end, axis = frames[i][:3, 3], frames[i + 1][:3, 3], frames[i][:3, 2]
        if i == n - 1:
            end = end + 0.09 * size * frames[-1][:3, 2]
        joints.append(tube(start - 1.5 * radius * axis, start + 1.5 * radius * axis, 1.32 * radius))
        corner = start + axis * float((end - start) @ axis)
        for a, b in ((start, corner), (corner, end)):
            if np.linalg.norm(b - a) > 0.2 * radius:
                links.append(tube(a, b, 0.92 * radius, 0.78 * radius))
    return links, joints


def box(lower: ArrayLike, upper: ArrayLike, T: FloatArray | None = None) -> Triangles:
    """A box between two corners, moved by T (4, 4)."""
    points = np.where(CORNERS == 1, np.asarray(upper, dtype=float), np.asarray(lower, dtype=float))
    if T is not None:
        points = points @ T[:3, :3].T + T[:3, 3]
    return points, np.array([half for a, b, c, d in FACES.values() for half in ((a, b, c), (a, c, d))], dtype=float)


def painted(solids: Sequence[Painted]) -> Trace:
    """One Mesh3d trace of opaque solids, each in its own colour."""
    colours = [colour for mesh, colour in solids for _ in mesh[1]]
    return trace([mesh for mesh, _ in solids], None, "arm", facecolor=colours)


def trace(meshes: Sequence[Triangles], colour: str | None, name: str, **more: Any) -> Trace:
    """One Mesh3d trace of several meshes in one colour."""
    points = np.vstack([m[0] for m in meshes])
    shift = np.cumsum([0, *[len(m[0]) for m in meshes[:-1]]])
    faces = np.vstack([m[1] + s for m, s in zip(meshes, shift, strict=True)]).astype(np.int32)
    corners = dict(zip("ijk", faces.T, strict=True))
    options: dict[str, Any] = {
        "name": name,
        "hoverinfo": "skip",
        "flatshading": False,
        "lighting": LIGHTING,
        "showlegend": False,
        "lightposition": {"x": 3000, "y": -6000, "z": 9000},
        **more,
    }
    return drawn("mesh3d", **xyz(np.round(points, 5).astype(np.float32)), **corners, color=colour, **options)


def words(said: Sequence[Said], **more: Any) -> Trace:
    """Words in a scene."""
    at = xyz(np.array([place for place, _, _ in said], dtype=float))
    font = {"color": [colour for _, _, colour in said], "size": 13}
    texts = [word for _, word, _ in said]
    return drawn("scatter3d", **at, mode="text", text=texts, textfont=font, name="words", **QUIET, **more)


def arrow(start: ArrayLike, vector: ArrayLike, colour: str, width: float) -> list[Painted]:
    """A solid arrow from ``start`` along ``vector``; nothing for a zero vector."""
    a, v = np.asarray(start, dtype=float), np.asarray(vector, dtype=float)
    length = float(np.linalg.norm(v))
    if length < 1e-9 or not np.isfinite(length):
        return []
    head = min(0.35 * length, 5.5 * width)
    neck = a + v * (1 - head / length)
    return [(tube(a, neck, width, sides=14), colour), (tube(neck, a + v, 2.4 * width, 0.0, sides=18), colour)]


def frame(T: FloatArray, size: float, dark: bool) -> list[Painted]:
    """The axes of a coordinate frame T (4, 4), each in its colour and ``size`` m long."""
    origin, colours = T[:3, 3], axis_colours(dark)
    return [
        (tube(origin, origin + size * T[:3, column], 0.035 * size, sides=10), colours[axis])
        for column, axis in enumerate("xyz")
    ]
