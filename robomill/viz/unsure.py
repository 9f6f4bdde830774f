"""Pictures of how sure a cut is: the distribution of what it uses of its tolerance, what each input does to that."""

from collections.abc import Sequence

import numpy as np

from robomill.arrays import FloatArray
from robomill.viz.chart import Chart
from robomill.viz.remedies import WHOLE
from robomill.viz.theme import axis, figure, palette, rgba, say

HEIGHT, BINS, ROW = 300, 40, 30  # px, bars, px
BEYOND = 0.999  # of the draws are drawn


def distribution(used: FloatArray, now: float, sure: float, *, dark: bool) -> Chart:
    """How many of the draws (k,), % of them, use how much of the tolerance, %; lines at what is used ``now``, at what
    95 % of them keep (``sure``), and at all of it."""
    p = palette(dark)
    known = used[np.isfinite(used)]
    edges = np.linspace(float(known.min()), float(np.quantile(known, BEYOND)) + 1e-9, BINS + 1)
    share = 100.0 * np.histogram(known, edges)[0] / max(len(used), 1)
    top = 1.28 * float(share.max(initial=1e-9))
    fig = figure(dark=dark, height=HEIGHT, revision="draws", showlegend=False, bargap=0.04)
    fig.layout["margin"] = {"l": 56, "r": 16, "t": 10, "b": 48, "autoexpand": False}
    hover = "%{x:.0f} % of the tolerance: %{y:.1f} % of the draws<extra></extra>"
    centres = 0.5 * (edges[1:] + edges[:-1])
    fig.add("bar", x=centres, y=share, marker={"color": rgba(p.accent, 0.75)}, hovertemplate=hover)
    marks = [(now, "predicted", "dot", p.text), (sure, "95 %", "solid", p.text), (WHOLE, "tolerance", "dash", p.warm)]
    first, last = edges[0], max(edges[-1], *(at for at, *_ in marks if at <= 1.5 * edges[-1]))
    for k, (at, name, dash, colour) in enumerate(marks):
        if not np.isfinite(at) or (at == WHOLE and at > 1.5 * edges[-1]):
            continue
        fig.lines([at, at], [0.0, top], {"color": colour, "width": 2, "dash": dash}, hoverinfo="skip")
        side, shift = ("right", -5) if at - first > 0.7 * (last - first) else ("left", 5)  # within the picture
        ground = {"bgcolor": rgba(p.background, 0.8), "borderpad": 1}
        say(fig, f"<b>{name}</b>", at, (0.96 - 0.09 * k) * top, colour, size=13, xanchor=side, xshift=shift, **ground)
    fig.layout["xaxis"] = axis("% of the tolerance used", dark=dark, automargin=False)
    fig.layout["yaxis"] = axis("% of the draws", dark=dark, range=[0.0, top], automargin=False)
    return fig


def tornado_bars(names: Sequence[str], low: FloatArray, high: FloatArray, now: float, *, dark: bool) -> Chart:
    """Share of the tolerance used, %, with each input (p,) alone at the ends of its 95 % interval, the first on top; a
    line at what is used ``now``."""
    p = palette(dark)
    fig = figure(dark=dark, height=80 + ROW * len(names), revision="tornado", showlegend=False, bargap=0.3)
    fig.layout["margin"] = {"l": 10, "r": 16, "t": 10, "b": 48, "autoexpand": True}
    fig.add(
        "bar",
        y=list(names),
        x=np.abs(high - low),
        base=np.minimum(low, high),
        orientation="h",
        marker={"color": p.accent},
        customdata=np.column_stack([np.minimum(low, high), np.maximum(low, high)]),
        hovertemplate="%{y}: %{customdata[0]:.0f} to %{customdata[1]:.0f} % of the tolerance<extra></extra>",
    )
    ends = [names[0], names[-1]]
    fig.lines([now, now], ends, {"color": p.text, "width": 1.5, "dash": "dot"}, hoverinfo="skip")
    fig.layout["xaxis"] = axis("% of the tolerance used", dark=dark, automargin=True)
    fig.layout["yaxis"] = axis("", dark=dark, autorange="reversed", ticks="", automargin=True) | {"title": None}
    return fig
