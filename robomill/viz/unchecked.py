"""Figures from plain dictionaries: plotly's checking classes cost ten times what a figure of many panels needs."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import plotly.graph_objects as go

from robomill.viz.theme import figure

Trace = dict[str, Any]


def house_layout(*, dark: bool, height: int, revision: str, **layout: Any) -> dict[str, Any]:
    """The layout of ``theme.figure`` as a dictionary to add axes and annotations to."""
    base = figure(dark=dark, height=height, revision=revision, **layout).to_plotly_json()["layout"]
    return {**base, "annotations": [], "shapes": []}


def unchecked(data: Sequence[Trace], layout: dict[str, Any]) -> go.Figure:
    """The figure, without a check of its keys; a test makes the checks."""
    return go.Figure(data=list(data), layout=layout, _validate=False)


def words(text: str, x: float, y: float, size: float, colour: str, **more: Any) -> dict[str, Any]:
    """A caption without an arrow; ``more`` says what x and y refer to and where the text is anchored."""
    return {"x": x, "y": y, "text": text, "showarrow": False, "font": {"size": size, "color": colour}, **more}


ABOVE = {"xref": "paper", "yref": "paper", "xanchor": "left", "yanchor": "bottom"}
