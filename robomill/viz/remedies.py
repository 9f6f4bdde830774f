"""Pictures of remedies: places of the part, turns of the tool, a corrected path, the cost of stiffer joints."""

from collections.abc import Sequence

import numpy as np

from robomill.arrays import FloatArray
from robomill.viz.chart import Chart
from robomill.viz.theme import SEQUENTIAL, axis, colour_bar, figure, palette, say

MAP_HEIGHT, FRONT_HEIGHT = 420, 300  # px


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
        fig.add(
            "scatter",
            x=[at_x],
            y=[at_y],
            mode="markers",
            marker={
                "symbol": "circle-open" if name == "now" else "star",
                "size": 15,
                "color": "#FFFFFF",
                "line": {"width": 2.5, "color": "#FFFFFF"},
            },
            hovertemplate=f"{name}<br>X %{{x:.0f}}, Y %{{y:.0f}} {unit}<extra></extra>",
        )
        say(fig, f"<b>{name}</b>", at_x, at_y, "#FFFFFF", size=13, yshift=16, bgcolor="rgba(0,0,0,.55)", borderpad=2)
    fig.layout["xaxis"] = axis(f"part zero X, {unit}", dark=dark, constrain="domain", automargin=True)
    fig.layout["yaxis"] = axis(f"Y, {unit}", dark=dark, scaleanchor="x", constrain="domain", automargin=True)
    fig.layout["plot_bgcolor"] = palette(dark).panel
    return fig


def _used_map(x: FloatArray, y: FloatArray, used: FloatArray, name: str, where: str, *, dark: bool) -> Chart:
    """Share of the tolerance used (nx, ny), %, over x and y; ``where`` says a place to whoever points at it."""
    fig = figure(dark=dark, height=MAP_HEIGHT, revision=name, showlegend=False)
    fig.layout["margin"] = {"l": 62, "r": 10, "t": 10, "b": 48, "autoexpand": True}
    known = used[np.isfinite(used)]
    fig.add(
        "heatmap",
        x=x,
        y=y,
        z=np.asarray(used).T,
        colorscale=SEQUENTIAL,
        zmin=float(known.min()) if known.size else 0.0,
        zmax=float(np.quantile(known, 0.95)) if known.size else 1.0,
        colorbar=colour_bar("% of tolerance", dark=dark),
        hovertemplate=f"{where}<br>%{{z:.0f}} % of the tolerance<extra></extra>",
    )
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
    fig.add(
        "scatter",
        x=[chosen[0]],
        y=[chosen[1]],
        mode="markers",
        marker={"size": 13, "color": p.text},
        hovertemplate="this design: %{x:.0f} %, cost %{y:.2f}<extra></extra>",
    )
    say(fig, "<b>this design</b>", chosen[0], chosen[1], p.text, size=13, xanchor="left", xshift=10, yshift=10)
    fig.layout["xaxis"] = axis("% of the tolerance used", dark=dark, rangemode="tozero", automargin=False)
    fig.layout["yaxis"] = axis("cost (1: one joint twice as stiff)", dark=dark, rangemode="tozero", automargin=False)
    return fig


def corrected_lines(
    station: FloatArray, before: FloatArray, after: FloatArray, names: Sequence[str], unit: str, *, dark: bool
) -> Chart:
    """Deviations (k, m) in ``unit`` along the cut, station (m,), before (dashed) and after (whole) the correction; NaN
    where nothing is cut."""
    p = palette(dark)
    colours = (p.accent, p.warm)
    fig = figure(dark=dark, height=FRONT_HEIGHT, revision="corrected", hovermode="x unified")
    fig.layout["margin"] = {"l": 62, "r": 16, "t": 34, "b": 48, "autoexpand": False}
    fig.lay_out(legend={"y": 1.12})
    for when, values, look in (("before", before, "dot"), ("after", after, "solid")):
        for name, value, colour in zip(names, values, colours, strict=False):
            fig.add(
                "scatter",
                x=station,
                y=value,
                mode="lines",
                name=f"{name}, {when}",
                line={"color": colour, "width": 2, "dash": look},
                hovertemplate="%{y:+.4f} " + unit,
            )
    fig.layout["xaxis"] = axis(f"length cut, {unit}", dark=dark, automargin=False)
    fig.layout["yaxis"] = axis(f"off the path, {unit}", dark=dark, zeroline=True, automargin=False)
    return fig


def spins_map(
    station: FloatArray,
    angle: FloatArray,
    used: FloatArray,
    course: tuple[FloatArray, FloatArray],
    unit: str,
    *,
    dark: bool,
) -> Chart:
    """Share of the tolerance used (s, a), %, along the cut, station (s,) in ``unit``, by the tool's spin, angle (a,)
    degrees; blank beyond limits and near singular configurations. ``course`` is the best one, way and spin."""
    fig = _used_map(station, angle, used, "spins", f"%{{x:.0f}} {unit} on, spin %{{y:.0f}}°", dark=dark)
    fig.add(
        "scatter",
        x=course[0],
        y=course[1],
        mode="markers",
        marker={"size": 4, "color": "#FFFFFF"},
        hovertemplate=f"best course<br>%{{x:.0f}} {unit} on, spin %{{y:.0f}}°<extra></extra>",
    )
    fig.layout["xaxis"] = axis(f"way of the tool, {unit}", dark=dark, automargin=True)
    fig.layout["yaxis"] = axis("spin about the tool, °", dark=dark, automargin=True)
    return fig
