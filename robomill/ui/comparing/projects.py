"""Keep and compare: projects kept under a name, opened again and deleted; B, and up to three set-ups side by side.

B is an example, kept work, a file, or the project as it stands now.
"""

import time
from collections.abc import Mapping, Sequence
from functools import partial

import streamlit as st

from robomill.errors import ProjectError, RobomillError
from robomill.ui import pieces, session
from robomill.ui.comparing import other
from robomill.ui.comparing.differences import differences, outcomes
from robomill.ui.entry import inputs
from robomill.ui.keeping import autosave
from robomill.ui.keeping.shelf import Head, place_of
from robomill.ui.markup import as_markdown
from robomill.ui.project import (
    MAX_PROJECT_MB,
    preset_setup,
    presets,
    project_from_file,
    project_from_toml,
    project_to_toml,
)

NAME, CHOSEN, DELETED, OPEN = (f"snapshots.{word}" for word in ("name", "chosen", "deleted", "open"))
MOST = 3
NOTHING = ""


def open_door() -> None:
    """Open the door to kept projects and to B, on this page."""
    session.keep(OPEN, session.store().page)


def _close() -> None:
    session.drop(OPEN)


def show() -> None:
    """What is behind the door, while it is open; on another page it is not."""
    if session.kept(OPEN) == session.store().page:
        keep_and_compare()
    else:
        _close()


@st.dialog("Keep and compare", width="large", on_dismiss=_close)
def keep_and_compare() -> None:
    """The projects that this browser keeps, B, and those chosen side by side; closed once a project is taken."""
    if not session.kept(OPEN):
        st.rerun()
    if why := autosave.trouble():
        st.caption(as_markdown(why))
    heads = autosave.shelf().heads(autosave.line().key) if autosave.line().key else []
    named = [head for head in heads if head.place.startswith("name")]
    if autosave.line().key:
        _kept(heads, named)
    _b(named)
    if named:
        _side_by_side({head.place: head.name for head in named})


def _kept(heads: Sequence[Head], named: Sequence[Head]) -> None:
    """The project in force to be kept, what is kept under a name, and the work of other tabs."""
    with st.container(horizontal=True, vertical_alignment="bottom", gap="small"):
        name = session.kept(NAME, "")
        inputs.text("Keep the project in force as", NAME, name, partial(session.keep, NAME), max_chars=60)
        inputs.button("Keep", "snapshots.keep", "bookmark_add", _keep)
    for head in named:
        _row(head, deletable=True)
    if deleted := session.kept(DELETED):
        label = f"Put {deleted[0]} back"
        inputs.button(label, "snapshots.back", "undo", _put_back, type="tertiary")
    others = [head for head in heads if head.place.startswith("tab") and head.place != autosave.line().place]
    if others:
        st.caption("Work of other tabs of this browser")
    for head in others:
        _row(head)


def _row(head: Head, *, deletable: bool = False) -> None:
    with st.container(horizontal=True, vertical_alignment="center", gap="small", key=f"row-{head.place}"):
        st.text(f"{head.name} · {autosave.clock(head.time)}", width="stretch")
        inputs.button("Open", f"snapshots.open.{head.place}", "folder_open", _open, head.place, type="tertiary")
        if deletable:
            inputs.button("Delete", f"snapshots.delete.{head.place}", "delete", _delete, head.place, type="tertiary")


def _b(named: Sequence[Head]) -> None:
    """B by its name, as the project is now, or from a file."""
    pieces.note("B stands beside A, the project in force, on every page. Take B puts it in force; Undo leads back.")
    names, now = choices(named), session.project().view.beside
    now = now if now in names else NOTHING
    inputs.choice("Compare with", "other.which", names, now, _choose, inputs.LISTED)
    inputs.button("The project as it is now", "other.pin", "push_pin", _pin, width="stretch")
    fresh = session.store().revision
    inputs.upload("A project or set-up file (.toml)", "other.file", _take, most_MB=MAX_PROJECT_MB, fresh=fresh)


def choices(named: Sequence[Head]) -> dict[str, str]:
    """What can be compared with, by what ``other.choose`` takes."""
    names = {NOTHING: "Nothing"}
    names |= {f"{other.KEPT}:{head.place}": f"Kept: {head.name}" for head in named}
    names |= {f"{other.EXAMPLE}:{name}": f"Example: {preset_setup(name).name}" for name in presets()}
    held = other.other()
    if held is not None:  # a file, or the project as it was
        names.setdefault(session.project().view.beside, held.name)
    return names


def _side_by_side(titles: Mapping[str, str]) -> None:
    """A table of the project in force and those chosen of the ``titles`` by place."""
    chosen = [place for place in session.kept(CHOSEN, ()) if place in titles]
    label = f"Beside the project in force, up to {MOST}"
    inputs.several(label, CHOSEN, titles, chosen, _put_beside, inputs.PLAIN)
    if not chosen:
        return
    names, setups = ["In force"], [session.project().setup]
    for place in chosen:
        try:
            setups.append(project_from_toml(autosave.shelf().get(autosave.line().key, place)[1][0]).setup)
            names.append(titles[place])
        except RobomillError as exc:
            pieces.error(exc)
    rows = [*outcomes(setups, session.project().view.length), *differences(setups)]
    pieces.table(rows, "q" + "v" * len(setups), ["", *names])


def _put_beside(places: Sequence[str]) -> None:
    session.keep(CHOSEN, tuple(places[-MOST:]))


def _keep() -> None:
    name = session.kept(NAME, "").strip()
    if not name:
        raise ProjectError("Give the project a name to keep it under.")
    texts = [project_to_toml(session.project())]
    autosave.shelf().put(autosave.line().key, place_of(name), (name, 0.0), texts)
    session.keep(NAME, "")


def _open(place: str) -> None:
    autosave.bring_kept(place)
    _close()


def _delete(place: str) -> None:
    key = autosave.line().key
    head, texts = autosave.shelf().get(key, place)
    autosave.shelf().drop(key, place)
    session.keep(DELETED, (head.name, head.time, texts))


def _put_back() -> None:
    name, when, texts = session.kept(DELETED)
    autosave.shelf().put(autosave.line().key, place_of(name), (name, when), texts)
    session.drop(DELETED)


def _choose(which: str) -> None:
    other.choose(which)
    _close()


def _pin() -> None:
    now = session.project()
    other.pin(f"{now.setup.name}, as it was at {autosave.clock(time.time())}", now)
    _close()


def _take(data: bytes, name: str) -> None:
    new = project_from_file(data, name, session.project())
    other.pin(new.setup.name, new)
    _close()
