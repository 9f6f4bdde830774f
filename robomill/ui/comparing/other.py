"""The other project, B: what the one in force, A, is held against on every page, each simulated by itself.

B is an example, work that is kept, a file, or the project as it stood at a moment. What a page says of B is what it
would say were B in force: so says it the same code, and so B can be taken as it is.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager, suppress
from dataclasses import dataclass, replace

from robomill.errors import ProjectError, RobomillError
from robomill.simulation.result import SimulationResult
from robomill.simulation.setup import SimulationSetup
from robomill.ui import pieces, session
from robomill.ui.keeping import autosave
from robomill.ui.keeping.shelf import PLACE, side_of
from robomill.ui.pieces import Tile
from robomill.ui.project import Project, preset_setup, presets, project_from_toml, project_to_toml
from robomill.ui.work import cached, job, running
from robomill.ui.work.job import Underway

EXAMPLE, KEPT, HERE = "example", "kept", "here"  # where B is from; "here" is what only this session can hold
HELD, READ, RUN = "other.held", "other.read", "other.run"


@dataclass(frozen=True, eq=False)
class Other:
    """B, and what it is called."""

    name: str
    project: Project


def other() -> Other | None:
    """What the project in force is held against; None where nothing is, or what was is no longer there."""
    kind, _, name = session.project().view.beside.partition(":")
    if kind == EXAMPLE and name in presets():
        return Other(preset_setup(name).name, Project(preset_setup(name), preset=name))
    if kind == KEPT and PLACE.fullmatch(name):
        return _read(name)
    found: Other | None = session.kept(HELD) if kind == HERE else None
    return found


def _read(place: str) -> Other | None:
    """Work that this browser keeps, read once."""
    known: tuple[str, Other] | None = session.kept(READ)
    if known is None or known[0] != place:
        key = autosave.line().key
        try:
            if not key or not autosave.shelf().has(key, place):
                return None
            head, texts = autosave.shelf().get(key, place)
            known = place, Other(head.name, project_from_toml(texts[0]))
        except RobomillError:
            return None
        session.keep(READ, known)
    return known[1]


def choose(which: str) -> None:
    """Hold the project against ``which``: "example:heart", "kept:name-...", or "" for nothing."""
    job.give_up(RUN)
    session.drop(READ)
    session.look(beside=which)


def pin(name: str, project: Project) -> None:
    """Hold the project in force against a ``project``, after a reload as well where work is kept at all."""
    key, place = autosave.line().key, side_of(f"{name}\n{project.digest()}")
    session.drop(HELD)
    with suppress(ProjectError):  # what cannot be kept is held by this session
        if key:
            autosave.shelf().put(key, place, (name, 0.0), [project_to_toml(project)])
            choose(f"{KEPT}:{place}")
            return
    choose(HERE)
    session.keep(HELD, Other(name, project))


def taking(found: Other) -> Project:
    """B as the project: its set-up and what is known of it, looked at as now."""
    new = found.project
    return session.project().replace(setup=new.setup, preset=new.preset, knowledge=new.knowledge)


def take() -> None:
    """Put B in force; undo leads back to A."""
    found = other()
    if found is not None:
        session.open_project(taking(found))


@contextmanager
def in_force() -> Iterator[Project | None]:
    """As if B were the project: what a page says of it then. None where there is no B, or A is the same set-up."""
    found = other()
    if found is None or found.project.setup.digest() == session.project().setup.digest():
        yield None
        return
    with session.as_if(taking(found)) as project:
        yield project


def result(setup: SimulationSetup) -> SimulationResult:
    """The run of B. Raises its refusal, and ``Underway`` where it goes on beside the page."""
    return running.computed(setup, RUN)


def held() -> SimulationResult | None:
    """The run of B where it is there."""
    with in_force() as project:
        return None if project is None else cached.held(project.setup)


def tiles(made: Sequence[Tile], theirs: Callable[[Project], Sequence[Tile]]) -> None:
    """The tiles ``made`` of A, with those of B in them: ``theirs`` makes them as if B were the project."""
    beside: list[Tile] = []
    with in_force() as project:
        if project is not None:
            beside = _theirs(project, theirs)
    pieces.tiles([replace(tile, other=_value(tile, *beside[k : k + 1])) for k, tile in enumerate(made)])


def _theirs(project: Project, theirs: Callable[[Project], Sequence[Tile]]) -> list[Tile]:
    """None while its run is not there, or where it is refused: the bar says how far it is, or why."""
    try:
        with suppress(RobomillError):  # what needs no run is there all the same
            result(project.setup)
        return list(theirs(project))
    except (RobomillError, Underway):
        return []


def _value(tile: Tile, theirs: Tile | None = None) -> str:
    if theirs is None:
        return ""
    return theirs.value if theirs.label == tile.label else f"{theirs.value}, {theirs.label}"
