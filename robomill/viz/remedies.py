"""Pictures of remedies: places of the part, turns of the tool, a corrected path, the cost of stiffer joints."""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from robomill.arrays import FloatArray
from robomill.viz.along import Along
from robomill.viz.chart import Chart
from robomill.viz.theme import SEQUENTIAL, axis, colour_bar, figure, hover, palette, say

MAP_HEIGHT, FRONT_HEIGHT = 420, 300  # px
NEAR_TOLERANCE = 0.5  # of it: deviations beyond are drawn with it
CORRECTED = ("across the feed", "along the axis")
HALF_TURN = 180.0  # deg
WHOLE = 100.0  # % of the tolerance


def places_map(
    x: FloatArray,
    y: FloatArray,
    used: FloatArray,
    marks: Sequence[tuple[str, float, float]],
    unit: str,
    *,
    dark: bool,
) -> Chart:
    """Share of the tolerance used (nx, ny), %, with part zero at x (nx,), y (ny,) in ``unit``; blank where no place is
    allowed. ``marks`` are places by name."""
    fig = _used_map(x, y, used, "places", f"X %{{x:.0f}}, Y %{{y:.0f}} {unit}", dark=dark)
    for name, at_x, at_y in marks:
        symbol, rim = ("star", "#0B1C28") if name == "best" else ("circle-open", "#FFFFFF")
        marker = {"symbol": symbol, "size": 15, "color": "#FFFFFF", "line": {"width": 2, "color": rim}}
        seen = f"{name}<br>X %{{x:.0f}}, Y %{{y:.0f}} {unit}<extra></extra>"
        fig.dots([at_x], [at_y], marker, cliponaxis=False, hovertemplate=seen)
        _named(fig, name, at_x, at_y, yshift=18)
    fig.layout["xaxis"] = axis(f"part zero X, {unit}", dark=dark, constrain="domain", automargin=True)
    fig.layout["yaxis"] = axis(f"Y, {unit}", dark=dark, scaleanchor="x", constrain="domain", automargin=True)
    fig.layout["plot_bgcolor"] = palette(dark).panel
    return fig


def _used_map(x: FloatArray, y: FloatArray, used: FloatArray, name: str, where: str, *, dark: bool) -> Chart:
    """Share of the tolerance used (nx, ny), %, over x and y; ``where`` says a place to whoever points at it."""
    fig = figure(dark=dark, height=MAP_HEIGHT, revision=name, showlegend=False)
    fig.layout["margin"] = {"l": 62, "r": 10, "t": 10, "b": 48, "autoexpand": True}
    used = np.asarray(used)
    known = used[np.isfinite(used)]
    fig.add(
        "heatmap",
        x=x,
        y=y,
        z=used.T,
        colorscale=SEQUENTIAL,
        zmin=float(known.min()) if known.size else 0.0,
        zmax=float(np.quantile(known, 0.95)) if known.size else 1.0,
        colorbar=colour_bar("% of tolerance", dark=dark),
        hovertemplate=f"{where}<br>%{{z:.0f}} % of the tolerance<extra></extra>",
    )
    if known.size and known.min() < WHOLE < known.max() and min(used.shape) > 1:
        level = {"start": WHOLE, "end": WHOLE, "size": 1, "coloring": "none"}
        line = {"color": "#FFFFFF", "width": 2}
        fig.add("contour", x=x, y=y, z=used.T, contours=level, line=line, hoverinfo="skip", showscale=False)
    return fig


def cost_front(used: FloatArray, cost: FloatArray, chosen: tuple[float, float], *, dark: bool) -> Chart:
    """What each share of the tolerance (k,), %, costs (k,); ``chosen`` is the design found, (share, cost)."""
    p = palette(dark)
    fig = figure(dark=dark, height=FRONT_HEIGHT, revision="front", showlegend=False)
    fig.layout["margin"] = {"l": 56, "r": 16, "t": 10, "b": 48, "autoexpand": False}
    fig.add(
        "scatter",
        x=used,
        y=cost,
        mode="lines+markers",
        line={"color": p.accent, "width": 2},
        marker={"size": 6, "color": p.accent},
        hovertemplate="%{x:.0f} % of the tolerance costs %{y:.2f}<extra></extra>",
    )
    seen = "this design: %{x:.0f} %, cost %{y:.2f}<extra></extra>"
    fig.dots([chosen[0]], [chosen[1]], {"size": 13, "color": p.text}, hovertemplate=seen)
    say(fig, "<b>this design</b>", chosen[0], chosen[1], p.text, size=13, xanchor="left", xshift=10, yshift=10)
    fig.layout["xaxis"] = axis("% of the tolerance used", dark=dark, rangemode="tozero", automargin=False)
    fig.layout["yaxis"] = axis("cost (1: one joint twice as stiff)", dark=dark, rangemode="tozero", automargin=False)
    return fig


def corrected_lines(
    station: FloatArray,
    before: FloatArray,
    after: FloatArray,
    tolerance: float,
    unit: str,
    *,
    dark: bool,
) -> Chart:
    """Deviations (2, m) along the cut, station (m,), before (dotted) and after (whole) the correction, with the
    tolerance on the sides that they come near to; all in ``unit``, NaN where nothing is cut."""
    p = palette(dark)
    plot = Along.begin(station, unit, "corrected", dark=dark, height=FRONT_HEIGHT + 40)
    for when, values, look in (("before", before, "dot"), ("after", after, "solid")):
        for name, value, colour in zip(CORRECTED, values, (p.accent, p.warm), strict=True):
            line = {"color": colour, "width": 2.2, "dash": look}
            plot.curve(value, f"{name}, {when}", line, hover(unit))
    ends = float(np.nanmin(before, initial=0.0)), float(np.nanmax(before, initial=0.0))
    for side in (-1, 1):
        if side * ends[side > 0] > NEAR_TOLERANCE * tolerance:
            plot.level(side * tolerance, p.muted, "solid")
            say(plot.fig, "tolerance", 1, side * tolerance, p.muted, xref="paper", xanchor="right", yshift=9)
    plot.zero()
    return plot.done(f"Off the path, {unit}")


def spins_map(
    station: FloatArray,
    angle: FloatArray,
    used: FloatArray,
    courses: Mapping[str, tuple[FloatArray, FloatArray]],
    unit: str,
    *,
    dark: bool,
) -> Chart:
    """Share of the tolerance used (s, a), %, along the cut, station (s,) in ``unit``, by the tool's spin, angle (a,)
    degrees; blank beyond limits and near singular configurations. ``courses`` are way and spin by name."""
    fig = _used_map(station, angle, used, "spins", f"%{{x:.0f}} {unit} on, spin %{{y:.0f}}°", dark=dark)
    for (name, (way, spin)), dash in zip(courses.items(), ("dot", "solid"), strict=False):
        if not len(way):
            continue
        jumps = np.append(np.abs(np.diff(spin)) > HALF_TURN, False)  # over 360 degrees: the line breaks there
        fig.lines(
            way,
            np.where(jumps, np.nan, spin),
            {"color": "#FFFFFF", "width": 2.5, "dash": dash},
            hovertemplate=f"{name}<br>%{{x:.0f}} {unit} on, spin %{{y:.0f}}°<extra></extra>",
        )
        _named(fig, name, float(way[0]), float(spin[0]), xanchor="left", yshift=14 if dash == "solid" else -14)
    fig.layout["xaxis"] = axis(f"way of the tool, {unit}", dark=dark, automargin=True)
    fig.layout["yaxis"] = axis("spin about the tool, °", dark=dark, automargin=True, dtick=60)
    return fig


def _named(fig: Chart, name: str, x: float, y: float, **where: Any) -> None:
    """A name on a map, white on dark."""
    say(fig, f"<b>{name}</b>", x, y, "#FFFFFF", size=13, bgcolor="rgba(0,0,0,.6)", borderpad=2, **where)
