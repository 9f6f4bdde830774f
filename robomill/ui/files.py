"""The project as one versioned file: the set-up of ``io.projects`` with a ``[view]`` table after it."""

from __future__ import annotations

import dataclasses
from typing import Any

import tomli_w

from robomill.errors import ProjectError
from robomill.io.projects import open_project, setup_to_toml
from robomill.io.tables import parse_toml
from robomill.ui import uncertainty
from robomill.ui.state import Project, View

WHERE = "project file"
SUFFIX = ".robomill.toml"


def project_to_toml(project: Project, known: dict[str, Any] | None = None) -> str:
    """The project as text that ``project_from_toml`` reads back to the same set-up and view.

    ``known``: how sure the compliances are, as ``uncertainty.to_table`` gives it.
    """
    view = {k: v for k, v in dataclasses.asdict(project.view).items() if v is not None}
    return (
        setup_to_toml(project.setup)
        + "\n"
        + tomli_w.dumps({"view": {**view, "preset": project.preset}, **({"uncertainty": known} if known else {})})
    )


def project_from_toml(text: str, view: View | None = None) -> Project:
    """A project from its file, or from a bare set-up (then with ``view``). Raises ProjectError with the reason."""
    data = parse_toml(text, WHERE)
    table, known = data.pop("view", None), data.pop("uncertainty", None)
    setup = open_project(tomli_w.dumps(data), WHERE)
    if known is not None:
        uncertainty.from_table(setup, known)
    if table is None:
        return Project(setup, dataclasses.replace(view or View(), theta=None))
    if not isinstance(table, dict):
        raise ProjectError(f"{WHERE}: [view] is not a table; remove it or save the project again.")
    preset = table.pop("preset", "")
    return Project(setup, _view(table), preset if isinstance(preset, str) else "")


def _view(table: dict[str, Any]) -> View:
    known = {f.name: f for f in dataclasses.fields(View)}
    unknown = sorted(set(table) - set(known))
    if unknown:
        raise ProjectError(f"{WHERE}: [view] has a key {unknown[0]!r} that this robomill does not know; remove it.")
    values: dict[str, Any] = {}
    for name, value in table.items():
        default = known[name].default
        if name == "theta":
            numbers = isinstance(value, list) and all(isinstance(v, int | float) for v in value)
            good, value = numbers, tuple(map(float, value)) if numbers else value
        elif isinstance(default, float):
            good = isinstance(value, int | float) and not isinstance(value, bool)
        else:
            good = isinstance(value, str) and value in _CHOICES[name]
        if not good:
            raise ProjectError(f"{WHERE}: [view] {name} is {value!r:.40}; remove it or save the project again.")
        values[name] = float(value) if isinstance(default, float) else value
    return View(**values)


_CHOICES = {
    "units": ("mm", "in"),
    "joint_unit": ("1e-7 rad/(N m)", "kN m/rad"),
    "camera": ("iso", "along", "top", "front"),
    "share_axis": ("x", "y", "z"),
}
