"""What the project is compared with: an example, kept work, a file, or the project as it stands now."""

import time

import streamlit as st

from robomill.errors import ProjectError
from robomill.files import SETUP
from robomill.io.texts import read_text
from robomill.ui import other, pieces, session
from robomill.ui.entry import inputs
from robomill.ui.keeping import autosave
from robomill.ui.project import MAX_PROJECT_MB, preset_setup, presets, project_from_toml

NOTHING, CHOSEN = "", "other.chosen"


@st.dialog("Compare with …")
def comparing() -> None:
    """The list, the moment and the file to compare with; closed once something is chosen."""
    if session.drop(CHOSEN):
        st.rerun()
    pieces.note("B stands beside A, the project in force, on every page. Take B puts it in force; Undo leads back.")
    names, now = choices(), session.project().view.beside
    now = now if now in names else NOTHING
    inputs.choice("Compare with", "other.which", names, now, _choose, inputs.LISTED)
    inputs.button("The project as it is now", "other.pin", "push_pin", _pin, width="stretch")
    fresh = session.store().revision
    inputs.upload("A project or set-up file (.toml)", "other.file", _take, most_MB=MAX_PROJECT_MB, fresh=fresh)


def show() -> None:
    """Open it."""
    session.drop(CHOSEN)
    comparing()


def choices() -> dict[str, str]:
    """What can be compared with, by what ``other.choose`` takes."""
    names = {NOTHING: "Nothing"}
    held = session.kept(other.HELD)
    if held is not None:
        names[other.HERE] = held.name
    if autosave.line().key:
        for head in autosave.shelf().heads(autosave.line().key, "name"):
            names[f"{other.KEPT}:{head.place}"] = f"Kept: {head.name}"
    return names | {f"{other.EXAMPLE}:{name}": f"Example: {preset_setup(name).name}" for name in presets()}


def _choose(which: str) -> None:
    other.choose(which)
    session.keep(CHOSEN, True)


def _pin() -> None:
    now = session.project()
    session.keep(CHOSEN, True)
    other.pin(f"{now.setup.name}, as it was at {autosave.clock(time.time())}", now)


def _take(data: bytes, name: str) -> None:
    try:
        new = project_from_toml(read_text(data, ProjectError, SETUP, name)[0])
    except ProjectError as exc:
        raise ProjectError(f"{name} was not opened. {exc} Your project is as it was.") from None
    other.pin(new.setup.name, new)
    session.keep(CHOSEN, True)
