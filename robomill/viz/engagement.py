"""What pushes back along the path, and how the tool meets the part there."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import plotly.graph_objects as go

from robomill.arrays import FloatArray
from robomill.viz.along import Along
from robomill.viz.theme import axis, palette, rgba

COMPONENTS = ("feed", "feed-normal", "axial")
DASHES = ("dot", "solid", "dash")


@dataclass(frozen=True, eq=False)
class ForceCurves:
    """Along the path: s (m,) in ``unit``; mean (m, 3) N; peak low and high (m, 3); alloy low and high (m, 3) or None.

    Everything is NaN where nothing is cut. ``names`` are the axes of the components.
    """

    s: FloatArray
    mean: FloatArray
    unit: str
    names: tuple[str, str, str] = COMPONENTS
    peak: tuple[FloatArray, FloatArray] | None = None
    alloy: tuple[FloatArray, FloatArray] | None = None


@dataclass(frozen=True, eq=False)
class ArcCurves:
    """Arc of engagement from phi_st to phi_ex (m,) degrees and depth (m,) in ``unit`` against the length cut s (m,)."""

    s: FloatArray
    phi_st: FloatArray
    phi_ex: FloatArray
    depth: FloatArray
    unit: str


def force_figure(curves: ForceCurves, *, dark: bool, height: int = 330, station: float | None = None) -> go.Figure:
    """Mean force by component, the alloy's band around it, the extremes of a revolution as thin lines."""
    p = palette(dark)
    plot = Along.begin(curves.s, curves.unit, "force", dark=dark, height=height)
    for c, (name, colour) in enumerate(zip(curves.names, (p.muted, p.accent, p.warm), strict=True)):
        if curves.alloy is not None:
            plot.shade((curves.alloy[0][:, c], curves.alloy[1][:, c]), "alloy's rows", rgba(colour, 0.18), c == 1)
        for k, extreme in enumerate(curves.peak or ()):
            line = {"color": colour, "width": 1, "dash": "dot"}
            first = c == 1 and k == 0
            plot.curve(extreme[:, c], "peak of a turn", line, legendgroup="peak", showlegend=first)
        plot.curve(curves.mean[:, c], name, {"color": colour, "width": 2.4, "dash": DASHES[c]}, "%{y:+.1f} N")
    plot.zero()
    return plot.done("Force on the tool, N", station)


def engagement_figure(curves: ArcCurves, *, dark: bool, height: int = 320, station: float | None = None) -> go.Figure:
    """The arc as a band from its start to its end, its size, and the depth."""
    p = palette(dark)
    plot = Along.begin(curves.s, curves.unit, "engagement", dark=dark, height=height)
    plot.shade((curves.phi_st, curves.phi_ex), "arc of engagement", rgba(p.warm, 0.18))
    plot.curve(curves.phi_ex - curves.phi_st, "its size", {"color": p.warm, "width": 2}, "%{y:.0f}°")
    line = {"color": p.accent, "width": 2, "dash": "dash"}
    plot.curve(curves.depth, "depth", line, "%{y:.3f} " + curves.unit, yaxis="y2")
    top = float(np.nanmax(curves.depth, initial=0.0)) or 1.0
    depth = {"overlaying": "y", "side": "right", "showgrid": False, "tickmode": "auto", "nticks": 5}
    plot.fig.update_layout(yaxis2=axis(f"Depth, {curves.unit}", dark=dark, range=[0, 1.35 * top], **depth))
    ticks = [0, 45, 90, 135, 180]
    return plot.done("Engagement angle, ° from the left", station, range=[0, 190], tickvals=ticks)
