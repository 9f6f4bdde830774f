"""How sure a curve along the path is: shaded bands, on a figure of their own or laid under one that is there."""

from __future__ import annotations

import numpy as np
import plotly.graph_objects as go

from robomill.arrays import BoolArray, FloatArray
from robomill.viz.paths import thin
from robomill.viz.theme import axis, axis_colours, figure, palette, rgba


def add_band(fig: go.Figure, s: FloatArray, value: FloatArray, half: FloatArray, name: str, *, dark: bool) -> None:
    """Shade value +- half (m,) against s (m,) in the colour of component ``name`` ("x", "y", "z"; "": the size).

    Everything in the units of the figure; where either is NaN the shade stops.
    """
    colour = axis_colours(dark).get(name, palette(dark).text)
    chosen = thin(len(s))
    s, value, half = s[chosen], value[chosen], half[chosen]
    for k, run in enumerate(_runs(np.isfinite(value) & np.isfinite(half))):
        x = np.concatenate([s[run], s[run][::-1]])
        y = np.concatenate([(value + half)[run], (value - half)[run][::-1]])
        fig.add_scatter(
            x=x,
            y=y,
            mode="lines",
            fill="toself",
            fillcolor=rgba(colour, 0.22),
            line={"width": 0},
            name="95 % band",
            legendgroup="band",
            showlegend=k == 0 and name == "",
            hoverinfo="skip",
        )


def band_figure(
    s: FloatArray,
    value: FloatArray,
    half: FloatArray,
    now: FloatArray | None,
    component: str,
    unit: str,
    *,
    dark: bool,
    height: int = 320,
) -> go.Figure:
    """One component of the deviation with its band; dashed beneath it the values that the project has now.

    s, value, half (m,) in ``unit`` (mm or in); ``component`` "x", "y", "z" or "" for the size.
    """
    p = palette(dark)
    colour = axis_colours(dark).get(component, p.text)
    symbol = f"δ<sub>{component.upper()}</sub>" if component else "size"
    fig = figure(
        dark=dark,
        height=height,
        revision=f"band-{component}",
        hovermode="x unified",
        margin={"l": 8, "r": 16, "t": 34, "b": 8},
    )
    add_band(fig, s, value, half, component, dark=dark)
    fig.data[0].showlegend = True
    i = thin(len(s))
    if now is not None:
        fig.add_scatter(
            x=s[i],
            y=now[i],
            mode="lines",
            name="project now",
            line={"color": p.muted, "width": 1.6, "dash": "dash"},
            hovertemplate="%{y:+.4f} " + unit,
        )
    fig.add_scatter(
        x=s[i],
        y=value[i],
        mode="lines",
        name=f"{symbol}, load tests",
        line={"color": colour, "width": 2.4},
        customdata=half[i],
        hovertemplate="%{y:+.4f} ± %{customdata:.4f} " + unit,
    )
    fig.update_layout(
        xaxis=axis(f"Length cut, {unit}", dark=dark), yaxis=axis(f"Deviation {symbol} in {{M}}, {unit}", dark=dark)
    )
    return fig


def _runs(good: BoolArray) -> list[slice]:
    """Slices of consecutive True entries."""
    edges = np.flatnonzero(np.diff(np.concatenate([[0], good.astype(np.int8), [0]])))
    return [slice(int(a), int(b)) for a, b in zip(edges[::2], edges[1::2], strict=True)]
