"""How the tool meets the part at one place: the dial, seen from the spindle with the feed pointing up."""

from dataclasses import dataclass
from typing import Any

import numpy as np

from robomill.arrays import FloatArray
from robomill.units import format_value
from robomill.viz.chart import Chart
from robomill.viz.theme import arrow, figure, palette, rgba, say


@dataclass(frozen=True, eq=False)
class Dial:
    """One step of the path from above, the feed pointing up.

    phi_st, phi_ex in degrees clockwise from the left of the feed; depth in ``unit``; force (3,) N (feed, feed-normal,
    axial); scale N is the force whose arrow is as long as the cutter's radius; others (r, 3) N what the alloy's other
    rows give; peak (3,) N or None at the worst instant of a turn.
    """

    phi_st: float
    phi_ex: float
    depth: float
    unit: str
    force: FloatArray
    scale: float
    hand: str = "right"
    flutes: int = 2
    engaged: bool = True
    others: FloatArray | None = None
    peak: FloatArray | None = None


def dial_figure(dial: Dial, *, dark: bool, height: int = 320) -> Chart:
    """The cutter as a circle in its material, the arc that cuts, and the mean force as an arrow."""
    p = palette(dark)
    fig = figure(dark=dark, height=height, revision="dial", margin={"l": 4, "r": 4, "t": 6, "b": 4})
    ring = np.linspace(0.0, 2.0 * np.pi, 121)
    if dial.engaged and dial.phi_ex > dial.phi_st:
        _material(fig, dial, dark)
    rim = {"mode": "lines", "line": {"color": p.joint, "width": 1.6}}
    fig.area(np.cos(ring), np.sin(ring), rgba(p.panel, 0.96), **rim)
    if dial.engaged and dial.phi_ex > dial.phi_st:
        _arc(fig, dial, dark)
    _teeth(fig, dial, p.muted)
    _turning(fig, dial, p.muted)
    _forces(fig, dial, dark)
    say(fig, "feed ↑", 0, 1.86, p.muted)
    size = float(np.hypot(*dial.force[:2]))
    words = f"{size:.0f} N across" if dial.engaged or size > 0 else "in air"
    if abs(dial.force[2]) >= 0.05:
        words += f", {abs(dial.force[2]):.0f} N {'into' if dial.force[2] < 0 else 'out of'} the part"
    say(fig, words, 0, -1.72, p.text, size=13)
    fig.lay_out(
        showlegend=False,
        hovermode="closest",
        xaxis={"visible": False, "range": [-1.75, 1.75], "fixedrange": True, "constrain": "domain"},
        yaxis={"visible": False, "range": [-1.95, 2.0], "scaleanchor": "x", "fixedrange": True},
    )
    return fig


def _place(phi_deg: Any, radius: Any = 1.0) -> tuple[FloatArray, FloatArray]:
    """Points on the dial: 0 deg is the left of the feed, 90 straight ahead (up)."""
    phi = np.radians(phi_deg)
    return -np.cos(phi) * radius, np.sin(phi) * radius


def _material(fig: Chart, dial: Dial, dark: bool) -> None:
    """What lies ahead of the cutting arc, hatched as cut metal."""
    p = palette(dark)
    phi = np.linspace(dial.phi_st, dial.phi_ex, 61)
    x, y = _place(phi)
    top = 1.62
    outline_x = np.concatenate([x, [x[-1]], [x[0]], [x[0]]])
    outline_y = np.concatenate([y, [top], [top], [y[0]]])
    hatched = {"shape": "/", "size": 8, "solidity": 0.08, "fgcolor": p.metal_edge, "bgcolor": rgba(p.metal, 0.28)}
    fig.area(outline_x, outline_y, rgba(p.metal, 0.4), fillpattern=hatched)


def _arc(fig: Chart, dial: Dial, dark: bool) -> None:
    p = palette(dark)
    phi = np.linspace(dial.phi_st, dial.phi_ex, 61)
    x, y = _place(phi)
    fig.area(np.concatenate([[0.0], x, [0.0]]), np.concatenate([[0.0], y, [0.0]]), rgba(p.warm, 0.16))
    arc = dial.phi_ex - dial.phi_st
    hover = (
        f"arc {arc:.0f}°, from {dial.phi_st:.0f}° to {dial.phi_ex:.0f}°<br>depth {format_value(dial.depth, dial.unit)}"
    )
    fig.lines(x, y, {"color": p.warm, "width": 5}, name="arc of engagement", hovertemplate=f"{hover}<extra></extra>")
    x, y = _place(0.5 * (dial.phi_st + dial.phi_ex), 1.27)
    say(fig, f"{arc:.0f}°", float(x), float(y), p.warm, size=13, bgcolor=rgba(p.background, 0.75), borderpad=2)


def _teeth(fig: Chart, dial: Dial, colour: str) -> None:
    turn = 1 if dial.hand == "right" else -1
    for tooth in range(dial.flutes):
        phi = 20.0 + turn * 360.0 * tooth / dial.flutes
        x, y = zip(_place(phi, 0.72), _place(phi, 1.0), strict=True)
        fig.lines(x, y, {"color": colour, "width": 2}, hoverinfo="skip")


def _turning(fig: Chart, dial: Dial, colour: str) -> None:
    """An arrow for the sense of turning: clockwise seen from the spindle for a right-hand cutter."""
    turn = 1.0 if dial.hand == "right" else -1.0
    phi = 250.0 + turn * np.linspace(-24, 24, 25)
    x, y = _place(phi, 1.17)
    fig.lines(x, y, {"color": colour, "width": 1.4}, hoverinfo="skip")
    arrow(fig, (x[-3], y[-3]), (x[-1], y[-1]), colour, 1.4)


def _forces(fig: Chart, dial: Dial, dark: bool) -> None:
    p = palette(dark)
    scale = dial.scale or 1.0
    if dial.others is not None and len(dial.others):
        ring = {"size": 8, "color": rgba(p.accent, 0.35), "line": {"width": 1.2, "color": p.accent}}
        said = {"name": "the alloy's other rows", "hovertemplate": "another row of the alloy<extra></extra>"}
        fig.dots(-dial.others[:, 1] / scale, dial.others[:, 0] / scale, ring, **said)
    for force, colour, width in ((dial.peak, rgba(p.accent, 0.45), 2), (dial.force, p.accent, 3.4)):
        if force is not None and float(np.hypot(force[0], force[1])) >= 1e-9:
            arrow(fig, (0.0, 0.0), (-force[1] / scale, force[0] / scale), colour, width)
    fig.dots([0], [0], {"size": 6, "color": p.joint}, hoverinfo="skip")
