"""The groove's cross-section as an engineering drawing: material hatched, the ideal dashed, dimension lines."""

from dataclasses import dataclass
from typing import Any

import numpy as np

from robomill.arrays import FloatArray
from robomill.units import format_value
from robomill.viz.chart import Chart
from robomill.viz.theme import Point, arrow, axis, figure, palette, rgba, say

HEAD = {"arrowhead": 3, "arrowsize": 1.1}


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


def section_figure(drawing: SectionDrawing, *, dark: bool) -> Chart:
    """The drawing, to one scale in both directions; the reader looks along the feed, left is left."""
    p, d = palette(dark), drawing
    fig = figure(dark=dark, height=320, revision="section", margin={"l": 8, "r": 8, "t": 30, "b": 8})
    good = np.isfinite(d.machined)
    u, z = d.u[good], d.machined[good]
    if len(u) == 0:
        return fig
    step = max(d.depth, 0.12 * d.width, 1e-6) if np.isfinite(d.depth) else 1.0
    bottom = float(np.min(z)) - 0.9 * step
    hatched = {"shape": "/", "size": 9, "solidity": 0.06, "fgcolor": p.metal_edge, "bgcolor": rgba(p.metal, 0.22)}
    fill = rgba(p.metal, 0.30)
    fig.area([u[0], *u, u[-1]], [bottom, *z, bottom], fill, name="material", fillpattern=hatched)
    keep = np.isfinite(d.ideal)
    for x, y, name, line in (
        (u, z, "machined", {"color": p.text, "width": 2.6}),
        (d.u_ideal[keep], d.ideal[keep], "ideal", {"color": p.accent, "width": 1.8, "dash": "dash"}),
    ):
        hover = f"across %{{x:.3f}} {d.unit}<br>height %{{y:.3f}} {d.unit}<extra>{name}</extra>"
        fig.lines(x, y, line, name=name, hovertemplate=hover)
    if np.isfinite([d.wall_left, d.wall_right, d.depth]).all():
        _dimensions(fig, d, step, dark)
    plain: dict[str, Any] = {"dark": dark, "showgrid": False, "constrain": "domain"}
    # Left of the feed is +u; looking along the feed it lies on the left, so the axis runs backwards.
    across = [float(u[-1]), float(u[0])] if u[-1] > u[0] else [float(u[0]), float(u[-1])]
    upwards: dict[str, Any] = {"scaleanchor": "x", "scaleratio": 1, "range": [bottom, d.top + 1.45 * step]}
    return fig.lay_out(
        xaxis=axis(f"Across the cut, {d.unit} (+ is left of the feed)", range=across, **plain),
        yaxis=axis(f"Height z<sub>W</sub>, {d.unit}", **upwards, **plain),
    )


def _dimensions(fig: Chart, d: SectionDrawing, step: float, dark: bool) -> None:
    p = palette(dark)
    walls = sorted((d.wall_left, d.wall_right))
    centre = 0.5 * (d.wall_left + d.wall_right)
    ideal_centre = centre - d.centre_offset
    over = d.top + 0.95 * step
    seen = float(np.nanmin(d.u)), float(np.nanmax(d.u))
    if walls[0] < seen[0] or walls[1] > seen[1]:
        _wide(fig, d, over, seen, dark)
        return
    for x in walls:
        _line(fig, (x, d.top + 0.08 * step), (x, over + 0.14 * step), p.muted)
        arrow(fig, (centre, over), (x, over), p.text, **HEAD)
    _text(fig, (centre, over), _width(d), p.text, dark)

    # The depth stands on the side that the words on the centre leave free, under its arrows: in a narrow window there
    # is no room beside the words on the floor.
    side, under = -1.0 if d.centre_offset < 0.0 else 1.0, d.floor - 0.42 * step
    wall, middle = walls[0] if side > 0.0 else walls[1], 0.5 * (d.top + d.floor)
    beside = wall - side * 0.75 * step
    _line(fig, (wall - side * 0.1 * step, d.floor), (beside - side * 0.15 * step, d.floor), p.muted)
    for y in (d.top, d.floor):
        arrow(fig, (beside, middle), (beside, y), p.text, **HEAD)
    _text(fig, (beside, under), _depth(d), p.text, dark)

    _text(fig, (centre, d.floor + 0.42 * step), _floor(d), p.warm, dark)
    if np.isnan(d.centre_offset):
        return
    reach = 0.55 * step
    for x, colour in ((ideal_centre, p.accent), (centre, p.warm)):
        _line(fig, (x, d.floor - 0.62 * step), (x, d.top + 0.45 * step), colour, "dashdot")
    arrow(fig, (centre + side * reach, under), (centre, under), p.warm, **HEAD)
    arrow(fig, (ideal_centre - side * reach, under), (ideal_centre, under), p.warm, **HEAD)
    _text(fig, (centre + side * reach, under), _off(d), p.warm, dark, "right" if side > 0 else "left")


def _wide(fig: Chart, d: SectionDrawing, over: float, seen: tuple[float, float], dark: bool) -> None:
    """A groove wider than the drawing: its numbers in words, a dimension line that runs out of the picture."""
    p = palette(dark)
    inside = [w for w in (d.wall_left, d.wall_right) if seen[0] <= w <= seen[1]]
    ends = [*inside, *[seen[0] if w < seen[0] else seen[1] for w in (d.wall_left, d.wall_right) if w not in inside]]
    middle = 0.5 * (min(ends) + max(ends))
    for wall in inside:
        _line(fig, (wall, d.top), (wall, over), p.muted)
        arrow(fig, (middle, over), (wall, over), p.text, **HEAD)
    for end in ends[len(inside) :]:
        _line(fig, (middle, over), (end, over), p.text)
    _text(fig, (middle, over), f"{_width(d)}, {_depth(d)}", p.text, dark)
    _text(fig, (middle, d.floor - 0.4 * (over - d.top)), f"{_off(d)}, {_floor(d)}", p.warm, dark)


def _width(d: SectionDrawing) -> str:
    return f"width {format_value(d.width, d.unit, 3)}"


def _depth(d: SectionDrawing) -> str:
    return f"depth {format_value(d.depth, d.unit, 3)}"


def _off(d: SectionDrawing) -> str:
    return f"centre off {format_value(d.centre_offset, d.unit, 3, sign=True)}"


def _floor(d: SectionDrawing) -> str:
    return f"floor {format_value(d.floor_error, d.unit, 3, sign=True)}"


def _line(fig: Chart, a: Point, b: Point, colour: str, dash: str = "solid") -> None:
    line = {"color": colour, "width": 1, "dash": dash}
    fig.shape(type="line", x0=a[0], y0=a[1], x1=b[0], y1=b[1], line=line)


def _text(fig: Chart, at: Point, text: str, colour: str, dark: bool, xanchor: str = "center") -> None:
    behind: dict[str, Any] = {"bgcolor": rgba(palette(dark).background, 0.88), "borderpad": 3}
    say(fig, text, *at, colour, size=13, xanchor=xanchor, yanchor="middle", **behind)
