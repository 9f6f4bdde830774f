"""What pushes back along the path, and how the tool meets the part there."""

import numpy as np

from robomill.arrays import FloatArray
from robomill.cutting.force import ForceSpread
from robomill.simulation.result import SimulationResult
from robomill.simulation.spread import AlloySpread
from robomill.simulation.stations import force_components
from robomill.units import from_si
from robomill.viz.along import Along, at_feed
from robomill.viz.chart import Chart
from robomill.viz.theme import axis, palette, rgba

COMPONENTS = ("feed", "feed-normal", "axial")
DASHES = ("dot", "solid", "dash")


def force_figure(
    result: SimulationResult,
    spread: AlloySpread | None,
    peak: ForceSpread | None,
    unit: str,
    *,
    dark: bool,
    i: int = -1,
) -> Chart:
    """Mean force by component, the alloy's band around it, the extremes of a revolution as thin lines.

    A line stands at sample ``i``.
    """
    p, s = palette(dark), from_si(result.path.s, unit)
    mean, band = at_feed(result, result.force_components), _band(result, spread)
    extremes = () if peak is None else (at_feed(result, peak.low), at_feed(result, peak.high))
    plot = Along.begin(s, unit, "force", dark=dark, height=360)
    for c, (name, colour) in enumerate(zip(COMPONENTS, (p.muted, p.accent, p.warm), strict=True)):
        if band is not None:
            plot.shade((band[0][:, c], band[1][:, c]), "alloy's rows", rgba(colour, 0.18), c == 1)
        for k, extreme in enumerate(extremes):
            line = {"color": colour, "width": 1, "dash": "dot"}
            first = c == 1 and k == 0
            plot.curve(extreme[:, c], "peak of a turn", line, legendgroup="peak", showlegend=first)
        plot.curve(mean[:, c], name, {"color": colour, "width": 2.4, "dash": DASHES[c]}, "%{y:+.1f} N")
    plot.zero()
    if i >= 0:
        plot.station(float(s[i]))
    return plot.done("Force on the tool, N")


def _band(result: SimulationResult, spread: AlloySpread | None) -> tuple[FloatArray, FloatArray] | None:
    if spread is None or len(spread.titles) < 2:
        return None
    rows = force_components(result, spread)
    return at_feed(result, rows.min(axis=0)), at_feed(result, rows.max(axis=0))


def engagement_figure(result: SimulationResult, unit: str, *, dark: bool, i: int = -1) -> Chart:
    """The arc as a band from its start to its end, its size, and the depth; a line at sample ``i``."""
    p, c, s = palette(dark), result.conditions, from_si(result.path.s, unit)
    phi_st, phi_ex = (np.where(c.engaged, from_si(phi, "deg"), np.nan) for phi in (c.phi_st, c.phi_ex))
    depth = np.where(result.path.cutting, from_si(c.a_p, unit), np.nan)
    plot = Along.begin(s, unit, "engagement", dark=dark, height=300)
    plot.shade((phi_st, phi_ex), "arc of engagement", rgba(p.warm, 0.18))
    plot.curve(phi_ex - phi_st, "its size", {"color": p.warm, "width": 2}, "%{y:.0f}°")
    line = {"color": p.accent, "width": 2, "dash": "dash"}
    plot.curve(depth, "depth", line, "%{y:.3f} " + unit, yaxis="y2")
    top = float(np.nanmax(depth, initial=0.0)) or 1.0
    right = {"overlaying": "y", "side": "right", "showgrid": False, "tickmode": "auto", "nticks": 5}
    plot.fig.lay_out(yaxis2=axis(f"Depth, {unit}", dark=dark, range=[0, 1.35 * top], **right))
    if i >= 0:
        plot.station(float(s[i]))
    return plot.done("Engagement angle, ° from the left", range=[0, 190], tickvals=[0, 45, 90, 135, 180])
