"""Points that can be clicked on a curve: plotly tells of clicks on markers only, so clear ones lie over the line."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import plotly.graph_objects as go

from robomill.arrays import FloatArray

MAX_PICKS = 800
CLEAR = "rgba(0,0,0,0)"
_CLEAR = {"marker": {"color": CLEAR, "opacity": 1}}


def add_picks(fig: go.Figure, s: FloatArray, value: FloatArray, words: Sequence[str]) -> None:
    """Clear markers at (s, value) (m,), NaN left out, with ``words`` (m,) to hover; a picked point's x is its station.

    A click counts for the first of the points that are hovered, so these become the only ones: wherever the mouse is,
    the nearest of them answers.
    """
    good = np.flatnonzero(np.isfinite(value) & np.isfinite(s))
    if len(good) > MAX_PICKS:
        good = good[np.linspace(0, len(good) - 1, MAX_PICKS).astype(int)]
    fig.update_traces(hoverinfo="skip", hovertemplate=None)
    fig.add_scatter(
        x=s[good],
        y=value[good],
        mode="markers",
        name="pick",
        showlegend=False,
        text=[words[int(i)] for i in good],
        hovertemplate="%{text}<extra></extra>",
        marker={"size": 14, "color": CLEAR, "line": {"width": 0}},
        selected=_CLEAR,
        unselected=_CLEAR,
    )
    fig.update_layout(dragmode="pan", clickmode="event+select", hovermode="closest", hoverdistance=-1)


def add_point(fig: go.Figure, x: float, y: float, colour: str, rim: str) -> None:
    """A dot where the station is on the curve."""
    if np.isfinite(x) and np.isfinite(y):
        fig.add_scatter(
            x=[x],
            y=[y],
            mode="markers",
            showlegend=False,
            hoverinfo="skip",
            name="station",
            marker={"size": 11, "color": colour, "line": {"width": 2, "color": rim}},
        )
