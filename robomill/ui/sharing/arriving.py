"""Who comes by a link: its project is opened where no work of one's own is in force, and offered where some is."""

from dataclasses import dataclass

import streamlit as st

from robomill.errors import RobomillError
from robomill.ui import pieces, session
from robomill.ui.entry import inputs
from robomill.ui.keeping import autosave
from robomill.ui.markup import as_markdown
from robomill.ui.project import Project
from robomill.ui.sharing import address

NOTICE = "arriving.notice"


@dataclass(frozen=True, eq=False)
class Arrived:
    """What a link brought: the project that waits to be opened, or why there is none."""

    project: Project | None = None
    why: str = ""


def take_up() -> None:
    """Read the link by which the page was opened, once: the address has it no longer then, a reload brings one's own
    work."""
    said = {key: st.query_params[key] for key in address.KEYS if key in st.query_params}
    if not said:
        return
    for key in said:
        del st.query_params[key]
    try:
        brought = address.opened(said)
    except RobomillError as exc:
        session.keep(NOTICE, Arrived(why=str(exc)))
        return
    if brought.digest() == session.project().digest():
        return
    if autosave.untouched(session.project()):
        session.open_project(brought)
    else:
        session.keep(NOTICE, Arrived(brought))


def notice() -> None:
    """What a link brought, while nobody has answered."""
    found: Arrived | None = session.kept(NOTICE)
    if found is None:
        return
    if found.project is None:
        pieces.error(f"The link was not opened. {found.why} Your project is as it was.")
        inputs.button("OK", "arriving.ok", "check", session.drop, NOTICE, type="tertiary")
        return
    with st.container(horizontal=True, vertical_alignment="center", gap="small", key="arriving-notice"):
        name = found.project.setup.name
        st.markdown(
            f":material/link: The link holds another project, {as_markdown(name)}. Yours is as it was.", width="stretch"
        )
        inputs.button("Open it", "arriving.open", "folder_open", _open, found.project, type="tertiary")
        inputs.button("Keep mine", "arriving.keep", "check", session.drop, NOTICE, type="tertiary")


def _open(project: Project) -> None:
    session.open_project(project)
    session.drop(NOTICE)
