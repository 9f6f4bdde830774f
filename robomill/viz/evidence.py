"""What was claimed, what was measured and what is computed here, on one scale."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from robomill.units import format_value
from robomill.viz.chart import Chart
from robomill.viz.theme import axis, figure, palette, say

COLOURS = {
    "paper": "#2F7FD0",
    "measured": "#0E9A72",
    "assumed": "#CE8A00",
    "user": "#9A66D0",
    "computed": "#7B8A94",
}


@dataclass(frozen=True)
class Claim:
    """One number: where it comes from (``kind`` is a provenance), its value and perhaps its range, in one unit.

    A ``rough`` one is said to be "about" its value.
    """

    label: str
    kind: str
    value: float
    low: float = float("nan")
    high: float = float("nan")
    note: str = ""
    rough: bool = False


def evidence_figure(claims: Sequence[Claim], unit: str, *, dark: bool) -> Chart:
    """Each claim a row: a dot with its number, a bar for its range."""
    rows = len(claims)
    margin = {"l": 12, "r": 24, "t": 8, "b": 8}
    fig = figure(dark=dark, height=70 + 46 * rows, revision="evidence", margin=margin)
    measured = [c.value for c in claims if c.kind == "measured" and np.isfinite(c.value)]
    for value in measured[:1]:
        fig.upright(x=value, line={"color": COLOURS["measured"], "width": 1.2, "dash": "dash"})
    for i, claim in enumerate(claims):
        _row(fig, claim, rows - 1 - i, unit, dark)
    top = max([*(v for c in claims for v in (c.value, c.low, c.high) if np.isfinite(v)), 1e-9])
    fig.lay_out(
        showlegend=False,
        xaxis=axis(f"Sideways error of the groove, {unit}", dark=dark, range=[0.0, 1.12 * top], rangemode="tozero"),
        yaxis={"range": [-0.45, rows - 0.25], "visible": False},
    )
    return fig


def _row(fig: Chart, claim: Claim, y: int, unit: str, dark: bool) -> None:
    p = palette(dark)
    colour = COLOURS.get(claim.kind, p.muted)
    value = format_value(claim.value, unit)
    said = value if claim.kind == "computed" else format_value(claim.value, unit, 2)
    text = f"<b>{'about ' * claim.rough}{said}</b>"
    if np.isfinite(claim.low) and np.isfinite(claim.high):
        ends = [format_value(v, unit, 2, with_unit=False) for v in (claim.low, claim.high)]
        text += f"  ({ends[0]} to {ends[1]})"
        hover = f"{format_value(claim.low, unit)} to {format_value(claim.high, unit)}<extra></extra>"
        bar = {"color": colour, "width": 9}
        fig.lines([claim.low, claim.high], [y, y], bar, opacity=0.35, hovertemplate=hover)
    fig.lines([0.0, claim.value], [y, y], {"color": colour, "width": 1.5}, opacity=0.5, hoverinfo="skip")
    symbol = "diamond" if claim.kind == "measured" else "circle"
    mark = {"size": 13, "color": colour, "line": {"width": 1.5, "color": p.background}, "symbol": symbol}
    hover = f"{claim.label}: {value}<br>{claim.kind}. {claim.note}<extra></extra>"
    fig.dots([claim.value], [y], mark, cliponaxis=False, hovertemplate=hover)
    # Above its mark, not beside it: a telephone has no room for both.
    say(fig, f"{text}  {claim.label}", 0, y, p.text, size=13, xref="paper", xanchor="left", yshift=14)
