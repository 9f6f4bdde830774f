"""The workspace in three dimensions: cells as voxels with only their outer faces, boxes as wires, beside the arm."""

from typing import Any

import numpy as np

from robomill.arrays import BoolArray, FloatArray
from robomill.viz.chart import Chart, Trace, drawn, xyz
from robomill.viz.maps import Scale
from robomill.viz.solids import CORNERS, FACES, LIGHTING, words
from robomill.viz.theme import colour_bar, palette


def outer_faces(mask: BoolArray) -> tuple[FloatArray, FloatArray]:
    """(cell (f, 3), corners (f, 4, 3)): faces between a True cell of ``mask`` (nx, ny, nz) and one that is not.

    Cells by index, corners in units of cells (cell i spans i - 1/2 to i + 1/2).
    """
    padded = np.pad(mask, 1)
    cells, corners = [], []
    for (axis, side), order in FACES.items():
        neighbour = np.roll(padded, -1 if side else 1, axis=axis)
        found = np.argwhere((padded & ~neighbour)[1:-1, 1:-1, 1:-1]).astype(float)
        cells.append(found)
        corners.append(found[:, None, :] + CORNERS[list(order)][None] - 0.5)
    return np.concatenate(cells), np.concatenate(corners)


def voxel_trace(
    mask: BoolArray,
    axes: tuple[FloatArray, FloatArray, FloatArray],
    shown: tuple[FloatArray, Scale] | None = None,
    *,
    dark: bool,
) -> Trace:
    """Voxels of ``mask`` at the points of ``axes`` (m): clear and in one colour, or solid and coloured by ``shown``.

    shown: values (nx, ny, nz) in display units and their scale.
    """
    cells, corners = outer_faces(mask)
    points = np.stack([_place(axes[i], corners[..., i]) for i in range(3)], axis=-1).reshape(-1, 3)
    first = 4 * np.arange(len(cells))
    faces = np.concatenate([first[:, None] + [0, 1, 2], first[:, None] + [0, 2, 3]])
    more: dict[str, Any] = {"color": palette(dark).accent}
    if shown is not None:
        i, j, k = cells.astype(int).T
        values = shown[1].shade(shown[0])[i, j, k].astype(np.float32)
        colours = shown[1].colours(dark)
        bar = {"colorbar": colour_bar(shown[1].title, dark=dark, len=0.7)}
        more = {"intensity": np.concatenate([values, values]), "intensitymode": "cell", **colours, **bar}
    return drawn(
        "mesh3d",
        **xyz(points.astype(np.float32)),
        i=faces[:, 0].astype(np.int32),
        j=faces[:, 1].astype(np.int32),
        k=faces[:, 2].astype(np.int32),
        opacity=0.25 if shown is None else 1.0,
        flatshading=True,
        hoverinfo="skip",
        name="reach",
        showlegend=False,
        lighting=LIGHTING,
        **more,
    )


def wire_box(lower: FloatArray, upper: FloatArray, colour: str, label: str, dash: str = "solid") -> list[Trace]:
    """The edges of a box (m) with a word at its highest corner."""
    c = np.where(CORNERS.astype(bool), upper, lower)
    edges = [(a, b) for a in range(8) for b in range(a + 1, 8) if np.abs(CORNERS[a] - CORNERS[b]).sum() == 1]
    gap = np.full(3, np.nan)
    line = np.array([point for a, b in edges for point in (c[a], c[b], gap)])
    return [
        drawn(
            "scatter3d",
            **xyz(line),
            mode="lines",
            line={"color": colour, "width": 5, "dash": dash},
            name=label,
            hoverinfo="name",
            showlegend=False,
        ),
        words([(np.array([upper[0], lower[1], upper[2]]), label, colour)], textposition="top center"),
    ]


def widen(fig: Chart, lower: FloatArray, upper: FloatArray, room: float = 2.4) -> None:
    """Stretch the ranges of a scene of ``arm_figure`` so that the box lower .. upper (m) is inside, to scale."""
    axes = [fig.layout["scene"][f"{a}axis"] for a in "xyz"]
    low, high = np.array([each["range"] for each in axes], dtype=float).T
    low, high = np.minimum(low, lower), np.maximum(high, upper)
    span = high - low
    ratio = room * span / np.linalg.norm(span)
    ranges = {f"{a}axis": {"range": [float(low[i]), float(high[i])]} for i, a in enumerate("xyz")}
    fig.lay_out(scene={**ranges, "aspectratio": dict(zip("xyz", ratio.tolist(), strict=True))})


def _place(axis: FloatArray, index: FloatArray) -> FloatArray:
    """Coordinates at fractional indices; half a cell beyond the ends."""
    if len(axis) == 1:
        return axis[0] + index * 0.01
    step = float(np.diff(axis).mean())
    return np.interp(index, [-1.0, *range(len(axis)), float(len(axis))], [axis[0] - step, *axis, axis[-1] + step])
