"""Figures against the length cut: what all of them share, and what is laid over one that is there."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from robomill.arrays import FloatArray, IntArray, stretches
from robomill.simulation.result import SimulationResult
from robomill.viz.chart import QUIET, Chart
from robomill.viz.theme import axis, axis_colours, figure, palette, rgba, say

MAX_POINTS = 6000
MAX_PICKS = 800
CLEAR = "rgba(0,0,0,0)"
_CLEAR = {"marker": {"color": CLEAR, "opacity": 1}}


def thin(count: int, keep: Sequence[int] = ()) -> IntArray:
    """Indices of at most about ``MAX_POINTS`` of ``count`` samples; ``keep`` are always among them."""
    if count <= MAX_POINTS:
        return np.arange(count)
    chosen = np.linspace(0, count - 1, MAX_POINTS).astype(np.int64)
    return np.unique(np.concatenate([chosen, np.asarray(keep, dtype=np.int64)]))


def at_feed(result: SimulationResult, values: FloatArray) -> FloatArray:
    """``values`` (m, k) with NaN where nothing is cut, so that lines break there."""
    return np.where(result.path.cutting[:, None], values, np.nan)


@dataclass(frozen=True, eq=False)
class Along:
    """A figure against the length cut s (m,), in ``unit`` (mm or in); of long runs the ``chosen`` samples are drawn."""

    fig: Chart
    s: FloatArray
    chosen: IntArray
    unit: str
    dark: bool

    @classmethod
    def begin(
        cls, s: FloatArray, unit: str, revision: str, *, dark: bool, height: int, keep: Sequence[int] = ()
    ) -> Along:
        """An empty figure; samples ``keep`` are drawn however long the run is."""
        margin = {"l": 8, "r": 16, "t": 36, "b": 8}
        fig = figure(dark=dark, height=height, revision=revision, hovermode="x unified", margin=margin)
        return cls(fig, s, thin(len(s), keep), unit, dark)

    def curve(self, value: FloatArray, name: str, line: dict[str, Any], hover: str = "", **more: Any) -> None:
        """value (m,) as a line; ``hover`` is the format of its number, "" leaves it out of the hover text."""
        words: dict[str, Any] = {"hovertemplate": hover} if hover else {"hoverinfo": "skip"}
        i = self.chosen
        self.fig.lines(self.s[i], value[i], line, name=name, **words, **more)

    def shade(self, band: tuple[FloatArray, FloatArray], name: str, fill: str, legend: bool = True) -> None:
        """The region between two curves (m,)."""
        i = self.chosen
        shade(self.fig, self.s[i], (band[0][i], band[1][i]), name, fill, legend)

    def level(self, y: float, colour: str, dash: str = "dash") -> None:
        """A thin line at a limit."""
        self.fig.across(y=y, line={"color": colour, "width": 1.2, "dash": dash})

    def zero(self) -> None:
        """A quiet line at zero."""
        self.fig.across(y=0, line={"color": palette(self.dark).line, "width": 1})

    def station(self, at: float, name: str = "") -> None:
        """A line where the station is."""
        accent = palette(self.dark).accent
        self.fig.upright(x=at, line={"color": accent, "width": 1.6})
        if name:
            say(self.fig, name, at, 0, accent, yref="paper", yshift=10, xshift=4, xanchor="left")

    def done(self, title: str, **more: Any) -> Chart:
        """The figure with its axes (``more``: of y)."""
        return self.fig.lay_out(
            xaxis=axis(f"Length cut, {self.unit}", dark=self.dark), yaxis=axis(title, dark=self.dark, **more)
        )


def shade(
    fig: Chart, s: FloatArray, band: tuple[FloatArray, FloatArray], name: str, fill: str, legend: bool = True
) -> None:
    """The region between the two curves (m,) of ``band`` against s (m,); it stops where either is NaN."""
    low, high = band
    good = np.isfinite(low) & np.isfinite(high)
    runs = [slice(begin, past) for begin, past in stretches(good)]
    for k, run in enumerate(run for run in runs if np.any(high[run] - low[run] > 1e-9)):
        there, back = np.concatenate([s[run], s[run][::-1]]), np.concatenate([high[run], low[run][::-1]])
        named = {"name": name, "legendgroup": name, "showlegend": legend and k == 0}
        fig.area(there, back, fill, mode="lines", line={"width": 0}, **named)


def add_band(fig: Chart, s: FloatArray, value: FloatArray, half: FloatArray, name: str, *, dark: bool) -> None:
    """Shade value +- half (m,) against s (m,) in the colour of component ``name`` ("x", "y", "z"; "": the size).

    Everything in the units of the figure; where either is NaN the shade stops.
    """
    colour, i = axis_colours(dark).get(name, palette(dark).text), thin(len(s))
    band = (value - half)[i], (value + half)[i]
    shade(fig, s[i], band, "95 % band", rgba(colour, 0.22), legend=name == "")


def add_picks(fig: Chart, s: FloatArray, value: FloatArray, words: Sequence[str]) -> None:
    """Clear markers at (s, value) (m,), NaN left out, with ``words`` (m,) to hover; a picked point's x is its station.

    Plotly tells of clicks on markers only, and a click counts for the first of the points that are hovered, so these
    become the only ones: wherever the mouse is, the nearest of them answers.
    """
    good = np.flatnonzero(np.isfinite(value) & np.isfinite(s))
    if len(good) > MAX_PICKS:
        good = good[np.linspace(0, len(good) - 1, MAX_PICKS).astype(int)]
    for trace in fig.traces:
        trace.update(hoverinfo="skip", hovertemplate=None)
    hover = {"text": [words[int(i)] for i in good], "hovertemplate": "%{text}<extra></extra>"}
    unseen = {"size": 14, "color": CLEAR, "line": {"width": 0}}
    fig.dots(s[good], value[good], unseen, name="pick", showlegend=False, selected=_CLEAR, unselected=_CLEAR, **hover)
    fig.lay_out(dragmode="pan", clickmode="event+select", hovermode="closest", hoverdistance=-1)


def add_point(fig: Chart, x: float, y: float, *, dark: bool) -> None:
    """A dot where the station is on the curve."""
    if np.isfinite(x) and np.isfinite(y):
        p = palette(dark)
        marker = {"size": 11, "color": p.accent, "line": {"width": 2, "color": p.background}}
        fig.dots([x], [y], marker, name="station", **QUIET)
