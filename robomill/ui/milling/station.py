"""What stands at the station: program lines, arm, dial, section, shares; all drawn for one sample of the path."""

import html
from typing import Any

import numpy as np
import streamlit as st

from robomill.simulation.origin.spread import AlloySpread
from robomill.simulation.result import SimulationResult
from robomill.simulation.stations import force_components
from robomill.simulation.tools import cutting_numbers
from robomill.surface.sections.groove import GrooveSection
from robomill.surface.sections.measures import MEASURED
from robomill.surface.sections.section_law import TITLES
from robomill.ui import pieces, session, shell
from robomill.ui.comparing import other
from robomill.ui.entry import declared, inputs
from robomill.ui.milling import springs as springs_panel
from robomill.ui.milling.scrubber import station_m
from robomill.ui.work import cached
from robomill.units import format_si, from_si, unit_label
from robomill.viz.deviation import shares_figure
from robomill.viz.dial import Dial, dial_figure
from robomill.viz.sections import section_figure
from robomill.viz.theme import tool_colours
from robomill.viz.views import section_drawing

AROUND = 5


def code(result: SimulationResult, i: int, height: int = 300) -> None:
    """The program around the line in force."""
    lines = result.setup.source.block_texts()
    block = int(result.path.block[i]) if i >= 0 else 0
    first = max(0, min(block - 1 - AROUND, len(lines) - 2 * AROUND - 1))
    tools, shown = _tool_of_line(result), []
    for k in range(first, min(first + 2 * AROUND + 1, len(lines))):
        tone = (
            "background:color-mix(in srgb, var(--rm-code) 24%, transparent);font-weight:600;" if k + 1 == block else ""
        )
        mark = "▸" if k + 1 == block else " "
        tool, colour = tools.get(k + 1, ("", "transparent"))
        shown.append(
            f'<div title="{html.escape(tool)}" style="display:flex;gap:.8rem;padding:.1rem .5rem;border-radius:4px;'
            f'border-left:4px solid {colour};{tone}">'
            f'<span style="opacity:.5;min-width:3.2rem;text-align:right">{mark} {k + 1}</span>'
            f'<span style="white-space:pre;overflow:hidden;text-overflow:ellipsis">{html.escape(lines[k][:160])}</span>'
            "</div>"
        )
    st.html(
        f'<div style="--rm-code:#2F7FD0;font-family:Source Code Pro,monospace;font-size:.84rem;line-height:1.75;'
        f'min-height:{height}px">{"".join(shown)}</div>'
    )


def _tool_of_line(result: SimulationResult) -> dict[int, tuple[str, str]]:
    """What the lines that cut are cut with: the tool's name and its colour; nothing where one cutter does all."""
    path, known = result.path, result.setup.tools
    numbers = cutting_numbers(path).tolist() if known else []
    colours = tool_colours(numbers, shell.dark())
    pairs = np.unique(np.stack([path.block, path.tool])[:, path.cutting], axis=1).T.tolist() if known else []
    return {block: (known.called(number), colours[number]) for block, number in pairs}


def dial(
    result: SimulationResult, i: int, spread: AlloySpread | None, peak: Any, dark: bool, height: int = 300
) -> None:
    """Engagement and force at the station, seen from the spindle."""
    if i < 0:
        return
    c, unit, cutter = result.conditions, session.project().view.length, result.tooling.at(i)
    across = np.hypot(result.force_components[:, 0], result.force_components[:, 1])
    top = float(np.nanmax(np.where(result.judged, across, 0.0), initial=0.0))
    others = None
    if spread is not None and len(spread.titles) > 1:
        others = force_components(result, spread)[1:, i]
        top = max(top, float(np.hypot(others[:, 0], others[:, 1]).max()))
    worst_turn = None if peak is None else peak.at_peak[i]
    if worst_turn is not None:
        top = max(top, float(np.hypot(*worst_turn[:2])))
    fig = dial_figure(
        Dial(
            float(from_si(float(c.phi_st[i]), "deg")),
            float(from_si(float(c.phi_ex[i]), "deg")),
            float(from_si(float(c.a_p[i]), unit)),
            unit,
            result.force_components[i],
            top / 1.45 or 1.0,
            cutter.hand,
            cutter.flutes,
            bool(c.engaged[i]),
            others,
            worst_turn,
        ),
        dark=dark,
        height=height,
    )
    words = "Seen from the spindle. Orange: the arc that cuts, blue: the mean force"
    words += ", pale blue: the peak of a turn" if worst_turn is not None else ""
    words += ", rings: by other published coefficients of the alloy" if others is not None else ""
    assumed = "" if result.setup.engagement else " The arc is a full slot, as assumed."
    pieces.figure(
        fig,
        "linked-dial",
        caption=words + "." + assumed,
        alt="Arc of engagement and force on the tool at the station, seen from the spindle.",
    )


def section(result: SimulationResult, i: int, dark: bool) -> Any:
    """The dimensioned section at the station, and to the same scale that of the project beside; returns the first."""
    found = pieces.attempt(cached.groove, result.setup, station_m(result))
    if found is None:
        return None
    theirs = other.held()
    beside = None if theirs is None else pieces.attempt(cached.groove, theirs.setup, station_m(theirs))
    _section(result, found, beside, dark)
    if theirs is not None and beside is not None:
        pieces.strong("B, to the same scale")
        _section(theirs, beside, found, dark, "-of-b")
    return found


def _section(
    result: SimulationResult, found: GrooveSection, beside: GrooveSection | None, dark: bool, key: str = ""
) -> None:
    unit = session.project().view.length
    if not len(found.w) or found.kind == "unknown":
        pieces.note(f"No section here: {found.note}.")
        return
    scale = section_drawing(beside, unit) if beside is not None and len(beside.w) else None
    pieces.figure(
        section_figure(section_drawing(found, unit), dark=dark, beside=scale),
        f"linked-section{key}",
        name=f"sections{key}",
        table=lambda: result.sections.columns(),
        caption=f"Through the finished part, at {format_si(station_m(result), unit, 1)} of cut, looking along "
        f"the feed, to scale, in {unit_label(unit)}. Dashed: the ideal surface."
        + (f" {found.note[0].upper()}{found.note[1:]}." if found.kind == "nothing" else ""),
        alt=section_words(found, unit),
    )


def section_words(section: GrooveSection, unit: str) -> str:
    """A section in words with its numbers, for whoever does not see the drawing."""
    if section.kind == "nothing":
        return f"Cross-section: {section.note}."
    known = [(MEASURED[name], getattr(section, name)) for name in section.measures]
    found = [f"{of.label.lower()} {of.shown(value, unit)}" for of, value in known if np.isfinite(value)]
    return f"Cross-section of a {TITLES[section.kind].lower()}: {', '.join(found) or 'nothing can be measured'}."


def shares(result: SimulationResult, i: int, dark: bool) -> None:
    """Which joint or spring gives, stacked along the path."""
    unit = session.project().view.length
    title, pick = st.columns([1, 1.2], vertical_alignment="center")
    title.markdown("**What gives**")
    with pick:
        declared.seen("view.share_axis", inputs.HIDDEN)
    axis = session.project().view.share_axis
    pieces.figure(
        shares_figure(result, axis, unit, dark=dark, i=i),
        f"shares-{axis}",
        name=f"joint-shares-{axis}",
        table=lambda: result.columns(),
        caption="Shares stack to the total line.",
        alt="Deviation along the path stacked by joint and spring.",
    )


def lines_of(result: SimulationResult, i: int) -> None:
    """Every compliance with its own line, at the station."""
    if i >= 0:
        springs_panel.lines_table(result, i)
        if result.setup.links is not None and not result.setup.add_sag:
            pieces.note("The sag is a constant offset that zeroing the part takes out; it is shown, not added.")
