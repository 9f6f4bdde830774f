"""Maps over planes: heat maps in one figure on common scales, with points to pick and the point in hand."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from robomill.arrays import FloatArray, IntArray
from robomill.units import UNITS, format_number, from_si, unit_label
from robomill.viz.chart import Chart, drawn
from robomill.viz.theme import ABOVE, SEQUENTIAL, axis, colour_bar, diverging, figure, joint_colours, palette, say
from robomill.workspace.grid import Grid
from robomill.workspace.quantities import Colours, MapQuantity

PICKED_PER_MAP = 200  # points that can be clicked; each is an element of the page and costs time to draw
LEFT, RIGHT = 62, 84  # px for tick labels and colour bar, fixed: measuring them would draw everything twice
LINE = 15  # px of a line of a panel's title
BAR_ROOM = 110  # px of height that a colour bar with its title beside it needs; bars with less stand side by side


@dataclass(frozen=True)
class Scale:
    """A colour scale that one or more maps share, in display units.

    kind: "diverging" is symmetric about zero (signed values), "sequential" runs from low to high (sizes), "joints" has
    one colour a joint, "reach" one for what is reached.
    """

    title: str
    low: float
    high: float
    kind: Colours = "sequential"
    joints: tuple[int, ...] = ()
    digits: int = 3

    @classmethod
    def of(cls, what: MapQuantity, values: FloatArray, joints: tuple[int, ...]) -> Scale:
        """The scale of a quantity from its values in display units: centred on zero where both signs occur."""
        seen = values[np.isfinite(values)]
        low, high = (float(seen.min()), float(seen.max())) if len(seen) else (0.0, 1.0)
        one_sign = what.colours == "diverging" and not low < 0 < high
        return cls(what.label, low, high, "sequential" if one_sign else what.colours, joints, UNITS[what.unit].digits)

    @classmethod
    def signed(cls, title: str, values: Sequence[FloatArray]) -> Scale:
        """A scale centred on zero, as wide as the largest size in ``values``."""
        top = symmetric_limit(values)
        return cls(title, -top, top, "diverging")

    def shade(self, values: FloatArray) -> FloatArray:
        """What is coloured: the values; of joints the place of each number among ``joints``, since numbers may skip."""
        if self.kind != "joints":
            return values
        return np.where(np.isfinite(values), np.searchsorted(self.joints, np.nan_to_num(values)), np.nan)

    def colours(self, dark: bool) -> dict[str, Any]:
        """Colour scale and its ends, as plotly takes them."""
        if self.kind == "joints":
            count = len(self.joints)
            colours = joint_colours(count, dark)
            steps = [[(i + side) / count, colours[i]] for i in range(count) for side in (0, 1)]
            return {"colorscale": steps, "cmin": -0.5, "cmax": count - 0.5}
        if self.kind == "reach":
            return {"colorscale": [[0, palette(dark).panel], [1, palette(dark).accent]], "cmin": 0, "cmax": 1}
        if self.kind == "diverging":
            top = max(abs(self.low), abs(self.high)) or 1.0
            return {"colorscale": diverging(dark), "cmin": -top, "cmax": top}
        high = self.high if self.high > self.low else self.low + 1e-9
        return {"colorscale": SEQUENTIAL, "cmin": self.low, "cmax": high}


@dataclass(frozen=True, eq=False)
class Map:
    """One panel: values (nu, nv) in display units or numbers of joints, NaN where not reached; ``scale``: its name."""

    title: str
    values: FloatArray
    scale: str = "main"
    unit: str = ""


Panels = Sequence[Sequence[Map | None]]


@dataclass(frozen=True, eq=False)
class MapSheet:
    """Panels in rows over one plane: u (nu,) across and v (nv,) upwards, in display units.

    ``point`` (u, v) is marked in every panel.
    """

    rows: Panels
    u: FloatArray
    v: FloatArray
    u_title: str
    v_title: str
    scales: dict[str, Scale] = field(default_factory=dict)
    point: tuple[float, float] | None = None
    on_plane: bool = True

    @classmethod
    def over(cls, rows: Panels, grid: Grid, normal: str, unit: str, scales: dict[str, Scale], **more: Any) -> MapSheet:
        """Panels over the cells of a plane, lengths in ``unit``; ``more``: the point in hand."""
        across, upwards = (a for a in "xyz" if a != normal)
        u, v = (from_si(getattr(grid, a), unit) for a in (across, upwards))
        u_title, v_title = (f"{a.upper()}<sub>M</sub>, {unit_label(unit)}" for a in (across, upwards))
        return cls(rows, u, v, u_title, v_title, scales, **more)


def symmetric_limit(values: Sequence[FloatArray]) -> float:
    """The largest size over several maps, for a scale centred on zero; 1 where nothing is reached."""
    tops = [float(np.nanmax(np.abs(v))) for v in values if np.isfinite(v).any()]
    return max(tops, default=1.0) or 1.0


def sheet_figure(
    sheet: MapSheet, *, dark: bool, panel_height: int, revision: str, gap_x: float = 0.05, gap_y: int = 46
) -> Chart:
    """All panels of ``sheet`` in one figure; panning and zooming one moves all."""
    n_rows, n_columns = len(sheet.rows), max(len(row) for row in sheet.rows)
    lines = 1 + max(m.title.count("<br>") for row in sheet.rows for m in row if m is not None)
    top, bottom, gap_y = 11 + LINE * lines, 44, gap_y + LINE * (lines - 1)
    height = top + n_rows * panel_height + (n_rows - 1) * gap_y + bottom
    inner = height - top - bottom
    width = (1.0 - gap_x * (n_columns - 1)) / n_columns
    used = list(dict.fromkeys(m.scale for row in sheet.rows for m in row if m is not None))
    beside = inner < BAR_ROOM * len(used)
    data: list[dict[str, Any]] = []
    fig = figure(
        dark=dark,
        height=height,
        revision=revision,
        dragmode="pan",
        hovermode="closest",
        hoverdistance=-1,
        clickmode="event+select",
        showlegend=False,
        margin={"l": LEFT, "r": RIGHT * (len(used) if beside else 1), "t": top, "b": bottom, "autoexpand": False},
    )
    for name in used:
        fig.layout[f"coloraxis{_number(used.index(name))}"] = _colour_axis(sheet, name, used, beside, dark)
    index = 0
    for r, row in enumerate(sheet.rows):
        y1 = 1.0 - r * (panel_height + gap_y) / inner
        y0 = max(y1 - panel_height / inner, 0.0)
        for c, panel in enumerate(row):
            if panel is None:
                continue
            x0, lowest = c * (width + gap_x), r == n_rows - 1 or _below_empty(sheet, r, c)
            place = (x0, min(x0 + width, 1.0), lowest), (y0, min(y1, 1.0), c == 0 or not any(row[:c]))
            data += _traces(sheet, panel, index, used, dark)
            _decorate(fig, sheet, panel, index, place, dark)
            index += 1
    fig.add_traces(data)
    return fig


def picked_point(sheet_u: FloatArray, sheet_v: FloatArray, u: float, v: float) -> tuple[float, float]:
    """(u, v) of the grid's point next to where was clicked."""
    return float(sheet_u[np.abs(sheet_u - u).argmin()]), float(sheet_v[np.abs(sheet_v - v).argmin()])


def _number(index: int) -> str:
    return "" if index == 0 else str(index + 1)


def _below_empty(sheet: MapSheet, r: int, c: int) -> bool:
    return all(c >= len(row) or row[c] is None for row in sheet.rows[r + 1 :])


def _colour_axis(sheet: MapSheet, name: str, used: list[str], beside: bool, dark: bool) -> dict[str, Any]:
    scale = sheet.scales[name]
    place = used.index(name)
    share = 1.0 if beside else 1.0 / len(used)
    bar = colour_bar(scale.title, dark=dark, x=1.005, len=share, y=0.5 if beside else 1.0 - share * (place + 0.5))
    if beside:
        bar["xpad"] += RIGHT * place
    if scale.kind == "joints":
        bar.update(tickvals=list(range(len(scale.joints))), ticktext=[f"joint {j}" for j in scale.joints])
    return {**scale.colours(dark), **({"showscale": False} if scale.kind == "reach" else {"colorbar": bar})}


def _traces(sheet: MapSheet, panel: Map, index: int, used: list[str], dark: bool) -> list[dict[str, Any]]:
    """The heat map, the points that can be clicked, and the point in hand."""
    p = palette(dark)
    name = _number(index)
    axes = {"xaxis": f"x{name}", "yaxis": f"y{name}"}
    traces: list[dict[str, Any]] = [
        {
            "type": "heatmap",
            "x": sheet.u,
            "y": sheet.v,
            "z": np.ascontiguousarray(sheet.scales[panel.scale].shade(panel.values).astype(np.float32).T),
            "coloraxis": f"coloraxis{_number(used.index(panel.scale))}",
            "hoverinfo": "skip",
            "name": panel.title,
            **axes,
        },
        {**_pick_layer(sheet, panel, sheet.scales[panel.scale], dark), **axes},
    ]
    if sheet.point is not None:
        size = {"size": 7, "color": p.text, "line": {"color": p.background, "width": 1.4 if sheet.on_plane else 2}}
        mark = {"symbol": "circle" if sheet.on_plane else "circle-open", **size}
        either = {key: {"marker": {"opacity": 1}} for key in ("selected", "unselected")}
        x, y = ([place] for place in sheet.point)
        traces.append(drawn("scatter", x=x, y=y, mode="markers", hoverinfo="skip", marker=mark, **either, **axes))
    return traces


def _pick_layer(sheet: MapSheet, panel: Map, scale: Scale, dark: bool) -> dict[str, Any]:
    """Unseen points over the map: a heat map alone returns no clicks. They carry the hover text, too."""
    every = max(1, int(np.ceil(np.sqrt(len(sheet.u) * len(sheet.v) / PICKED_PER_MAP))))
    iu, iv = _thin(len(sheet.u), every), _thin(len(sheet.v), every)
    U, V = np.meshgrid(sheet.u[iu], sheet.v[iv], indexing="ij")
    values = np.asarray(panel.values)[np.ix_(iu, iv)].ravel()
    place = f"{sheet.u_title}: %{{x:.4g}}<br>{sheet.v_title}: %{{y:.4g}}"
    return {
        "type": "scatter",
        "x": U.ravel().astype(np.float32),
        "y": V.ravel().astype(np.float32),
        "mode": "markers",
        "text": [hover_text(value, panel.unit, scale) for value in values.tolist()],
        "name": panel.title,
        "marker": {"size": 7, "opacity": 0, "color": palette(dark).text},
        "hovertemplate": f"<b>{panel.title}</b><br>%{{text}}<br>{place}<extra></extra>",
    }


def hover_text(value: float, unit: str, scale: Scale) -> str:
    """A value of a map in words, as its hover text says it."""
    if not math.isfinite(value):
        return "not reached"
    if scale.kind == "joints":
        return f"joint {int(value)}"
    if scale.kind == "reach":
        return "reached" if value > 0.5 else "not reached"
    return f"{format_number(value, scale.digits)} {unit}".rstrip()


def _thin(count: int, every: int) -> IntArray:
    """Indices 0, every, ... so that the last one is the last point wherever that divides."""
    start = ((count - 1) % every) // 2
    return np.arange(start, count, every)


def _decorate(
    fig: Chart,
    sheet: MapSheet,
    panel: Map,
    index: int,
    place: tuple[tuple[float, float, bool], tuple[float, float, bool]],
    dark: bool,
) -> None:
    """Axes and title of one panel; ``place``: from, to and whether the axis is titled, across and upwards."""
    p = palette(dark)
    name = _number(index)
    (x0, x1, lowest), (y0, y1, leftmost) = place
    for letter, other, domain, points, shown, title in (
        ("x", "y", [x0, x1], sheet.u, lowest, sheet.u_title),
        ("y", "x", [y0, y1], sheet.v, leftmost, sheet.v_title),
    ):
        fig.layout[f"{letter}axis{name}"] = {
            **axis("", dark=dark, showgrid=False, nticks=5 if len(sheet.rows[0]) < 3 or letter == "y" else 3),
            **({} if index == 0 else {"matches": letter}),
            "domain": domain,
            "anchor": f"{other}{name}",
            "showticklabels": shown,
            "range": whole_cells(points),
            "automargin": False,
            "visible": shown,
            "showline": False,
            "title": {"text": title, "standoff": 4, "font": {"size": 12, "color": p.muted}} if shown else {"text": ""},
        }
    say(fig, panel.title, x0, y1, p.text, size=13, yshift=2, align="left", **ABOVE)


def whole_cells(points: FloatArray) -> list[float]:
    """From half a cell before the first point to half a cell after the last one."""
    half = 0.5 * float(np.diff(points).min()) if len(points) > 1 else 0.5
    return [float(points[0] - half), float(points[-1] + half)]
