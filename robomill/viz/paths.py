"""Figures along the path: deviation as components, shares by joint, the path seen from above coloured by a quantity."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
import plotly.graph_objects as go

from robomill.arrays import FloatArray, IntArray
from robomill.viz.theme import (
    axis,
    axis_colours,
    figure,
    joint_colours,
    palette,
    rgba,
)

MAX_POINTS = 6000


def thin(count: int, keep: Sequence[int] = ()) -> IntArray:
    """Indices of at most about ``MAX_POINTS`` of ``count`` samples; ``keep`` are always among them."""
    if count <= MAX_POINTS:
        return np.arange(count)
    chosen = np.linspace(0, count - 1, MAX_POINTS).astype(np.int64)
    return np.unique(np.concatenate([chosen, np.asarray(keep, dtype=np.int64)]))


def components_figure(
    s: FloatArray,
    delta: FloatArray,
    block: IntArray,
    tolerance: float,
    unit: str,
    *,
    dark: bool,
    height: int = 300,
    station: float | None = None,
) -> go.Figure:
    """Deviation (m, 3) and its size against the length cut s (m,); everything already in ``unit`` (s in mm or in)."""
    p = palette(dark)
    length = "in" if unit == "in" else "mm"
    i = thin(len(s), [int(np.nanargmax(np.nan_to_num(np.linalg.norm(delta, axis=1))))])
    fig = figure(
        dark=dark,
        height=height,
        revision="components",
        hovermode="x unified",
        margin={"l": 8, "r": 16, "t": 34, "b": 8},
    )
    size = np.linalg.norm(delta, axis=1)
    fig.add_scatter(
        x=s[i],
        y=size[i],
        name="size",
        mode="lines",
        line={"color": p.text, "width": 2.4},
        hovertemplate="%{y:.4f} " + unit,
        fill="tozeroy",
        fillcolor=rgba(p.text, 0.05),
    )
    for column, (name, colour) in enumerate(axis_colours(dark).items()):
        fig.add_scatter(
            x=s[i],
            y=delta[i, column],
            name=f"δ<sub>{name.upper()}</sub>",
            mode="lines",
            line={"color": colour, "width": 2, "dash": ("dot", "solid", "dash")[column]},
            hovertemplate="%{y:+.4f} " + unit,
            customdata=block[i],
        )
    for side in (1, -1) if np.nanmin(delta, initial=0.0) < -0.6 * tolerance else (1,):
        fig.add_hline(y=side * tolerance, line={"color": p.bad, "width": 1.2, "dash": "dash"})
    fig.add_annotation(
        x=1,
        xref="paper",
        y=tolerance,
        yshift=9,
        xanchor="right",
        text=f"tolerance {tolerance:g} {unit}",
        showarrow=False,
        font={"size": 12, "color": p.bad},
    )
    fig.add_hline(y=0, line={"color": p.line, "width": 1})
    _mark_station(fig, station, dark)
    fig.update_layout(
        xaxis=axis(f"Length cut, {length}", dark=dark), yaxis=axis(f"Deviation in {{M}}, {unit}", dark=dark)
    )
    return fig


def shares_figure(
    s: FloatArray,
    shares: FloatArray,
    names: Sequence[str],
    total: FloatArray,
    component: str,
    unit: str,
    *,
    dark: bool,
    height: int = 300,
    station: float | None = None,
) -> go.Figure:
    """Joint shares (m, n) of one component, stacked: what pushes the tip up above zero, what pulls it back below."""
    p = palette(dark)
    length = "in" if unit == "in" else "mm"
    i = thin(len(s))
    fig = figure(
        dark=dark,
        height=height,
        revision=f"shares-{component}",
        hovermode="x unified",
        margin={"l": 8, "r": 16, "t": 34, "b": 8},
    )
    colours = joint_colours(7, dark)
    shares, names, order = _without_the_small(shares, names)
    for j, name in enumerate(names):
        colour = colours[order[j] % 7] if order[j] >= 0 else p.muted
        for sign in (1, -1):
            part = np.where(np.sign(np.nan_to_num(shares[i, j])) == sign, shares[i, j], 0.0)
            if not np.any(part):
                continue
            fig.add_scatter(
                x=s[i],
                y=part,
                name=name,
                stackgroup="up" if sign > 0 else "down",
                mode="lines",
                line={"width": 0.6, "color": colour},
                fillcolor=rgba(colour, 0.78),
                legendgroup=name,
                hovertemplate="%{y:+.4f} " + unit,
            )
    fig.add_scatter(
        x=s[i],
        y=total[i],
        name="total",
        mode="lines",
        line={"color": p.text, "width": 2.2},
        hovertemplate="%{y:+.4f} " + unit,
    )
    fig.add_hline(y=0, line={"color": p.line, "width": 1})
    _mark_station(fig, station, dark)
    fig.update_layout(
        xaxis=axis(f"Length cut, {length}", dark=dark),
        yaxis=axis(f"Share of δ<sub>{component.upper()}</sub>, {unit}", dark=dark),
    )
    return fig


def _without_the_small(shares: FloatArray, names: Sequence[str]) -> tuple[FloatArray, list[str], list[int]]:
    """Shares under 1 % of the largest as one "others"; the third value keeps each joint's own colour."""
    size = np.nanmax(np.abs(shares), axis=0, initial=0.0, where=np.isfinite(shares))
    large = size >= 0.01 * max(float(size.max(initial=0.0)), 1e-300)
    kept = np.flatnonzero(large)
    if large.all() or not large.any():
        return shares, list(names), list(range(len(names)))
    rest = shares[:, ~large].sum(axis=1, keepdims=True)
    small = [name.removeprefix("joint ") for name, big in zip(names, large, strict=True) if not big]
    label = f"joints {', '.join(small)} (under 1 %)"
    return np.hstack([shares[:, large], rest]), [*(names[int(j)] for j in kept), label], [*kept.tolist(), -1]


def _mark_station(fig: go.Figure, station: float | None, dark: bool) -> None:
    if station is not None:
        style: dict[str, Any] = {"color": palette(dark).accent, "width": 1.6}
        fig.add_vline(x=station, line=style)
        fig.add_annotation(
            x=station,
            y=0,
            yref="paper",
            yshift=10,
            xshift=4,
            xanchor="left",
            text="station",
            showarrow=False,
            font={"size": 12, "color": palette(dark).accent},
        )
