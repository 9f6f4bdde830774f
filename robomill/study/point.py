"""One point of a study, computed: the same wherever it runs."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from importlib import import_module
from typing import Any

from robomill.errors import RobomillError
from robomill.simulation.run import simulate
from robomill.study.addressed import Data, changed
from robomill.study.responses import RESPONSES, WORDS


def version() -> str:
    """Of the robomill that computes."""
    return str(import_module("robomill").__version__)


@dataclass(frozen=True)
class Task:
    """What every point of a study shares: the set-up as tables, the keys of the parameters, what is asked."""

    data: Data
    keys: tuple[str, ...]
    responses: tuple[str, ...]


@dataclass(frozen=True)
class Row:
    """What came of a point: its number, the responses in their order, and why there are none ("" where there are)."""

    point: int
    values: tuple[Any, ...]
    reason: str = ""


def computed(task: Task, point: int, values: Sequence[Any]) -> Row:
    """The row of a point. What is refused, and a mistake of robomill's own, fails this point with its reason."""
    try:
        run = simulate(changed(task.data, dict(zip(task.keys, values, strict=True))))
        return Row(point, tuple(RESPONSES[name].of(run) for name in task.responses))
    except RobomillError as refused:
        return failed(task, point, str(refused))
    except MemoryError:
        return failed(task, point, "There is not enough memory for this point; take coarser cells or steps.")
    except Exception as mistake:  # one point of thousands: told in its row, and counted as failed
        return failed(task, point, f"A mistake of robomill's own ({type(mistake).__name__}: {mistake!s:.200}).")


def failed(task: Task, point: int, reason: str) -> Row:
    """The row of a point that has no numbers."""
    return Row(point, tuple("" if name in WORDS else float("nan") for name in task.responses), reason)
