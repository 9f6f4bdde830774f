"""The measuring room's figures: the groove's middle line and floor along its length, and how its error is spread."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from robomill.arrays import FloatArray, IntArray
from robomill.units import MINUS, decimals, unit_label
from robomill.viz.along import Along
from robomill.viz.chart import Chart
from robomill.viz.theme import axis, figure, hover, palette, rgba, say

CLIPPED = 2.0  # tolerances: what is further out would press the rest of the curve flat


@dataclass(frozen=True, eq=False)
class ProfileCurves:
    """Along the groove, all in ``unit``: station, centre offset (+ left of the feed), floor error (+ material left).

    band (2, q): lowest and highest offset over the alloy's rows; fit (q,): the best straight line, whose ends lie in
    the same stations; measured (station (k,), offset (k,)) from a measuring machine; None where none is. ``joined``:
    what lies between two stations lies between their values; else they are dots.
    """

    station: FloatArray
    offset: FloatArray
    floor: FloatArray
    unit: str
    wall_tolerance: float
    floor_tolerance: float
    band: FloatArray | None = None
    fit: FloatArray | None = None
    measured: tuple[FloatArray, FloatArray] | None = None
    joined: bool = True


def profile_figure(curves: ProfileCurves, block: IntArray, station: float, *, dark: bool) -> Chart:
    """The profile with its tolerance, its band, its best line and what was measured; ``block`` (q,) source lines."""
    p, unit = palette(dark), curves.unit
    plot = Along.begin(curves.station, unit, "profile", dark=dark, height=320)
    only_floor = not np.isfinite(curves.offset).any() and curves.measured is None
    limits = _limits(curves.floor_tolerance if only_floor else curves.wall_tolerance, curves.floor_tolerance)
    most = max(place for place, _ in limits)
    inside = {"fillcolor": rgba(p.muted, 0.07), "line": {"width": 0}, "layer": "below"}
    plot.fig.shape(type="rect", xref="x domain", x0=0, x1=1, y0=-most, y1=most, **inside)
    if curves.band is not None:
        plot.shade((curves.band[0], curves.band[1]), "published coefficients", rgba(p.accent, 0.16))
    seen = f"{hover(unit)}, line %{{customdata}}"
    for value, name, colour in ((curves.offset, "centre offset", p.accent), (curves.floor, "floor", p.text)):
        if np.isfinite(value).any() and not curves.joined:
            plot.fig.dots(
                curves.station, value, {"size": 7, "color": colour}, name=name, hovertemplate=seen, customdata=block
            )
        elif np.isfinite(value).any():
            plot.curve(value, name, {"color": colour, "width": 2.2}, seen, customdata=block)
    if curves.fit is not None:
        plot.curve(curves.fit, "best line", {"color": p.muted, "width": 1.2, "dash": "dot"})
    if curves.measured is not None:
        marks = {"size": 8, "symbol": "diamond-open", "color": p.text, "line": {"width": 1.6}}
        plot.fig.dots(*curves.measured, marks, name="measured", hovertemplate=f"measured {hover(unit)}")
    for place, words in limits:
        plot.level(place, p.muted, "solid")
        say(plot.fig, words, 1, place, p.muted, xref="paper", xanchor="right", yshift=9 if place > 0 else -9)
    plot.zero()
    drawn = np.concatenate([curves.offset, curves.floor, *([] if curves.band is None else curves.band)])
    largest = float(np.abs(drawn[np.isfinite(drawn)]).max(initial=0.0))
    reach = min(1.15 * max(most, largest), CLIPPED * most)
    if beyond := beyond_chart(curves):
        say(plot.fig, f"{beyond} beyond", 0, 1, p.muted, xref="paper", yref="paper", xanchor="left", yanchor="top")
    plot.station(station)
    plot.fig.lay_out(showlegend=True)  # of a single curve, too: one must know which of them is there
    return plot.done(f"{'Floor error' if only_floor else 'Error across the cut'}, {unit}", range=[-reach, reach])


def beyond_chart(curves: ProfileCurves) -> int:
    """How many stations lie beyond what the chart shows."""
    ends = CLIPPED * max(curves.wall_tolerance, curves.floor_tolerance)
    outside = (np.abs(values) > ends for values in (curves.offset, curves.floor))
    return int(np.logical_or(*outside).sum())


def _limits(walls: float, floors: float) -> list[tuple[float, str]]:
    """Where the tolerances of walls and floors lie, with their words: one pair where they are one."""
    told = [(walls, "tolerance")] if walls == floors else [(walls, "walls"), (floors, "floors")]
    return [(side * value, f"{sign} {words}") for value, words in told for side, sign in ((1, "+"), (-1, MINUS))]


def histogram_figure(
    edges: FloatArray, share: Mapping[str, FloatArray], tolerances: FloatArray, unit: str = "mm", *, dark: bool
) -> Chart:
    """Share (%) of all walls and floors by signed error (``unit``), ``share`` of each stacked; ``tolerances`` of walls
    and floors marked."""
    p, label = palette(dark), unit_label(unit)
    walls, floors = map(float, tolerances)
    middle = 0.5 * (edges[1:] + edges[:-1])
    margin = {"l": 8, "r": 16, "t": 48, "b": 8}
    fig = figure(dark=dark, height=320, revision="histogram", margin=margin, bargap=0.04, barmode="stack")
    for (name, value), colour in zip(share.items(), (p.accent, p.muted), strict=True):
        fig.add(
            "bar",
            x=middle,
            y=value,
            width=np.diff(edges),
            name=name,
            marker={"color": colour, "line": {"width": 0.6, "color": p.line}},
            hovertemplate=f"{name} %{{x:+.{decimals(unit, None)}f}} {label}<br>%{{y:.1f}} %<extra></extra>",
        )
    for place, words in _limits(walls, floors):
        fig.upright(x=place, line={"color": p.muted, "width": 1.2})
        say(fig, words, place, 1.0, p.muted, yref="paper", yanchor="bottom")
    reach = max(1.12 * walls, 1.12 * floors, float(np.abs(edges).max()) * 1.04)
    fig.lay_out(
        legend={"y": 1.09},
        xaxis=axis(f"Error, {label}", dark=dark, range=[-reach, reach]),
        yaxis=axis("Share of walls and floors, %", dark=dark, rangemode="tozero"),
    )
    return fig
