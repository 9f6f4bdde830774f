"""What every page begins with: page config, style, project store and sidebar."""

from __future__ import annotations

import re
from typing import Any

import streamlit as st

from robomill import compiled
from robomill.errors import RobomillError
from robomill.ui import inputs, render, state, uncertainty
from robomill.ui.files import SUFFIX, project_to_toml
from robomill.ui.parts import error
from robomill.ui.style import CSS, LOGO
from robomill.ui.theme_watch import theme_watch
from robomill.viz.theme import palette

MAX_PROJECT_MB = 25
UNIT_CHOICES = {"mm": "mm", "in": "inch"}
JOINT_UNITS = {"1e-7 rad/(N m)": "×10⁻⁷ rad/(N m)", "kN m/rad": "kN m/rad"}


def begin(title: str) -> state.Project:
    """Start a page: the first call of every page. Returns the project of this session."""
    st.set_page_config(page_title=f"{title} · robomill", page_icon=":material/precision_manufacturing:", layout="wide")
    st.html(CSS)
    render.worker()
    if compiled.missing():
        with st.spinner(f"{compiled.WORDS} ..."):
            compiled.build()
    p = palette(dark())
    st.logo(LOGO.format(accent=p.accent, text=p.text), size="large")
    try:
        state.enter(title)
    except RobomillError as exc:
        error(exc)
        st.stop()
    with st.sidebar:
        _sidebar()
        theme_watch()
    return state.project()


def dark() -> bool:
    """Whether the person's screen is dark."""
    return st.context.theme.type == "dark"


def _sidebar() -> None:
    kept = state.store()
    with st.container(horizontal=True, gap="small"):
        st.button(
            "Undo", icon=":material/undo:", disabled=not kept.past, on_click=state.undo, width="stretch", key="undo"
        )
        st.button(
            "Redo", icon=":material/redo:", disabled=not kept.future, on_click=state.redo, width="stretch", key="redo"
        )
    _preset()
    view = kept.project.view
    inputs.choice("Lengths", "view.units", UNIT_CHOICES, view.units, lambda v: state.look(units=v))
    inputs.choice(
        "Joint compliance",
        "view.joint_unit",
        JOINT_UNITS,
        view.joint_unit,
        lambda v: state.look(joint_unit=v),
        horizontal=False,
    )
    _project(kept)


def _preset() -> None:
    names = state.presets()
    current = state.project().preset
    titles = {name: name.replace("_", " ").capitalize() for name in names}
    if current not in titles:
        titles = {current: "Your file", **titles}
    inputs.choice("Preset", "project.preset", titles, current, state.open_preset, horizontal=False)
    if current in names and state.project().setup.digest() != state.preset_setup(current).digest():
        st.button(
            "Back to preset",
            icon=":material/restart_alt:",
            key="back",
            width="stretch",
            type="tertiary",
            on_click=state.open_preset,
            args=(current,),
        )


def _project(kept: state.Store) -> None:
    project = kept.project
    st.caption("Project")
    known = uncertainty.to_table(project.setup)  # here, since a download's callable runs outside the session
    with st.container(horizontal=True, gap="small"):
        with st.popover("Open", icon=":material/folder_open:", width="stretch", key="open"):
            _open(kept)
        st.download_button(
            "Save",
            data=lambda: project_to_toml(project, known),
            file_name=_file_name(project.setup.name),
            mime="application/toml",
            icon=":material/save:",
            on_click="ignore",
            width="stretch",
            key="save",
        )
    waiting = kept.refused.get("open")
    if waiting:
        error(waiting[1])


def _open(kept: state.Store) -> None:
    key = f"open:{kept.revision}"
    st.file_uploader(
        "A project or set-up file (.toml)",
        key=key,
        type=["toml"],
        max_upload_size=MAX_PROJECT_MB,
        on_change=lambda: _take(st.session_state.get(key)),
    )
    inputs.sentence("open")  # here as well: the open popover lies over the sentence in the side bar


def _take(file: Any) -> None:
    if file is None:
        inputs.accept("open")
        return
    try:
        text = file.getvalue().decode("utf-8")
    except UnicodeDecodeError:
        inputs.refuse("open", None, f"{file.name}: this is not a text file; expected a project saved by robomill.")
        return
    reason = state.open_text(text)
    if reason:
        inputs.refuse("open", None, f"{file.name} was not opened. {reason} Your project is as it was.")


def _file_name(name: str) -> str:
    return (re.sub(r"[^A-Za-z0-9]+", "-", name).strip("-").lower() or "project") + SUFFIX
