"""Every public name of ``import robomill as rm``, by the room of the package that it lives in."""

from __future__ import annotations

import inspect
from types import ModuleType

import robomill as rm
from robomill import learn

ROOMS = {
    "io": "Files in and out",
    "robot": "Robots",
    "kinematics": "Where the tool is",
    "compliance": "How much it gives",
    "workspace": "Maps",
    "toolpath": "Toolpaths",
    "cutting": "Cutters, materials and forces",
    "surface": "The part",
    "simulation": "A run",
    "identification": "Load tests and identification",
    "improve": "What would fix it",
    "study": "Studies",
    "report": "Tables and reports",
}
ELSEWHERE = {
    "compensate": "improve",
    "process_force": "cutting",
    "identify": "identification",
    "read_load_tests": "identification",
}
REST = "Further names"
ERRORS = "Errors"


def pages() -> dict[str, str]:
    """The generated piece by name."""
    by_room: dict[str, list[str]] = {title: [] for title in (*ROOMS.values(), REST, ERRORS)}
    for name in rm.__all__:
        by_room[_title(name, getattr(rm, name))].append(name)
    said = []
    for title, names in by_room.items():
        if names:
            listed = sorted(names, key=lambda name: (not inspect.isclass(getattr(rm, name)), name.lower()))
            said += [f"## {title}", *(_directive(name) for name in listed)]
    return {"names.md": "\n\n".join(said), "names_learn.md": "\n\n".join(_of_learn())}


def _of_learn() -> list[str]:
    """The names of ``from robomill import learn``, functions first: they are what a course begins with."""
    names = sorted(learn.__all__, key=lambda name: (inspect.isclass(getattr(learn, name)), name.lower()))
    return [_directive(name, learn) for name in names]


def _title(name: str, value: object) -> str:
    """The heading under which a name stands: by the room of its module, unless another is nearer to its subject."""
    if inspect.isclass(value) and issubclass(value, Exception):
        return ERRORS
    parts = str(getattr(value, "__module__", "")).split(".")
    room = ELSEWHERE.get(name, parts[1] if len(parts) > 1 else "")
    return ROOMS.get(room, REST)


def _directive(name: str, of: ModuleType = rm) -> str:
    value, called = getattr(of, name), f"{of.__name__}.{name}"
    if inspect.isclass(value):
        return f"```{{eval-rst}}\n.. autoclass:: {called}\n   :members:\n```"
    if inspect.isroutine(value):
        return f"```{{eval-rst}}\n.. autofunction:: {called}\n```"
    return f"```{{eval-rst}}\n.. autodata:: {called}\n```"
