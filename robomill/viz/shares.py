"""Joint shares as bars, what stiffer joints buy, and the deviation along the six lines of the paper's Fig. 8."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from robomill.arrays import FloatArray
from robomill.units import MINUS, format_number
from robomill.viz.chart import Chart, Trace
from robomill.viz.theme import ABOVE, axis, figure, hover, joint_colours, palette, say

SHARES_HEIGHT, LINES_HEIGHT = 266, 480  # px


def share_bars(
    names: Sequence[str],
    shares: FloatArray,
    joints: Sequence[int],
    unit: str,
    *,
    dark: bool,
    old: FloatArray | None = None,
) -> Chart:
    """Bars, one a component, of the joints' shares (n, k) in ``unit``: what adds goes right, what takes away left.

    A long mark is the sum; a grey one ``old`` (k,), the sum before. The page says the joints' colours.
    """
    p = palette(dark)
    colours = joint_colours(7, dark)
    fig = figure(dark=dark, height=SHARES_HEIGHT, revision="share-bars", barmode="relative", bargap=0.34)
    fig.lay_out(showlegend=False, margin={"l": 34, "r": 50, "t": 6, "b": 38, "autoexpand": False})
    data: list[Trace] = [
        {
            "type": "bar",
            "y": list(names),
            "x": shares[j],
            "orientation": "h",
            "name": f"joint {number}",
            "marker": {"color": colours[j % 7], "line": {"width": 0}},
            "hovertemplate": f"joint {number}<br>%{{y}}: {hover(unit, axis='x')}<extra></extra>",
        }
        for j, number in enumerate(joints)
    ]
    total = shares.sum(axis=0)
    if old is not None and not np.allclose(old, total, rtol=1e-6, atol=1e-12):
        data.append(_marks("sum before", names, old, p.muted, unit))
    data.append(_marks("sum", names, total, p.text, unit))
    top = float(np.nanmax(np.abs(shares), initial=0.0)) or 1.0
    right = np.maximum(shares, 0).sum(axis=0)
    left = float(np.minimum(shares, 0).sum(axis=0).min(initial=0.0))
    for name, value, edge in zip(names, total, right, strict=True):
        say(fig, format_number(value, 3, sign=True), max(edge, 0.0), name, p.text, size=12.5, xanchor="left", xshift=8)
    span = [1.12 * left - 0.02 * top, 1.10 * float(right.max(initial=0.1)) + 0.05 * top]
    fig.layout["xaxis"] = axis(unit, dark=dark, range=span, automargin=False, nticks=4) | {
        "zeroline": True,
        "zerolinecolor": p.line,
    }
    fig.layout["xaxis"]["title"]["standoff"] = 2
    fig.layout["yaxis"] = axis("", dark=dark, autorange="reversed", ticks="", showline=False, automargin=False) | {
        "title": None
    }
    fig.add_traces(data)
    return fig


def _marks(name: str, names: Sequence[str], values: FloatArray, colour: str, unit: str) -> Trace:
    return {
        "type": "scatter",
        "x": values,
        "y": list(names),
        "mode": "markers",
        "name": name,
        "hovertemplate": f"{name} {hover(unit, axis='x')}<extra></extra>",
        "marker": {"symbol": "line-ns-open", "size": 20, "color": colour, "line": {"width": 3, "color": colour}},
    }


def _amount(value: float, top: float, unit: str, digits: int) -> str:
    """With ``digits`` decimals; what is a thousandth of the largest or less is none."""
    text = format_number(value, digits)
    return "0" if abs(value) <= 1e-3 * top or not text.strip(f"{MINUS}0.") else f"{text} {unit}"


def gain_bars(gain: FloatArray, unit: str, digits: int, joints: Sequence[int], *, dark: bool, height: int) -> Chart:
    """What a stiffer joint buys, gain (n,) in ``unit`` with ``digits`` decimals: one bar a joint in the joint's colour,
    the best on top."""
    p, colours = palette(dark), joint_colours(7, dark)
    order = np.argsort(-gain, kind="stable")
    top, low = float(np.nanmax(gain, initial=0.0)) or 1.0, float(np.nanmin(gain, initial=0.0))
    none = 0.5 * 10.0**-digits  # a loss below it is written as 0, and on the right of its bar
    fig = figure(dark=dark, height=height, revision="gains", bargap=0.25, showlegend=False)
    fig.layout["margin"] = {"l": 58, "r": 24, "t": 6, "b": 44, "autoexpand": False}
    fig.add(
        "bar",
        y=[f"joint {joints[i]}" for i in order],
        x=np.where((gain < 0.0) & (gain > -none), 0.0, gain)[order],
        orientation="h",
        marker={"color": [colours[i % 7] for i in order]},
        text=[_amount(gain[i], top, unit, digits) for i in order],
        textposition="outside",
        cliponaxis=False,
        textfont={"color": p.text, "size": 12.5},
        hovertemplate=f"%{{y}}: %{{customdata:.4g}} {unit}<extra></extra>",
        customdata=gain[order],
    )
    span = [1.3 * low - 0.1 * top if low < -none else 0.0, 1.16 * top]
    fig.layout["xaxis"] = axis(unit, dark=dark, nticks=6, range=span, automargin=False)
    fig.layout["xaxis"]["title"]["standoff"] = 6
    fig.layout["yaxis"] = axis("", dark=dark, autorange="reversed", ticks="", automargin=False) | {"title": None}
    return fig


@dataclass(frozen=True, eq=False)
class LinePanel:
    """One line of Fig. 8 in display units: s (m,), total (m,), by joint (m, n), and the total before a change."""

    title: str
    s: FloatArray
    total: FloatArray
    by_joint: FloatArray
    old: FloatArray | None = None


def line_panels(
    panels: Sequence[LinePanel],
    joints: Sequence[int],
    s_titles: Sequence[str],
    unit: str,
    *,
    dark: bool,
) -> Chart:
    """Deviation along straight lines, total and by joint, all panels on one vertical scale."""
    p, columns = palette(dark), 3
    rows = -(-len(panels) // columns)
    margin = {"l": 8, "r": 8, "t": 58, "b": 8}
    fig = figure(dark=dark, height=LINES_HEIGHT, revision="lines", hovermode="x unified", margin=margin)
    fig.lay_out(legend={"y": 1.07})
    gap = 0.08  # with the room left and right of each line it keeps the end labels of two panels apart
    width, tall = (1 - gap * (columns - 1)) / columns, (1 - 0.2 * (rows - 1)) / rows
    span = list(_span(panels))
    data: list[Trace] = []
    for index, panel in enumerate(panels):
        r, c = divmod(index, columns)
        suffix = "" if index == 0 else str(index + 1)
        data += _line_traces(panel, joints, unit, suffix, dark)
        x0, y1 = c * (width + gap), 1 - r * (tall + 0.2)
        fig.layout[f"xaxis{suffix}"] = axis(s_titles[index], dark=dark, nticks=4, anchor=f"y{suffix}") | {
            "domain": [x0, min(x0 + width, 1.0)],
            "range": _wider(panel.s),
        }
        title = f"deviation, {unit}" if c == 0 else ""
        fig.layout[f"yaxis{suffix}"] = axis(title, dark=dark, range=span, nticks=5, anchor=f"x{suffix}") | {
            "domain": [max(y1 - tall, 0.0), y1],
            "showticklabels": c == 0,
        }
        say(fig, panel.title, x0, y1, p.text, size=13, yshift=3, **ABOVE)
    fig.add_traces(data)
    return fig


def _wider(s: FloatArray) -> list[float]:
    """The range of s with room at both ends, so that no tick label stands out over its panel."""
    low, high = float(np.min(s)), float(np.max(s))
    room = 0.06 * (high - low) or 1.0
    return [low - room, high + room]


def _line_traces(panel: LinePanel, joints: Sequence[int], unit: str, suffix: str, dark: bool) -> list[Trace]:
    p = palette(dark)
    colours = joint_colours(7, dark)
    common: Trace = {
        "type": "scatter",
        "mode": "lines",
        "x": panel.s,
        "xaxis": f"x{suffix}",
        "yaxis": f"y{suffix}",
        "showlegend": suffix == "",
        "hovertemplate": hover(unit),
    }
    drawn: list[tuple[str, FloatArray, Trace]] = [
        (f"joint {number}", panel.by_joint[:, j], {"color": colours[j % 7], "width": 1.6})
        for j, number in enumerate(joints)
    ]
    if panel.old is not None:
        drawn.append(("total before", panel.old, {"color": p.muted, "width": 2, "dash": "dot"}))
    drawn.append(("total", panel.total, {"color": p.text, "width": 2.6}))
    return [{**common, "y": y, "name": name, "legendgroup": name, "line": line} for name, y, line in drawn]


def _span(panels: Sequence[LinePanel]) -> tuple[float, float]:
    every = np.concatenate(
        [np.concatenate([q.total, q.by_joint.ravel(), q.old if q.old is not None else []]) for q in panels]
    )
    if not np.isfinite(every).any():
        return 0.0, 1.0
    low, high = min(float(np.nanmin(every)), 0.0), max(float(np.nanmax(every)), 0.0)
    room = 0.07 * (high - low) or 1.0
    return low - (room if low < 0 else 0.3 * room), high + room
