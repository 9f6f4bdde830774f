"""The milling page's body: inputs on the left; the cut with its scrubber, and three questions that share it."""

import dataclasses
from functools import partial
from typing import Any

import numpy as np
import streamlit as st

from robomill.cutting.force import ForceSpread
from robomill.learn.worked import of_the_run
from robomill.simulation.origin.spread import AlloySpread, alloy_spread, peak_force
from robomill.simulation.result import SimulationResult
from robomill.ui import pieces, session
from robomill.ui.entry import inputs, tools as tools_panel
from robomill.ui.judged import evidence as evidence_panel
from robomill.ui.judged.verdict import NOT_COUNTED, verdict_row
from robomill.ui.judged.worked import mathematics
from robomill.ui.milling import (
    cut as cut_panel,
    film,
    force as force_panel,
    force_view,
    live_cut,
    metrology as metrology_panel,
    pictures as picture_panel,
    scrubber as linked,
    springs as springs_panel,
    station as station_views,
)
from robomill.ui.pieces import Tile
from robomill.ui.posed.arm import arm_at
from robomill.ui.serving.menu import file_of
from robomill.ui.work import cached, running
from robomill.units import format_count, format_limit, format_many, format_si

QUESTIONS = {"force": "How hard does it push?", "tip": "Where does the tip go?", "part": "What will I measure?"}
QUESTION = "milling.question"


@cached.shared(cached.by_result, "Force over the alloy's rows and over a turn")
def spread_of(result: SimulationResult) -> tuple[AlloySpread | None, ForceSpread | None]:
    """Range over the alloy's rows and over a revolution, from the cache."""
    return alloy_spread(result), peak_force(result)


def tiles(result: SimulationResult, made: list[Tile]) -> list[Tile]:
    """The page's tiles with the influence of the spin at the tip."""
    unit = session.project().view.length
    *first, tip, verdict = made
    if words := _spin_words(result, unit):
        tip = dataclasses.replace(tip, ranges=[*tip.ranges, words])
    return [*first, tip, verdict]


def _spin_words(result: SimulationResult, unit: str) -> str:
    """How much the free spin about the tool matters; "" for an arm that has none."""
    if result.setup.robot.n < 6 or result.worst < 0:
        return ""
    ends = pieces.attempt(cached.over_spin, result.setup)
    if ends is None or not np.isfinite(ends.range).all():
        return ""
    low, high = (format_si(float(end), unit) for end in ends.range)
    if low == high:
        return ""
    return f"{format_many(ends.range, unit, between=' to ', with_unit=False)}: spin about the tool"


def _mean_and_peak(result: SimulationResult) -> str:
    """Which force the verdict is of, where a tooth is known to push harder."""
    peak, i = spread_of(result)[1], result.decided.sample
    if peak is None or i < 0:
        return ""
    mean, most = (format_si(float(N), "N", 0) for N in (result.force_size[i], np.linalg.norm(peak.at_peak[i])))
    return f"The verdict is of the mean force, {mean} where it decides; a tooth pushes with up to {most} there. " * (
        mean != most
    )


def inputs_column(result: SimulationResult | None) -> None:
    """Force, cutter, stock, what else gives, tolerance."""
    setup = session.project().setup
    _beside_titles(result)
    with st.expander("**Force on the tool**", expanded=True, key="milling.open.force"):
        force_panel.inputs_panel()
        if result is not None and result.coupling is not None and not result.coupling.converged:
            pieces.said("warning", result.coupling.finding.sentence, "warning")
    with st.expander("**Tools**" if setup.tools else "**Cutter**", expanded=True, key="milling.open.cutter"):
        if not setup.tools:
            cut_panel.cutter_inputs()
        tools_panel.panel()
        if result is not None:
            for finding in result.notes:
                if finding.code in force_view.OF_CUTTER:
                    pieces.said("warning", finding.sentence, "warning")
    with st.expander("**Stock** in {W}", expanded=False, key="milling.open.stock"):
        cut_panel.stock_inputs()
    with st.expander("**Other flexibility**", expanded=False, key="milling.open.springs"):
        springs_panel.inputs_panel()
    with st.expander("**Tolerance and accuracy**", expanded=True, key="milling.open.accuracy"):
        cut_panel.judgement_inputs()


def _beside_titles(result: SimulationResult | None) -> None:
    """What each group of inputs says, at the end of its title: one reads it with the group folded away. By style, since
    Streamlit unfolds what gets another title."""
    setup, unit = session.project().setup, session.project().view.length
    said = {"cutter": format_count(len(setup.tools), "tool") if setup.tools else cut_panel.cutter_words()}
    said |= {"stock": cut_panel.stock_words(), "accuracy": format_limit(setup.tolerance, unit)}
    if result is not None and (i := result.decided.sample) >= 0:
        said["force"] = format_si(float(result.force_size[i]), "N", 0)
    rules = [f'.st-key-milling-open-{name} summary::after {{ content: "{words}" }}' for name, words in said.items()]
    st.html(f"<style>{' '.join(rules)}</style>")


def workbench(dark: bool) -> None:
    """Everything below the headline: inputs in a column of their own, beside them the cut and what is known of it."""
    digest = session.project().setup.digest()
    left, right = bench()
    with left:
        _inputs(digest)
    with right:
        _looks(digest, dark)


def bench() -> list[Any]:
    """The two columns of the page: inputs, which scroll by themselves, and the picture with what belongs to it."""
    return pieces.split([1, 2.5], "milling", gap="small")


def waiting(dark: bool) -> None:
    """The page while there are no numbers: inputs, where what is missing is asked for, and the last cut, greyed."""
    left, right = bench()
    with left:
        inputs_column(None)
    last = session.kept(running.LAST)
    with right:
        if last is not None:
            with picture_place():
                live_cut.panel(last, dark)
        words = "Nothing is computed yet: where a value is named above, or asked for among the inputs, give it."
        stays = "" if last is None else "; the picture is the last one"
        pieces.said("info", f"{words} What you typed is kept{stays}.")


def picture_place() -> Any:
    """Where the picture stands: it has its room before it is there (a container of nothing would have none)."""
    place = st.container(key="milling-look")
    place.html('<i class="rm-room"></i>')
    return place


def _numbers(result: SimulationResult, i: int, spread: AlloySpread | None) -> None:
    """What holds at the position, and the verdict's tiles."""
    linked.where(result, i, spread)
    pieces.note(f"{_mean_and_peak(result)}{NOT_COUNTED}")
    verdict_row(result, session.project().view.length, partial(tiles, result))
    mathematics(lambda: of_the_run(result, result.decided.sample), "milling")
    if result.worst >= 0:
        st.page_link(file_of("Improve"), label="What would fix it?", icon=":material/build:")


@st.fragment
def _inputs(digest: str) -> None:
    """Runs alone while something is opened; a changed set-up runs the whole page."""
    project = session.project()
    if project.setup.digest() != digest:
        st.rerun()
    inputs_column(running.shown(project.setup))


@st.fragment
def _looks(digest: str, dark: bool) -> None:
    """Runs alone once the scrubber has settled."""
    project = session.project()
    if project.setup.digest() != digest:
        st.rerun()
    result = running.shown(project.setup)
    if result is None:
        return
    picture, i = picture_place(), linked.index(result)
    known = pieces.attempt(spread_of, result)
    if known is not None:
        _numbers(result, i, known[0])
    with picture:  # after the numbers, which are there sooner
        live_cut.panel(result, dark)
        if live_cut.without_webgl():
            picture_panel.rendered_picture(result, i, dark)
    if known is None:
        return
    spread, peak = known
    with st.container(key="milling-more"):
        question = _answer(result, i, spread, peak, dark)
    with st.container(key="milling-wide"):
        if question == "force":
            st.header("How sure is the force?")
            force_view.alloy_table(result, i, spread)
            force_view.worth_knowing(result)
        elif question == "tip":
            _tip(result, i, spread, peak, dark)
        else:
            _surface(result, i, dark)


def _answer(result: SimulationResult, i: int, spread: AlloySpread | None, peak: ForceSpread | None, dark: bool) -> str:
    """One of three questions, which share the position along the cut, and what answers it beside the inputs; what is
    wider, or only asks what does not hang on them, stands below both."""
    question: str = inputs.pick("Question", QUESTION, QUESTIONS, "part", inputs.HIDDEN)
    if question == "force":
        with st.container(border=True):
            force_view.force_plot(result, i, spread, peak, dark)
            force_view.facts(result, i, peak)
        _engaged(result, i, spread, peak, dark)
    elif question == "tip":
        with st.container(border=True):
            linked.deviation_plot(result, i, spread, dark)
        _code_and_arm(result, i)
    else:
        _part(result, i, spread, dark)
    return question


def _code_and_arm(result: SimulationResult, i: int) -> None:
    code, arm = pieces.split([1, 1.15], "code-arm")
    with code, st.container(border=True, height="stretch"):
        st.markdown("**Program**")
        station_views.code(result, i)
    with arm, st.container(border=True, height="stretch"):
        if i >= 0:
            arm_at(result, i, "linked-arm", 330, aspect=1.0)


def _engaged(
    result: SimulationResult, i: int, spread: AlloySpread | None, peak: ForceSpread | None, dark: bool
) -> None:
    dial, along = pieces.split([1, 1.35], "force-engagement")
    with dial, st.container(border=True, height="stretch"):
        station_views.dial(result, i, spread, peak, dark)
    with along, st.container(border=True, height="stretch"):
        force_view.engagement_plot(result, i, dark)
        force_view.coupling_facts(result)


def _tip(result: SimulationResult, i: int, spread: AlloySpread | None, peak: ForceSpread | None, dark: bool) -> None:
    dial, section = pieces.split([1, 1.9], "dial-section")
    with dial, st.container(border=True, height="stretch"):
        station_views.dial(result, i, spread, peak, dark)
    with section, st.container(border=True, height="stretch"):
        station_views.section(result, i, dark)
    shares, lines = pieces.split([1.3, 1], "shares-lines")
    with shares, st.container(border=True, height="stretch"):
        station_views.shares(result, i, dark)
    with lines, st.container(border=True, height="stretch"):
        st.markdown("**Line by line, at the station**")
        station_views.lines_of(result, i)


def _part(result: SimulationResult, i: int, spread: AlloySpread | None, dark: bool) -> None:
    section, along = pieces.split([1, 1], "section-profile", gap="small")
    with section, st.container(border=True, height="stretch"):
        st.markdown("**Section at the position**")
        metrology_panel.section_facts(station_views.section(result, i, dark))
    with along, st.container(border=True, height="stretch"):
        st.markdown("**Along the cut**")
        metrology_panel.profile_panel(result, spread, dark)


def _surface(result: SimulationResult, i: int, dark: bool) -> None:
    """The error over the whole surface, the paper's test beside it, and what is taken away."""
    with st.container(border=True):
        st.markdown("**Over the whole surface**")
        metrology_panel.spread_panel(result, dark)
    if evidence_panel.is_papers_path(session.project()):
        st.header("The paper's test beside this calculation")
        with st.container(border=True):
            evidence_panel.panel(session.project(), dark)
    st.header("Downloads")
    picture_panel.downloads(result, i)
    with st.expander("Film of the cut", icon=":material/movie:", key="milling.open.film"):
        film.panel(result, dark)
