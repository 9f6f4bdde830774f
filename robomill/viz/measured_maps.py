"""A level of a measured map, the same level of the joint model, and their difference (the paper's Fig. 13)."""

from dataclasses import dataclass
from typing import Any

import numpy as np

from robomill.arrays import FloatArray
from robomill.viz.chart import QUIET, Chart
from robomill.viz.theme import SEQUENTIAL, axis, colour_bar, diverging, figure, palette, rgba


@dataclass(frozen=True, eq=False)
class Level:
    """values (nx, ny) over x (nx,), y (ny,), everything in display units; NaN is masked and reads as not measured.

    points (k, 2): where it was measured, as dots; limits: the ends of the colour scale; signed: blue to orange.
    """

    x: FloatArray
    y: FloatArray
    values: FloatArray
    points: FloatArray
    limits: tuple[float, float]
    title: str
    unit: str
    length_unit: str
    signed: bool = False


def level_figure(level: Level, *, dark: bool, revision: str) -> Chart:
    """The level as a map with its measured points."""
    p = palette(dark)
    fig = figure(dark=dark, height=340, revision=revision, margin={"l": 8, "r": 8, "t": 8, "b": 8})
    bar: dict[str, Any] = colour_bar(f"{level.title}, {level.unit}", dark=dark)
    # Within the paper, over a plot that leaves room for it: outside, plotly would shrink the plot.
    bar.update(
        {"orientation": "h", "x": 0.5, "xanchor": "center", "y": 0.86, "yanchor": "bottom", "len": 0.9, "ypad": 0}
    )
    bar["title"]["side"] = "top"
    fig.add(
        "heatmap",
        x=level.x,
        y=level.y,
        z=level.values.T,
        zmin=level.limits[0],
        zmax=level.limits[1],
        colorscale=diverging(dark) if level.signed else SEQUENTIAL,
        colorbar=bar,
        hovertemplate="X %{x:.0f}, Y %{y:.0f}<br>%{z:.3f} " + level.unit + "<extra></extra>",
    )
    if len(level.points):
        dots = {"size": 4.5, "color": rgba(p.background, 0.85), "line": {"color": rgba(p.text, 0.8), "width": 1}}
        fig.dots(level.points[:, 0], level.points[:, 1], dots, **QUIET)
    fig.lay_out(
        plot_bgcolor=rgba(p.muted, 0.16),
        xaxis=axis(f"X<sub>M</sub>, {level.length_unit}", dark=dark, showgrid=False, range=_span(level.x)),
        yaxis=axis(
            f"Y<sub>M</sub>, {level.length_unit}", dark=dark, showgrid=False, range=_span(level.y), domain=[0.0, 0.83]
        ),
    )
    return fig


def _span(values: FloatArray) -> list[float]:
    """The axis from half a cell before the first to half a cell after the last coordinate."""
    step = float(np.diff(values).mean()) if len(values) > 1 else 1.0
    return [float(values[0] - step / 2), float(values[-1] + step / 2)]
