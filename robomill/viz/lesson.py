"""The lesson's small figure: determinant and largest compliance on the way to the edge of the workspace."""

from __future__ import annotations

import plotly.graph_objects as go

from robomill.arrays import FloatArray
from robomill.viz.theme import axis, figure, palette


def ray_figure(
    radius: FloatArray,
    det: FloatArray,
    soft: FloatArray,
    here: int,
    radius_title: str,
    det_title: str,
    soft_title: str,
    *,
    dark: bool,
    height: int = 250,
) -> go.Figure:
    """det (m,) above and the softest compliance (m,) below against radius (m,), with a mark at index ``here``."""
    p = palette(dark)
    fig = figure(dark=dark, height=height, revision="ray", showlegend=False, margin={"l": 8, "r": 8, "t": 8, "b": 8})
    for values, colour, suffix, title in ((det, p.accent, "", det_title), (soft, p.caution, "2", soft_title)):
        fig.add_scatter(
            x=radius,
            y=values,
            mode="lines",
            line={"color": colour, "width": 3},
            xaxis=f"x{suffix}",
            yaxis=f"y{suffix}",
            hovertemplate=f"{title}: %{{y:.3f}}<extra></extra>",
        )
        fig.add_scatter(
            x=[radius[here]],
            y=[values[here]],
            mode="markers",
            xaxis=f"x{suffix}",
            yaxis=f"y{suffix}",
            marker={"color": p.text, "size": 12},
            hoverinfo="skip",
        )
        top = suffix == ""
        domain = [0.56, 1.0] if top else [0.0, 0.44]
        fig.update_layout(
            {
                f"xaxis{suffix}": axis(
                    "" if top else radius_title, dark=dark, anchor=f"y{suffix}", nticks=5, showticklabels=not top
                ),
                f"yaxis{suffix}": axis(title, dark=dark, anchor=f"x{suffix}", domain=domain, nticks=4),
            }
        )
    return fig
