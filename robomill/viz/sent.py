"""A chart as it is sent to a browser: its dictionary with arrays packed, neither checked nor copied on the way."""

import base64
from typing import Any

import numpy as np
from plotly.basedatatypes import BaseFigure

from robomill.viz.chart import Chart

PACKED = {"float32": "f4", "float64": "f8", "int8": "i1", "int16": "i2", "int32": "i4", "uint8": "u1", "uint32": "u4"}
LISTED = {"range", "geojson", "layer", "layers"}  # where plotly.js takes no packed array
NARROW = np.iinfo(np.int32)


class Sent(BaseFigure):  # type: ignore[misc]
    """What Streamlit takes for a figure of plotly's; asked for its dictionary, it gives the chart's own.

    Plotly's figure builds an object for every property and copies all of it: ten times what a page needs.
    """

    def __init__(self, chart: Chart) -> None:
        self._chart = chart

    def to_dict(self) -> dict[str, Any]:
        """Traces and layout in plotly's words, arrays as plotly.js reads them."""
        return {"data": [sendable(trace) for trace in self._chart.traces], "layout": sendable(self._chart.layout)}


def sendable(value: Any, name: str = "") -> Any:
    """``value`` with its arrays packed; what is None in a dictionary is left out."""
    if isinstance(value, dict):
        return {name: sendable(item, name) for name, item in value.items() if item is not None}
    if isinstance(value, list | tuple):
        return [sendable(item) for item in value]
    if isinstance(value, np.ndarray):
        return value.tolist() if name in LISTED else _packed(value)
    return value


def _packed(array: np.ndarray[Any, Any]) -> Any:
    if array.dtype.kind == "i" and array.size and NARROW.min <= array.min() and array.max() <= NARROW.max:
        array = array.astype(np.int32)
    kind = PACKED.get(array.dtype.name)
    if kind is None or not array.size:
        return array.tolist()
    sent = {"dtype": kind, "bdata": base64.b64encode(array.tobytes()).decode("ascii")}
    return {**sent, "shape": ", ".join(map(str, array.shape))} if array.ndim > 1 else sent
