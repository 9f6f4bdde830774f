"""Triangle meshes for 3-D figures: tubes, cones, boxes and coordinate frames, as plotly traces.

Points in m, in the frame of the figure. Meshes are merged, so that an arm is two or three traces and not thirty.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
import plotly.graph_objects as go
from numpy.typing import ArrayLike

from robomill.arrays import FloatArray
from robomill.viz.theme import axis_colours

Mesh = tuple[FloatArray, FloatArray]  # vertices (v, 3), faces (f, 3)
LIGHTING = {"ambient": 0.74, "diffuse": 0.55, "specular": 0.18, "roughness": 0.55, "fresnel": 0.08}


def tube(start: ArrayLike, end: ArrayLike, radius: float, end_radius: float | None = None, sides: int = 22) -> Mesh:
    """A closed tube (a cone where the radii differ) between two points."""
    a, b = np.asarray(start, dtype=float), np.asarray(end, dtype=float)
    axis = b - a
    length = float(np.linalg.norm(axis))
    axis = axis / length if length > 1e-12 else np.array([0.0, 0.0, 1.0])
    helper = np.array([0.0, 0.0, 1.0]) if abs(axis[2]) < 0.9 else np.array([1.0, 0.0, 0.0])
    u = np.cross(axis, helper)
    u /= np.linalg.norm(u)
    v = np.cross(axis, u)
    angle = np.linspace(0, 2 * np.pi, sides, endpoint=False)
    ring = np.cos(angle)[:, None] * u + np.sin(angle)[:, None] * v
    points = np.vstack([a + radius * ring, b + (radius if end_radius is None else end_radius) * ring, a, b])
    i = np.arange(sides)
    j = (i + 1) % sides
    faces = np.vstack(
        [
            np.stack([i, j, i + sides], axis=1),
            np.stack([j, j + sides, i + sides], axis=1),
            np.stack([j, i, np.full(sides, 2 * sides)], axis=1),
            np.stack([i + sides, j + sides, np.full(sides, 2 * sides + 1)], axis=1),
        ]
    )
    return points, faces.astype(float)


def box(lower: ArrayLike, upper: ArrayLike, T: FloatArray | None = None) -> Mesh:
    """A box between two corners, moved by T (4, 4)."""
    corners = np.array([lower, upper], dtype=float)
    points = np.array([[corners[i, 0], corners[j, 1], corners[k, 2]] for i in (0, 1) for j in (0, 1) for k in (0, 1)])
    if T is not None:
        points = points @ T[:3, :3].T + T[:3, 3]
    faces = [
        (0, 1, 3),
        (0, 3, 2),
        (4, 6, 7),
        (4, 7, 5),
        (0, 4, 5),
        (0, 5, 1),
        (2, 3, 7),
        (2, 7, 6),
        (0, 2, 6),
        (0, 6, 4),
        (1, 5, 7),
        (1, 7, 3),
    ]
    return points, np.array(faces, dtype=float)


def trace(meshes: Sequence[Mesh], colour: str, name: str, **more: Any) -> go.Mesh3d:
    """One Mesh3d trace of several meshes in one colour."""
    points = np.vstack([m[0] for m in meshes])
    shift = np.cumsum([0, *[len(m[0]) for m in meshes[:-1]]])
    faces = np.vstack([m[1] + s for m, s in zip(meshes, shift, strict=True)]).astype(np.int32)
    x, y, z = np.round(points, 5).astype(np.float32).T
    options: dict[str, Any] = {
        "name": name,
        "hoverinfo": "skip",
        "flatshading": False,
        "lighting": LIGHTING,
        "showlegend": False,
        "lightposition": {"x": 3000, "y": -6000, "z": 9000},
        **more,
    }
    return go.Mesh3d(x=x, y=y, z=z, i=faces[:, 0], j=faces[:, 1], k=faces[:, 2], color=colour, **options)


def arrow(start: ArrayLike, vector: ArrayLike, colour: str, name: str, label: str, width: float) -> list[Any]:
    """A solid arrow from ``start`` along ``vector`` with a word at its head; nothing for a zero vector."""
    a, v = np.asarray(start, dtype=float), np.asarray(vector, dtype=float)
    length = float(np.linalg.norm(v))
    if length < 1e-9 or not np.isfinite(length):
        return []
    head = min(0.35 * length, 5.5 * width)
    neck = a + v * (1 - head / length)
    meshes = [tube(a, neck, width, sides=14), tube(neck, a + v, 2.4 * width, 0.0, sides=18)]
    tip = a + v * (1 + 0.12)
    word = go.Scatter3d(
        x=[tip[0]],
        y=[tip[1]],
        z=[tip[2]],
        mode="text",
        text=[label],
        textfont={"color": colour, "size": 13},
        hoverinfo="skip",
        showlegend=False,
        name=name,
    )
    return [trace(meshes, colour, name), word]


def frame(
    T: FloatArray, name: str, size: float, dark: bool, label: tuple[float, float, float] = (0, 0, 1.3)
) -> list[Any]:
    """The axes of a coordinate frame with its name at ``label`` (in axis lengths, in the frame itself)."""
    colours = axis_colours(dark)
    origin = T[:3, 3]
    traces: list[Any] = []
    for column, axis in enumerate("xyz"):
        end = origin + size * T[:3, column]
        traces.append(trace([tube(origin, end, 0.035 * size, sides=10)], colours[axis], name))
    at = origin + size * T[:3, :3] @ np.asarray(label, dtype=float)
    traces.append(
        go.Scatter3d(
            x=[at[0]],
            y=[at[1]],
            z=[at[2]],
            mode="text",
            text=[f"{{{name}}}"],
            hoverinfo="skip",
            showlegend=False,
            textfont={"size": 13, "color": colours["z"]},
            name=name,
        )
    )
    return traces
