"""What shells are offered for an argument: samples, files, and words that are known; loaded when a shell asks."""

import argparse
from collections.abc import Callable, Iterable
from contextlib import suppress
from functools import partial
from importlib import import_module
from typing import Any

from robomill.errors import RobomillError


def offered(action: argparse.Action, completer: Callable[..., Iterable[str]], *first: Any) -> None:
    """Let shells offer for ``action`` what ``completer`` finds."""
    action.completer = partial(completer, *first)  # type: ignore[attr-defined]


def samples(kind: str, prefix: str, **_: Any) -> list[str]:
    """Names of samples of a ``kind`` and files that begin with ``prefix``."""
    from argcomplete.completers import FilesCompleter

    return [*names(kind, prefix), *([] if kind == "any" else FilesCompleter()(prefix))]


def names(kind: str, prefix: str, **_: Any) -> list[str]:
    """Names of samples of a ``kind`` ("any": of all) that begin with ``prefix``."""
    from robomill.io import samples as stored

    found = dict.fromkeys(sample.name for sample in stored.samples() if kind in (sample.kind, "any"))
    return [name for name in found if name.startswith(prefix)]


def words(module: str, name: str, more: tuple[str, ...], prefix: str, **_: Any) -> list[str]:
    """The words that a module knows by ``name``, and ``more``."""
    known = (*more, *getattr(import_module(f"robomill.{module}"), name))
    return [word for word in known if word.startswith(prefix)]


def compliance_sets(prefix: str, parsed_args: argparse.Namespace, **_: Any) -> list[str]:
    """Those of the robot that was named before, or of the set-up's."""
    robot = _robot(parsed_args)
    return [] if robot is None else [name for name in robot.compliance_sets if name.startswith(prefix)]


def quantities(prefix: str, parsed_args: argparse.Namespace, **_: Any) -> list[str]:
    """What a map of the robot that was named before may show; several with commas."""
    from robomill.workspace.quantities import map_quantities

    robot = _robot(parsed_args)
    done, comma, last = prefix.rpartition(",")
    return [] if robot is None else [f"{done}{comma}{name}" for name in map_quantities(robot) if name.startswith(last)]


def _robot(parsed_args: argparse.Namespace) -> Any:
    """The robot that was named; None where that is not known yet."""
    from robomill.cli import given

    robot, setup = (getattr(parsed_args, name, None) for name in ("robot", "setup"))
    with suppress(RobomillError):
        if robot not in (None, given.STDIN):
            return given.robot(robot)
        if setup not in (None, given.STDIN):
            return given.setup(setup, allow_outside=False).robot
    return None
