"""One scrubber for everything: code line, arm, engagement and force, the point on the curve, the section."""

import html
from collections.abc import Mapping
from functools import partial
from typing import Any

import numpy as np
import streamlit as st

from robomill.simulation.origin.spread import AlloySpread
from robomill.simulation.result import SimulationResult
from robomill.simulation.stations import move_at, nearest_judged
from robomill.ui import pieces, session
from robomill.ui.judged import uncertainty
from robomill.units import format_many, from_si
from robomill.viz.along import add_picks, add_point, at_feed, shade
from robomill.viz.deviation import components_figure
from robomill.viz.theme import palette, rgba

MAX_HOVERED = 100_000


def station_m(result: SimulationResult) -> float:
    """The station, m of length cut."""
    return session.project().view.station * float(result.path.s[-1])


def index(result: SimulationResult) -> int:
    """The sample that the scrubber points at; -1 where none counts for the verdict."""
    return nearest_judged(result, station_m(result))


def where(result: SimulationResult, i: int, spread: AlloySpread | None) -> None:
    """One line beneath the scrubber, which says how far the tip is off there: program line, tool, place, and between
    which ends the alloy's rows lie."""
    unit = session.project().view.length
    if i < 0:
        how = "reached" if not result.reached[result.path.cutting].any() else "judged: the headline says why"
        pieces.note(f"Nothing of this cut can be {how}.")
        return
    point = format_many(result.path.p[i], unit, 2, with_unit=False)
    here, line = move_at(result, station_m(result)), f"line {result.path.block[i]}"
    words = [f"<b>{line[0].upper()}{line[1:]}</b>", f"the tip stands at ({point}) {unit} in {{W}}"]
    if not result.judged[here]:  # the picture tells of the move that is made there; what follows, of the nearest judged
        why = "is not judged here" if result.reached[here] else "is not reached here"
        words[0] = f"<b>Line {result.path.block[here]}</b> {why}; what follows is of the nearest point that is, {line}"
    if between := _range(spread, i, unit):
        words.append(f"tip off by {between}")
    if result.setup.tools:
        words.insert(1, html.escape(result.setup.tools.called(int(result.path.tool[i]))))
    st.html(f'<p class="rm-lead" style="font-size:.95rem">{" · ".join(words)}</p>')


def _range(spread: AlloySpread | None, i: int, unit: str) -> str:
    if spread is None or len(spread.titles) < 2:
        return ""
    low, high = float(spread.deviation[:, i].min()), float(spread.deviation[:, i].max())
    return f"{format_many((low, high), unit, between=' to ')} by published coefficients"


def deviation_plot(result: SimulationResult, i: int, spread: AlloySpread | None, dark: bool) -> None:
    """Deviation by component with its band; a click on the curve moves the scrubber there."""
    unit = session.project().view.length
    s = from_si(result.path.s, unit)
    delta = from_si(at_feed(result, result.delta), unit)
    fig = components_figure(result, unit, dark=dark, i=i)
    size = np.linalg.norm(delta, axis=1)
    caption = "Deflected minus commanded, in {M}. Click the curve to go there."
    if spread is not None and len(spread.titles) > 1:
        at = from_si(at_feed(result, spread.deviation.T), unit)
        shade(fig, s, (at.min(axis=1), at.max(axis=1)), "published coefficients", rgba(palette(dark).text, 0.18))
        caption = "Deflected minus commanded, in {M}; shaded: by the alloy's other coefficients. Click to go there."
    if uncertainty.banded(fig, result, unit, dark=dark):
        caption = f"{caption} {uncertainty.band_caption(result.setup)}"
    if i >= 0:
        add_point(fig, float(s[i]), float(size[i]), dark=dark)
    words = (
        [
            f"line {line}, after {at:.2f} {unit}<br><b>{off:.4f} {unit}</b><br>δ<sub>X</sub> {d[0]:+.4f}, "
            f"δ<sub>Y</sub> {d[1]:+.4f}, δ<sub>Z</sub> {d[2]:+.4f}"
            for line, at, off, d in zip(result.path.block, s, size, delta, strict=True)
        ]
        if len(s) < MAX_HOVERED
        else [""] * len(s)
    )
    add_picks(fig, s, size, words)
    pieces.figure(
        fig,
        "linked-deviation",
        name="deviation",
        table=lambda: result.columns(),
        caption=caption,
        alt="Deviation of the tool tip along the path, by component.",
        on_pick=partial(_station_at, result),
    )


def _station_at(result: SimulationResult, point: Mapping[str, Any]) -> None:
    total = float(from_si(float(result.path.s[-1]), session.project().view.length))
    session.look(station=min(max(float(point["x"]) / total, 0.0), 1.0))
