"""One scrubber for everything: code line, arm, engagement and force, the point on the curve, the section."""

from __future__ import annotations

import html
from collections.abc import Callable
from typing import Any

import numpy as np
import streamlit as st

from robomill.arrays import FloatArray
from robomill.report.tables import deviation_columns, section_columns
from robomill.simulation.result import SimulationResult
from robomill.simulation.spread import AlloySpread
from robomill.toolpath.source import GCodeSource, LinesSource, PathSource, SketchSource
from robomill.ui import cache, inputs, parts, springs_panel, state
from robomill.ui.program_view import program_lines
from robomill.units import format_si, format_value, from_si
from robomill.viz.arm import arm_figure, displacement_scale
from robomill.viz.engagement import Dial, dial_figure, shade
from robomill.viz.paths import components_figure, shares_figure
from robomill.viz.picking import add_picks, add_point
from robomill.viz.sections import section_figure
from robomill.viz.theme import palette
from robomill.viz.views import arm_scene, sample_at, section_drawing

AROUND = 5
MAX_HOVERED = 100_000


def station_m(result: SimulationResult) -> float:
    """The station, m of length cut."""
    return state.project().view.station * float(result.path.s[-1])


def go_to(result: SimulationResult, i: int) -> None:
    """Move the scrubber to sample ``i``."""
    total = float(result.path.s[-1])
    if i >= 0 and total > 0:
        state.look(station=min(max(float(result.path.s[i]) / total, 0.0), 1.0))


def scrubber(result: SimulationResult) -> int:
    """The slider over the length cut, with steps from line to line; returns the sample it points at."""
    view, unit = state.project().view, state.project().view.length
    top = max(float(from_si(float(result.path.s[-1]), unit)), 1e-9)
    i = sample_at(result, station_m(result))
    slide, back, on, worst = st.columns([5, 1.15, 1.15, 1.5], vertical_alignment="bottom", gap="small")
    with slide:
        inputs.slider(
            f"Station: {unit} of cut", "view.station", 0.0, round(top, 3), round(view.station * top, 3),
            lambda v: state.look(station=min(max(v / top, 0.0), 1.0)), step=round(top / 200, 4) or 0.001, form="%.2f",
        )  # fmt: skip
    lines = cut_lines(result)
    place = int(np.searchsorted(lines, result.path.block[i])) if i >= 0 else 0
    for column, step, label, words in (
        (back, -1, "Back", "previous line"), (on, 1, "Next", "next line"),
    ):  # fmt: skip
        other = place + step
        column.button(
            label, key=f"scrub:{label.lower()}", help=f"To the {words} that cuts", width="stretch",
            disabled=not 0 <= other < len(lines), on_click=_to_line, args=(result, lines, other),
        )  # fmt: skip
    worst.button(
        "Worst", key="scrub:worst", icon=":material/my_location:", width="stretch", on_click=go_to,
        args=(result, result.worst), disabled=result.worst < 0, help="Land on the largest deviation",
    )  # fmt: skip
    return sample_at(result, station_m(result))


def cut_lines(result: SimulationResult) -> FloatArray:
    """Source lines that cut, in rising order."""
    return np.unique(result.path.block[result.path.cutting])


def _to_line(result: SimulationResult, lines: FloatArray, number: int) -> None:
    samples = np.flatnonzero((result.path.block == lines[number]) & result.path.cutting)
    go_to(result, int(samples[len(samples) // 2]))


def where(result: SimulationResult, i: int, spread: AlloySpread | None) -> None:
    """One line: program line, place, deviation, force."""
    unit = state.project().view.length
    if i < 0:
        parts.note("Nothing of this cut can be reached.")
        return
    point = ", ".join(format_si(float(v), unit, 2).rpartition(" ")[0] for v in result.path.p[i])
    words = [
        f"<b>Line {result.path.block[i]}</b>", f"at ({point}) {unit} in {{W}}",
        f"tip off by <b>{format_si(float(result.deviation[i]), unit)}</b>{_range(spread, i, unit)}",
        f"force {format_si(float(np.linalg.norm(result.F[i])), 'N', 0)}",
    ]  # fmt: skip
    st.html(f'<p class="rm-lead" style="font-size:.95rem">{" · ".join(words)}</p>')


def _range(spread: AlloySpread | None, i: int, unit: str) -> str:
    if spread is None or len(spread.titles) < 2:
        return ""
    low, high = float(spread.deviation[:, i].min()), float(spread.deviation[:, i].max())
    return f" ({format_si(low, unit).rpartition(' ')[0]} to {format_si(high, unit).rpartition(' ')[0]} by alloy row)"


def deviation_plot(result: SimulationResult, i: int, spread: AlloySpread | None, dark: bool, height: int = 330) -> None:
    """Deviation by component with its band; a click on the curve moves the scrubber there."""
    unit = state.project().view.length
    s = from_si(result.path.s, unit)
    delta = from_si(at_feed(result, result.delta), unit)
    fig = components_figure(
        s, delta, result.path.block, float(from_si(result.setup.tolerance, unit)), unit, dark=dark,
        station=float(s[i]) if i >= 0 else None, height=height,
    )  # fmt: skip
    size = np.linalg.norm(delta, axis=1)
    caption = "Deflected minus commanded, in {M}. Click the curve to go there."
    if spread is not None and len(spread.titles) > 1:
        at = from_si(at_feed(result, spread.deviation.T), unit)
        shade(fig, s, at.min(axis=1), at.max(axis=1), palette(dark).text, "alloy's rows")
        caption = "Deflected minus commanded, in {M}; shaded: the alloy's other coefficient rows. Click to go there."
    p = palette(dark)
    if i >= 0:
        add_point(fig, float(s[i]), float(size[i]), p.accent, p.background)
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
    key = "linked-deviation"
    parts.figure(
        fig, key, name="deviation", table=lambda: deviation_columns(result), caption=caption,
        alt="Deviation of the tool tip along the path, by component.", on_select=_picker(result, key),
    )  # fmt: skip


def _picker(result: SimulationResult, key: str) -> Callable[[], None]:
    unit = state.project().view.length

    def take() -> None:
        picked = st.session_state.get(key)
        points = picked["selection"]["points"] if picked else []
        if points:
            total = float(from_si(float(result.path.s[-1]), unit))
            state.look(station=min(max(float(points[0]["x"]) / total, 0.0), 1.0))

    return take


def at_feed(result: SimulationResult, values: FloatArray) -> FloatArray:
    """``values`` (m, k) with NaN where nothing is cut, so that lines break there."""
    return np.where(result.path.cutting[:, None], values, np.nan)


def code(result: SimulationResult, i: int, height: int = 300) -> None:
    """The program around the line in force."""
    lines = source_lines(result.setup.source)
    block = int(result.path.block[i]) if i >= 0 else 0
    first = max(0, min(block - 1 - AROUND, len(lines) - 2 * AROUND - 1))
    shown = []
    for k in range(first, min(first + 2 * AROUND + 1, len(lines))):
        tone = (
            "background:color-mix(in srgb, var(--rm-code) 24%, transparent);font-weight:600;" if k + 1 == block else ""
        )
        mark = "▸" if k + 1 == block else " "
        shown.append(
            f'<div style="display:flex;gap:.8rem;padding:.1rem .5rem;border-radius:4px;{tone}">'
            f'<span style="opacity:.5;min-width:3.2rem;text-align:right">{mark} {k + 1}</span>'
            f'<span style="white-space:pre;overflow:hidden;text-overflow:ellipsis">{html.escape(lines[k][:160])}</span>'
            "</div>"
        )
    st.html(
        f'<div style="--rm-code:#2F7FD0;font-family:Source Code Pro,monospace;font-size:.84rem;line-height:1.75;'
        f'min-height:{height}px">{"".join(shown)}</div>'
    )


def source_lines(source: PathSource) -> list[str]:
    """What a block number points at: lines of a program, rows of a table, shapes of a sketch."""
    if isinstance(source, GCodeSource):
        return list(program_lines(source.text))
    if isinstance(source, LinesSource):
        ends = zip(from_si(source.start, "mm"), from_si(source.end, "mm"), from_si(source.v_f, "mm/min"), strict=True)
        return [f"({_point(a)}) → ({_point(b)})  {v:.0f} mm/min" for a, b, v in ends]
    assert isinstance(source, SketchSource)
    return [
        f"{e.shape}, {len(e.points)} points, {format_si(e.depth, 'mm', 2)} deep, {format_si(e.v_f, 'mm/min', 0)}"
        for e in source.sketch.elements
    ]


def _point(p: FloatArray) -> str:
    return ", ".join(f"{v:g}" for v in np.round(p, 3))


def arm(result: SimulationResult, i: int, dark: bool, height: int = 330) -> None:
    """The arm as it stands at the station."""
    if i < 0:
        return
    scene = arm_scene(result, i)
    drawn = displacement_scale(result.delta[i], scene.frames)
    parts.figure(
        arm_figure(scene, dark=dark, height=height, revision="linked-arm", zoom=0.86), "linked-arm",
        alt="The arm at the station with force and displacement.",
        caption=f"Blue: force on the tool. Orange: displacement, shown × {int(float(f'{drawn:.2g}')):,}.",
    )  # fmt: skip


def dial(
    result: SimulationResult, i: int, spread: AlloySpread | None, peak: Any, dark: bool, height: int = 300
) -> None:
    """Engagement and force at the station, seen from the spindle."""
    if i < 0:
        return
    c, unit = result.conditions, state.project().view.length
    across = np.hypot(result.force_components[:, 0], result.force_components[:, 1])
    top = float(np.nanmax(np.where(result.judged, across, 0.0), initial=0.0))
    others = None
    if spread is not None and len(spread.titles) > 1:
        others = np.einsum("ij,ri->rj", result.R_MF[i], spread.F[1:, i])
        top = max(top, float(np.hypot(others[:, 0], others[:, 1]).max()))
    worst_turn = None if peak is None else peak.at_peak[i]
    if worst_turn is not None:
        top = max(top, float(np.hypot(*worst_turn[:2])))
    fig = dial_figure(
        Dial(
            float(from_si(float(c.phi_st[i]), "deg")), float(from_si(float(c.phi_ex[i]), "deg")),
            float(from_si(float(c.a_p[i]), unit)), unit, result.force_components[i], top / 1.45 or 1.0,
            result.setup.cutter.hand, result.setup.cutter.flutes, bool(c.engaged[i]), others, worst_turn,
        ), dark=dark, height=height,
    )  # fmt: skip
    words = "Seen from the spindle. Orange: the arc that cuts, blue: the mean force"
    words += ", pale blue: the peak of a turn" if worst_turn is not None else ""
    words += ", rings: the alloy's other rows" if others is not None else ""
    assumed = "" if result.setup.engagement else " The arc is a full slot, as assumed."
    parts.figure(fig, "linked-dial", caption=words + "." + assumed,
                 alt="Arc of engagement and force on the tool at the station, seen from the spindle.")  # fmt: skip


def section(result: SimulationResult, i: int, dark: bool, height: int = 320) -> Any:
    """The dimensioned section at the station; returns it."""
    unit = state.project().view.length
    groove = parts.attempt(cache.groove, result.setup, station_m(result))
    if groove is None:
        return None
    if groove.note:
        parts.note(f"No section here: {groove.note}.")
        return groove
    parts.figure(
        section_figure(section_drawing(groove, unit), dark=dark, height=height), "linked-section",
        name="groove-sections", table=lambda: section_columns(result),
        caption=f"Section after {format_si(station_m(result), unit, 1)} of cut, looking along the feed, to scale. "
        "Dashed: the ideal groove.",
        alt="Cross-section of the groove with its dimensions and the ideal groove dashed.",
    )  # fmt: skip
    return groove


def shares(result: SimulationResult, i: int, dark: bool, height: int = 320) -> None:
    """Which joint or spring gives, stacked along the path."""
    view, unit = state.project().view, state.project().view.length
    title, pick = st.columns([1, 1.2], vertical_alignment="center")
    title.markdown("**What gives**")
    with pick:
        inputs.choice("Shares of", "view.share_axis", {a: f"in {a.upper()}" for a in "xyz"}, view.share_axis,
                      lambda a: state.look(share_axis=a), label_visibility="collapsed")  # fmt: skip
    axis = state.project().view.share_axis
    column = "xyz".index(axis)
    every = np.concatenate([result.delta_joint[:, :, column], result.delta_spring[:, :, column]], axis=1)
    names = [f"joint {n}" for n in result.setup.robot.joint_numbers] + [s.name for s in result.setup.springs]
    s = from_si(result.path.s, unit)
    fig = shares_figure(
        s, from_si(at_feed(result, every), unit), names, from_si(at_feed(result, result.delta), unit)[:, column], axis,
        unit, dark=dark, station=float(s[i]) if i >= 0 else None, height=height,
    )  # fmt: skip
    named: set[str] = set()
    for trace in fig.data:  # a joint that pushes both ways has two areas and needs one name
        trace.showlegend = trace.name not in named
        named.add(trace.name)
    parts.figure(
        fig, f"shares-{axis}", name=f"joint-shares-{axis}", table=lambda: deviation_columns(result),
        caption="Shares stack to the total line.", alt="Deviation along the path stacked by joint and spring.",
    )  # fmt: skip


def lines_of(result: SimulationResult, i: int) -> None:
    """Every compliance with its own line, at the station."""
    if i >= 0:
        springs_panel.lines_table(result, i)
        if result.setup.links is not None and not result.setup.add_sag:
            parts.note("The sag is a constant offset that zeroing the part takes out; it is shown, not added.")


def band_words(spread: AlloySpread | None, result: SimulationResult, unit: str) -> str:
    """``"0.18 to 0.33 mm by alloy row"`` for the largest deviation, or nothing."""
    if spread is None or len(spread.titles) < 2 or not result.judged.any():
        return ""
    largest = np.where(result.judged, spread.deviation, -np.inf).max(axis=1)
    ends = [
        format_value(float(from_si(float(v), unit)), unit, 2 if unit == "mm" else 4)
        for v in (largest.min(), largest.max())
    ]
    return f"{ends[0].rpartition(' ')[0]} to {ends[1]} by alloy row"
