"""What the toolpath page says first and draws: one sentence, tiles, the path coloured by what was asked."""

from __future__ import annotations

from functools import lru_cache
from typing import Any

import numpy as np
import streamlit as st

from robomill.arrays import FloatArray, IntArray
from robomill.simulation.result import SimulationResult
from robomill.simulation.setup import SimulationSetup
from robomill.toolpath.path import Toolpath
from robomill.toolpath.source import PathSource
from robomill.ui import cached, pieces, session
from robomill.ui.toolpath.details import duration, finding_words, move_words, worst_first, written_in
from robomill.ui.toolpath.program_view import select_line, selected_line
from robomill.ui.toolpath.reach import PathReach
from robomill.ui.toolpath.summary import missed_blocks, path_summary
from robomill.units import (
    format_count,
    format_many,
    format_percent,
    format_short_count,
    format_si,
    format_value,
    from_si,
    unit_label,
)
from robomill.viz.path_picture import BUDGET, PathPicture, decimate

AUTO_SAMPLES = 60_000
ASKED = "toolpath.asked"
COLOUR, SHAPE = "toolpath.colour", "toolpath.shape"
COLOURS = {"reach": "Reach", "deviation": "Deviation", "limits": "Room to limits", "feed": "Feed", "depth": "Height"}
SHAPES = {"plan": "From above", "turn": "Turnable", "arm": "With the arm"}

NOUNS = {"program": "cut", "lines": "cut", "sketch": "shape"}
PLACES = {"program": "line", "lines": "row", "sketch": "shape"}


def samples(setup: SimulationSetup) -> int:
    """About how many points a simulation of this path has."""
    path = setup.toolpath
    return int(len(path) + float(path.s[-1]) / setup.step)


def simulated(setup: SimulationSetup) -> SimulationResult | None:
    """The run of this set-up: at once where it is short, on demand where it is long. Raises its refusal."""
    if samples(setup) <= AUTO_SAMPLES and not setup.engagement:
        return cached.result(setup)
    if st.session_state.get(ASKED) == setup.digest():
        with st.spinner(f"Simulating about {format_short_count(samples(setup))} points …", show_time=True):
            return cached.result(setup)
    return None


def ask_button(setup: SimulationSetup) -> None:
    """The button that simulates a long path."""
    count = samples(setup)
    words = "the engagement is found step by step" if setup.engagement else f"about {format_short_count(count)} points"
    with st.container(horizontal=True, vertical_alignment="center", gap="small"):
        if st.button("Simulate", icon=":material/play_arrow:", type="primary", key="toolpath.simulate"):
            st.session_state[ASKED] = setup.digest()
            st.rerun()
        pieces.note(f"Not simulated yet: {words}. Until then the path is coloured by reach.")


def headline(
    source: PathSource, path: Toolpath | None, reach: PathReach | None, result: SimulationResult | None, unit: str
) -> None:
    """Whether the path can be reached and how far off it is; beneath, what was read.

    Always two lines, so that the board beneath does not move while one draws.
    """
    name, noun = source.name, source.kind
    if path is None:
        pieces.headline(f"Toolpath · {name}", "There is no path yet.", "Draw one, or take a ready-made sketch.")
        return
    summary = path_summary(path)
    size = format_many(summary.high - summary.low, unit, 1 if unit == "mm" else 2, " × ")
    lead = f"{format_count(summary.blocks, NOUNS[noun])} within {size}."
    if source.kind == "program":
        lead = f"{written_in(source, path)} · {move_words(path)} · {lead}"
    pieces.headline(f"Toolpath · {name}", verdict(reach, result, unit, noun), lead)


def verdict(reach: PathReach | None, result: SimulationResult | None, unit: str, noun: str) -> str:
    """The page's one sentence."""
    if reach is None:
        return "The path was read; the arm was not asked."
    missed, length, _ = missed_blocks(reach)
    if missed:
        return f"{format_si(length, unit, 1)} of the cut cannot be reached."
    if result is None or result.worst < 0:
        return "The arm reaches all of the path."
    worst = format_si(result.max_deviation, unit, 2 if unit == "mm" else 4)
    return f"All in reach; at most {worst} off, at {PLACES[noun]} {result.worst_block:,}."


def tiles(
    path: Toolpath | None, reach: PathReach | None, result: SimulationResult | None, unit: str, noun: str
) -> None:
    """Length and time, reach, deviation, findings."""
    if path is None:
        pieces.tiles([pieces.Tile(label, "–") for label in ("At feed", "Reach", "Max deviation", "Shapes")])
        return
    summary = path_summary(path)
    rapids = summary.moves - summary.cuts if path.counts is None else path.counts[0]
    found = [
        pieces.Tile(
            "At feed",
            format_si(float(path.s[-1]), unit, 1 if unit == "mm" else 2),
            f"{duration(float(path.t[-1]))} · {move_words(path)}, {rapids:,} rapid",
        )
    ]
    if reach is None:
        found.append(pieces.Tile("Reach", "not computed"))
    else:
        missed, _, lost = missed_blocks(reach)
        blocks = lost.tolist()
        share = 1.0 - missed / max(path_summary(reach.path).cuts, 1)
        named = ", ".join(f"{b:,}" for b in blocks[:3]) + (" …" if len(blocks) > 3 else "")
        words = f"out of reach at {PLACES[noun]} {named}" if blocks else "of the cut, within the joint limits"
        # Rounded down: what is not all of it must not read 100 %.
        found.append(
            pieces.Tile("Reach", format_value(np.floor(share * 100), "%", 0), words, tone="out" if blocks else "ok")
        )
    found.append(_deviation_tile(result, unit, noun))
    if noun != "program":
        words = "cut in this order" if summary.blocks > 1 else "one cut"
        found.append(pieces.Tile({"sketch": "Shapes", "lines": "Rows"}[noun], f"{summary.blocks:,}", words))
        pieces.tiles(found)
        return
    alarming = sum(f.count for f in path.findings if f.level in ("error", "warning", "suspicious"))
    count = sum(f.count for f in path.findings)
    words = finding_words(worst_first(path.findings)[0]) if count else "every word understood"
    found.append(pieces.Tile("Findings", f"{count:,}", words, tone="tight" if alarming else ""))
    pieces.tiles(found)


def _deviation_tile(result: SimulationResult | None, unit: str, noun: str) -> pieces.Tile:
    if result is None:
        return pieces.Tile("Max deviation", "–", "not simulated yet")
    if result.worst < 0:
        return pieces.Tile("Max deviation", "–", "nothing was reached")
    tone = {"ok": "ok", "tight": "tight"}.get(result.verdict.level, "out")
    return pieces.Tile(
        "Max deviation",
        format_si(result.max_deviation, unit, 3 if unit == "mm" else 4),
        f"{PLACES[noun]} {result.worst_block:,} · {format_percent(result.verdict.share)} of the tolerance",
        tone=tone,
        kind="computed",
    )


def picture_choices(has_result: bool) -> tuple[str, str]:
    """What the path is coloured by, and from where it is seen."""
    colours = COLOURS if has_result else {k: v for k, v in COLOURS.items() if k != "deviation"}
    shapes = SHAPES if has_result else {k: v for k, v in SHAPES.items() if k != "arm"}
    if st.session_state.get(COLOUR) not in colours:
        st.session_state[COLOUR] = "deviation" if has_result else "reach"
    if st.session_state.get(SHAPE) not in shapes:
        st.session_state[SHAPE] = "plan"
    with st.container(horizontal=True, horizontal_alignment="distribute", vertical_alignment="center", gap="small"):
        shape = st.segmented_control(
            "Seen",
            list(shapes),
            key=SHAPE,
            format_func=lambda k: shapes[k],
            required=True,
            label_visibility="collapsed",
        )
        colour = st.selectbox(
            "Coloured by",
            list(colours),
            key=COLOUR,
            format_func=lambda k: f"Coloured by {colours[k].lower()}",
            label_visibility="collapsed",
            width=210,
        )
    return str(colour), str(shape)


def picture(
    setup: SimulationSetup, reach: PathReach, result: SimulationResult | None, colour: str, unit: str
) -> PathPicture:
    """The path as it is drawn, in display units."""
    use = result if result is not None and colour == "deviation" else None
    path = use.path if use is not None else reach.path
    more: dict[str, Any] = {}
    if use is not None:
        limit = float(from_si(setup.tolerance, unit))
        more = {
            "value": from_si(use.deviation, unit),
            "title": "Deviation",
            "unit": unit_label(unit),
            "worst": use.worst,
            "limit": limit,
            "digits": 4 if unit == "in" else 3,
        }
    elif colour == "limits":
        more = {"value": from_si(reach.room, "deg"), "title": "Room to the nearest limit", "unit": "°", "digits": 1}
    elif colour == "feed":
        feed = session.project().view.feed
        more = {"value": from_si(path.v_f, feed), "title": "Feed", "unit": unit_label(feed), "digits": 1}
    elif colour == "depth":
        z = from_si(path.p[:, 2], unit)
        more = {"value": z - float(z.min()), "title": "Height above the deepest point", "unit": unit_label(unit)}
    stock = setup.stock_block
    return PathPicture(
        points=from_si(path.p, unit),
        cutting=path.cutting,
        block=path.block,
        length_unit=unit_label(unit),
        reached=use.reached if use is not None else reach.reached,
        selected=selected_line(),
        noun=PLACES[setup.source.kind],
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


def take_pick(key: str) -> None:
    """A click on the path points at its line."""
    picked = st.session_state.get(key)
    points = picked["selection"]["points"] if picked else []
    if points and points[0].get("customdata") is not None:
        data = points[0]["customdata"]
        select_line(int(data["0"] if isinstance(data, dict) else data[0]))


def path_columns(reach: PathReach, result: SimulationResult | None) -> dict[str, FloatArray]:
    """The numbers behind the picture."""
    path = reach.path
    columns = {"line": path.block.astype(float), "cutting": path.cutting.astype(float)}
    for i, axis in enumerate("xyz"):
        columns[f"{axis}_W_mm"] = from_si(path.p[:, i], "mm")
    columns |= {
        "feed_mm_min": from_si(path.v_f, "mm/min"),
        "feed_mm_s": from_si(path.v_f, "mm/s"),
        "reached": reach.reached.astype(float),
        "room_to_limits_deg": from_si(reach.room, "deg"),
    }
    if result is not None and len(result.path) == len(path):
        columns["deviation_mm"] = from_si(result.deviation, "mm")
    return columns


def stock_note(setup: SimulationSetup) -> None:
    """Where a stated stock does not hold the path, say so and offer the stock that does."""
    if setup.stock is None:
        return
    summary = path_summary(setup.toolpath)
    low, high = summary.low, summary.high
    room = 1e-6 + np.array([setup.cutter.radius, setup.cutter.radius, np.inf])
    beside = np.maximum(setup.stock.lower - low - room, high - setup.stock.upper - room)
    below = float(setup.stock.lower[2] - low[2])
    if max(float(beside[:2].max()), below) <= 1e-6:
        return
    with st.container(horizontal=True, vertical_alignment="center", gap="small"):
        pieces.note("The path leaves the stock that is stated: what lies outside cuts air.")
        st.button(
            "Let the stock follow the path",
            key="stock.follow",
            icon=":material/fit_screen:",
            type="tertiary",
            on_click=lambda: session.change(stock=None),
        )
