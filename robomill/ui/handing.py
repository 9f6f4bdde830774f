"""What a person hands on, on every page: a report of the cut, a link, a command, Python."""

from collections.abc import Mapping
from functools import partial
from typing import Any
from urllib.parse import urlencode

import streamlit as st

from robomill.errors import RobomillError
from robomill.identification.knowledge import Knowledge
from robomill.simulation.result import SimulationResult
from robomill.ui import address, cached, pieces, session
from robomill.ui.project import SUFFIX, Project, project_to_toml
from robomill.ui.spoken import spoken

REMEDIES = "handing.remedies"  # kept by who computes them: (fingerprint of the set-up, what was made)
A_REPORT, A_SAMPLE = 0.1, 0.4e-3  # s, about
OPEN = "handing.open"  # the page on which the panel is open
LESSON = ("lesson", "step")  # what an address says beside the project


def row(project: Project) -> None:
    """The buttons beside the project's file."""
    with st.container(horizontal=True, gap="small"):
        _report(project)
        here = session.store().page
        st.button(
            "Share", key="share", icon=":material/share:", width="stretch", on_click=session.keep, args=(OPEN, here)
        )
    if session.kept(OPEN) == here:  # also when the page runs once more beside it
        shared(project)


def _report(project: Project) -> None:
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


@st.dialog("Share", width="large", on_dismiss=lambda: session.drop(OPEN))
def shared(project: Project) -> None:
    """A link, a command and Python, each to be copied; the file where one of them needs it."""
    file = f"{pieces.called()}{SUFFIX}"
    link = link_of(project, st.query_params)
    pieces.note("The symbol at the right of each copies it.")
    pieces.note("Link to this page")
    if link is None:
        pieces.note("This project is too long for an address: send its file, which opens on any page.")
    else:
        st.code(link, language=None, wrap_lines=True)
    try:
        said = spoken(project, session.store().page, file)
    except RobomillError as exc:
        pieces.error(exc)
        return
    for title, words, language in (("Command", said.command, "bash"), ("Python", said.python, "python")):
        pieces.note(title)
        st.code(words, language=language, wrap_lines=True)
    if said.by_file or link is None:
        pieces.note(f"Run it in the folder in which {file} stands.")
        pieces.download("Save the file", project_to_toml(project), file, "share.file", icon=":material/save:")


def link_of(project: Project, beside: Mapping[str, str]) -> str | None:
    """The address of this page with this project, and of ``beside`` the lesson and its step; None where it is too
    long."""
    said = address.packed(project)
    if said is None:
        return None
    own = {key: beside[key] for key in LESSON if key in beside}
    return f"{(st.context.url or '').partition('?')[0]}?{urlencode(own | said)}"
