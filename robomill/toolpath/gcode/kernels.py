"""The rules of ``line_rules`` and ``motion_rules``, compiled for long programs: the same functions, on arrays."""

from __future__ import annotations

import inspect
from typing import Annotated, Any

from numba.extending import register_jitable

from robomill.compiled import Axes, In2, InInt1, Out2, OutBool1, kernel
from robomill.toolpath.gcode import line_rules, motion_rules, records

InBytes1 = Annotated[Any, Axes("uint8", 1)]
State = Annotated[Any, Axes(records.STATE, 1, written=True)]
Moves = Annotated[Any, Axes(records.MOVE, 1, written=True)]

for _module in (line_rules, motion_rules):
    for _name, _rule in inspect.getmembers(_module, inspect.isfunction):
        if _rule.__module__ == _module.__name__:
            register_jitable(_rule)


@kernel
def scan(text: InBytes1, starts: InInt1, words: Out2, plain: OutBool1) -> None:
    """``line_rules.scan``."""
    line_rules.scan(text, starts, words, plain)


@kernel
def run(state: State, words: In2, first_line: int, rows: Moves) -> tuple[int, int]:
    """``motion_rules.run`` on ``state`` (1,)."""
    return motion_rules.run(state[0], words, first_line, rows)  # type: ignore[no-any-return]
