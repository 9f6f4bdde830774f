"""A level of a measured map, the same level of the joint model, and their difference (the paper's Fig. 13)."""

from __future__ import annotations

from typing import Any

import numpy as np
import plotly.graph_objects as go

from robomill.arrays import FloatArray
from robomill.viz.theme import SEQUENTIAL, axis, colour_bar, diverging, figure, palette, rgba


def level_figure(
    x: FloatArray,
    y: FloatArray,
    values: FloatArray,
    points: FloatArray,
    limits: tuple[float, float],
    title: str,
    unit: str,
    *,
    signed: bool,
    length_unit: str,
    dark: bool,
    revision: str,
    height: int = 340,
) -> go.Figure:
    """values (nx, ny) over x (nx,), y (ny,), everything in display units; NaN is masked and reads as not measured.

    points (k, 2): where it was measured, as dots; limits: the ends of the colour scale; signed: blue to orange.
    """
    p = palette(dark)
    fig = figure(dark=dark, height=height, revision=revision, margin={"l": 8, "r": 8, "t": 8, "b": 8})
    bar: dict[str, Any] = colour_bar(f"{title}, {unit}", dark=dark)
    # Within the paper, over a plot that leaves room for it: outside, plotly would shrink the plot.
    bar.update(
        {"orientation": "h", "x": 0.5, "xanchor": "center", "y": 0.86, "yanchor": "bottom", "len": 0.9, "ypad": 0}
    )
    bar["title"]["side"] = "top"
    fig.add_heatmap(
        x=x,
        y=y,
        z=values.T,
        zmin=limits[0],
        zmax=limits[1],
        colorscale=diverging(dark) if signed else SEQUENTIAL,
        colorbar=bar,
        hovertemplate="X %{x:.0f}, Y %{y:.0f}<br>%{z:.3f} " + unit + "<extra></extra>",
    )
    if len(points):
        fig.add_scatter(
            x=points[:, 0],
            y=points[:, 1],
            mode="markers",
            showlegend=False,
            hoverinfo="skip",
            marker={"size": 4.5, "color": rgba(p.background, 0.85), "line": {"color": rgba(p.text, 0.8), "width": 1}},
        )
    fig.update_layout(
        plot_bgcolor=rgba(p.muted, 0.16),
        xaxis=axis(f"X<sub>M</sub>, {length_unit}", dark=dark, showgrid=False, range=_span(x)),
        yaxis=axis(f"Y<sub>M</sub>, {length_unit}", dark=dark, showgrid=False, range=_span(y), domain=[0.0, 0.83]),
    )
    return fig


def _span(values: FloatArray) -> list[float]:
    """The axis from half a cell before the first to half a cell after the last coordinate."""
    step = float(np.diff(values).mean()) if len(values) > 1 else 1.0
    return [float(values[0] - step / 2), float(values[-1] + step / 2)]
