"""The report of the cut in force, to print or hand over, with the remedies that were computed for it."""

from functools import partial
from typing import Any

import streamlit as st

from robomill.identification.knowledge import Knowledge
from robomill.simulation.result import SimulationResult
from robomill.ui import pieces, session
from robomill.ui.project import Project
from robomill.ui.work import cached

REMEDIES = "handing.remedies"  # kept by who computes them: (fingerprint of the set-up, what was made)
A_REPORT, A_SAMPLE = 0.1, 0.4e-3  # s, about


def button(project: Project) -> None:
    """The report of the run in force; without one, nothing is handed on."""
    found = cached.held(project.setup)
    if found is None:
        why = "There is no result to report yet: the cut is still computed, or was refused."
        look: dict[str, Any] = {"icon": ":material/description:", "width": "stretch"}
        st.button("Report", key="report.none", disabled=True, help=why, **look)
        return
    known, tried = session.known(project.setup), _tried(project)
    about = (cached.by_result(found), None if known is None else known.source, len(tried))
    seconds = A_REPORT + A_SAMPLE * len(found.path)
    pieces.download(
        "Report",
        partial(page_of, found, known, tried),
        pieces.named("report.html"),
        "report",
        pieces.Making(seconds, lambda: about),
        icon=":material/description:",
        width="stretch",
        help="One page to print or hand over: verdict, pictures, lines, what it rests on",
    )


def _tried(project: Project) -> tuple[Any, ...]:
    """Remedies that were computed for this cut."""
    digest, made = session.kept(REMEDIES, ("", ()))
    return tuple(made) if digest == project.setup.digest() else ()


def page_of(result: SimulationResult, known: Knowledge | None, tried: tuple[Any, ...]) -> str:
    """The report as text."""
    from robomill.report.html import page
    from robomill.report.remedies_told import told
    from robomill.report.simulation_record import simulation_record

    return page(result, simulation_record(result, known), [row for each in tried for row in told(each)])
