"""A level of a measured map, the same level of the joint model, and their difference (the paper's Fig. 13)."""

from typing import Any

from robomill.arrays import FloatArray
from robomill.viz.chart import QUIET, Chart
from robomill.viz.maps import MapSheet, whole_cells
from robomill.viz.theme import axis, colour_bar, figure, palette, rgba


def level_figure(sheet: MapSheet, points: FloatArray, *, dark: bool, revision: str) -> Chart:
    """The one panel of ``sheet`` as a map, with the ``points`` (k, 2) where it was measured as dots.

    Everything is in display units; NaN is masked and reads as not measured.
    """
    p, scale = palette(dark), sheet.scales["main"]
    panel, colours = sheet.rows[0][0], scale.colours(dark)
    assert panel is not None
    fig = figure(dark=dark, height=340, revision=revision, margin={"l": 8, "r": 8, "t": 8, "b": 8})
    bar: dict[str, Any] = colour_bar(scale.title, dark=dark)
    # Within the paper, over a plot that leaves room for it: outside, plotly would shrink the plot.
    bar.update(
        {"orientation": "h", "x": 0.5, "xanchor": "center", "y": 0.86, "yanchor": "bottom", "len": 0.9, "ypad": 0}
    )
    bar["title"]["side"] = "top"
    fig.add(
        "heatmap",
        x=sheet.u,
        y=sheet.v,
        z=panel.values.T,
        zmin=colours["cmin"],
        zmax=colours["cmax"],
        colorscale=colours["colorscale"],
        colorbar=bar,
        hovertemplate="X %{x:.0f}, Y %{y:.0f}<br>%{z:.3f} " + panel.unit + "<extra></extra>",
    )
    if len(points):
        dots = {"size": 4.5, "color": rgba(p.background, 0.85), "line": {"color": rgba(p.text, 0.8), "width": 1}}
        fig.dots(points[:, 0], points[:, 1], dots, **QUIET)
    fig.lay_out(
        plot_bgcolor=rgba(p.muted, 0.16),
        xaxis=axis(sheet.u_title, dark=dark, showgrid=False, range=whole_cells(sheet.u)),
        yaxis=axis(sheet.v_title, dark=dark, showgrid=False, range=whole_cells(sheet.v), domain=[0.0, 0.83]),
    )
    return fig
