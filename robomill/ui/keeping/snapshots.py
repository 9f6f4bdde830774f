"""Projects kept under a name: opened again, deleted, put beside each other and the one in force."""

import dataclasses
import hashlib
from collections.abc import Mapping, Sequence
from functools import partial
from typing import Any

import numpy as np
import streamlit as st

from robomill.errors import ProjectError, RobomillError
from robomill.io.setups.projects import setup_to_toml
from robomill.io.tables import parse_toml
from robomill.quantities import Quantity, quantities
from robomill.simulation.setup import SimulationSetup
from robomill.ui import pieces, session
from robomill.ui.entry import inputs
from robomill.ui.keeping import autosave
from robomill.ui.keeping.shelf import Head, place_of
from robomill.ui.markup import as_markdown
from robomill.ui.project import project_from_toml, project_to_toml
from robomill.ui.verdict import WORDS
from robomill.ui.work import cached
from robomill.units import format_si, unit_label

NAME, CHOSEN, DELETED, OPENED = (f"snapshots.{word}" for word in ("name", "chosen", "deleted", "opened"))
MOST = 3
# Of a set-up's file: what is no decision, or said by the rows above.
NOT_COMPARED = ("format", "version", "name", "description", "provenance")


@st.dialog("Kept projects", width="large")
def kept_projects() -> None:
    """The projects that this browser keeps, and those chosen beside the one in force."""
    if session.drop(OPENED):
        st.rerun()
    if why := autosave.trouble():
        st.caption(as_markdown(why))
    if not autosave.line().key:
        return
    heads = autosave.shelf().heads(autosave.line().key)
    named = [head for head in heads if head.place.startswith("name")]
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
    if named:
        titles = {head.place: head.name for head in named}
        chosen = [place for place in session.kept(CHOSEN, ()) if place in titles]
        label = f"Beside the project in force, up to {MOST}"
        inputs.several(label, CHOSEN, titles, chosen, _choose, inputs.PLAIN)
        if chosen:
            compared({titles[place]: place for place in chosen})


def show() -> None:
    """Open the list of kept projects."""
    session.drop(OPENED)
    kept_projects()


def _choose(places: Sequence[str]) -> None:
    session.keep(CHOSEN, tuple(places[-MOST:]))


def _row(head: Head, *, deletable: bool = False) -> None:
    with st.container(horizontal=True, vertical_alignment="center", gap="small", key=f"row-{head.place}"):
        st.text(f"{head.name} · {autosave.clock(head.time)}", width="stretch")
        inputs.button("Open", f"snapshots.open.{head.place}", "folder_open", _open, head.place, type="tertiary")
        if deletable:
            inputs.button("Delete", f"snapshots.delete.{head.place}", "delete", _delete, head.place, type="tertiary")


def _keep() -> None:
    name = session.kept(NAME, "").strip()
    if not name:
        raise ProjectError("Give the project a name to keep it under.")
    texts = [project_to_toml(session.project())]
    autosave.shelf().put(autosave.line().key, place_of(name), (name, 0.0), texts)
    session.keep(NAME, "")


def _open(place: str) -> None:
    autosave.bring_kept(place)
    session.keep(OPENED, True)


def _delete(place: str) -> None:
    key = autosave.line().key
    head, texts = autosave.shelf().get(key, place)
    autosave.shelf().drop(key, place)
    session.keep(DELETED, (head.name, head.time, texts))


def _put_back() -> None:
    name, when, texts = session.kept(DELETED)
    autosave.shelf().put(autosave.line().key, place_of(name), (name, when), texts)
    session.drop(DELETED)


def compared(places: Mapping[str, str]) -> None:
    """The table: what each project comes to, then what differs in the set-ups by name and value."""
    names, setups = ["In force"], [session.project().setup]
    for name, place in places.items():
        try:
            setups.append(project_from_toml(autosave.shelf().get(autosave.line().key, place)[1][0]).setup)
            names.append(name)
        except RobomillError as exc:
            pieces.error(exc)
    rows = [*outcomes(setups, session.project().view.length), *differences(setups)]
    pieces.table(rows, "q" + "v" * len(setups), ["", *names])


def outcomes(setups: Sequence[SimulationSetup], unit: str) -> list[list[str]]:
    """Robot, force, wall, floor and verdict of each set-up, a row each."""
    return [list(row) for row in zip(OUTCOMES, *(_outcome(setup, unit) for setup in setups), strict=True)]


OUTCOMES = ("Robot", "Force", "Wall error", "Floor error", "Verdict")


def _outcome(setup: SimulationSetup, unit: str) -> tuple[str, ...]:
    robot, force = setup.robot.title or setup.robot.name, setup.force.title
    try:
        result = cached.result(setup)
    except RobomillError as exc:
        return robot, force, "–", "–", str(exc)
    verdict = result.verdict
    read = [
        format_si(each.value, unit, sign=True) if each.worst >= 0 else "–" for each in (verdict.wall, verdict.floor)
    ]
    size = np.linalg.norm(result.F[result.path.cutting], axis=-1)
    size = size[np.isfinite(size)]
    most = f", up to {format_si(float(size.max()), 'N')}" if size.size else ""
    return robot, force + most, *read, WORDS[verdict.level]


def differences(setups: Sequence[SimulationSetup]) -> list[list[str]]:
    """What the set-ups' files say differently, a row each: its name, then each value."""
    said = [_flat(parse_toml(setup_to_toml(setup), "set-up")) for setup in setups]
    rows = []
    for key in dict.fromkeys(key for each in said for key in each):
        values = [each.get(key) for each in said]
        if any(value != values[0] for value in values[1:]):
            declared = next((found for setup in setups if (found := _declared(setup, key))), None)
            rows.append([_title(key, declared), *(_shown(value, declared) for value in values)])
    return rows


def _flat(table: Mapping[str, Any], under: tuple[str, ...] = ()) -> dict[tuple[str, ...], Any]:
    found: dict[tuple[str, ...], Any] = {}
    for name, value in table.items():
        if not under and name in NOT_COMPARED:
            continue
        found |= _flat(value, (*under, name)) if isinstance(value, Mapping) else {(*under, name): value}
    return found


def _declared(setup: SimulationSetup, key: tuple[str, ...]) -> Quantity | None:
    """The declared number that stands under ``key`` of the set-up's file."""
    owner: Any = getattr(setup, key[0], None) if len(key) == 2 and key[0] != "numerics" else setup
    known = quantities(type(owner)).values() if dataclasses.is_dataclass(owner) else ()
    return next((each for each in known if each.key == key[-1]), None)


def _title(key: tuple[str, ...], declared: Quantity | None) -> str:
    where = "" if len(key) == 1 or key[0] == "numerics" else f"{key[0].capitalize()}: "
    return where + (declared.label if declared is not None else " ".join(key[-1:]).replace("_", " "))


def _shown(value: Any, declared: Quantity | None) -> str:
    """A value of a file in few words."""
    if value is None:
        return "–"
    if isinstance(value, bool):
        return "on" if value else "off"
    if isinstance(value, float | int):
        unit = unit_label(declared.unit) if declared is not None else ""
        return f"{value:.6g} {unit}".rstrip()
    if isinstance(value, list) and all(isinstance(each, float | int) for each in value) and len(value) <= 7:
        return ", ".join(_shown(each, None) for each in value)
    text = str(value)
    if len(text) <= 60 and "\n" not in text:
        return text
    return f"{len(text.splitlines())} lines ({hashlib.sha256(text.encode()).hexdigest()[:6]})"
