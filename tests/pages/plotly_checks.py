"""Plotly's own checks of a figure that was made without them."""

from __future__ import annotations

from typing import Any

import numpy as np
import plotly.graph_objects as go

from robomill.viz.chart import Chart


def checked_figure(chart: Chart) -> go.Figure:
    """The figure as plotly takes it; AssertionError or ValueError where that is not what was written."""
    found = go.Figure(data=chart.traces, layout=chart.layout)
    plain = go.Figure(data=list(chart.traces), layout=chart.layout, _validate=False)
    checked, written = (known(figure.to_plotly_json()) for figure in (found, plain))
    np.testing.assert_equal(checked["layout"], written["layout"])
    assert len(checked["data"]) == len(written["data"])
    for one, other in zip(checked["data"], written["data"], strict=True):
        np.testing.assert_equal(one, other)
    return found


def known(value: Any) -> Any:
    """Without what is None, and every tuple a list: neither matters to plotly."""
    if isinstance(value, dict):
        return {name: known(each) for name, each in value.items() if each is not None}
    if isinstance(value, list | tuple):
        return [known(each) for each in value]
    return value
