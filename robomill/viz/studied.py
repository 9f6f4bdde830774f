"""Pictures of a study: a response over two numbers as a map, or over one as dots coloured by another."""

from __future__ import annotations

import numpy as np

from robomill.arrays import FloatArray
from robomill.viz.chart import Chart
from robomill.viz.theme import SEQUENTIAL, axis, colour_bar, figure, palette, say

HEIGHT = 380  # px
Named = tuple[str, FloatArray]
"""A quantity with its unit, and its values (k,)."""


def response_map(x: Named, y: Named, response: Named, limit: float, *, dark: bool) -> Chart:
    """A response over the full grid of two numbers, blank where a point failed; a line where it is ``limit``."""
    fig = figure(dark=dark, height=HEIGHT, revision="study", showlegend=False)
    fig.layout["margin"] = {"l": 66, "r": 10, "t": 10, "b": 48, "autoexpand": True}
    columns, i = np.unique(x[1], return_inverse=True)
    rows, j = np.unique(y[1], return_inverse=True)
    z = np.full((len(rows), len(columns)), np.nan)
    z[j, i] = response[1]
    hover = f"{x[0]} %{{x:.4g}}<br>{y[0]} %{{y:.4g}}<br>{response[0]} %{{z:.4g}}<extra></extra>"
    bar = colour_bar(response[0], dark=dark)
    fig.add("heatmap", x=columns, y=rows, z=z, colorscale=SEQUENTIAL, colorbar=bar, hovertemplate=hover)
    known = z[np.isfinite(z)]
    if known.size and known.min() < limit < known.max() and min(z.shape) > 1:
        level = {"start": limit, "end": limit, "size": 1, "coloring": "none"}
        line = {"color": "#FFFFFF", "width": 2}
        fig.add("contour", x=columns, y=rows, z=z, contours=level, line=line, hoverinfo="skip", showscale=False)
    fig.layout["xaxis"] = axis(x[0], dark=dark, automargin=True)
    fig.layout["yaxis"] = axis(y[0], dark=dark, automargin=True)
    return fig


def response_dots(x: Named, colour: Named, response: Named, limit: float, *, dark: bool) -> Chart:
    """A response over one number, each point coloured by another; a line at ``limit`` where some are near it."""
    p = palette(dark)
    fig = figure(dark=dark, height=HEIGHT, revision="study", showlegend=False)
    fig.layout["margin"] = {"l": 66, "r": 10, "t": 10, "b": 48, "autoexpand": True}
    marker = {
        "size": 8,
        "color": colour[1],
        "colorscale": SEQUENTIAL,
        "colorbar": colour_bar(colour[0], dark=dark),
        "line": {"width": 0.5, "color": p.muted},
    }
    hover = f"{x[0]} %{{x:.4g}}<br>{colour[0]} %{{marker.color:.4g}}<br>{response[0]} %{{y:.4g}}<extra></extra>"
    fig.dots(x[1], response[1], marker, hovertemplate=hover)
    known = response[1][np.isfinite(response[1])]
    if known.size and limit < 1.2 * known.max():
        ends = [float(np.min(x[1])), float(np.max(x[1]))]
        fig.lines(ends, [limit, limit], {"color": p.warm, "width": 1.5, "dash": "dash"}, hoverinfo="skip")
        say(fig, "tolerance", 1, limit, p.warm, xref="paper", xanchor="right", yshift=9)
    fig.layout["xaxis"] = axis(x[0], dark=dark, automargin=True)
    fig.layout["yaxis"] = axis(response[0], dark=dark, rangemode="tozero", automargin=True)
    return fig
