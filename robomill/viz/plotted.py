"""A plane chart as a PNG, drawn by matplotlib: a picture for files and reports, where no browser draws it.

Read here is what the charts hold that are written to files: scatter traces, shapes that are lines, annotations. What is
of the mouse is left out.
"""

import html
import io
import re
import warnings
from collections.abc import Sequence
from typing import Any

import numpy as np

from robomill.extras import needed
from robomill.viz.chart import Chart, Trace
from robomill.viz.theme import palette

WIDTH, LEFT, RIGHT, UNDER, ROW = 960, 84, 20, 60, 24  # px: the picture, around its axes, a row of words over them
DPI, DOT = 150, 1.5  # dots an inch, and dots of a px: a px is 1/100 inch
POINTS = 0.72  # of a px
DASHES = {"solid": "-", "dash": (0, (5, 3)), "dot": (0, (1, 2)), "dashdot": (0, (6, 3, 1, 3))}
_RGBA = re.compile(r"rgba\((\d+),(\d+),(\d+),([\d.]+)\)")
_LOW = re.compile(r"<sub>(.*?)</sub>")


def png(chart: Chart, captions: Sequence[str] = ()) -> bytes:
    """The chart with ``captions`` above it. Raises MissingExtraError without matplotlib."""
    with needed("A picture as PNG"):
        from matplotlib import figure

    named = [trace["name"] for trace in chart.traces if trace.get("name") and trace.get("showlegend", True)]
    over, inner = 12 + ROW * (len(captions) + bool(named)), int(chart.layout["height"])
    height = over + inner + UNDER
    fig = figure.Figure(figsize=(WIDTH / 100, height / 100), dpi=DPI, facecolor="white")
    box = (LEFT / WIDTH, UNDER / height, (WIDTH - LEFT - RIGHT) / WIDTH, inner / height)
    ax = fig.add_axes(box)
    for order, trace in enumerate(chart.traces):
        _draw(ax, trace, order + 2)
    _lay_out(ax, chart)
    for shape in chart.layout.get("shapes", []):
        _shape(ax, shape)
    for said in chart.layout.get("annotations", []):
        _annotation(ax, said)
    for row, words in enumerate(captions):
        place = (LEFT / WIDTH, 1.0 - (8 + ROW * row) / height)
        fig.text(*place, _words(words), fontsize=(15 - 3 * bool(row)) * POINTS, va="top", color=palette(False).text)
    if named:
        ax.legend(loc="lower left", bbox_to_anchor=(-0.01, 1.0), ncols=len(named), frameon=False, fontsize=12 * POINTS)
    file = io.BytesIO()
    with warnings.catch_warnings():  # a letter that matplotlib's font lacks is a box in the picture, no word on stderr
        warnings.filterwarnings("ignore", "Glyph .* missing", UserWarning)
        fig.savefig(file, format="png", dpi=DPI, metadata={"Software": "robomill"})
    return file.getvalue()


def _draw(ax: Any, trace: Trace, order: int) -> None:
    """A line, which ends where a value is missing, or an area."""
    if trace["type"] != "scatter" or "markers" in trace.get("mode", "lines"):
        raise ValueError(f"a trace {trace['type']!r} ({trace.get('mode')}) is not drawn as PNG")
    x, y = (np.asarray(trace[name], dtype=float) for name in "xy")
    name = _words(trace["name"]) if trace.get("name") and trace.get("showlegend", True) else "_"
    if trace.get("fill") == "tozeroy":
        ax.fill_between(x, y, color=_colour(trace["fillcolor"]), linewidth=0, zorder=order)
    elif trace.get("fill"):
        hatch = {"hatch": "//", "edgecolor": palette(False).metal_edge} if "fillpattern" in trace else {}
        ax.fill(x, y, facecolor=_colour(trace["fillcolor"]), linewidth=0, zorder=order, **hatch)
    if trace.get("mode") != "none":
        ax.plot(x, y, label=name, zorder=order, solid_joinstyle="round", **_stroke(trace["line"]))


def _lay_out(ax: Any, chart: Chart) -> None:
    """Axes with their ranges, grids and titles; one scale for both where they are tied."""
    p, layout = palette(False), chart.layout
    ax.margins(x=0.0, y=0.08)
    levels = [shape["y0"] for shape in layout.get("shapes", []) if shape.get("yref") == "y"]
    ax.update_datalim([(ax.dataLim.x0, level) for level in levels])
    ax.autoscale_view()
    ax.set_xlim(layout["xaxis"].get("range"))
    ax.set_ylim(layout["yaxis"].get("range"))
    if "scaleanchor" in layout["yaxis"]:
        _share_scale(ax)
    for name, said in (("x", layout["xaxis"]), ("y", layout["yaxis"])):
        if said.get("showgrid", True):
            ax.grid(axis=name, color=p.grid)
        getattr(ax, f"set_{name}label")(_words(said["title"]["text"]), fontsize=13 * POINTS, color=p.muted)
    ax.set_axisbelow(True)
    ax.tick_params(labelsize=12 * POINTS, colors=p.muted, color=p.line)
    for side, spine in ax.spines.items():
        spine.set_visible(side in ("left", "bottom"))
        spine.set_color(p.line)


def _share_scale(ax: Any) -> None:
    """Both axes to one scale: the one with room to spare shows more, to both sides."""
    box = ax.get_window_extent()
    ends = ax.get_xlim(), ax.get_ylim()
    per_dot = [abs(high - low) / size for (low, high), size in zip(ends, (box.width, box.height), strict=True)]
    for (low, high), each, put in zip(ends, per_dot, (ax.set_xlim, ax.set_ylim), strict=True):
        middle, half = 0.5 * (low + high), 0.5 * (high - low) * max(per_dot) / each
        put(middle - half, middle + half)


def _shape(ax: Any, shape: dict[str, Any]) -> None:
    """A line between two points, each of their coordinates said in its own way."""
    ends = np.array([[_place(ax, shape, name, k) for k in "01"] for name in "xy"])
    line = ax.plot(*ends, transform=None, scalex=False, scaley=False, zorder=30, **_stroke(shape["line"]))
    line[0].set_clip_on(all(shape.get(f"{name}sizemode") != "pixel" for name in "xy"))


def _place(ax: Any, shape: dict[str, Any], name: str, k: str) -> float:
    """Dots from the corner of the picture: of a value on the axis, so many px beside one, or a share of the axis."""
    value, axis = shape[f"{name}{k}"], "xy".index(name)
    if shape.get(f"{name}sizemode") == "pixel":
        return _dots(ax, axis, shape[f"{name}anchor"]) + DOT * value
    if shape.get(f"{name}ref", name) != name:
        return float(ax.transAxes.transform((value, value))[axis])
    return _dots(ax, axis, value)


def _dots(ax: Any, axis: int, value: float) -> float:
    return float(ax.transData.transform((value, value))[axis])


def _annotation(ax: Any, said: dict[str, Any]) -> None:
    """Words, or an arrow."""
    at = []
    for axis, name in enumerate("xy"):
        paper = said.get(f"{name}ref", name) == "paper"
        here = float(ax.transAxes.transform((said[name],) * 2)[axis]) if paper else _dots(ax, axis, said[name])
        at.append(here + DOT * said.get(f"{name}shift", 0))
    if said.get("showarrow", True):
        tail = at[0] + DOT * said["ax"], at[1] - DOT * said["ay"]
        drawn = {"arrowstyle": "-|>", "color": said["arrowcolor"], "shrinkA": 0, "shrinkB": 0, "linewidth": 0.9}
        ax.annotate("", at, tail, "figure pixels", "figure pixels", arrowprops=drawn, zorder=31, annotation_clip=False)
        return
    upright = {"middle": "center", "top": "top", "bottom": "bottom"}[said.get("yanchor", "middle")]
    behind = {"boxstyle": "square,pad=0.15", "facecolor": "white", "edgecolor": "none", "alpha": 0.85}
    style = {"ha": said.get("xanchor", "center"), "va": upright, "bbox": behind if "bgcolor" in said else None}
    font = said["font"]
    words = _words(said["text"])
    ax.text(*at, words, transform=None, fontsize=font["size"] * POINTS, color=font["color"], zorder=32, **style)


def _stroke(line: dict[str, Any]) -> dict[str, Any]:
    return {
        "color": _colour(line.get("color", "#000000")),
        "linewidth": POINTS * line.get("width", 2),
        "linestyle": DASHES[line.get("dash", "solid")],
    }


def _colour(text: str) -> Any:
    """As matplotlib reads it: shares of one, the last of them opacity."""
    found = _RGBA.fullmatch(text)
    return text if found is None else (*(int(found[k]) / 255 for k in (1, 2, 3)), float(found[4]))


def _words(text: str) -> str:
    """Plotly's markup (``<sub>``, ``&lt;``) as matplotlib's."""
    return html.unescape(_LOW.sub(r"$_{\1}$", text.replace("$", r"\$")))
