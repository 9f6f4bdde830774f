"""What pushes back along the path, and how the tool meets the part there."""

import numpy as np

from robomill.arrays import FloatArray
from robomill.cutting.force import COMPONENTS, ForceSpread
from robomill.simulation.origin.spread import AlloySpread
from robomill.simulation.result import SimulationResult
from robomill.units import from_si
from robomill.viz.along import Along, at_feed
from robomill.viz.chart import Chart
from robomill.viz.theme import axis, palette, rgba

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
    """Size of the mean force and one band: the alloy's other rows, else up to the peak of a revolution. Its components
    are in the key and come with a click on their names.

    A line stands at sample ``i``.
    """
    p, s = palette(dark), from_si(result.path.s, unit)
    mean = at_feed(result, result.force_components)
    plot = Along.begin(s, unit, "force", dark=dark, height=320)
    band, name = _band(result, spread, peak)
    if band is not None:
        plot.shade(band, name, rgba(p.accent, 0.18))
    plot.curve(np.linalg.norm(mean, axis=1), "mean force", {"color": p.accent, "width": 2.4}, "%{y:.1f} N")
    for c, component in enumerate(COMPONENTS.values()):
        line = {"color": p.text, "width": 1.6, "dash": DASHES[c]}
        plot.curve(mean[:, c], component, line, "%{y:+.1f} N", visible="legendonly")
    plot.zero()
    if i >= 0:
        plot.station(float(s[i]))
    return plot.done("Force on the tool, N")


def _band(
    result: SimulationResult, spread: AlloySpread | None, peak: ForceSpread | None
) -> tuple[tuple[FloatArray, FloatArray] | None, str]:
    """Between which sizes the force may lie, and by what."""
    if spread is not None and len(spread.titles) > 1:
        sizes = np.linalg.norm(spread.F, axis=2)
        low, high, name = sizes.min(axis=0), sizes.max(axis=0), "range over published coefficients"
    elif peak is not None:
        low, high, name = result.force_size, np.linalg.norm(peak.at_peak, axis=1), "to the peak of a turn"
    else:
        return None, ""
    return (at_feed(result, low[:, None])[:, 0], at_feed(result, high[:, None])[:, 0]), name


def engagement_figure(result: SimulationResult, unit: str, *, dark: bool, i: int = -1) -> Chart:
    """The arc as a band from its start to its end, its size, and the depth; a line at sample ``i``."""
    p, c, s = palette(dark), result.conditions, from_si(result.path.s, unit)
    phi_st, phi_ex = (np.where(c.engaged, from_si(phi, "deg"), np.nan) for phi in (c.phi_st, c.phi_ex))
    depth = np.where(result.path.cutting, from_si(c.a_p, unit), np.nan)
    plot = Along.begin(s, unit, "engagement", dark=dark, height=300)
    plot.shade((phi_st, phi_ex), "arc of engagement", rgba(p.text, 0.12))
    plot.curve(phi_ex - phi_st, "its size", {"color": p.text, "width": 2}, "%{y:.0f}°")
    line = {"color": p.accent, "width": 2, "dash": "dash"}
    plot.curve(depth, "depth", line, "%{y:.3f} " + unit, yaxis="y2")
    top = float(np.nanmax(depth, initial=0.0)) or 1.0
    right = {"overlaying": "y", "side": "right", "showgrid": False, "tickmode": "auto", "nticks": 5}
    plot.fig.lay_out(yaxis2=axis(f"Depth, {unit}", dark=dark, range=[0, 1.35 * top], **right))
    if i >= 0:
        plot.station(float(s[i]))
    return plot.done("Engagement angle, ° from the left", range=[0, 190], tickvals=[0, 45, 90, 135, 180])
