"""What is sent to a browser is what plotly itself would send."""

import base64
import json

import numpy as np
import plotly.graph_objects as go
import plotly.io
import pytest
from plotly.tools import return_figure_from_figure_or_data

from robomill.viz.chart import Chart
from robomill.viz.sent import Sent

KINDS = {"f4": np.float32, "f8": np.float64, "i1": np.int8, "i2": np.int16, "i4": np.int32, "u1": np.uint8}


def as_read(value):
    """A figure's JSON as plotly.js reads it: packed arrays unpacked, lists of numbers the same as them, no null."""
    if isinstance(value, dict) and "bdata" in value:
        array = np.frombuffer(base64.b64decode(value["bdata"]), KINDS[value["dtype"]])
        return as_read(array.reshape([int(n) for n in value.get("shape", str(len(array))).split(",")]).tolist())
    if isinstance(value, dict):
        return {name: as_read(item) for name, item in value.items() if item is not None}
    if isinstance(value, list):
        return [as_read(item) for item in value]
    return float("nan") if value is None else value


def plotly_figure(chart: Chart) -> go.Figure:
    return go.Figure(data=list(chart.traces), layout=chart.layout, _validate=False)


@pytest.fixture
def chart() -> Chart:
    made = Chart({"xaxis": {"range": np.array([0.0, 2.0]), "title": None}, "height": 300, "template": {}})
    x = np.linspace(0.0, 1.0, 5)
    made.add("scatter", x=x, y=np.where(x > 0.5, np.nan, x), name="curve", text=["a", None, "c", "d", "e"])
    made.add("heatmap", z=np.arange(6.0, dtype=np.float32).reshape(2, 3), x=np.arange(3), y=[True, False])
    made.add("mesh3d", x=x, y=x, z=x, i=np.array([0, 1]), j=np.array([1, 2]), k=np.array([2, 3]), facecolor=None)
    made.add("scatter", x=np.array(["p", "q"]), y=np.array([], dtype=float), customdata=np.array([[2**40, 1]]))
    made.annotate(x=np.float64(0.5), y=1, text="here")
    return made


def test_a_browser_reads_what_plotly_would_send(chart):
    ours = return_figure_from_figure_or_data(Sent(chart), validate_figure=True)
    theirs = plotly_figure(chart).to_dict()
    one, other = (as_read(json.loads(plotly.io.to_json(each, validate=False))) for each in (ours, theirs))
    np.testing.assert_equal(one, other)


def test_the_chart_stays_as_it_was(chart):
    before = [dict(trace) for trace in chart.traces]
    Sent(chart).to_dict()["data"][0]["name"] = "another"
    for one, other in zip(before, chart.traces, strict=True):
        assert one.keys() == other.keys()
        assert all(one[name] is other[name] for name in one)
