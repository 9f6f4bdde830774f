"""A figure as plain dictionaries in plotly's own words: its checking classes take a hundred times as long to build one.

A trace is ``{"type": "scatter", "x": ..., ...}``, the layout nested as in plotly's reference, without underscores for
nesting. Nothing is checked while a figure is made; the tests check every figure that they make.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

from robomill.arrays import FloatArray
from robomill.extras import needed

if TYPE_CHECKING:
    import plotly.graph_objects as go

Trace = dict[str, Any]
QUIET: dict[str, Any] = {
    "showlegend": False,
    "hoverinfo": "skip",
}  # a trace that neither the legend nor the mouse tells of


def drawn(kind: str, **what: Any) -> Trace:
    """A trace of a ``kind`` that plotly knows: scatter, bar, mesh3d ..."""
    return {"type": kind, **what}


def xyz(points: FloatArray) -> dict[str, FloatArray]:
    """Points (q, 3) as a trace in space takes them."""
    return dict(zip("xyz", points.T, strict=True))


@dataclass(frozen=True, eq=False)
class Chart:
    """Traces in the order in which they are drawn, and the layout around them."""

    layout: dict[str, Any]
    traces: list[Trace] = field(default_factory=list)

    def add(self, kind: str, **what: Any) -> None:
        """Draw a trace over what is there."""
        self.traces.append(drawn(kind, **what))

    def lines(self, x: Any, y: Any, line: dict[str, Any], **more: Any) -> None:
        """Draw a line through points of the plane."""
        self.add("scatter", x=x, y=y, mode="lines", line=line, **more)

    def dots(self, x: Any, y: Any, marker: dict[str, Any], **more: Any) -> None:
        """Draw markers at points of the plane."""
        self.add("scatter", x=x, y=y, mode="markers", marker=marker, **more)

    def area(self, x: Any, y: Any, fill: str, **more: Any) -> None:
        """Fill an outline in the plane, without a rim unless ``more`` says one."""
        self.add("scatter", x=x, y=y, fill="toself", fillcolor=fill, hoverinfo="skip", **{"mode": "none", **more})

    def add_traces(self, traces: Iterable[Trace]) -> None:
        """Draw traces over what is there, one after the other."""
        self.traces.extend(traces)

    def annotate(self, **annotation: Any) -> None:
        """Words or an arrow in the layout."""
        self.layout.setdefault("annotations", []).append(annotation)

    def shape(self, **shape: Any) -> None:
        """A line or an area in the layout."""
        self.layout.setdefault("shapes", []).append(shape)

    def across(self, y: float, line: dict[str, Any]) -> None:
        """A level line from side to side."""
        self.shape(type="line", xref="x domain", x0=0, x1=1, yref="y", y0=y, y1=y, line=line)

    def upright(self, x: float, line: dict[str, Any]) -> None:
        """A line from the bottom to the top."""
        self.shape(type="line", xref="x", x0=x, x1=x, yref="y domain", y0=0, y1=1, line=line)

    def lay_out(self, **layout: Any) -> Chart:
        """Say more of the layout; what is a dictionary in both is joined. Returns itself."""
        self.layout.update(_joined(self.layout, layout))
        return self

    @property
    def figure(self) -> go.Figure:
        """What plotly draws."""
        with needed("A figure"):
            import plotly.graph_objects as go
        return go.Figure(data=list(self.traces), layout=self.layout, _validate=False)


def _joined(one: dict[str, Any], more: dict[str, Any]) -> dict[str, Any]:
    both = {name: _joined(one[name], value) for name, value in more.items() if _nested(one.get(name), value)}
    return {**one, **more, **both}


def _nested(one: Any, more: Any) -> bool:
    return isinstance(one, dict) and isinstance(more, dict)
