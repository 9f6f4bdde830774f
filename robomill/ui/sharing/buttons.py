"""The buttons by which a project is handed on, on every page: a report of the cut; a link, a command, Python."""

from collections.abc import Mapping
from urllib.parse import urlencode

import streamlit as st

from robomill.errors import RobomillError
from robomill.ui import pieces, session
from robomill.ui.project import SUFFIX, Project, project_to_toml
from robomill.ui.sharing import address, report
from robomill.ui.sharing.spoken import spoken

OPEN = "handing.open"  # the page on which the panel is open
LESSON = ("lesson", "step")  # what an address says beside the project


def row(project: Project) -> None:
    """The buttons beside the project's file."""
    with st.container(horizontal=True, gap="small"):
        report.button(project)
        here = session.store().page
        st.button(
            "Share", key="share", icon=":material/share:", width="stretch", on_click=session.keep, args=(OPEN, here)
        )
    if session.kept(OPEN) == here:  # also when the page runs once more beside it
        shared(project)


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
        if words:
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
