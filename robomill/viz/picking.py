"""Points that can be clicked on a curve: plotly tells of clicks on markers only, so faint ones lie over the line."""

from __future__ import annotations

import numpy as np
import plotly.graph_objects as go

from robomill.arrays import FloatArray

MAX_PICKS = 800
_FAINT = {"marker": {"color": "rgba(0,0,0,0)", "opacity": 1}}


def add_picks(fig: go.Figure, s: FloatArray, value: FloatArray) -> None:
    """Faint markers at (s, value), NaN left out; a picked point's x is its station."""
    good = np.flatnonzero(np.isfinite(value) & np.isfinite(s))
    if len(good) > MAX_PICKS:
        good = good[np.linspace(0, len(good) - 1, MAX_PICKS).astype(int)]
    fig.add_scatter(
        x=s[good], y=value[good], mode="markers", name="pick", showlegend=False, hoverinfo="skip",
        marker={"size": 14, "color": "rgba(0,0,0,0)", "line": {"width": 0}}, selected=_FAINT, unselected=_FAINT,
    )  # fmt: skip
    fig.update_layout(dragmode="pan", clickmode="event+select")


def add_point(fig: go.Figure, x: float, y: float, colour: str, rim: str) -> None:
    """A dot where the station is on the curve."""
    if np.isfinite(x) and np.isfinite(y):
        fig.add_scatter(
            x=[x], y=[y], mode="markers", showlegend=False, hoverinfo="skip", name="station",
            marker={"size": 11, "color": colour, "line": {"width": 2, "color": rim}},
        )  # fmt: skip
