"""A cross-section as an engineering drawing: material hatched, the ideal dashed, dimensions of what was cut.

Dimension lines and words keep their distances in pixels, so that they stand clear of each other however deep the cut is
and however narrow the picture. Numbers are in the unit of the axes.
"""

from dataclasses import dataclass
from typing import Any

import numpy as np

from robomill.arrays import FloatArray
from robomill.surface.sections.measures import MEASURED
from robomill.surface.sections.section_law import Kind
from robomill.units import format_value
from robomill.viz.chart import Chart
from robomill.viz.theme import axis, figure, palette, rgba, say

HEIGHT = 330
OVER, UNDER = 74, 66  # px above the part and below its floor that dimensions need
CUT = 96  # px, at most, for the depth of the cut
ROW = 22  # px from one row of words to the next
NARROW = 0.25  # of the picture's width: words centred closer to its edge would run out of it
ROOM_OF_WORDS, ROOM_OF_LINE = 0.2, 0.12  # of the width, that the depth needs beside a wall
PAD = 0.02  # of the width, on either side: a wall at the end of the picture is drawn whole
HEAD: dict[str, Any] = {"showarrow": True, "text": "", "arrowhead": 3, "arrowsize": 1.1, "arrowwidth": 1.1, "ay": 0}


@dataclass(frozen=True, eq=False)
class SectionDrawing:
    """A section across the cut, everything in ``unit`` (mm or in), angles in degrees.

    u, u_ideal (k,): across the cut, + to the left of the feed, 0 on the commanded centre line; machined, ideal (k,):
    heights in {W} there. The dimensions are the measured ones, not read off the drawing; NaN where there is none.
    ``near`` is the wall of a step or pocket. ``note`` stands in the picture where there is nothing to measure.
    """

    kind: Kind
    near: str
    u: FloatArray
    machined: FloatArray
    u_ideal: FloatArray
    ideal: FloatArray
    wall_left: float
    wall_right: float
    wall_left_ideal: float
    wall_right_ideal: float
    wall_left_error: float
    wall_right_error: float
    width: float
    depth: float
    centre_offset: float
    floor_error: float
    flatness: float
    error_mean: float
    error_max: float
    slope: float
    floor: float
    unit: str = "mm"
    note: str = ""

    @property
    def top(self) -> float:
        """Height from which the depth counts; the highest of the section where none is measured."""
        top = self.floor + self.depth
        return top if np.isfinite(top) else float(np.max(self.machined))

    def number(self, name: str) -> str:
        """One of its lengths."""
        return format_value(getattr(self, name), self.unit, 3, sign=MEASURED[name].signed, with_unit=False)

    def told(self, name: str) -> str:
        """The same behind its name: "floor −0.102"."""
        return f"{MEASURED[name].short} {self.number(name)}"

    def has(self, *names: str) -> bool:
        """Whether all of these are measured."""
        return bool(np.isfinite([getattr(self, name) for name in names]).all())


def section_figure(drawing: SectionDrawing, *, dark: bool, beside: SectionDrawing | None = None) -> Chart:
    """The drawing, to one scale in both directions; the reader looks along the feed, left is left. With another drawing
    ``beside`` it, both are to the same scale."""
    p, d = palette(dark), drawing
    fig = figure(dark=dark, height=HEIGHT, revision=f"section-{d.kind}", margin={"l": 8, "r": 8, "t": 26, "b": 8})
    good = np.isfinite(d.machined)
    u, z = d.u[good], d.machined[good]
    if len(u) == 0:
        return fig
    across, upwards = _ranges(d, u, z)
    if beside is not None and (there := np.isfinite(beside.machined)).any():
        others = _ranges(beside, beside.u[there], beside.machined[there])
        across, upwards = (_as_long(*both) for both in zip((across, upwards), others, strict=True))
    bottom = float(np.min(z)) - 40.0 * abs(upwards[1] - upwards[0])
    if d.kind in ("groove", "step", "pocket") and not d.has("floor"):
        bottom = float(np.min(z))  # cut through: what lies below is no material
    hatched = {"shape": "/", "size": 9, "solidity": 0.06, "fgcolor": p.metal_edge, "bgcolor": rgba(p.metal, 0.22)}
    fill = rgba(p.metal, 0.30)
    fig.area([u[0], *u, u[-1]], [bottom, *z, bottom], fill, name="material", fillpattern=hatched, showlegend=False)
    keep = np.isfinite(d.ideal)
    for x, y, name, line in (
        (u, z, "machined", {"color": p.text, "width": 2.6}),
        (d.u_ideal[keep], d.ideal[keep], "ideal", {"color": p.accent, "width": 1.8, "dash": "dash"}),
    ):
        hover = f"across %{{x:.3f}} {d.unit}<br>height %{{y:.3f}} {d.unit}<extra>{name}</extra>"
        fig.lines(x, y, line, name=name, hovertemplate=hover)
    _dimensions(fig, d, dark)
    plain: dict[str, Any] = {"dark": dark, "showgrid": False, "constrain": "range", "nticks": 6}
    # Left of the feed is +u; looking along the feed it lies on the left, so the axis runs backwards.
    return fig.lay_out(
        xaxis=axis(f"Across the cut, {d.unit} (+ is left of the feed)", range=across[::-1], **plain),
        yaxis=axis(f"Height z<sub>W</sub>, {d.unit}", range=upwards, scaleanchor="x", scaleratio=1, **plain),
    )


def _ranges(d: SectionDrawing, u: FloatArray, z: FloatArray) -> tuple[list[float], list[float]]:
    """What is shown across and upwards; the drawing is to scale, so the wider of the two decides."""
    low = d.floor if d.has("floor") else float(np.min(z))
    cut = max(d.top - low, 0.02 * float(np.ptp(u)))
    pad = PAD * float(np.ptp(u))
    return [float(np.min(u)) - pad, float(np.max(u)) + pad], [low - cut * UNDER / CUT, d.top + cut * OVER / CUT]


def _as_long(ends: list[float], other: list[float]) -> list[float]:
    """``ends`` moved apart, about their middle, until they are as far from each other as those of the ``other``."""
    grow = max(0.5 * ((other[1] - other[0]) - (ends[1] - ends[0])), 0.0)
    return [ends[0] - grow, ends[1] + grow]


def _dimensions(fig: Chart, d: SectionDrawing, dark: bool) -> None:
    """The dimensions of each kind."""
    if d.kind == "groove":
        _width(fig, d, dark)
        _centre(fig, d, dark)
    if d.kind in ("step", "pocket"):
        _near_wall(fig, d, dark)
    if d.kind in ("groove", "step", "pocket"):
        _depth(fig, d, dark)
        _floor(fig, d, dark)
    if d.kind == "free" and d.has("error_mean", "error_max", "slope"):
        words = f"{d.told('error_mean')}, at most {d.number('error_max')}"
        _head(fig, [words, f"sloping by {format_value(d.slope, 'deg', 1)}"], dark)
    if d.kind == "nothing":
        _axis_line(fig, d, 0.0, palette(dark).accent)
        _head(fig, ["nothing is cut here"], dark)


def _width(fig: Chart, d: SectionDrawing, dark: bool) -> None:
    """A dimension line over a groove, from wall to wall."""
    if not d.has("width"):
        return
    p, up = palette(dark), 2 * ROW + 4
    for wall, way in ((d.wall_left, 1), (d.wall_right, -1)):
        _upright(fig, wall, (d.top, d.top), (4, up + 5), p.muted)
        fig.annotate(x=wall, y=d.top, ax=18 * way, yshift=up, arrowcolor=p.text, **HEAD)
    line = {"color": p.text, "width": 1.1}
    fig.shape(type="line", x0=d.wall_left, x1=d.wall_right, y0=up, y1=up, ysizemode="pixel", yanchor=d.top, line=line)
    _text(fig, 0.5 * (d.wall_left + d.wall_right), d.top, d.told("width"), dark, yshift=up)


def _depth(fig: Chart, d: SectionDrawing, dark: bool) -> None:
    """A dimension line in the material beside a wall, with its number over the part; over the cut, each of them, where
    the picture ends beside the wall."""
    walls = [(name, getattr(d, f"wall_{name}")) for name in ([d.near] if d.near else ["right", "left"])]
    walls = [(name, w) for name, w in walls if np.isfinite(w)] if all(name for name, _ in walls) else []
    if not d.has("depth", "floor") or not walls:
        return
    p, (name, wall) = palette(dark), walls[0]
    out = 1 if name == "right" else -1  # px count to the right, where the right wall's material is
    room = (wall - float(np.min(d.u)) if out > 0 else float(np.max(d.u)) - wall) / float(np.ptp(d.u))
    way, words = out if room > ROOM_OF_LINE else -out, out if room > ROOM_OF_WORDS else -out
    line = {"color": p.text, "width": 1.1}
    at: dict[str, Any] = {"xsizemode": "pixel", "xanchor": wall, "type": "line", "line": line}
    fig.shape(x0=20 * way, x1=20 * way, y0=d.floor, y1=d.top, **at)
    for y in (d.floor, d.top):
        fig.shape(x0=3 * way, x1=26 * way, y0=y, y1=y, **{**at, "line": {**line, "color": p.muted}})
    beyond = _beyond(d, name, words)
    anchor = "left" if words > 0 else "right"
    _text(fig, beyond, d.top, d.told("depth"), dark, yshift=ROW - 8, xshift=4 * words, xanchor=anchor)


def _floor(fig: Chart, d: SectionDrawing, dark: bool) -> None:
    """What is known of the floor, in rows under it."""
    if not d.has("floor"):
        _text(fig, 0.0, float(np.min(d.machined)), "cut through: no floor", dark, yshift=-ROW + 4)
        return
    words = [d.told("floor_error")] if d.has("floor_error") else []
    if d.kind != "groove" and d.has("flatness"):
        words.append(f"flat within {d.number('flatness')}")
    for row, each in enumerate(words):
        at = _middle(d)
        under = d.floor if d.kind == "groove" else float(np.min(d.machined))  # beside a step the cut may be deeper
        _text(fig, at, under, each, dark, yshift=-(row + 1) * ROW + 4, xanchor=_anchor(d, at))


def _centre(fig: Chart, d: SectionDrawing, dark: bool) -> None:
    """The ideal and the machined middle of a groove, with how far they are apart."""
    if not d.has("centre_offset", "wall_left", "wall_right"):
        return
    p, middle = palette(dark), _middle(d)
    for at, colour in ((middle - d.centre_offset, p.accent), (middle, p.text)):
        _axis_line(fig, d, at, colour)
    _text(
        fig,
        middle,
        d.floor if d.has("floor") else float(np.min(d.machined)),
        d.told("centre_offset"),
        dark,
        yshift=-2 * ROW + 2,
    )


def _near_wall(fig: Chart, d: SectionDrawing, dark: bool) -> None:
    """How far the wall of a step or pocket stands from where it was told to stand."""
    if not d.near or not d.has(f"wall_{d.near}", f"wall_{d.near}_error"):
        return
    p, up = palette(dark), 2 * ROW
    wall, ideal = getattr(d, f"wall_{d.near}"), getattr(d, f"wall_{d.near}_ideal")
    for at, colour in ((ideal, p.accent), (wall, p.text)):
        _upright(fig, at, (d.top, d.top), (4, up - ROW // 2), colour)
    _text(fig, wall, d.top, d.told(f"wall_{d.near}_error"), dark, yshift=up, xanchor=_anchor(d, wall))


def _beyond(d: SectionDrawing, name: str, way: int) -> float:
    """Of a wall as it stands and as it was told, the one that is further to the right (``way`` 1) or left (-1): words
    beyond both are crossed by neither. Left is +u."""
    both = (getattr(d, f"wall_{name}"), getattr(d, f"wall_{name}_ideal"))
    return float(min(way * u for u in both if np.isfinite(u)) * way)


def _middle(d: SectionDrawing) -> float:
    """Where the words on a floor stand: between the walls of a groove, between the wall and the end of the picture of
    others."""
    if d.kind == "groove" and d.has("wall_left", "wall_right"):
        return 0.5 * (d.wall_left + d.wall_right)
    if not d.near or not d.has(f"wall_{d.near}"):
        return 0.0
    end = float(np.min(d.u) if d.near == "left" else np.max(d.u))
    return float(0.5 * (getattr(d, f"wall_{d.near}") + end))


def _anchor(d: SectionDrawing, u: float) -> str:
    """How words at a position are anchored, so that they stay in the picture; left is +u."""
    share = (float(np.max(d.u)) - u) / float(np.ptp(d.u))
    return "left" if share < NARROW else "right" if share > 1.0 - NARROW else "center"


def _axis_line(fig: Chart, d: SectionDrawing, at: float, colour: str) -> None:
    low = d.floor if d.has("floor") else float(np.min(d.machined))
    _upright(fig, at, (low, d.top), (-2 * ROW + 12, ROW - 4), colour, "dashdot")


def _upright(
    fig: Chart, x: float, ends: tuple[float, float], beyond: tuple[int, int], colour: str, dash: str = "solid"
) -> None:
    """An upright line between two heights, each ``beyond`` px further up."""
    line = {"color": colour, "width": 1, "dash": dash}
    for y, (a, b) in zip(ends, ((beyond[0], 0), (0, beyond[1])), strict=True):
        if ends[0] == ends[1] and a:
            continue
        start = beyond[0] if ends[0] == ends[1] else a
        fig.shape(type="line", x0=x, x1=x, y0=start, y1=b, ysizemode="pixel", yanchor=y, line=line)
    if ends[0] != ends[1]:
        fig.shape(type="line", x0=x, x1=x, y0=ends[0], y1=ends[1], line=line)


def _head(fig: Chart, words: list[str], dark: bool) -> None:
    """Words at the top of the picture."""
    for row, each in enumerate(words):
        behind = {"bgcolor": rgba(palette(dark).background, 0.88), "borderpad": 2}
        place = {"xref": "paper", "yref": "paper", "yanchor": "top", "yshift": -row * ROW - 4}
        say(fig, each, 0.5, 1.0, palette(dark).text, size=13, **place, **behind)


def _text(fig: Chart, x: float, y: float, text: str, dark: bool, **more: Any) -> None:
    p = palette(dark)
    behind: dict[str, Any] = {"bgcolor": rgba(p.background, 0.88), "borderpad": 2, "yanchor": "middle"}
    say(fig, text, x, y, p.text, size=12, **behind, **more)
