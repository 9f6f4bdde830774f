"""What the start page tells: the cause in one line, the groove, where the numbers come from, the doors."""

import html
from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np
import streamlit as st

from robomill.files import PROGRAM
from robomill.paper import SLOT
from robomill.provenance import kind_word
from robomill.simulation.judging.verdict_words import TIP
from robomill.simulation.origin.origins import sources
from robomill.simulation.result import SimulationResult
from robomill.simulation.setup import SimulationSetup
from robomill.ui import pieces, rendered, session
from robomill.ui.entry import inputs
from robomill.ui.judged import evidence
from robomill.ui.judged.verdict import verdict_sentence
from robomill.ui.markup import unparted
from robomill.ui.posed.push import decided
from robomill.ui.project import Project, View
from robomill.ui.serving.menu import file_of, head_for
from robomill.ui.work import cached
from robomill.units import format_beside, format_count, format_si, format_times
from robomill.viz.rendered.picture import SurfacePicture
from robomill.viz.surfaces import surface_figure
from robomill.viz.theme import DIVERGING
from robomill.viz.views import surface_picture

PURPOSE = "robomill predicts how far a milling robot is pushed off its path by the cutting force, and why."
DOORS = (
    ("I design robots", "Which joint is worth stiffening?", "Improve", "Stiffen a joint"),
    ("I teach", "Why does a robot bend sideways?", "Learn", "Start the lesson"),
)
OPENED, STIFFEN = "improve.remedy", "stiffen"  # what the Improve page shows opened
KINDS = {"user": "of your own"}  # as one counts them; the others are their own word


def purpose() -> None:
    """What this is, in one sentence."""
    st.html(f'<p class="rm-purpose">{html.escape(PURPOSE)}</p>')


def cause(result: SimulationResult, unit: str) -> str:
    """One line: the force, where the tip goes, and the joints that give most; and at which place of the cut, where the
    tip is farthest off its path at another one."""
    cut = decided(result)
    if cut is None:
        return ""
    kind = result.decided.kind
    elsewhere = kind is not TIP and cut.moved.components(unit) != replace(cut, i=result.worst).moved.components(unit)
    where = f"Where the {kind.what} is farthest off, " if elsewhere else ""
    return f"{where}{cut.moved.sentence(unit)} {cut.moved.blame(unit)}".rstrip()


def groove_picture(result: SimulationResult, view: View, height: int, dark: bool) -> None:
    """The machined groove as a rendered picture, or turnable where nothing can be rendered."""
    setup, times = result.setup, view.exaggeration
    size = (940, round(940 * height / 400))
    alt = (
        f"The part as milled, coloured by its signed error, displacement shown {format_times(times, 6)}. "
        f"{verdict_sentence(result, view.length)}"
    )

    def scene() -> SurfacePicture:
        how: dict[str, Any] = {"camera": "iso", "dark": dark, "size": size, "captions": (), "scale": False}
        return surface_picture(result, cached.pictured(setup, times), error_unit=view.length, **how)

    def turnable() -> None:
        shown = pieces.attempt(cached.pictured, setup, times)
        if shown is not None:
            figure = surface_figure(shown, setup.tolerance, view.length, dark=dark, height=height)
            pieces.figure(figure, "start-surface", alt=alt)

    rendered.picture("start.groove", (setup.digest(), times, "start", dark, size, view.units), scene, alt, turnable)
    what = "groove" if result.path.on_one_line else "part"
    ends = [format_beside(k * setup.tolerance, setup.tolerance, view.length, 2, sign=True) for k in (-1, 1)]
    colours = ",".join(str(colour) for _, colour in DIVERGING)
    st.html(
        f'<div class="rm-key"><span>{unparted(ends[0])} cut too deep</span>'
        f'<i style="background:linear-gradient(90deg,{colours})"></i>'
        f"<span>{unparted(ends[1])} material left</span></div>"
    )
    whose = " of walls" if setup.floor_tolerance not in (None, setup.tolerance) else ""
    pieces.note(
        f"The {what} as milled; its colours end at the tolerance{whose}. Displacement shown {format_times(times, 6)}."
    )


def where_from(setup: SimulationSetup) -> None:
    """Each block of numbers with its badge and its source."""
    rows = [
        (s.what, pieces.subscripts(s.value), pieces.sourced(s.provenance))
        for s in sources(setup, session.project().view.length)
    ]
    pieces.table(rows, "qv ")


def beside_the_paper(project: Project) -> None:
    """The paper's numbers beside those of robomill, for the paper's own cut; never forced to match."""
    if not evidence.is_papers_path(project):
        pieces.note("The paper's numbers are shown beside robomill's when its milling test is open.")
        return
    found = pieces.attempt(evidence.claims, project)
    if found is None:
        return
    top = max((abs(c.value) for c in found if np.isfinite(c.value)), default=1.0) or 1.0
    rows = [
        (
            f"{c.label} " + pieces.badge(c.kind),
            pieces.bar(abs(c.value) / top, c.kind),
            "about " * c.rough + format_si(abs(c.value), project.view.length, 2),
        )
        for c in found
    ]
    pieces.table(rows, " bn")
    pieces.note(
        f"Sideways error of the groove. {format_si(SLOT.from_map, project.view.length, 2)} is read off a map whose "
        "raw data are not printed, and Table 3 alone cannot give it. The link lengths are chosen by the paper's own "
        "C_yy, so the joints' share of it is no independent check; stiffnesses and forces are nowhere tuned to match."
    )


def why(setup: SimulationSetup, length: str) -> str:
    """On how many numbers the result rests, by who says them: "11 inputs: 5 published, 5 assumed, 1 measured"."""
    kinds = [source.provenance.kind for source in sources(setup, length)]
    order = sorted(dict.fromkeys(kinds), key=lambda kind: -kinds.count(kind))
    counted = ", ".join(f"{kinds.count(kind)} {KINDS.get(kind, kind_word(kind))}" for kind in order)
    return f"Why believe this? It rests on {format_count(len(kinds), 'input')}: {counted}"


def doors(take: Callable[[bytes, str], None]) -> None:
    """A card for each kind of visitor; the one who mills drops a program there, which ``take`` gets."""
    with st.container(key="doors", height="stretch"):
        with st.container(border=True, key="door-mill", height="stretch"):
            _door("I mill parts", "Will my part come out true? Drop its G-code here: .nc, .ngc, .tap")
            inputs.upload("Check my program", "start.program", _then(take), most_MB=PROGRAM.most_MB)
        for title, text, page, label in DOORS:
            with st.container(border=True, key=f"door-{label.split()[-1]}", height="stretch"):
                _door(title, text)
                _lead(page, label)


def _lead(page: str, label: str) -> None:
    """To the page of a door, which opens at what the door says."""
    if page == "Learn":
        st.page_link(file_of(page), label=label, icon=":material/arrow_forward:")
        return
    inputs.button(label, "start.stiffen", "arrow_forward", _stiffen)


def _stiffen() -> None:
    session.keep(OPENED, STIFFEN)
    head_for("Improve")


def _door(title: str, text: str) -> None:
    st.html(f'<div class="rm-door"><h2>{html.escape(title)}</h2><p>{html.escape(text)}</p></div>')


def _then(take: Callable[[bytes, str], None]) -> Callable[[bytes, str], None]:
    """``take``, and to the toolpath page, where a program is asked what it cuts."""

    def taken(data: bytes, name: str) -> None:
        take(data, name)
        head_for("Toolpath")

    return taken
