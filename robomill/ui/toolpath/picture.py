"""The path as a picture: coloured by what was asked, seen from above, turned, or with the arm."""

from collections.abc import Mapping
from functools import lru_cache, partial
from typing import Any

import numpy as np
import streamlit as st

from robomill.arrays import FloatArray, IntArray
from robomill.simulation.edges import edge_notes
from robomill.simulation.reach import PathReach
from robomill.simulation.result import SimulationResult
from robomill.simulation.setup import SimulationSetup
from robomill.simulation.stations import nearest_judged
from robomill.simulation.tools import cutting_numbers
from robomill.ui import pieces, session
from robomill.ui.entry import inputs
from robomill.ui.posed.arm import arm_at
from robomill.ui.toolpath.program_view import select_line, selected_line
from robomill.ui.toolpath.summary import path_summary
from robomill.units import decimals, from_si, unit_label
from robomill.viz.path_picture import BUDGET, PathPicture, decimate
from robomill.viz.toolpath import plan_picture, turnable_picture

COLOURS = {
    "reach": "Reach",
    "deviation": "Deviation",
    "limits": "Room to limits",
    "feed": "Feed",
    "depth": "Height",
    "tool": "Tool",
}
SHAPES = {"plan": "From above", "turn": "Turnable", "arm": "With the arm"}


def path_figure(setup: SimulationSetup, reach: PathReach, result: SimulationResult | None, dark: bool) -> None:
    """The choices and the picture; beside the drawing board a lower one."""
    unit, height = session.project().view.length, 300 if setup.source.kind == "sketch" else 380
    judged = result is not None and bool(result.judged.any())  # else there is no deviation that could be coloured
    colour, seen = _choices(result is not None, judged, len(cutting_numbers(reach.path)) > 1)
    key = f"toolpath.{seen}"
    if seen == "arm" and result is not None:
        index = result.worst if result.worst >= 0 else nearest_judged(result, 0.0)
        pieces.note("The arm where the tip is farthest off its path.")
        arm_at(result, index, key, height, zoom=0.85)
        return
    picture = _picture(setup, reach, result, colour, unit)
    thinned = f" {picture.caption}" if picture.caption else ""
    if seen == "turn":
        figure, times = turnable_picture(picture, dark=dark, height=height)
        caption, alt = f"Heights shown × {times:g}, parallel projection.", "The path in space, to be turned."
    else:
        figure = plan_picture(picture, dark=dark, height=height)
        caption = "From above; a click shows the line."
        alt = "The path from above."
    pieces.figure(
        figure,
        key,
        name="toolpath",
        table=lambda: _columns(reach, result),
        on_pick=None if seen == "turn" else _point_at,
        caption=caption + thinned,
        alt=alt,
    )


def _choices(simulated: bool, judged: bool, several: bool) -> tuple[str, str]:
    """What the path is coloured by (by its deviation where some of it is ``judged``, by tool where there are
    ``several``), and from where it is seen."""
    left_out = {"deviation": not judged, "tool": not several}
    colours = {k: f"Coloured by {v.lower()}" for k, v in COLOURS.items() if not left_out.get(k, False)}
    shapes = {k: v for k, v in SHAPES.items() if simulated or k != "arm"}
    with st.container(horizontal=True, horizontal_alignment="distribute", vertical_alignment="center", gap="small"):
        with st.container(width="content"):
            seen = inputs.pick("Seen", "toolpath.seen", shapes, look=inputs.HIDDEN)
        with st.container(width=210):
            look = inputs.Look(listed=True, hidden=True)
            usual = "deviation" if judged else "reach"
            colour = inputs.pick("Coloured by", "toolpath.colour", colours, usual, look)
    return str(colour), str(seen)


def _picture(
    setup: SimulationSetup, reach: PathReach, result: SimulationResult | None, colour: str, unit: str
) -> PathPicture:
    """The path as it is drawn, in display units."""
    use = result if result is not None and colour == "deviation" else None
    path = use.path if use is not None else reach.path
    more: dict[str, Any] = {}
    if use is not None:
        more = {
            "value": from_si(use.deviation, unit),
            "title": "Deviation of the tip",
            "unit": unit_label(unit),
            "worst": use.worst,
            "limit": float(from_si(setup.tolerance, unit)),
            "digits": decimals(unit, None),
        }
    elif colour == "limits":
        more = {"value": from_si(reach.room, "%"), "title": "Room to the nearest limit", "unit": "%", "digits": 1}
    elif colour == "feed":
        feed = session.project().view.feed
        more = {"value": from_si(path.v_f, feed), "title": "Feed", "unit": unit_label(feed), "digits": 1}
    elif colour == "depth":
        z = from_si(path.p[:, 2], unit)
        more = {"value": z - float(z.min()), "title": "Height above the deepest point", "unit": unit_label(unit)}
    elif colour == "tool":
        names = {n: setup.tools.called(n) for n in cutting_numbers(path).tolist()}
        more = {"tools": path.tool, "tool_names": names}
    stock = setup.stock_block
    return PathPicture(
        points=from_si(path.p, unit),
        cutting=path.cutting,
        block=path.block,
        length_unit=unit_label(unit),
        reached=use.reached if use is not None else reach.reached,
        selected=selected_line(),
        noun=setup.source.block_name,
        stock=(from_si(stock.lower, unit), from_si(stock.upper, unit)),
        total=len(setup.toolpath) - 1,
        indices=_kept(use if use is not None else reach),
        **more,
    )


@lru_cache(maxsize=6)
def _kept(drawn: PathReach | SimulationResult) -> IntArray:
    """Which points are drawn, found once for each path."""
    path = drawn.path
    must = [drawn.worst] if isinstance(drawn, SimulationResult) and drawn.worst >= 0 else []
    return decimate(path.p, path.cutting, drawn.reached, BUDGET, must)


def _point_at(point: Mapping[str, Any]) -> None:
    """A click on the path points at its line."""
    data = point.get("customdata")
    if data is not None:
        select_line(int(data["0"] if isinstance(data, dict) else data[0]))


def _columns(reach: PathReach, result: SimulationResult | None) -> dict[str, FloatArray]:
    """The numbers behind the picture."""
    path = reach.path
    columns = {"line": path.block.astype(float), "cutting": path.cutting.astype(float)}
    for i, axis in enumerate("xyz"):
        columns[f"{axis}_W_mm"] = from_si(path.p[:, i], "mm")
    columns |= {
        "feed_mm_min": from_si(path.v_f, "mm/min"),
        "feed_mm_s": from_si(path.v_f, "mm/s"),
        "reached": reach.reached.astype(float),
        "limit_distance_percent": from_si(reach.room, "%"),
    }
    if result is not None and len(result.path) == len(path):
        columns["deviation_mm"] = from_si(result.deviation, "mm")
    return columns


def stock_note(setup: SimulationSetup) -> None:
    """Where a stated stock does not hold the path, or leaves no wall beside it, say so and offer the stock that
    does."""
    if setup.stock is None:
        return
    odd = _outside(setup) or "".join(each.sentence for each in edge_notes(setup, setup.toolpath))
    if not odd:
        return
    with st.container(horizontal=True, vertical_alignment="center", gap="small"):
        pieces.note(odd)
        follow = partial(session.change, stock=None)
        inputs.button("Let the stock follow the path", "toolpath.stock", "fit_screen", follow, type="tertiary")


def _outside(setup: SimulationSetup) -> str:
    """That a stated stock does not hold the path; "" where it does."""
    assert setup.stock is not None
    summary = path_summary(setup.toolpath)
    low, high = summary.low, summary.high
    room = 1e-6 + np.array([setup.cutter.radius, setup.cutter.radius, np.inf])
    beside = np.maximum(setup.stock.lower - low - room, high - setup.stock.upper - room)
    below = float(setup.stock.lower[2] - low[2])
    leaves = max(float(beside[:2].max()), below) > 1e-6
    return "The path leaves the stock that is stated: what lies outside cuts air." if leaves else ""
