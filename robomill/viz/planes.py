"""Maps over all planes of a region as a browser draws them: numbers in 16 bits, colours, ticks and words.

Everything that is read off the screen was computed here: the browser looks it up and draws it, plane by plane.
"""

from __future__ import annotations

import base64
import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field
from itertools import pairwise
from typing import Any

import numpy as np
from numpy.typing import NDArray

from robomill.arrays import FloatArray, digest
from robomill.units import NOT_REACHED, decimals, format_many, format_number, from_si, to_si, unit_label
from robomill.viz.maps import Scale, whole_cells
from robomill.viz.theme import palette

STEPS = 65534  # 1 to 65535 are the values from the lowest to the highest, 0 is not reached
CONTOURS, FEW_CONTOURS = 8, 5  # over all planes, of one map and of each of several
LEFT, RIGHT, FOOT, CAPTION, SLIDER, GAP = 52, 74, 40, 22, 32, 10  # px, as board.js and board.css have them
LEGEND, LEAST_HIGH = 30, 60  # px of what stands beneath, and of a panel at least


@dataclass(frozen=True, eq=False)
class Codes:
    """Values of a map over the planes w (nw,) of a region, in SI, as 16-bit codes.

    ``text``: base64 of uint16, little-endian, u fastest, then v, then w. least, most, mean (nw,): of each plane, from
    the values themselves; NaN where nothing of it is reached. ``digest`` tells these from others.
    """

    low: float
    high: float
    text: str
    least: FloatArray
    most: FloatArray
    mean: FloatArray
    digest: str

    @property
    def reached(self) -> bool:
        """Whether any cell is."""
        return math.isfinite(self.low)


def coded(values: NDArray[np.floating[Any]]) -> Codes:
    """The codes of values (nw, nv, nu) in SI, NaN where not reached; true to 1/131068 of their range."""
    known = np.isfinite(values)
    count = known.sum(axis=(1, 2))
    some = count > 0
    least, most, mean = (np.full(len(values), np.nan) for _ in range(3))
    least[some] = np.nanmin(values[some], axis=(1, 2))
    most[some] = np.nanmax(values[some], axis=(1, 2))
    mean[some] = np.nansum(values[some], axis=(1, 2)) / count[some]
    low, high = (float(least[some].min()), float(most[some].max())) if some.any() else (math.nan, math.nan)
    span = high - low if high > low else 1.0
    codes = np.where(known, 1.0 + np.rint((np.nan_to_num(values) - (low if some.any() else 0.0)) / span * STEPS), 0.0)
    packed = codes.astype("<u2").tobytes()
    text = base64.b64encode(packed).decode("ascii")
    return Codes(low, high, text, least, most, mean, digest((packed, low, high)))


def ends(codes: Iterable[Codes], unit: str) -> FloatArray:
    """(2 k,) in ``unit``: the lowest and the highest value of each map of which anything is reached."""
    found = np.array([end for each in codes if each.reached for end in (each.low, each.high)])
    return from_si(found, unit)


def extremes(codes: Codes, unit: str, digits: int = 2) -> list[str]:
    """The range of each plane in words."""
    low, high = from_si(codes.least, unit), from_si(codes.most, unit)
    return [_between(a, b, digits) for a, b in zip(low, high, strict=True)]


def _between(low: float, high: float, digits: int) -> str:
    return format_many((low, high), "1", digits, " … ") if math.isfinite(low) else NOT_REACHED


def means(codes: Codes, unit: str, digits: int = 3) -> list[str]:
    """The mean of each plane in words."""
    return [format_number(mean, digits) for mean in from_si(codes.mean, unit)]


def neat(low: float, high: float, most: int) -> list[float]:
    """At most ``most`` multiples of 1, 2 or 5 times a power of ten between ``low`` and ``high``, both included."""
    span = high - low
    if not (math.isfinite(span) and span > 1e-12 * max(abs(low), abs(high))):
        return []
    power = math.floor(math.log10(span / most))
    for step in (m * 10.0 ** (power + d) for d in (0, 1, 2) for m in (1, 2, 5)):
        first, last = math.ceil(low / step - 1e-9), math.floor(high / step + 1e-9)
        if last - first + 1 <= most:
            return [k * step for k in range(first, last + 1)]
    return []


def said(ticks: Sequence[float]) -> list[tuple[float, str]]:
    """Ticks with their words: as many decimals as tell them apart."""
    step = min((b - a for a, b in pairwise(ticks)), default=abs(ticks[0]) if ticks else 1.0)
    digits = max(0, -math.floor(math.log10(step) + 1e-9)) if step > 0 else 0
    return [(tick, format_number(tick, digits)) for tick in ticks]


@dataclass(frozen=True, eq=False)
class PlaneMap:
    """One panel: its title (with ``low``, what follows _ in it is set low), codes, scale, unit and a note a plane.

    ``slider`` is the one that moves it; ``shown`` names the panel for a reader who does not see it.
    """

    title: str
    codes: Codes
    unit: str
    scale: str = "main"
    notes: Sequence[str] = ()
    slider: int = 0
    low: bool = True


@dataclass(frozen=True, eq=False)
class PlaneSheet:
    """Panels in rows over the planes ``w`` (nw,) of a region, u (nu,) across and v (nv,) upwards, in ``unit``.

    axes: the letters of u, v, w. ``drawn`` (nw,) says each plane in mm. scales by name; ``outlines``: (kind, points
    (k, 2)) of the project's part and cut; ``width`` px that the sheet has where the window is wide, ``most`` px that a
    panel may be high.
    """

    rows: Sequence[Sequence[PlaneMap | None]]
    u: FloatArray
    v: FloatArray
    w: FloatArray
    axes: tuple[str, str, str]
    unit: str
    scales: dict[str, Scale]
    outlines: Sequence[tuple[str, FloatArray]] = field(default_factory=list)
    width: int = 700
    most: int = 400

    @property
    def panels(self) -> list[tuple[int, int, PlaneMap]]:
        """Every panel with its row and column."""
        return [(r, c, m) for r, row in enumerate(self.rows) for c, m in enumerate(row) if m is not None]


def sheet_data(sheet: PlaneSheet, *, dark: bool) -> dict[str, Any]:
    """What the browser needs to draw ``sheet``, as it goes there; ``rev`` tells it from others."""
    panels = sheet.panels
    kept = {id(m.codes): m.codes for _, _, m in panels}
    place = {key: k for k, key in enumerate(kept)}
    words = [_words(axis, sheet.unit) for axis in (sheet.u, sheet.v, sheet.w)]
    ranges = [whole_cells(axis) for axis in (sheet.u, sheet.v)]
    data: dict[str, Any] = {
        "u": _axis(sheet, 0, ranges[0], words[0]),
        "v": _axis(sheet, 1, ranges[1], words[1]),
        "w": {
            "letter": sheet.axes[2],
            "at": [round(float(value), 6) for value in sheet.w],
            "said": words[2],
            "drawn": [f"{float(from_si(to_si(float(value), sheet.unit), 'mm')):.6g}" for value in sheet.w],
        },
        "unit": unit_label(sheet.unit),
        "scales": [_scale(scale, dark) for scale in sheet.scales.values()],
        "panels": [_panel(sheet, r, c, m, place[id(m.codes)]) for r, c, m in panels],
        "rows": len(sheet.rows),
        "columns": max(len(row) for row in sheet.rows),
        "outlines": [{"kind": kind, "points": np.round(points, 4).tolist()} for kind, points in sheet.outlines],
        "colours": {name: getattr(palette(dark), name) for name in ("text", "muted", "line", "background", "accent")},
        "most": sheet.most,
        "height": _height(sheet, ranges),
    }
    data["rev"] = digest((repr(data), [codes.digest for codes in kept.values()]))[:24]
    data["codes"] = [codes.text for codes in kept.values()]
    return data


def _words(axis: FloatArray, unit: str) -> list[str]:
    """Coordinates in words: as many decimals as tell neighbours apart."""
    step = float(np.diff(axis).min()) if len(axis) > 1 else 1.0
    digits = max(decimals(unit, 0), -math.floor(math.log10(step) + 1e-9))
    return [format_number(value, digits) for value in axis]


def _axis(sheet: PlaneSheet, k: int, span: list[float], words: list[str]) -> dict[str, Any]:
    axis = (sheet.u, sheet.v)[k]
    return {
        "letter": sheet.axes[k],
        "at": [round(float(value), 6) for value in axis],
        "said": words,
        "span": span,
        "ticks": said(neat(span[0], span[1], 5)),
    }


def _scale(scale: Scale, dark: bool) -> dict[str, Any]:
    colours = scale.colours(dark)
    low, high = float(colours["cmin"]), float(colours["cmax"])
    ticks = [(float(k), f"joint {j}") for k, j in enumerate(scale.joints)] if scale.kind == "joints" else []
    return {
        "kind": scale.kind,
        "title": scale.title,
        "low": low,
        "high": high,
        "stops": colours["colorscale"],
        "ticks": ticks or said(neat(low, high, 7)),
        "digits": scale.digits,
        "words": ["not reached", "reached"] if scale.kind == "reach" else [words for _, words in ticks],
    }


def _panel(sheet: PlaneSheet, row: int, column: int, panel: PlaneMap, codes: int) -> dict[str, Any]:
    scale = sheet.scales[panel.scale]
    low, high = (float(from_si(end, panel.unit)) for end in (panel.codes.low, panel.codes.high))
    # A map that is one value to its last digit has no lines, whatever its rounding errors are.
    sizes = scale.kind not in ("joints", "reach") and high - low > 2.0 * 10.0**-scale.digits
    most = CONTOURS if len(sheet.panels) < 3 else FEW_CONTOURS
    return {
        "row": row,
        "column": column,
        "title": panel.title,
        "sub": panel.low,
        "codes": codes,
        "low": low if panel.codes.reached else 0.0,
        "high": high if panel.codes.reached else 0.0,
        "scale": list(sheet.scales).index(panel.scale),
        "unit": unit_label(panel.unit),
        "notes": list(panel.notes),
        "slider": panel.slider,
        "contours": said(neat(low, high, most)) if sizes and panel.codes.reached else [],
    }


def _height(sheet: PlaneSheet, ranges: list[list[float]]) -> int:
    """px that the sheet takes where it is ``width`` wide: X and Y to the same scale."""
    rows, columns = len(sheet.rows), max(len(row) for row in sheet.rows)
    bars = sum(scale.kind != "reach" for scale in sheet.scales.values())
    bars = min(bars, 1) if rows > 1 else bars  # over each other
    (u0, u1), (v0, v1) = ranges
    wide = (sheet.width - LEFT - RIGHT * bars - GAP * (columns - 1)) / columns
    high = min(max(wide * (v1 - v0) / (u1 - u0), LEAST_HIGH), sheet.most)
    sliders = SLIDER if len(sheet.w) > 1 else 0
    return round(sliders + rows * (high + CAPTION) + (rows - 1) * GAP + FOOT + LEGEND)
