"""Deviation along the path: by component, by joint, with its band, and by two methods."""

from collections.abc import Sequence

import numpy as np

from robomill.arrays import FloatArray
from robomill.simulation.result import SimulationResult
from robomill.units import format_limit, from_si
from robomill.viz.along import Along, add_band, at_feed
from robomill.viz.chart import Chart
from robomill.viz.theme import axis_colours, hover, joint_colours, palette, rgba, say

DASHES = {"x": "dot", "y": "solid", "z": "dash"}


def components_figure(result: SimulationResult, unit: str, *, dark: bool, i: int = -1) -> Chart:
    """The deviation's size and components; a line at sample ``i``."""
    p = palette(dark)
    s, delta = from_si(result.path.s, unit), from_si(at_feed(result, result.delta), unit)
    tolerance = float(from_si(result.setup.tolerance, unit))
    plot = Along.begin(s, unit, "components", dark=dark, height=330, keep=[max(result.worst, 0)])
    below = {"fill": "tozeroy", "fillcolor": rgba(p.text, 0.05)}
    plot.curve(np.linalg.norm(delta, axis=1), "size", {"color": p.text, "width": 2.4}, hover(unit, sign=False), **below)
    for column, (name, colour) in enumerate(axis_colours(dark).items()):
        line = {"color": colour, "width": 2, "dash": DASHES[name]}
        lines = result.path.block[plot.chosen]
        plot.curve(delta[:, column], f"δ<sub>{name.upper()}</sub>", line, hover(unit), customdata=lines)
    for side in (1, -1) if np.nanmin(delta, initial=0.0) < -0.6 * tolerance else (1,):
        plot.level(side * tolerance, p.muted, "solid")
    words = f"tolerance of the surface {format_limit(result.setup.tolerance, unit)}"
    say(plot.fig, words, 1, tolerance, p.muted, xref="paper", xanchor="right", yshift=9)
    plot.zero()
    if i >= 0:
        plot.station(float(s[i]), "station")
    return plot.done(f"Deviation in {{M}}, {unit}")


def shares_figure(result: SimulationResult, component: str, unit: str, *, dark: bool, i: int = -1) -> Chart:
    """Shares of a ``component`` ("x", "y", "z") by joint and spring, stacked; a line at sample ``i``.

    What pushes the tip up stands above zero, what pulls it back below.
    """
    p, column = palette(dark), "xyz".index(component)
    s, seen = from_si(result.path.s, unit), hover(unit)
    every = np.concatenate([result.delta_joint[:, :, column], result.delta_spring[:, :, column]], axis=1)
    named = [f"joint {n}" for n in result.setup.robot.joint_numbers] + [s.name for s in result.setup.springs]
    if result.ahead is not None:
        every, named = np.column_stack([every, result.ahead[:, column]]), [*named, "corrected program"]
    plot = Along.begin(s, unit, f"shares-{component}", dark=dark, height=320)
    shares, names, order = _without_the_small(from_si(at_feed(result, every), unit), named)
    for j, name in enumerate(names):
        colour = joint_colours(7, dark)[order[j] % 7] if order[j] >= 0 else p.muted
        said = False
        for sign, stack in ((1, "up"), (-1, "down")):
            part = np.where(np.sign(np.nan_to_num(shares[:, j])) == sign, shares[:, j], 0.0)
            if np.any(part[plot.chosen]):  # a joint that pushes both ways has two areas and needs one name
                area = {"stackgroup": stack, "fillcolor": rgba(colour, 0.78), "legendgroup": name}
                plot.curve(part, name, {"width": 0.6, "color": colour}, seen, showlegend=not said, **area)
                said = True
    total = from_si(at_feed(result, result.delta), unit)[:, column]
    plot.curve(total, "total", {"color": p.text, "width": 2.2}, seen)
    plot.zero()
    if i >= 0:
        plot.station(float(s[i]), "station")
    return plot.done(f"Share of δ<sub>{component.upper()}</sub>, {unit}")


def band_figure(
    curves: tuple[FloatArray, FloatArray, FloatArray, FloatArray], component: str, unit: str, *, dark: bool
) -> Chart:
    """Length cut, value, half width of its band, and what the project has now (dashed), each (m,) in ``unit``.

    ``component`` is "x", "y", "z", or "" for the size.
    """
    p, (s, value, half, now) = palette(dark), curves
    symbol = f"δ<sub>{component.upper()}</sub>" if component else "size"
    plot = Along.begin(s, unit, f"band-{component}", dark=dark, height=320)
    add_band(plot.fig, s, value, half, component, dark=dark)
    if plot.fig.traces:
        plot.fig.traces[0]["showlegend"] = True
    plot.curve(now, "project now", {"color": p.muted, "width": 1.6, "dash": "dash"}, hover(unit))
    line = {"color": axis_colours(dark).get(component, p.text), "width": 2.4}
    seen = f"{hover('±')} {hover(unit, sign=False, axis='customdata')}"
    plot.curve(value, f"{symbol}, load tests", line, seen, customdata=half[plot.chosen])
    return plot.done(f"Deviation {symbol} in {{M}}, {unit}")


def both_figure(s: FloatArray, by_map: FloatArray, by_joints: FloatArray, unit: str, *, dark: bool) -> Chart:
    """Size of the deviation along the path (m,) by the measured map and by the joint model, in ``unit``."""
    p = palette(dark)
    plot = Along.begin(s, unit, "both", dark=dark, height=280)
    plot.curve(by_map, "measured map", {"color": p.warm, "width": 2.4}, hover(unit, sign=False))
    plot.curve(by_joints, "joint model", {"color": p.accent, "width": 2.2, "dash": "dash"}, hover(unit, sign=False))
    return plot.done(f"Deviation, {unit}", rangemode="tozero")


def _without_the_small(shares: FloatArray, names: Sequence[str]) -> tuple[FloatArray, list[str], list[int]]:
    """Shares under 1 % of the largest as one "others"; the third value keeps each joint's own colour."""
    size = np.nanmax(np.abs(shares), axis=0, initial=0.0, where=np.isfinite(shares))
    large = size >= 0.01 * max(float(size.max(initial=0.0)), 1e-300)
    kept = np.flatnonzero(large)
    if large.all() or not large.any():
        return shares, list(names), list(range(len(names)))
    rest = shares[:, ~large].sum(axis=1, keepdims=True)
    label = f"{', '.join(name for name, big in zip(names, large, strict=True) if not big)} (under 1 %)"
    return np.hstack([shares[:, large], rest]), [*(names[int(j)] for j in kept), label], [*kept.tolist(), -1]
