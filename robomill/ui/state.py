"""The project: one frozen value under one session key, with its history. Widgets are views of it.

``Project`` is what a person works on: the simulation set-up and how it is looked at. Every change replaces it
(``change``, ``look``), so undo is a list of earlier values and nothing typed is lost on a page change.
"""

from __future__ import annotations

import dataclasses
import time
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any, cast

import numpy as np
import streamlit as st

from robomill.errors import RobomillError
from robomill.io.projects import load_setup
from robomill.io.samples import samples_dir
from robomill.provenance import Provenance
from robomill.robot.model import Robot
from robomill.simulation.setup import SimulationSetup

KEY = "robomill"
EDITED = Provenance("user", "entered in the app")
# Blocks of a set-up whose numbers become the user's own when their field is changed.
BLOCKS = {
    "source": "path",
    "T_MW": "part",
    "cutter": "cutter",
    "force": "force",
    "stock": "stock",
    "tolerance": "tolerance",
}
ROBOT_BLOCKS = {
    "geometry": ("alpha", "a", "d", "theta_offset", "sign"),
    "lengths": ("a", "d"),
    "limits": ("limits_all",),
    "tool": ("T_tool",),
    "base": ("T_base",),
}
DEFAULT_PRESET = "paper_flute"
MAX_HISTORY = 60
ONE_GESTURE_S = 1.2  # a slider being dragged sends many values; they are one step back


@dataclass(frozen=True)
class View:
    """How the project is looked at; saved with it, but not part of the history."""

    units: str = "mm"
    joint_unit: str = "1e-7 rad/(N m)"
    exaggeration: float = 10.0
    station: float = 0.5
    camera: str = "iso"
    share_axis: str = "y"
    theta: tuple[float, ...] | None = None

    @property
    def length(self) -> str:
        """Unit of lengths and deviations, a key of ``UNITS``."""
        return self.units

    @property
    def feed(self) -> str:
        """Unit of feed rates."""
        return "in/min" if self.units == "in" else "mm/min"


@dataclass(frozen=True, eq=False)
class Project:
    """The set-up, the view on it, and the preset it began with."""

    setup: SimulationSetup
    view: View = field(default_factory=View)
    preset: str = DEFAULT_PRESET


@dataclass(eq=False)
class Store:
    """What lives in the session: the project, its history, and input that was refused but is still shown.

    ``revision`` counts changes that came from outside a table editor, so that editors start afresh then. ``seeded`` are
    the widgets of ``page`` that have been given their value: a widget that returns with its page has lost it.
    """

    project: Project
    past: list[Project] = field(default_factory=list)
    future: list[Project] = field(default_factory=list)
    revision: int = 0
    refused: dict[str, tuple[Any, str]] = field(default_factory=dict)
    frames: dict[str, Any] = field(default_factory=dict)
    last_label: str = ""
    last_time: float = 0.0
    page: str = ""
    seeded: set[str] = field(default_factory=set)


def presets() -> dict[str, str]:
    """Folder name -> folder name of every sample with a set-up, the default first."""
    names = sorted(path.parent.name for path in samples_dir().glob("*/setup.toml"))
    return {name: name for name in sorted(names, key=lambda name: (name != DEFAULT_PRESET, name))}


@st.cache_resource(max_entries=32, show_spinner=False)
def preset_setup(name: str) -> SimulationSetup:
    """The set-up of a sample folder, read once."""
    return load_setup(samples_dir() / name / "setup.toml")


def store() -> Store:
    """The session's store; the first call opens the paper's milling test."""
    if KEY not in st.session_state:
        st.session_state[KEY] = Store(Project(preset_setup(DEFAULT_PRESET)))
    return cast(Store, st.session_state[KEY])


def enter(page: str) -> None:
    """Say which page is running, so that widgets shared by pages are seeded again after a page change."""
    kept = store()
    if kept.page != page:
        kept.page = page
        kept.seeded.clear()


def project() -> Project:
    """The project of this session."""
    return store().project


def before() -> Project | None:
    """The project before the last change, for ghosts and differences; None at the start."""
    past = store().past
    return past[-1] if past else None


def change(*, label: str = "", from_editor: bool = False, **fields: Any) -> None:
    """Replace fields of the set-up; remembered for undo. Quick changes with one ``label`` count as one.

    Raises the RobomillError of the field that refuses; the project then stays as it was.
    """
    kept = store()
    given = kept.project.setup
    marked = dict(given.provenance) | {BLOCKS[name]: EDITED for name in fields if name in BLOCKS}
    if isinstance(fields.get("robot"), Robot):
        fields["robot"] = _marked(given.robot, fields["robot"])
    new = given.replace(**{"provenance": marked, **fields})
    if new.digest() != given.digest():
        replace(dataclasses.replace(kept.project, setup=new), label, from_editor)


def _marked(old: Robot, new: Robot) -> Robot:
    """``new`` with the blocks that were changed by hand said to be the user's own."""
    if old.name != new.name or dict(old.provenance) != dict(new.provenance):
        return new
    changed = {
        block: EDITED
        for block, names in ROBOT_BLOCKS.items()
        if block in new.provenance and not all(np.array_equal(getattr(old, n), getattr(new, n)) for n in names)
    }
    return new.replace(provenance={**new.provenance, **changed}) if changed else new


def replace(new: Project, label: str = "", from_editor: bool = False) -> None:
    """Put a whole new project in force; the old one can be had back with ``undo``."""
    kept = store()
    now = time.monotonic()
    if not (label and label == kept.last_label and kept.past and now - kept.last_time < ONE_GESTURE_S):
        kept.past = [*kept.past, kept.project][-MAX_HISTORY:]
    kept.project, kept.future, kept.last_label, kept.last_time = new, [], label, now
    if not from_editor:
        kept.revision += 1


def look(**fields: Any) -> None:
    """Replace fields of the view; not part of the history."""
    kept = store()
    kept.project = dataclasses.replace(kept.project, view=dataclasses.replace(kept.project.view, **fields))


def undo() -> None:
    """Back to the project before the last change; the view stays."""
    _step(lambda kept: (kept.past, kept.future))


def redo() -> None:
    """Forward again after an undo."""
    _step(lambda kept: (kept.future, kept.past))


def _step(lists: Callable[[Store], tuple[list[Project], list[Project]]]) -> None:
    kept = store()
    source, target = lists(kept)
    if not source:
        return
    target.append(kept.project)
    kept.project = dataclasses.replace(source.pop(), view=kept.project.view)
    _forget(kept)


def open_preset(name: str) -> None:
    """Start from a sample; undo leads back."""
    kept = store()
    replace(Project(preset_setup(name), kept.project.view, name))
    look(theta=None)
    _forget(kept)


def open_text(text: str) -> str:
    """Open a project file; returns "" or the reason why it was refused (the current project then stays)."""
    from robomill.ui.files import project_from_toml

    try:
        new = project_from_toml(text, store().project.view)
    except RobomillError as exc:
        return str(exc)
    replace(new)
    _forget(store())
    return ""


def _forget(kept: Store) -> None:
    kept.revision += 1
    kept.last_label = ""
    kept.refused.clear()
    kept.frames.clear()
