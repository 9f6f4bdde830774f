"""The groove's cross-section as an engineering drawing: material hatched, the ideal dashed, dimension lines."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import plotly.graph_objects as go

from robomill.arrays import FloatArray
from robomill.units import format_value
from robomill.viz.theme import axis, figure, palette, rgba


@dataclass(frozen=True, eq=False)
class SectionDrawing:
    """A section across the cut, everything in ``unit`` (mm or in).

    u, u_ideal (k,): across the cut, + to the left of the feed, 0 on the commanded centre line; machined, ideal (k,):
    heights in {W} there. The dimensions are the measured ones, not read off the drawing; NaN where there is no groove.
    """

    u: FloatArray
    machined: FloatArray
    u_ideal: FloatArray
    ideal: FloatArray
    wall_left: float
    wall_right: float
    width: float
    depth: float
    centre_offset: float
    floor_error: float
    top: float
    floor: float
    unit: str = "mm"


def section_figure(drawing: SectionDrawing, *, dark: bool, height: int = 400, revision: str = "section") -> go.Figure:
    """The drawing, to one scale in both directions; the reader looks along the feed, left is left."""
    p = palette(dark)
    d = drawing
    fig = figure(dark=dark, height=height, revision=revision, margin={"l": 8, "r": 8, "t": 30, "b": 8})
    good = np.isfinite(d.machined)
    u, z = d.u[good], d.machined[good]
    if len(u) == 0:
        return fig
    step = max(d.depth, 0.12 * d.width, 1e-6) if np.isfinite(d.depth) else 1.0
    bottom = float(np.min(z)) - 0.9 * step
    fig.add_scatter(
        x=[u[0], *u, u[-1]],
        y=[bottom, *z, bottom],
        mode="none",
        fill="toself",
        name="material",
        fillcolor=rgba(p.metal, 0.30),
        hoverinfo="skip",
        fillpattern={
            "shape": "/",
            "size": 9,
            "solidity": 0.06,
            "fgcolor": p.metal_edge,
            "bgcolor": rgba(p.metal, 0.22),
        },
    )
    fig.add_scatter(
        x=u,
        y=z,
        mode="lines",
        name="machined",
        line={"color": p.text, "width": 2.6},
        hovertemplate=f"across %{{x:.3f}} {d.unit}<br>height %{{y:.3f}} {d.unit}<extra>machined</extra>",
    )
    keep = np.isfinite(d.ideal)
    fig.add_scatter(
        x=d.u_ideal[keep],
        y=d.ideal[keep],
        mode="lines",
        name="ideal",
        line={"color": p.accent, "width": 1.8, "dash": "dash"},
        hovertemplate=f"across %{{x:.3f}} {d.unit}<br>height %{{y:.3f}} {d.unit}<extra>ideal</extra>",
    )
    if np.isfinite([d.wall_left, d.wall_right, d.depth]).all():
        _dimensions(fig, d, step, dark)
    # Left of the feed is +u; looking along the feed it lies on the left, so the axis runs backwards.
    fig.update_layout(
        xaxis=axis(
            f"Across the cut, {d.unit} (+ is left of the feed)",
            dark=dark,
            showgrid=False,
            constrain="domain",
            range=[float(u[-1]), float(u[0])] if u[-1] > u[0] else [float(u[0]), float(u[-1])],
        ),
        yaxis=axis(
            f"Height z<sub>W</sub>, {d.unit}",
            dark=dark,
            scaleanchor="x",
            scaleratio=1,
            showgrid=False,
            constrain="domain",
            range=[bottom, d.top + 1.45 * step],
        ),
    )
    return fig


def _dimensions(fig: go.Figure, d: SectionDrawing, step: float, dark: bool) -> None:
    p = palette(dark)
    centre = 0.5 * (d.wall_left + d.wall_right)
    ideal_centre = centre - d.centre_offset
    over = d.top + 0.95 * step
    seen = float(np.nanmin(d.u)), float(np.nanmax(d.u))
    if min(d.wall_left, d.wall_right) < seen[0] or max(d.wall_left, d.wall_right) > seen[1]:
        _wide(fig, d, over, seen, dark)
        return
    for x in (d.wall_left, d.wall_right):
        _line(fig, x, d.top + 0.08 * step, x, over + 0.14 * step, p.muted)
    _arrow(fig, (centre, over), (d.wall_left, over), p.text)
    _arrow(fig, (centre, over), (d.wall_right, over), p.text)
    _text(fig, centre, over, f"width {format_value(d.width, d.unit, 3)}", p.text, p.background)

    beside = min(d.wall_left, d.wall_right) - 0.75 * step
    _line(fig, min(d.wall_left, d.wall_right) + 0.1 * step, d.floor, beside - 0.15 * step, d.floor, p.muted)
    middle = 0.5 * (d.top + d.floor)
    _arrow(fig, (beside, middle), (beside, d.top), p.text)
    _arrow(fig, (beside, middle), (beside, d.floor), p.text)
    _text(fig, beside, middle, f"depth {format_value(d.depth, d.unit, 3)}", p.text, p.background)

    under = d.floor - 0.42 * step
    for x, colour in ((ideal_centre, p.accent), (centre, p.warm)):
        _line(fig, x, d.floor - 0.62 * step, x, d.top + 0.45 * step, colour, "dashdot")
    side = 1.0 if d.centre_offset >= 0 else -1.0
    reach = 0.55 * step
    _arrow(fig, (centre + side * reach, under), (centre, under), p.warm)
    _arrow(fig, (ideal_centre - side * reach, under), (ideal_centre, under), p.warm)
    _text(
        fig,
        centre + side * reach,
        under,
        f"centre off {format_value(d.centre_offset, d.unit, 3, sign=True)}",
        p.warm,
        p.background,
        xanchor="right" if side > 0 else "left",
    )
    away = 0.5 * (max(d.wall_left, d.wall_right) + float(np.nanmax(d.u)))
    _text(
        fig,
        away,
        d.floor,
        f"floor {format_value(d.floor_error, d.unit, 3, sign=True)}",
        p.warm,
        p.background,
    )


def _wide(fig: go.Figure, d: SectionDrawing, over: float, seen: tuple[float, float], dark: bool) -> None:
    """A groove wider than the drawing: its numbers in words, a dimension line that runs out of the picture."""
    p = palette(dark)
    inside = [w for w in (d.wall_left, d.wall_right) if seen[0] <= w <= seen[1]]
    ends = [*inside, *[seen[0] if w < seen[0] else seen[1] for w in (d.wall_left, d.wall_right) if w not in inside]]
    middle = 0.5 * (min(ends) + max(ends))
    for wall in inside:
        _line(fig, wall, d.top, wall, over, p.muted)
        _arrow(fig, (middle, over), (wall, over), p.text)
    for end in ends[len(inside) :]:
        _line(fig, middle, over, end, over, p.text)
    words = f"width {format_value(d.width, d.unit, 3)}, depth {format_value(d.depth, d.unit, 3)}"
    _text(fig, middle, over, words, p.text, p.background)
    off = f"centre off {format_value(d.centre_offset, d.unit, 3, sign=True)}"
    floor = f"floor {format_value(d.floor_error, d.unit, 3, sign=True)}"
    _text(fig, middle, d.floor - 0.4 * (over - d.top), f"{off}, {floor}", p.warm, p.background)


def _line(fig: go.Figure, x0: float, y0: float, x1: float, y1: float, colour: str, dash: str = "solid") -> None:
    fig.add_shape(type="line", x0=x0, y0=y0, x1=x1, y1=y1, line={"color": colour, "width": 1, "dash": dash})


def _arrow(fig: go.Figure, tail: tuple[float, float], head: tuple[float, float], colour: str) -> None:
    fig.add_annotation(
        x=head[0],
        y=head[1],
        ax=tail[0],
        ay=tail[1],
        xref="x",
        yref="y",
        axref="x",
        ayref="y",
        text="",
        showarrow=True,
        arrowhead=3,
        arrowsize=1.1,
        arrowwidth=1.2,
        arrowcolor=colour,
        standoff=0,
    )


def _text(fig: go.Figure, x: float, y: float, text: str, colour: str, background: str, xanchor: str = "center") -> None:
    fig.add_annotation(
        x=x,
        y=y,
        text=text,
        showarrow=False,
        xanchor=xanchor,
        yanchor="middle",
        borderpad=3,
        font={"size": 13, "color": colour},
        bgcolor=rgba(background, 0.88),
    )
