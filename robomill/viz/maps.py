"""Colour scales of maps, and a level of a map with its axes.

One rule: dark is stiff, or able; bright is soft, or near what the arm cannot do. Compliance runs through cividis, what
the arm is able to through a single hue of its own.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any, Literal

import numpy as np

from robomill.arrays import FloatArray
from robomill.units import UNITS, from_si, unit_label
from robomill.viz.theme import ABLE, SEQUENTIAL, diverging, joint_colours, palette
from robomill.workspace.grid import Grid
from robomill.workspace.quantities import Colours, MapQuantity


@dataclass(frozen=True)
class Scale:
    """A colour scale that one or more maps share, in display units.

    kind: "diverging" is symmetric about zero (signed values), "sequential" runs from low to high (sizes), "able" from
    small to large sizes of what one wants much of, "joints" has one colour a joint, "reach" one for what is reached.
    """

    title: str
    low: float
    high: float
    kind: Colours | Literal["able"] = "sequential"
    joints: tuple[int, ...] = ()
    digits: int = 3

    @classmethod
    def of(cls, what: MapQuantity, values: FloatArray, joints: tuple[int, ...], unit: str = "") -> Scale:
        """The scale of a quantity from its values in ``unit``, its own where none is said: centred on zero where both
        signs occur."""
        unit = unit or what.unit
        seen = values[np.isfinite(values)]
        low, high = (float(seen.min()), float(seen.max())) if len(seen) else (0.0, 1.0)
        kind: Any = what.colours
        if kind in ("sequential", "diverging") and not (kind == "diverging" and low < 0 < high):
            kind = "able" if what.able else "sequential"
        title = f"{what.title}, {unit_label(unit)}" if unit_label(unit) else what.title
        return cls(title, low, high, kind, joints, UNITS[unit].digits)

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
        stops = SEQUENTIAL
        if self.kind == "able":  # by size: where all is below zero, the lowest value is the largest
            stops = ABLE if self.high > 0 else [[share, ABLE[-1 - k][1]] for k, (share, _) in enumerate(ABLE)]
        return {"colorscale": stops, "cmin": self.low, "cmax": high}


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
    """Panels in rows over one plane: u (nu,) across and v (nv,) upwards, in display units."""

    rows: Panels
    u: FloatArray
    v: FloatArray
    u_title: str
    v_title: str
    scales: dict[str, Scale] = field(default_factory=dict)

    @classmethod
    def over(cls, rows: Panels, grid: Grid, normal: str, unit: str, scales: dict[str, Scale]) -> MapSheet:
        """Panels over the cells of a plane, lengths in ``unit``."""
        across, upwards = (a for a in "xyz" if a != normal)
        u, v = (from_si(getattr(grid, a), unit) for a in (across, upwards))
        u_title, v_title = (f"{a.upper()}<sub>M</sub>, {unit_label(unit)}" for a in (across, upwards))
        return cls(rows, u, v, u_title, v_title, scales)


def symmetric_limit(values: Sequence[FloatArray]) -> float:
    """The largest size over several maps, for a scale centred on zero; 1 where nothing is reached."""
    tops = [float(np.nanmax(np.abs(v))) for v in values if np.isfinite(v).any()]
    return max(tops, default=1.0) or 1.0


def whole_cells(points: FloatArray) -> list[float]:
    """From half a cell before the first point to half a cell after the last one."""
    half = 0.5 * float(np.diff(points).min()) if len(points) > 1 else 0.5
    return [float(points[0] - half), float(points[-1] + half)]
