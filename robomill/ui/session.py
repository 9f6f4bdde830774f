"""What lives in a session: the project with its history, values that outlive their page, and refused input.

``Project`` is the whole truth of what a person decided. Every change replaces it (``change``, ``look``), so undo is a
list of earlier values and nothing typed is lost on a page change. What belongs to no project (a film being made, a
file waiting to be read, the view of a panel) is kept by name: ``keep("milling.question", "tip")``.
"""

from __future__ import annotations

import contextlib
import dataclasses
import math
import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from typing import Any, cast

import streamlit as st

from robomill.budgets import weight
from robomill.errors import RobomillError
from robomill.identification.knowledge import Knowledge
from robomill.provenance import GIVEN, TYPED
from robomill.robot.model import Robot
from robomill.robot.sources import changed_blocks
from robomill.simulation.origin.sources import changed_sources
from robomill.simulation.setup import SimulationSetup
from robomill.ui.bench import Bench
from robomill.ui.project import DEFAULT_PRESET, MapView, Project, preset_setup, project_from_toml
from robomill.ui.serving.closing import while_open

KEY = "robomill"
EDITED = TYPED
MAX_HISTORY = 60
MAX_HISTORY_BYTES = 32 * 2**20  # of a session; the project before the last change stays, however heavy
HEAVY = 2**20  # bytes of a project whose history is weighed: weighing takes as long as a history is deep
ONE_GESTURE_S = 1.2  # a slider being dragged sends many values; they are one step back


@dataclass(frozen=True)
class Told:
    """What was ``put`` into a widget and ``when`` (monotonic), and what it held ``before``, the last first."""

    put: Any
    before: tuple[Any, ...] = ()
    when: float = -math.inf


@dataclass(eq=False)
class Store:
    """What lives in the session: the project, its history, and input that was refused but is still shown.

    ``values`` are kept by name. ``read_as`` says of numbers just typed what is shown for them and how they were meant.
    ``revision`` counts changes that came from outside a table editor, so that editors
    start afresh then. ``seeded`` are the widgets of ``page`` that have been given their value: a widget that returns
    with its page has lost it. ``older`` are project files of an earlier session, to be gone back to after ``past``.
    ``keeper`` is called after every change. ``returned``: the page was open before this session was (its server had
    forgotten it), and what its widgets hold beside the project is the edit of that moment. ``runs`` counts the
    runs of pages. ``heavy`` are names of what is kept only while a browser is there. ``told`` says what was put into
    widgets over what they held; ``said`` when the browser last said something new of each, None where nobody listens.
    """

    project: Project
    past: list[Project] = field(default_factory=list)
    future: list[Project] = field(default_factory=list)
    values: dict[str, Any] = field(default_factory=dict)
    revision: int = 0
    refused: dict[str, tuple[Any, str]] = field(default_factory=dict)
    read_as: dict[str, tuple[str, str]] = field(default_factory=dict)
    frames: dict[str, Any] = field(default_factory=dict)
    last_label: str = ""
    last_time: float = 0.0
    page: str = ""
    runs: int = 0
    seeded: set[str] = field(default_factory=set)
    heavy: set[str] = field(default_factory=set)
    older: list[str] = field(default_factory=list)
    keeper: Callable[[Store], None] | None = None
    returned: bool = False
    told: dict[str, Told] = field(default_factory=dict)
    said: dict[str, float] | None = None

    def let_go(self) -> None:
        """Let go of what is heavy, save for work under way: the browser may come back for it."""
        while self.heavy:
            name = self.heavy.pop()
            if not getattr(self.values.get(name), "under_way", False):
                self.values.pop(name, None)

    def put(self, project: Project) -> None:
        """Put ``project`` in force, and have it kept."""
        self.project = project
        if self.keeper is not None:
            self.keeper(self)


def store() -> Store:
    """The session's store; the first call opens the paper's milling test."""
    if KEY not in st.session_state:
        st.session_state[KEY] = Store(Project(preset_setup(DEFAULT_PRESET)))
    return cast(Store, st.session_state[KEY])


def enter(page: str) -> None:
    """Say which page is running, so that widgets shared by pages are seeded again after a page change."""
    held = store()
    held.runs += 1
    while_open(held)
    if held.page != page:
        held.returned = held.returned and not held.page
        held.page = page
        held.seeded.clear()
        held.told.clear()
        held.read_as.clear()


def kept(name: str, otherwise: Any = None) -> Any:
    """The value kept under ``name`` ("page.thing"), for as long as the session lasts."""
    return store().values.get(name, otherwise)


def keep(name: str, value: Any) -> None:
    """Keep ``value`` under ``name``; it outlives a visit to another page."""
    store().values[name] = value


def hold(name: str, value: Any) -> None:
    """Keep ``value`` under ``name`` for as long as a browser is there: results and pictures, which can be had again.

    A page that was closed, or cut off, is remembered for some minutes, with its project but without these.
    """
    store().heavy.add(name)
    keep(name, value)


def drop(name: str) -> Any:
    """Forget what is kept under ``name``, and return it; None where nothing is."""
    return store().values.pop(name, None)


def project() -> Project:
    """The project of this session."""
    return store().project


def maps() -> MapView:
    """What the maps look at, for the project's robot."""
    now = project()
    return now.maps.of(now.setup.robot)


def before() -> Project | None:
    """The project before the last change, for ghosts and differences; None at the start."""
    past = store().past
    return past[-1] if past else None


def change(*, label: str = "", from_editor: bool = False, **fields: Any) -> None:
    """Replace fields of the set-up; remembered for undo. Quick changes with one ``label`` count as one.

    Raises the RobomillError of the field that refuses; the project then stays as it was.
    """
    held = store()
    given = held.project.setup
    if isinstance(fields.get("robot"), Robot):
        fields["robot"] = _marked(given.robot, fields["robot"])
    said = changed_sources(given, fields, EDITED) | fields.get("provenance", {})
    new = held.project.replace(setup=given.replace(**{**fields, "provenance": said}))
    if new.digest() != held.project.digest():
        replace(new, label, from_editor)


def _marked(old: Robot, new: Robot) -> Robot:
    """``new`` with what was changed in ``old`` said to be entered here, where nothing more is known of it."""
    if old.name != new.name:
        return new
    here = {block: EDITED for block in changed_blocks(old, new) if new.provenance.get(block) == GIVEN}
    return new.replace(provenance=here) if here else new


def replace(new: Project, label: str = "", from_editor: bool = False) -> None:
    """Put a whole new project in force; the old one can be had back with ``undo``."""
    held = store()
    now = time.monotonic()
    if not (label and label == held.last_label and held.past and now - held.last_time < ONE_GESTURE_S):
        held.past = remembered([*held.past, held.project])
    held.future, held.last_label, held.last_time = [], label, now
    if not from_editor:
        held.revision += 1
    held.put(new)


def remembered(past: list[Project]) -> list[Project]:
    """The last of them: no more, and together no heavier, than a session may keep."""
    past = past[-MAX_HISTORY:]
    if weight(past[-1]) > HEAVY:
        while len(past) > 1 and weight(past) > MAX_HISTORY_BYTES:
            past = past[1:]
    return past


@contextlib.contextmanager
def as_if(other: Project) -> Iterator[Project]:
    """As if ``other`` were in force, with nothing before it: for what a page says of it then. It is not kept."""
    held = store()
    now = held.project, held.past
    held.project, held.past = other, []
    try:
        yield other
    finally:
        held.project, held.past = now


def look(**fields: Any) -> None:
    """Replace fields of the view; not part of the history."""
    held = store()
    held.put(held.project.replace(view=dataclasses.replace(held.project.view, **fields)))


def see(**fields: Any) -> None:
    """Replace fields of what the maps look at; not part of the history."""
    held = store()
    held.put(held.project.replace(maps=dataclasses.replace(maps(), **fields)))


def experiment(bench: Bench, label: str = "") -> None:
    """Put another bench of load tests in force; remembered for undo as ``change`` is."""
    held = store()
    if bench.digest() != held.project.bench.digest():
        replace(held.project.replace(bench=bench), label)


def know(found: Knowledge) -> None:
    """Say how sure the compliances in force are, where that has changed; undo leads back with the compliances."""
    held = store()
    setup = held.project.setup
    held.put(held.project.replace(knowledge=found.held_by(setup.robot, setup.springs)))


def known(setup: SimulationSetup) -> Knowledge | None:
    """What the project knows of the compliances of ``setup``; None where they did not come from an identification."""
    now = project()
    return now.knowledge if now.holds(setup) else None


def undo() -> None:
    """Back to the project before the last change; the looking stays."""
    _step(lambda held: (held.past, held.future))


def redo() -> None:
    """Forward again after an undo."""
    _step(lambda held: (held.future, held.past))


def _step(lists: Callable[[Store], tuple[list[Project], list[Project]]]) -> None:
    held = store()
    source, target = lists(held)
    if source is held.past and not source:
        _recall(held)
    if not source:
        return
    target.append(held.project)
    held.put(source.pop().replace(view=held.project.view, maps=held.project.maps))
    _forget(held)


def _recall(held: Store) -> None:
    """The last state of an earlier session into the past; one that this robomill no longer reads is passed over."""
    while held.older and not held.past:
        with contextlib.suppress(RobomillError):
            held.past.append(project_from_toml(held.older.pop()))


def open_preset(name: str) -> None:
    """Start from a sample; undo leads back."""
    held = store()
    now = held.project
    replace(Project(preset_setup(name), now.view, name, now.maps, bench=now.bench))
    look(theta=None)
    _forget(held)


def open_project(new: Project) -> None:
    """Put another project in force; undo leads back."""
    replace(new)
    _forget(store())


def _forget(held: Store) -> None:
    held.revision += 1
    held.last_label = ""
    held.refused.clear()
    held.read_as.clear()
    held.frames.clear()
