"""Figures of an identification: intervals beside reference values, correlations, residuals by test, models, plans.

Arrays come in display units; nothing here converts. Joints keep their colours, words stand beside them.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from robomill.arrays import BoolArray, FloatArray, IntArray
from robomill.units import format_number
from robomill.viz.chart import QUIET, Chart
from robomill.viz.theme import (
    axis,
    axis_colours,
    colour_bar,
    diverging,
    figure,
    joint_colours,
    palette,
    rgba,
    say,
    words_on,
)

MAX_TESTS = 3000
REFERENCE_SYMBOLS = ("diamond-open", "square-open", "triangle-up-open", "circle-open")
MARGIN = {"l": 8, "r": 16, "t": 34, "b": 8}
ROW = "Row of the file"
_ROW = 46


@dataclass(frozen=True, eq=False)
class Intervals:
    """Values (p,) with intervals low, high (p,) and their words; a NaN value is not known, its words say why.

    references: name -> (p,), drawn as open symbols; ``truth`` (p,) as crosses; ``logarithmic`` for positive values.
    """

    labels: tuple[str, ...]
    value: FloatArray
    low: FloatArray
    high: FloatArray
    words: tuple[str, ...]
    unit: str
    references: Mapping[str, FloatArray] = field(default_factory=dict)
    truth: FloatArray | None = None
    logarithmic: bool = True


def intervals_figure(shown: Intervals, *, dark: bool) -> Chart:
    """Each parameter as a point on its 95 % interval, the numbers written at the right."""
    low, high = _clipped(shown)
    compared = bool(shown.references) or shown.truth is not None
    top, y = 34 if compared else 8, np.arange(len(shown.labels))
    fig = figure(
        dark=dark,
        height=50 + top + _ROW * len(y),
        revision=f"intervals-{shown.unit}",
        margin={"l": 8, "r": 156, "t": top, "b": 8},
        showlegend=compared,
    )
    _fitted(fig, shown, low, high, dark)
    _compared(fig, shown, _start(shown, low, high), dark)
    more = _log_axis(shown, low, high) if shown.logarithmic else {}
    fig.lay_out(
        xaxis=axis(shown.unit, dark=dark, **more),
        yaxis=_names(shown.labels, dark),
    )
    return fig


def _fitted(fig: Chart, shown: Intervals, low: FloatArray, high: FloatArray, dark: bool) -> None:
    """Bars, points and numbers; words instead where a value is not known."""
    p, colours = palette(dark), joint_colours(7, dark)
    y, known = np.arange(len(shown.labels)), np.isfinite(shown.value)
    for k in y:
        if known[k]:
            line = {"color": rgba(colours[k % 7], 0.42), "width": 11}
            fig.lines([low[k], high[k]], [k, k], line, **QUIET)
            place = {"xshift": 8, "align": "left"}
            say(fig, shown.words[k], 1.0, float(k), p.text, size=12.5, xref="paper", xanchor="left", **place)
        else:
            say(fig, shown.words[k], 0.02, float(k), p.muted, size=12.5, xref="paper", xanchor="left")
    left = known & (shown.value < low)  # a logarithmic axis has no zero: an arrow to the left says where it is
    drawn = known & ~left
    dots = {"size": 10, "color": [colours[k % 7] for k in y[drawn]], "line": {"color": p.background, "width": 1.5}}
    hover = {"text": [shown.words[k] for k in y[drawn]], "hovertemplate": "%{text}<extra></extra>"}
    fig.dots(shown.value[drawn], y[drawn], dots, name="fitted, with its 95 % interval", **hover)
    _left_of_axis(fig, shown.value[left], y[left], _start(shown, low, high), [colours[k % 7] for k in y[left]])
    for k in y[left]:
        words = f"{format_number(shown.value[k], 2)} lies left of this axis"
        say(fig, words, 0.012, k + 0.36, p.muted, size=11.5, xref="paper", xanchor="left")


def _left_of_axis(fig: Chart, values: FloatArray, y: Any, start: float, colours: Any) -> None:
    """Arrows at the left end of the axis for values that lie left of it."""
    if not len(values):
        return
    marker = {"size": 12, "symbol": "triangle-left", "color": colours}
    hover = {
        "text": [format_number(v, 2) for v in values],
        "hovertemplate": "%{text}, left of this axis<extra></extra>",
    }
    fig.dots(np.full(len(values), start), y, marker, showlegend=False, cliponaxis=False, **hover)


def _compared(fig: Chart, shown: Intervals, start: float, dark: bool) -> None:
    """Reference sets as open symbols above their rows, the truth as crosses; arrows at ``start`` where they lie left of
    a logarithmic axis."""
    colour, y = palette(dark).text, np.arange(len(shown.labels))
    if shown.logarithmic:
        for k, values in enumerate([*shown.references.values(), *([] if shown.truth is None else [shown.truth])]):
            left = np.isfinite(values) & (values < start)
            of_truth = k == len(shown.references)
            _left_of_axis(fig, values[left], y[left] - (0.0 if of_truth else 0.3), start, colour)
    for (name, values), symbol in zip(shown.references.items(), REFERENCE_SYMBOLS, strict=False):
        marker = {"size": 9, "symbol": symbol, "color": colour, "line": {"width": 1.6}}
        hover = f"{name}: %{{x:.2f}} {shown.unit}<extra></extra>"
        fig.dots(values, y - 0.3, marker, name=name, hovertemplate=hover)
    if shown.truth is not None:
        marker = {"size": 11, "symbol": "x-thin", "line": {"width": 2.4, "color": colour}}
        hover = "truth: %{x:.2f}<extra></extra>"
        fig.dots(shown.truth, y, marker, name="truth", hovertemplate=hover)


def correlation_figure(names: Sequence[str], correlation: FloatArray, *, dark: bool) -> Chart:
    """Correlations (p, p) of the fitted parameters with their numbers; grey where one is not known."""
    p = palette(dark)
    text = [
        ["1" if i == j and np.isfinite(v) else _correlation(v) for j, v in enumerate(row)]
        for i, row in enumerate(correlation)
    ]
    written = len(names) <= 8
    fig = figure(dark=dark, height=330, revision="correlation", margin={"l": 8, "r": 8, "t": 8, "b": 8})
    fig.add(
        "heatmap",
        z=correlation,
        x=list(names),
        y=list(names),
        zmin=-1,
        zmax=1,
        colorscale=diverging(dark),
        xgap=2,
        ygap=2,
        text=text,
        showscale=not written,
        colorbar=colour_bar("correlation", dark=dark, tickvals=[-1, -0.5, 0, 0.5, 1]),
        hovertemplate="%{y} with %{x}: %{z:+.2f}<extra></extra>",
    )
    if written:
        row, column = np.nonzero(np.isfinite(correlation))
        fig.add(
            "scatter",
            x=[names[j] for j in column.tolist()],
            y=[names[i] for i in row.tolist()],
            mode="text",
            text=[text[i][j] for i, j in zip(row, column, strict=True)],
            textfont={"size": 12, "color": words_on(diverging(dark), 0.5 + 0.5 * correlation[row, column])},
            hoverinfo="skip",
            showlegend=False,
        )
    fig.lay_out(
        plot_bgcolor=rgba(p.muted, 0.10),
        xaxis=axis("", dark=dark, showgrid=False, ticks="", showline=False),
        yaxis=axis("", dark=dark, showgrid=False, ticks="", showline=False, autorange="reversed"),
    )
    return fig


def residuals_figure(
    row: IntArray, residual: FloatArray, outlier: BoolArray, unit: str, names: Sequence[str], *, dark: bool
) -> Chart:
    """Residuals (m, k) of each test against its row (m,); ``outlier`` (m,) are ringed and named.

    k components of those ``names``, or one. At most ``MAX_TESTS`` tests are drawn, outliers among them.
    """
    chosen = np.arange(len(row))
    if len(row) > MAX_TESTS:
        spread = np.linspace(0, len(row) - 1, MAX_TESTS).astype(int)
        chosen = np.unique(np.concatenate([spread, np.flatnonzero(outlier)[:MAX_TESTS]]))
    several = residual.shape[1] > 1
    colours = list(axis_colours(dark).values()) if several else [palette(dark).accent]
    fig = figure(dark=dark, height=330, revision=f"residuals-{unit}", margin=MARGIN)
    for k, (colour, symbol) in enumerate(zip(colours, ("circle", "square", "diamond"), strict=False)):
        if several and not np.isfinite(residual[:, k]).any():
            continue
        marker = {"size": 6, "color": colour, "symbol": symbol, "opacity": 0.85}
        _by_row(fig, row[chosen], residual[chosen, k], names[k] if several else "residual", f"+.4f}} {unit}", marker)
    fig.across(y=0, line={"color": palette(dark).line, "width": 1})
    marked = np.flatnonzero(outlier)
    if len(marked):
        worst = np.nanargmax(np.where(np.isnan(residual[marked]), -1, np.abs(residual[marked])), axis=1)
        _ring(fig, row[marked], residual[marked, worst], "does not fit", dark)
    fig.lay_out(xaxis=axis(ROW, dark=dark), yaxis=axis(f"Measured − predicted, {unit}", dark=dark))
    return fig


def gaps_figure(
    row: IntArray, gap: FloatArray, stated: FloatArray | None, suspect: BoolArray, unit: str, *, dark: bool
) -> Chart:
    """How far the line of pull of each row (m,) passes its pulley, with the load point found and with the stated one.

    ``stated`` None: the stated load point is the one in use; ``suspect`` (m,) are ringed and named.
    """
    p = palette(dark)
    fig = figure(dark=dark, height=250, revision=f"gaps-{unit}", margin=MARGIN)
    if stated is not None:
        marker = {"size": 7, "color": p.muted, "symbol": "circle-open"}
        _by_row(fig, row, stated, "with the stated load point", f".1f}} {unit}", marker)
    name = "with the load point that fits best" if stated is not None else "with the stated load point"
    _by_row(fig, row, gap, name, f".1f}} {unit}", {"size": 7, "color": p.accent, "symbol": "circle"})
    if suspect.any():
        _ring(fig, row[suspect], gap[suspect], "cannot be", dark)
    fig.lay_out(xaxis=axis(ROW, dark=dark), yaxis=axis(f"Gap, {unit}", dark=dark, rangemode="tozero"))
    return fig


def _by_row(fig: Chart, row: IntArray, y: FloatArray, name: str, shown: str, marker: dict[str, Any]) -> None:
    """One value a row of the file; ``shown`` ends the template of what is read off it."""
    hover = f"row %{{x}}<br>%{{y:{shown}<extra>{name}</extra>"
    fig.dots(row, y, marker, name=name, hovertemplate=hover)


def _ring(fig: Chart, row: IntArray, y: FloatArray, name: str, dark: bool) -> None:
    """Rings around rows that stand out, each named where they are few."""
    bad = palette(dark).bad
    ring = {"size": 15, "symbol": "circle-open", "color": bad, "line": {"width": 2}}
    fig.dots(row, y, ring, name=name, hoverinfo="skip", cliponaxis=False)
    if len(row) <= 12:
        words = {"text": [f"row {r}" for r in row], "textposition": "top center"}
        fig.traces[-1].update(words, mode="markers+text", textfont={"size": 12, "color": bad})


def models_figure(
    names: Sequence[str], in_sample: FloatArray, left_out: FloatArray, chosen: int, *, dark: bool
) -> Chart:
    """Errors in % of each model on its own data and on poses left out; the gap between the two is the over-fitting."""
    p = palette(dark)
    y = np.arange(len(names))
    fig = figure(dark=dark, height=84 + _ROW * len(names), revision="models", margin={"l": 8, "r": 96, "t": 34, "b": 8})
    for k in y:
        fig.lines([in_sample[k], left_out[k]], [k, k], {"color": rgba(p.warm, 0.55), "width": 6}, **QUIET)
        say(fig, f"{left_out[k]:.2f} %", 1.0, float(k), p.text, size=13, xref="paper", xshift=8, xanchor="left")
    for values, name, marker in (
        (in_sample, "on its own data", {"size": 10, "symbol": "circle-open", "color": p.muted, "line": {"width": 2}}),
        (left_out, "on unseen poses", {"size": 11, "color": p.accent}),
    ):
        fig.dots(values, y, marker, name=name, hovertemplate="%{x:.2f} %<extra></extra>")
    values = np.concatenate([in_sample, left_out])
    values = values[np.isfinite(values) & (values > 0)]
    ends = (values.min() / 1.6, values.max() * 1.6) if len(values) else (0.1, 100.0)
    labels = [f"<b>{name}</b>" if k == chosen else name for k, name in enumerate(names)]
    fig.lay_out(
        xaxis=axis("Error, % of the measured displacement", dark=dark, **_logarithmic(*ends)),
        yaxis=_names(labels, dark),
    )
    return fig


def gain_figure(names: Sequence[str], before: FloatArray, after: FloatArray, *, dark: bool) -> Chart:
    """Half widths of the 95 % intervals in % of the value, as they are and as the planned tests should make them."""
    p = palette(dark)
    top = float(np.max(before[np.isfinite(before)], initial=float(np.max(after[np.isfinite(after)], initial=1.0))))
    shown = np.where(np.isfinite(before), before, 1.15 * top)
    fig = figure(
        dark=dark,
        height=84 + 42 * len(names),
        revision="gain",
        barmode="group",
        bargap=0.34,
        bargroupgap=0.06,
        margin={"l": 8, "r": 64, "t": 34, "b": 8},
    )
    words = [f"± {v:.2g} %" if np.isfinite(v) else "not seen" for v in before]
    for name, values, text, colour in (
        ("now", shown, words, rgba(p.muted, 0.55)),
        ("after these tests", after, [f"± {v:.2g} %" for v in after], p.accent),
    ):
        fig.add(
            "bar",
            y=list(names),
            x=values,
            name=name,
            orientation="h",
            marker={"color": colour},
            text=text,
            textposition="outside",
            constraintext="none",
            textfont={"size": 12, "color": p.text},
            cliponaxis=False,
            hovertemplate="%{y}: %{text}<extra>" + name + "</extra>",
        )
    fig.lay_out(
        xaxis=axis("Half the 95 % interval, % of the value", dark=dark, rangemode="tozero"),
        yaxis=axis("", dark=dark, autorange="reversed", showgrid=False, ticks=""),
    )
    return fig


def _correlation(value: float) -> str:
    """A correlation as it is written in its cell."""
    if np.isnan(value):
        return ""
    return format_number(value, 2, sign=True) if abs(value) >= 0.005 else "0"


def _clipped(shown: Intervals) -> tuple[FloatArray, FloatArray]:
    """The ends that can be drawn: on a logarithmic axis nothing at or below zero, and nothing infinite."""
    low, high = shown.low.copy(), shown.high.copy()
    if shown.logarithmic:
        sizes = [shown.value, *shown.references.values()]
        flat = np.concatenate([v[np.isfinite(v) & (v > 0)] for v in sizes])
        bottom, top = (float(flat.min()), float(flat.max())) if len(flat) else (1.0, 10.0)
        # A spring that is all but rigid must not stretch the axis by decades.
        floor = max(bottom / 4, top / 120)
        low, high = np.maximum(low, floor), np.maximum(np.where(np.isfinite(high), high, top * 2), floor)
    return low, high


def _start(shown: Intervals, low: FloatArray, high: FloatArray) -> float:
    """Where the axis begins, if it is logarithmic."""
    ends = _log_axis(shown, low, high)["range"]
    return float(10.0 ** ends[0])  # type: ignore[index]


def _log_axis(shown: Intervals, low: FloatArray, high: FloatArray) -> dict[str, object]:
    known = np.isfinite(shown.value)
    more = [v[np.isfinite(v) & (v > 0)] for v in shown.references.values()]
    ends = np.concatenate([low[known], high[known], shown.value[known & (shown.value > 0)], *more])
    ends = ends[np.isfinite(ends) & (ends > 0)]
    bottom, top = (float(ends.min()), float(ends.max())) if len(ends) else (1.0, 10.0)
    return _logarithmic(bottom / 1.25, top * 1.25)


def _names(labels: Sequence[str], dark: bool) -> dict[str, Any]:
    """The axis of figures that have a row for each name, first above."""
    ticks = {"tickvals": list(range(len(labels))), "ticktext": list(labels), "ticks": ""}
    return axis("", dark=dark, range=[len(labels) - 0.4, -0.62], showgrid=False, **ticks)


def _logarithmic(low: float, high: float) -> dict[str, object]:
    ticks = _ticks(low, high)
    ends = [float(np.log10(low)), float(np.log10(high))]
    return {"type": "log", "range": ends, "tickvals": ticks, "ticktext": [f"{t:g}" for t in ticks]}


def _ticks(low: float, high: float) -> list[float]:
    """1, 2, 5 and their tens between two positive numbers."""
    decades = range(int(np.floor(np.log10(low))), int(np.ceil(np.log10(high))) + 1)
    return [m * 10.0**d for d in decades for m in (1, 2, 5) if low <= m * 10.0**d <= high]
