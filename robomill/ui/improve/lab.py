"""The strategy lab: the same part cut in several ways, side by side on one scale, each with its time and its error."""

from __future__ import annotations

import numpy as np
import streamlit as st

from robomill.arrays import FloatArray
from robomill.improve.advice import Advice, Way
from robomill.improve.remedies import decides
from robomill.report.drawn import Axes, svg
from robomill.report.tags import Html, joined, tag
from robomill.simulation.result import SimulationResult
from robomill.ui.improve.remedies import error_words
from robomill.ui.judged.verdict import WORDS
from robomill.units import format_duration, format_share, from_si, unit_label

WIDE, HIGH = 260, 150  # of a picture
ABOVE = 1.1  # of what is shown: so much room


def multiples(found: Advice, unit: str) -> None:
    """A picture for each way that applies: how far the tip is off over the time at feed."""
    ways = [(way, way.run) for way in found.ways if way.run is not None]
    seen = [_seen(run, unit) for _, run in ways]
    tolerance = float(from_si(found.setup.tolerance, unit))
    top = ABOVE * max([tolerance, *(float(np.nanmax(off, initial=0.0)) for _, off in seen)])
    longest = max(max((float(np.max(t, initial=0.0)) for t, _ in seen), default=0.0), 1e-9)
    axes = Axes(40, 18, WIDE - 48, HIGH - 52, (0.0, longest), (0.0, top))
    cards = [
        _card(way, run, axes, drawn, unit, way is found.best) for (way, run), drawn in zip(ways, seen, strict=True)
    ]
    st.html(tag("div", *cards, class_="rm-lab"))


def _seen(run: SimulationResult, unit: str) -> tuple[FloatArray, FloatArray]:
    """(q,) s at feed and (q,) how far the tip is off across the feed and along its axis, NaN where nothing is judged,
    with a gap where a rapid parts two cuts."""
    at = np.flatnonzero(run.path.cutting)
    off = from_si(np.linalg.norm(run.delta_in_cut[at, 1:], axis=1), unit)
    gap = np.flatnonzero(np.diff(at) > 1) + 1
    t = np.insert(np.asarray(run.path.t[at]), gap, run.path.t[at][gap])
    return t, np.insert(np.where(run.judged[at], off, np.nan), gap, np.nan)


def _card(
    way: Way, run: SimulationResult, axes: Axes, drawn: tuple[FloatArray, FloatArray], unit: str, best: bool
) -> Html:
    said = f"{way.title}: how far the tip is off over the time at feed."
    limit = axes.level(float(from_si(run.setup.tolerance, unit)), "tolerance", "limit")
    picture = [axes.frame("s at feed", f"tip off, {unit_label(unit)}"), limit, axes.line(*drawn, "wall")]
    used = f" · {format_share(way.share)}" if np.isfinite(way.share) else ""
    words = f"{format_duration(way.seconds)} · {error_words(decides(run), unit)}{used}"
    return tag(
        "figure",
        tag("figcaption", tag("b", way.title), joined([tag("span", words), tag("span", WORDS[run.verdict.level])])),
        svg(WIDE, HIGH, said, *picture),
        class_=f"{run.verdict.level}{' rm-best' if best else ''}",
    )
