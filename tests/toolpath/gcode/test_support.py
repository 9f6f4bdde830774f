"""Each row of the support table is tested by its own example."""

from __future__ import annotations

import pytest

from robomill.errors import GCodeError
from robomill.toolpath.gcode import Tool, interpret
from robomill.toolpath.gcode.support import DIFFERENCES, SUPPORT, Support

SAYS = {
    "G147 to G348, DISR=": "G147 approaches a contour on a straight line",
    "G81, G90.1, G95, A, #1, [ ], ...": "G81 is not known to grbl 1.1",
    "M62 to M68": "inputs and outputs",
    "M100 to M199": "M101",
    "other M codes": "M36",
    "other G codes": "may move",
    "G70 to G72": "a lathe.s cycle, which is not read",
    "U V W, G17.1": "no U axis",
    "POCKET SLOT LONGHOLE CYCLE60 to 79, 90, 840": "mills a circular pocket in passes that the control plans",
    "FL, other PLANE, other cycles": "FL X.1 LEN5 is of Heidenhain's",
    "$H $J": "moves the machine",
}
TOOLS = {n: Tool(n, 3e-3, (0.0, 0.0, n * 1e-2)) for n in range(1, 9)}


@pytest.mark.parametrize("row", SUPPORT, ids=[row.words for row in SUPPORT])
def test_row_holds(row: Support) -> None:
    tools = TOOLS if row.tools else None
    if row.status == "refused":
        with pytest.raises(GCodeError, match=SAYS[row.words]):
            interpret(row.example + "\n", dialect=row.dialect)
        return
    program = interpret(row.example + "\n", dialect=row.dialect, tools=tools)
    assert len(program) == row.moves
    assert program.end[-1] * 1e3 == pytest.approx(row.end, abs=1e-9)
    if row.status == "ignored":
        assert any(f.level == "ignored" and SAYS[row.words] in f.message for f in program.findings)


def test_rows_are_distinct() -> None:
    names = [row.words for row in SUPPORT]
    assert len(set(names)) == len(names)


def test_differences_are_as_stated() -> None:
    assert any("ends without" in f.message for f in interpret("G0 X1\n").findings)
    assert len(interpret("G0 X1 (" + "long " * 100 + ")\n")) == 1
    assert len(interpret("T77 M6 G43 H77\nG0 X1\n")) == 1
    assert len(interpret("O1 if [1]\nG0 X1\nO1 elseif [1/0]\nO1 endif\n")) == 1
    for text in ("G71 Q1", "G0 U1", "G10 L2 P1 R5\nG18 F9\nG2 X2 I1", "G1 X1", "T1 M6\nG41"):
        with pytest.raises(GCodeError):
            interpret(text + "\n")
    assert all(text.endswith(".") for text in DIFFERENCES)
