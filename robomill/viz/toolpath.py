"""The whole toolpath as a picture, from above or turnable: coloured by a quantity, with the line that is pointed at."""

from typing import Any, NamedTuple

import numpy as np
from plotly.colors import sample_colorscale

from robomill.arrays import BoolArray, FloatArray, IntArray
from robomill.viz.chart import QUIET, Chart
from robomill.viz.path_picture import PathPicture
from robomill.viz.theme import SEQUENTIAL, axis, axis3d, colour_bar, figure, palette, plain, rgba, tool_colours

VECTOR_LINES = 5_000
MAX_PICKS = 3_000
CLASSES = 16
HOLES = {"solid": "circle", "dash": "circle-open"}  # how a drilled hole is marked, by how a line of its kind is broken
NAMED = {True: "<br>not judged", False: ""}
MARGIN = 0.04  # of the stock, beyond it


def plan_picture(picture: PathPicture, *, dark: bool, height: int = 430) -> Chart:
    """The path from above: rapids dotted, cuts coloured, what is out of reach crossed, the selected line marked."""
    p = palette(dark)
    fig = figure(dark=dark, height=height, revision="path-plan", margin={"l": 8, "r": 8, "t": 30, "b": 8})
    _stock(fig, picture, dark)
    kept, ends = picture.kept, _ends(picture)
    cut, lost = picture.cutting[kept], picture.cutting[kept] & ~picture.reached[kept]
    kind = "scattergl" if len(kept) > VECTOR_LINES else "scatter"
    width = 3.0 if len(kept) < 3_000 else 1.6

    def draw(chosen: BoolArray, line: dict[str, Any], **more: Any) -> None:
        xy = _lines(picture, ends, chosen, (0, 1))
        fig.add(kind, **xy, mode="lines", line=line, hoverinfo="skip", **more)

    draw(~cut & (np.arange(len(kept)) > 0), {"color": p.muted, "width": 1, "dash": "dot"}, name="rapid")
    draw(cut, {"color": rgba(p.text, 0.18), "width": 2 * width}, showlegend=False)
    _halo(fig, picture, dark)
    upright = cut & (np.abs(ends[1] - ends[0])[:, :2].max(axis=1) < 1e-9)  # from above a drilled hole is a point
    for name, colour, chosen, legend, dash in _classes(picture, dark):
        draw(chosen, {"color": colour, "width": width, "dash": dash}, name=name, showlegend=legend)
        if (chosen & upright).any():
            _dots(fig, ends[1][chosen & upright], {"size": 8, "color": colour, "symbol": HOLES[dash]})
    if lost.any():
        at = picture.points[kept][lost]
        cross = {"size": 8, "symbol": "x-thin", "line": {"width": 1.8, "color": p.bad}}
        _dots(fig, at[:: max(1, len(at) // 400)], cross)
    _marks(fig, picture, dark)
    _picks(fig, picture, dark)
    unit = picture.length_unit
    fig.lay_out(
        xaxis=axis(f"x<sub>W</sub>, {unit}", dark=dark),
        clickmode="event+select",
        dragmode="pan",
        yaxis=axis(f"y<sub>W</sub>, {unit}", dark=dark, scaleanchor="x", scaleratio=1),
    )
    return fig


def turnable_picture(picture: PathPicture, *, dark: bool, height: int = 430) -> tuple[Chart, float]:
    """The path to be turned, and how many times heights are enlarged in it."""
    p = palette(dark)
    fig = figure(dark=dark, height=height, revision="path-turn", margin={"l": 0, "r": 0, "t": 0, "b": 0})
    kept, ends = picture.kept, _ends(picture)
    rapid = ~picture.cutting[kept] & (np.arange(len(kept)) > 0)

    def draw(xyz: dict[str, Any], line: dict[str, Any], **more: Any) -> None:
        fig.add("scatter3d", **xyz, mode="lines", line=line, hoverinfo="skip", **more)

    every = (0, 1, 2)
    draw(_lines(picture, ends, rapid, every), {"color": p.muted, "width": 1.5, "dash": "dot"}, name="rapid")
    here = picture.points[_selected(picture)]
    if len(here):
        xyz = dict(zip("xyz", here.T, strict=True))
        draw(xyz, {"color": rgba(p.text, 0.7), "width": 14}, showlegend=False)
    for name, colour, chosen, legend, dash in _classes(picture, dark):
        line = {"color": colour, "width": 5, "dash": dash}
        draw(_lines(picture, ends, chosen, every), line, name=name, showlegend=legend)
    if picture.value is not None:
        fig.add("scatter3d", x=[None], y=[None], z=[None], mode="markers", marker=_scale(picture, dark), **QUIET)
    size = np.maximum(np.ptp(picture.points, axis=0), 1e-9)
    times = float(np.clip(round(0.22 * float(size.max()) / max(float(size[2]), 1e-9)), 1, 50))
    ratio = 1.9 * np.maximum(size * [1.0, 1.0, times] / float(size.max()), 0.1)
    ratio *= min(1.0, 2.3 / float(np.linalg.norm(ratio)))
    camera = {"eye": {"x": -0.75, "y": -1.25, "z": 0.95}, "center": {"x": 0.0, "y": 0.0, "z": -0.1}}
    fig.lay_out(
        scene={
            **{f"{a}axis": axis3d(f"{a}<sub>W</sub>, {picture.length_unit}", dark=dark) for a in "xyz"},
            "aspectmode": "manual",
            "aspectratio": dict(zip("xyz", ratio.tolist(), strict=True)),
            "camera": {"projection": {"type": "orthographic"}, **camera},
            "uirevision": "path-turn",
        }
    )
    return fig, times


def _stock(fig: Chart, picture: PathPicture, dark: bool) -> None:
    if picture.stock is None:
        return
    p = palette(dark)
    (x0, y0), (x1, y1) = picture.stock[0][:2], picture.stock[1][:2]
    rim = {"mode": "lines", "line": {"color": p.line, "width": 1}}
    fig.area([x0, x1, x1, x0, x0], [y0, y0, y1, y1, y0], rgba(p.metal, 0.26), name="stock", **rim)
    beyond = MARGIN * max(x1 - x0, y1 - y0)
    fig.dots([x0 - beyond, x1 + beyond], [y0 - beyond, y1 + beyond], {"opacity": 0.0}, **QUIET)


def _dots(fig: Chart, at: FloatArray, marker: dict[str, Any], name: str = "") -> None:
    """Marks at points (q, 3), named in the legend where there is a name."""
    named: dict[str, Any] = {"name": name} if name else {"showlegend": False}
    fig.dots(at[:, 0], at[:, 1], marker, hoverinfo="skip", **named)


def _ends(picture: PathPicture) -> tuple[FloatArray, FloatArray]:
    """Start and end (q, 3) of the drawn segments; the first has no length."""
    q = picture.points[picture.kept]
    return np.concatenate([q[:1], q[:-1]]), q


def _lines(
    picture: PathPicture, ends: tuple[FloatArray, FloatArray], chosen: BoolArray, columns: tuple[int, ...]
) -> dict[str, Any]:
    """Coordinates of the chosen segments as one line with gaps; segments that follow each other are joined."""
    i = np.flatnonzero(chosen)
    if len(i) == 0:
        return {name: [] for name in "xyz"[: len(columns)]}
    begins = np.append(True, np.diff(i) > 1)
    before = np.cumsum(begins)
    # Each run: a gap (but for the first), its start, then the end of every segment.
    at = np.arange(len(i)) + 2 * before - 1
    out = np.full((at[-1] + 1, 3), np.nan, dtype=np.float32)
    out[at] = ends[1][i]
    out[at[begins] - 1] = ends[0][i[begins]]
    return {"xyz"[c]: out[:, c] for c in columns}


class _Class(NamedTuple):
    """Segments that are drawn alike: their name, their colour, which they are, whether the legend names them, and how
    their line is broken: what has no value is, since its colour would be one of the scale."""

    name: str
    colour: str
    chosen: BoolArray
    named: bool
    dash: str = "solid"


def _classes(picture: PathPicture, dark: bool) -> list[_Class]:
    """The kinds of segments of the cuts."""
    p = palette(dark)
    kept = picture.kept
    cut, reached = picture.cutting[kept], picture.reached[kept]
    lost = cut & ~reached
    missed = int((picture.cutting & ~picture.reached).sum())
    found = [_Class(f"out of reach ({missed} points)", p.bad, lost, True)] if missed else []
    if picture.tools is not None:
        tool = picture.tools[kept]
        colours = tool_colours(picture.tool_names, dark)
        made = [_Class(name, colours[n], cut & reached & (tool == n), True) for n, name in picture.tool_names.items()]
        return [*made, *found]
    if picture.value is None:
        return [_Class("in reach", p.good, cut & reached, True), *found]
    # The value of a segment is the largest since the segment before: thinning must not hide a peak.
    value = np.maximum.reduceat(np.nan_to_num(picture.value, nan=-np.inf), np.append(0, kept[:-1] + 1))
    known = cut & reached & np.isfinite(value)
    top = _top(picture)
    share = np.clip(np.nan_to_num(value, neginf=0.0) / top, 0.0, 1.0)
    index = np.minimum((share * CLASSES).astype(int), CLASSES - 1)
    over = known & (value > picture.limit) if picture.limit is not None else np.zeros(len(kept), dtype=bool)
    colours = sample_colorscale(SEQUENTIAL, list((np.arange(CLASSES) + 0.5) / CLASSES))
    made = [_Class("", colours[c], known & ~over & (index == c), False) for c in range(CLASSES)]
    made = [entry for entry in made if entry.chosen.any()]
    if over.any():
        made.append(_Class(f"above {picture.limit:g} {picture.unit}", p.bad, over, True))
    if unknown := int(picture.unknown.sum()):
        made.append(_Class(f"not judged ({unknown} points)", p.unjudged, cut & reached & ~known, True, "dash"))
    return made + found


def _top(picture: PathPicture) -> float:
    if picture.limit is not None:
        return picture.limit
    assert picture.value is not None
    good = picture.value[picture.cutting & np.isfinite(picture.value)]
    return float(good.max()) if len(good) and good.max() > 0 else 1.0


def _scale(picture: PathPicture, dark: bool) -> dict[str, Any]:
    """A marker that shows nothing but the colour bar."""
    title = f"{picture.title}, {picture.unit}" if picture.unit else picture.title
    return {
        "size": 0.1,
        "color": [0.0],
        "cmin": 0.0,
        "cmax": _top(picture),
        "colorscale": SEQUENTIAL,
        "showscale": True,
        "colorbar": colour_bar(title, dark=dark),
    }


def _selected(picture: PathPicture) -> IntArray:
    """Indices of the points of the selected line, with the point where it begins."""
    i = np.flatnonzero(picture.block == picture.selected) if picture.selected else np.empty(0, dtype=np.int64)
    if len(i) == 0:
        return i
    i = i[: 4 * MAX_PICKS]
    return np.append(max(int(i[0]) - 1, 0), i)


def _halo(fig: Chart, picture: PathPicture, dark: bool) -> None:
    """The line that is pointed at, as a border around whatever colour it has."""
    q = picture.points[_selected(picture)]
    if len(q):
        line, name = {"color": palette(dark).text, "width": 8}, f"{picture.noun} {picture.selected}"
        fig.lines(q[:, 0], q[:, 1], line, name=name, hoverinfo="skip")


def _marks(fig: Chart, picture: PathPicture, dark: bool) -> None:
    """Where the path begins, where the value is largest, and where the line that is pointed at ends."""
    p, rim = palette(dark), {"width": 2}
    end = picture.points[_selected(picture)][-1:]
    if len(end):
        _dots(fig, end, {"size": 16, "color": rgba(p.text, 0.12), "line": {"color": p.text, **rim}})
    _dots(fig, picture.points[:1], {"size": 11, "symbol": "circle-open", "color": p.text, "line": rim}, "start")
    if picture.worst >= 0:
        worst = {"size": 12, "symbol": "diamond-open", "color": p.text, "line": rim}
        _dots(fig, picture.points[picture.worst][None], worst, "tip most off")
    if picture.value is not None:
        fig.dots([None], [None], _scale(picture, dark), **QUIET)


def _picks(fig: Chart, picture: PathPicture, dark: bool) -> None:
    """Faint points to hover over and to click: a click on a bare line tells nobody anything."""
    kept = picture.kept[:: max(1, len(picture.kept) // MAX_PICKS)]
    q, block = picture.points[kept], picture.block[kept]
    words = [
        f"{picture.noun} {b}" + ("" if c else ", rapid") for b, c in zip(block, picture.cutting[kept], strict=True)
    ]
    hover = f"%{{text}}<br>x %{{x:.2f}}, y %{{y:.2f}}, z %{{customdata[1]:.2f}} {picture.length_unit}<extra></extra>"
    data: list[FloatArray] = [block.astype(float), q[:, 2]]
    if picture.tools is not None:
        words = [f"{w}<br>{plain(picture.tool_names.get(n, ''))}" for w, n in zip(words, picture.tools[kept].tolist())]
    if picture.value is not None:
        value = picture.value[kept]
        data.append(value)
        words = [
            w
            + (f"<br>{picture.title.lower()} {v:.{picture.digits}f} {picture.unit}" if np.isfinite(v) else NAMED[lost])
            for w, v, lost in zip(words, value, picture.unknown[kept].tolist(), strict=True)
        ]
    faint = {"opacity": 0.01}
    said: dict[str, Any] = {"text": words, "customdata": np.column_stack(data)}
    picked = {"selected": {"marker": faint}, "unselected": {"marker": faint}}
    dots = {"size": 9, "color": palette(dark).accent, **faint}
    fig.dots(q[:, 0], q[:, 1], dots, name="points", showlegend=False, hovertemplate=hover, **said, **picked)
