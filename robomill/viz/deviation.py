"""Deviation along the path: by component, by joint, with its band, and by two methods."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import plotly.graph_objects as go

from robomill.arrays import FloatArray, IntArray
from robomill.viz.along import Along, add_band
from robomill.viz.theme import axis_colours, joint_colours, palette, rgba, say

DASHES = {"x": "dot", "y": "solid", "z": "dash"}


@dataclass(frozen=True, eq=False)
class Components:
    """Path deviation delta (m, 3) against the length cut s (m,), with the lines (m,) and the tolerance; in ``unit``."""

    s: FloatArray
    delta: FloatArray
    block: IntArray
    tolerance: float
    unit: str


@dataclass(frozen=True, eq=False)
class Shares:
    """Shares (m, n) of one ``component`` of the deviation ("x", "y", "z") by joint and spring, with their sum (m,)."""

    s: FloatArray
    shares: FloatArray
    names: Sequence[str]
    total: FloatArray
    component: str
    unit: str


@dataclass(frozen=True, eq=False)
class BandCurve:
    """value +- half (m,) of a ``component`` ("": the size) against s (m,), what the project has now, in ``unit``."""

    s: FloatArray
    value: FloatArray
    half: FloatArray
    now: FloatArray | None
    component: str
    unit: str


def components_figure(c: Components, *, dark: bool, height: int = 300, station: float | None = None) -> go.Figure:
    """The deviation's size and components."""
    p = palette(dark)
    size = np.linalg.norm(c.delta, axis=1)
    worst = int(np.nanargmax(np.nan_to_num(size)))
    plot = Along.begin(c.s, c.unit, "components", dark=dark, height=height, keep=[worst])
    below = {"fill": "tozeroy", "fillcolor": rgba(p.text, 0.05)}
    plot.curve(size, "size", {"color": p.text, "width": 2.4}, "%{y:.4f} " + c.unit, **below)
    for column, (name, colour) in enumerate(axis_colours(dark).items()):
        line = {"color": colour, "width": 2, "dash": DASHES[name]}
        lines = c.block[plot.chosen]
        words = f"δ<sub>{name.upper()}</sub>"
        plot.curve(c.delta[:, column], words, line, "%{y:+.4f} " + c.unit, customdata=lines)
    for side in (1, -1) if np.nanmin(c.delta, initial=0.0) < -0.6 * c.tolerance else (1,):
        plot.level(side * c.tolerance, p.bad)
    words = f"tolerance {c.tolerance:g} {c.unit}"
    say(plot.fig, words, 1, c.tolerance, p.bad, xref="paper", xanchor="right", yshift=9)
    plot.zero()
    _name_station(plot, station)
    return plot.done(f"Deviation in {{M}}, {c.unit}", station)


def shares_figure(c: Shares, *, dark: bool, height: int = 300, station: float | None = None) -> go.Figure:
    """Shares stacked: what pushes the tip up above zero, what pulls it back below."""
    p = palette(dark)
    plot = Along.begin(c.s, c.unit, f"shares-{c.component}", dark=dark, height=height)
    hover = "%{y:+.4f} " + c.unit
    shares, names, order = _without_the_small(c.shares, c.names)
    for j, name in enumerate(names):
        colour = joint_colours(7, dark)[order[j] % 7] if order[j] >= 0 else p.muted
        named = False
        for sign, stack in ((1, "up"), (-1, "down")):
            part = np.where(np.sign(np.nan_to_num(shares[:, j])) == sign, shares[:, j], 0.0)
            if np.any(part[plot.chosen]):  # a joint that pushes both ways has two areas and needs one name
                area = {"stackgroup": stack, "fillcolor": rgba(colour, 0.78), "legendgroup": name}
                plot.curve(part, name, {"width": 0.6, "color": colour}, hover, showlegend=not named, **area)
                named = True
    plot.curve(c.total, "total", {"color": p.text, "width": 2.2}, hover)
    plot.zero()
    _name_station(plot, station)
    return plot.done(f"Share of δ<sub>{c.component.upper()}</sub>, {c.unit}", station)


def band_figure(c: BandCurve, *, dark: bool, height: int = 320) -> go.Figure:
    """The curve with its band; dashed beneath it the values that the project has now."""
    p = palette(dark)
    symbol = f"δ<sub>{c.component.upper()}</sub>" if c.component else "size"
    plot = Along.begin(c.s, c.unit, f"band-{c.component}", dark=dark, height=height)
    add_band(plot.fig, c.s, c.value, c.half, c.component, dark=dark)
    if plot.fig.data:
        plot.fig.data[0].showlegend = True
    if c.now is not None:
        line = {"color": p.muted, "width": 1.6, "dash": "dash"}
        plot.curve(c.now, "project now", line, "%{y:+.4f} " + c.unit)
    line = {"color": axis_colours(dark).get(c.component, p.text), "width": 2.4}
    hover = "%{y:+.4f} ± %{customdata:.4f} " + c.unit
    plot.curve(c.value, f"{symbol}, load tests", line, hover, customdata=c.half[plot.chosen])
    return plot.done(f"Deviation {symbol} in {{M}}, {c.unit}")


def both_figure(
    s: FloatArray, by_map: FloatArray, by_joints: FloatArray, unit: str, *, dark: bool, height: int = 280
) -> go.Figure:
    """Size of the deviation along the path (m,) by the measured map and by the joint model, in ``unit``."""
    p = palette(dark)
    plot = Along.begin(s, unit, "both", dark=dark, height=height)
    plot.curve(by_map, "measured map", {"color": p.warm, "width": 2.4}, "%{y:.4f} " + unit)
    plot.curve(by_joints, "joint model", {"color": p.accent, "width": 2.2, "dash": "dash"}, "%{y:.4f} " + unit)
    return plot.done(f"Deviation, {unit}", rangemode="tozero")


def _without_the_small(shares: FloatArray, names: Sequence[str]) -> tuple[FloatArray, list[str], list[int]]:
    """Shares under 1 % of the largest as one "others"; the third value keeps each joint's own colour."""
    size = np.nanmax(np.abs(shares), axis=0, initial=0.0, where=np.isfinite(shares))
    large = size >= 0.01 * max(float(size.max(initial=0.0)), 1e-300)
    kept = np.flatnonzero(large)
    if large.all() or not large.any():
        return shares, list(names), list(range(len(names)))
    rest = shares[:, ~large].sum(axis=1, keepdims=True)
    label = f"{', '.join(name for name, big in zip(names, large, strict=True) if not big)} (under 1 %)"
    return np.hstack([shares[:, large], rest]), [*(names[int(j)] for j in kept), label], [*kept.tolist(), -1]


def _name_station(plot: Along, station: float | None) -> None:
    if station is not None:
        beside: dict[str, Any] = {"yref": "paper", "yshift": 10, "xshift": 4, "xanchor": "left"}
        say(plot.fig, "station", station, 0, palette(plot.dark).accent, **beside)
