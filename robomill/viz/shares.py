"""Joint shares as bars, what stiffer joints buy, and the deviation along the six lines of the paper's Fig. 8."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import plotly.graph_objects as go

from robomill.arrays import FloatArray
from robomill.viz.theme import axis, figure, joint_colours, palette, rgba


def share_bars(
    names: Sequence[str],
    shares: FloatArray,
    joints: Sequence[int],
    unit: str,
    *,
    dark: bool,
    old: FloatArray | None = None,
    height: int = 300,
    revision: str = "share-bars",
    lit: Sequence[bool] | None = None,
) -> go.Figure:
    """Bars, one a component, of the joints' shares (n, k) in ``unit``: what adds goes right, what takes away left.

    The black mark is the sum; the hollow one ``old`` (k,), the sum before. ``lit`` components are full, others pale.
    """
    p = palette(dark)
    colours = joint_colours(7, dark)
    fig = figure(dark=dark, height=height, revision=revision, barmode="relative", bargap=0.34,
                 margin={"l": 8, "r": 58, "t": 30, "b": 8})  # fmt: skip
    shown = np.ones(len(names), bool) if lit is None else np.asarray(lit, dtype=bool)
    for j, number in enumerate(joints):
        fig.add_bar(
            y=list(names), x=shares[j], orientation="h", name=f"joint {number}",
            marker={"color": [rgba(colours[j % 7], 1.0 if on else 0.35) for on in shown], "line": {"width": 0}},
            hovertemplate=f"joint {number}<br>%{{y}}: %{{x:+.4f}} {unit}<extra></extra>",
        )  # fmt: skip
    total = shares.sum(axis=0)
    if old is not None and not np.allclose(old, total, rtol=1e-6, atol=1e-12):
        fig.add_scatter(
            x=old,
            y=list(names),
            mode="markers",
            name="sum before",
            hovertemplate="before %{x:+.4f} " + unit + "<extra></extra>",
            marker={"symbol": "line-ns-open", "size": 26, "color": p.muted, "line": {"width": 2.2, "color": p.muted}},
        )
    fig.add_scatter(
        x=total, y=list(names), mode="markers", name="sum", hovertemplate="sum %{x:+.4f} " + unit + "<extra></extra>",
        marker={"symbol": "line-ns-open", "size": 26, "color": p.text, "line": {"width": 3, "color": p.text}},
    )  # fmt: skip
    top = float(np.nanmax(np.abs(shares), initial=0.0)) or 1.0
    positive = np.maximum(shares, 0).sum(axis=0)
    for name, value, edge in zip(names, total, positive, strict=True):
        fig.add_annotation(
            x=max(edge, 0.0), y=name, text=_signed(value), showarrow=False, xanchor="left", xshift=8,
            font={"size": 12.5, "color": p.text},
        )  # fmt: skip
    low = float(np.minimum(shares, 0).sum(axis=0).min(initial=0.0))
    fig.update_layout(
        xaxis=axis(
            unit, dark=dark, range=[1.12 * low - 0.02 * top, 1.10 * float(positive.max(initial=0.1)) + 0.05 * top]
        ),
        yaxis=axis("", dark=dark, autorange="reversed", ticks="", showline=False) | {"title": None},
    )
    fig.add_vline(x=0, line={"color": p.line, "width": 1})
    return fig


def _amount(value: float, top: float) -> str:
    """Two digits beside the largest; what is a thousandth of it or less is none."""
    return f"{value:.3g}".replace("-", "−") if abs(value) > 1e-3 * top else "0"


def _signed(value: float) -> str:
    text = f"{value:+.3f}"
    return (text[1:] if float(text) == 0 else text).replace("-", "−")


def gain_bars(
    groups: Sequence[tuple[str, FloatArray, str]], joints: Sequence[int], *, dark: bool, height: int = 250
) -> go.Figure:
    """What a stiffer joint buys: one group of bars a place (title, gain (n,), unit), one bar a joint."""
    p = palette(dark)
    colours = joint_colours(7, dark)
    fig = figure(dark=dark, height=height, revision="gains", bargap=0.3, showlegend=False,
                 margin={"l": 8, "r": 8, "t": 34, "b": 8})  # fmt: skip
    count = len(groups)
    names = [f"joint {j}" for j in joints]
    gap = 0.07
    for g, (title, gain, unit) in enumerate(groups):
        suffix = "" if g == 0 else str(g + 1)
        width = (1 - gap * (count - 1)) / count
        start = g * (width + gap)
        top = float(np.nanmax(gain, initial=0.0)) or 1.0
        fig.add_trace(go.Bar(
            y=names, x=gain, orientation="h", xaxis=f"x{suffix}", yaxis=f"y{suffix}",
            marker={"color": [colours[j % 7] for j in range(len(joints))]},
            text=[_amount(v, top) for v in gain], textposition="outside", cliponaxis=False,
            textfont={"color": p.text, "size": 12.5}, hovertemplate=f"%{{y}}: %{{x:.4g}} {unit}<extra></extra>",
        ))  # fmt: skip
        low = float(np.nanmin(gain, initial=0.0))
        fig.update_layout(
            {
                f"xaxis{suffix}": axis(
                    unit,
                    dark=dark,
                    nticks=4,
                    domain=[start, min(start + width, 1.0)],
                    anchor=f"y{suffix}",
                    range=[1.3 * low if low < 0 else 0.0, 1.28 * top],
                ),
                f"yaxis{suffix}": axis(
                    "", dark=dark, autorange="reversed", anchor=f"x{suffix}", ticks="", showticklabels=g == 0
                )
                | {"title": None},
            }
        )
        fig.add_annotation(x=start, y=1.0, xref="paper", yref="paper", xanchor="left", yanchor="bottom", yshift=8,
                           text=f"<b>{title}</b>", showarrow=False, font={"size": 13, "color": p.text})  # fmt: skip
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
    panels: Sequence[LinePanel], joints: Sequence[int], s_titles: Sequence[str], unit: str, *, dark: bool,
    height: int = 480, columns: int = 3,
) -> go.Figure:  # fmt: skip
    """Deviation along straight lines, total and by joint, all panels on one vertical scale."""
    p = palette(dark)
    colours = joint_colours(7, dark)
    rows = -(-len(panels) // columns)
    fig = figure(dark=dark, height=height, revision="lines", hovermode="x unified",
                 margin={"l": 8, "r": 8, "t": 58, "b": 8}, legend_y=1.07)  # fmt: skip
    width, tall = (1 - 0.05 * (columns - 1)) / columns, (1 - 0.2 * (rows - 1)) / rows
    low, high = _span(panels)
    for index, panel in enumerate(panels):
        r, c = divmod(index, columns)
        suffix = "" if index == 0 else str(index + 1)
        where = {"xaxis": f"x{suffix}", "yaxis": f"y{suffix}", "showlegend": index == 0}
        for j, number in enumerate(joints):
            fig.add_trace(go.Scatter(
                x=panel.s, y=panel.by_joint[:, j], name=f"joint {number}", legendgroup=f"{number}", mode="lines",
                line={"color": colours[j % 7], "width": 1.6}, hovertemplate="%{y:+.4f} " + unit, **where,
            ))  # fmt: skip
        if panel.old is not None:
            fig.add_trace(go.Scatter(
                x=panel.s, y=panel.old, name="total before", legendgroup="before", mode="lines",
                line={"color": p.muted, "width": 2, "dash": "dot"}, hovertemplate="%{y:+.4f} " + unit, **where,
            ))  # fmt: skip
        fig.add_trace(go.Scatter(
            x=panel.s, y=panel.total, name="total", legendgroup="total", mode="lines",
            line={"color": p.text, "width": 2.6}, hovertemplate="%{y:+.4f} " + unit, **where,
        ))  # fmt: skip
        x0, y1 = c * (width + 0.05), 1 - r * (tall + 0.2)
        fig.update_layout({
            f"xaxis{suffix}": axis(s_titles[index], dark=dark, nticks=4, domain=[x0, min(x0 + width, 1.0)],
                                   anchor=f"y{suffix}"),
            f"yaxis{suffix}": axis(f"deviation, {unit}" if c == 0 else "", dark=dark, range=[low, high], nticks=5,
                                   domain=[max(y1 - tall, 0.0), y1], anchor=f"x{suffix}", showticklabels=c == 0),
        })  # fmt: skip
        fig.add_annotation(x=x0, y=y1, xref="paper", yref="paper", xanchor="left", yanchor="bottom", yshift=3,
                           text=panel.title, showarrow=False, font={"size": 13, "color": p.text})  # fmt: skip
    return fig


def _span(panels: Sequence[LinePanel]) -> tuple[float, float]:
    every = np.concatenate(
        [np.concatenate([q.total, q.by_joint.ravel(), q.old if q.old is not None else []]) for q in panels]
    )
    if not np.isfinite(every).any():
        return 0.0, 1.0
    low, high = min(float(np.nanmin(every)), 0.0), max(float(np.nanmax(every)), 0.0)
    room = 0.07 * (high - low) or 1.0
    return low - (room if low < 0 else 0.3 * room), high + room
