"""The rules of flow, lines, values, modes and motion, compiled for long programs: the same functions, on arrays."""

from __future__ import annotations

import inspect
import math
from typing import Annotated, Any

from robomill.compiled import Axes, called, kernel, part, taught
from robomill.toolpath import plane
from robomill.toolpath.gcode.parameters import Store
from robomill.toolpath.gcode.rules import (
    cycle_rules,
    flow_rules,
    line_rules,
    mode_rules,
    motion_rules,
    operator_rules,
    records,
    value_rules,
)
from robomill.toolpath.gcode.rules.records import Flow, Text

State = Annotated[Any, Axes(records.STATE, 1, written=True)]
Moves = Annotated[Any, Axes(records.MOVE, 1, written=True)]


def _teach() -> None:
    """The text of a number that lies too near the middle between two of the computer's is left to Python."""
    from numba.extending import overload

    overload(value_rules.nearest)(lambda text, first, end: lambda text, first, end: math.inf)


taught(_teach)

# What a value is made of is copied into ``value``: to hand on the store at every call would cost more than the work.
for _module in (operator_rules, value_rules, line_rules, plane, motion_rules, cycle_rules, mode_rules, flow_rules):
    for _name, _rule in inspect.getmembers(_module, inspect.isfunction):
        if _rule.__module__ == _module.__name__ and _rule is not value_rules.nearest:
            (part if _module is value_rules and _rule is not value_rules.value else called)(_rule)


@kernel
def run(state: State, store: Store, text: Text, flow: Flow, stretch: tuple[int, int], rows: Moves) -> tuple[int, int]:
    """``flow_rules.run`` on ``state`` (1,)."""
    done: tuple[int, int] = flow_rules.run(state[0], store, text, flow, stretch, rows)
    return done
