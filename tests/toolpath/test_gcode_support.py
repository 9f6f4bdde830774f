"""Each row of the support table is tested by its own example."""

from __future__ import annotations

import pytest

from robomill.errors import GCodeError
from robomill.toolpath.gcode import Tool, interpret
from robomill.toolpath.gcode.support import SUPPORT, Support

TOOLS = {n: Tool(n, 3e-3, (0.0, 0.0, n * 1e-2)) for n in range(1, 9)}


@pytest.mark.parametrize("row", SUPPORT, ids=[row.words for row in SUPPORT])
def test_row_holds(row: Support) -> None:
    tools = TOOLS if row.tools else None
    if row.status == "refused":
        with pytest.raises(GCodeError, match=row.says):
            interpret(row.example + "\n", dialect=row.dialect)
        return
    program = interpret(row.example + "\n", dialect=row.dialect, tools=tools)
    assert len(program) == row.moves
    assert program.end[-1] * 1e3 == pytest.approx(row.end, abs=1e-9)
    if row.status == "ignored":
        assert any(f.level == "ignored" and row.says in f.message for f in program.findings)


def test_rows_are_distinct() -> None:
    names = [row.words for row in SUPPORT]
    assert len(set(names)) == len(names)
