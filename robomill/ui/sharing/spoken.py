"""What is on the screen as a command and as Python: what is pasted elsewhere gives the same numbers.

Both begin with the example that the project began with, where it can be said what differs from it; else with a file.
"""

import shlex
from collections.abc import Iterator
from dataclasses import MISSING, Field, dataclass, fields, is_dataclass
from typing import Any

import numpy as np

import robomill
from robomill.arrays import digest
from robomill.errors import RobomillError
from robomill.io.robot.robots import load_robot, robot_names
from robomill.io.tables import exactly
from robomill.simulation.setup import SimulationSetup
from robomill.ui.project import Project, preset_setup, presets
from robomill.ui.sharing.questions import question

LONGEST = 1500  # characters of Python that anyone reads
MOST = 64  # numbers of an array that are written out
ASKS = {"Improve": "advise"}  # of a page what it asks of the cut; the others run it
OF_PYTHON = {
    "simulate": ("result = rm.simulate(setup)", "print(result.verdict.sentence)"),
    "advise": ("advice = rm.advise(setup)", "print(advice.best.title)"),
}
SLOTS = ("name", "description", "provenance")  # of a set-up what no number depends on


@dataclass(frozen=True)
class Spoken:
    """A command and Python that give the screen's numbers; ``by_file`` where one of them names the project's file. No
    command: "", where it takes more than options can say."""

    command: str
    python: str
    by_file: bool


def spoken(project: Project, page: str, file: str) -> Spoken:
    """How ``page`` of a project is had elsewhere; ``file`` is what the project's file is called."""
    verb = ASKS.get(page, "simulate")
    options = _options(project)
    if options is None or (verb != "simulate" and len(options) > 1):
        options = [file]
    code = _code(project)
    begin = code or (f'setup = rm.load_setup("{file}")',)
    asked = question(project, page)
    if asked is not None:
        command = shlex.join(["robomill", *asked.words]) if asked.words else ""
        return Spoken(command, "\n".join(["import robomill as rm", "", *begin, *asked.lines]), not code)
    python = "\n".join(["import robomill as rm", "", *begin, *OF_PYTHON[verb]])
    return Spoken(shlex.join(["robomill", verb, *options]), python, options == [file] or not code)


def _options(project: Project) -> list[str] | None:
    """The example and the options that make the project's set-up of it; None where options cannot."""
    if project.preset not in presets():
        return None
    want, now, words = project.setup, preset_setup(project.preset), [project.preset]
    try:
        if want.robot.name != now.robot.name and want.robot.name in robot_names() and now.measured_map is None:
            now = now.replace(robot=load_robot(want.robot.name))
            words += ["--robot", want.robot.name]
        chosen = want.robot.compliance_set
        if chosen != now.robot.compliance_set and chosen in now.robot.compliance_sets:
            now = now.replace(robot=now.robot.with_compliance_set(chosen))
            words += ["--compliance-set", chosen]
        allowed = exactly(want.tolerance, "mm")
        if want.tolerance != now.tolerance and allowed is not None:
            now = now.replace(tolerance_mm=allowed, floor_tolerance=None)
            words += ["--tol", repr(allowed)]
    except RobomillError:
        return None
    return words if now.digest() == want.digest() else None


def _code(project: Project) -> tuple[str, ...] | None:
    """Lines that make the project's set-up of its example; None where that takes a file."""
    if project.preset not in presets():
        return None
    want, base = project.setup, preset_setup(project.preset)
    lines = [f'setup = rm.load_setup("{project.preset}")']
    if base.digest() == want.digest():
        return tuple(lines)
    try:
        steps = list(_replacements(base, want))
    except (RobomillError, _UnsaidError):
        return None
    lines += [line for line, _ in steps]
    same = bool(steps) and steps[-1][1].digest() == want.digest()
    return tuple(lines) if same and len("".join(lines)) <= LONGEST else None


def _replacements(base: SimulationSetup, want: SimulationSetup) -> Iterator[tuple[str, SimulationSetup]]:
    """One line a field that differs, and the set-up as it is then."""
    now = base
    if want.robot.name != now.robot.name and want.robot.name in robot_names():
        now = now.replace(robot=load_robot(want.robot.name))
        yield f'setup = setup.replace(robot=rm.load_robot("{want.robot.name}"))', now
    chosen = want.robot.compliance_set
    if chosen != now.robot.compliance_set and chosen in now.robot.compliance_sets:
        now = now.replace(robot=now.robot.with_compliance_set(chosen))
        yield f'setup = setup.replace(robot=setup.robot.with_compliance_set("{chosen}"))', now
    for name in _names(want):
        old, new = getattr(now, name), getattr(want, name)
        if name not in SLOTS and digest(old) != digest(new):
            said, value = _said(old, new, f"setup.{name}")
            now = now.replace(**{name: value})
            yield f"setup = setup.replace({name}={said})", now


class _UnsaidError(Exception):
    """A value that takes a file to say."""


def _said(old: Any, new: Any, name: str) -> tuple[str, Any]:
    """Python for ``new``, where ``name`` is what ``old`` is called, and its value. Raises _UnsaidError."""
    if isinstance(new, str) and "\n" in new:
        raise _UnsaidError
    if new is None or isinstance(new, bool | int | str) or (isinstance(new, float) and np.isfinite(new)):
        return repr(new), new
    if isinstance(new, np.ndarray) and new.size <= MOST and new.dtype.kind in "fi" and np.isfinite(new).all():
        return repr(new.tolist()), new.tolist()
    if is_dataclass(new) and type(new) is type(old) and hasattr(new, "replace"):
        changed = {
            each: _said(getattr(old, each), getattr(new, each), f"{name}.{each}")
            for each in _names(new)
            if each not in SLOTS and digest(getattr(old, each)) != digest(getattr(new, each))
        }
        was: Any = old
        said = ", ".join(f"{each}={words}" for each, (words, _) in changed.items())
        return f"{name}.replace({said})", was.replace(**{each: value for each, (_, value) in changed.items()})
    if isinstance(new, tuple):
        items = [_said(None, each, "") for each in new]
        return f"({''.join(f'{words}, ' for words, _ in items)})", tuple(value for _, value in items)
    return _made(new)


def _made(new: Any) -> tuple[str, Any]:
    """Python that makes a value of a public class, and the value. Raises _UnsaidError."""
    kind = type(new)
    if not is_dataclass(new) or getattr(robomill, kind.__name__, None) is not kind:
        raise _UnsaidError
    given = {
        each.name: _said(None, getattr(new, each.name), "")
        for each in fields(new)
        if each.init and each.name not in SLOTS and digest(getattr(new, each.name)) != digest(_default(each))
    }
    said = ", ".join(f"{name}={words}" for name, (words, _) in given.items())
    return f"rm.{kind.__name__}({said})", kind(**{name: value for name, (_, value) in given.items()})


def _default(each: Field[Any]) -> Any:
    return () if each.default is MISSING else each.default  # no field holds nothing where something is needed


def _names(value: Any) -> list[str]:
    return [each.name for each in fields(value) if each.init]
