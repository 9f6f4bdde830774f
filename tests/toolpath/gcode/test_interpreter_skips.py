"""A / in the midst of a line: what follows it may be skipped, and is executed here as all of block delete is.

(Fanuc 16/18, Operator's Manual: optional block skip; the slash may stand anywhere in a block, where it is no division.)
"""

from __future__ import annotations

import numpy as np
import pytest

from robomill.errors import GCodeError
from robomill.toolpath.gcode import interpret


@pytest.mark.parametrize("dialect", ["fanuc", "auto"])
def test_a_slash_before_a_word_is_block_delete(dialect: str) -> None:
    program = interpret("G21 G90 G0 X1. / Y2.\nX3./2Y4. M8\nX[6/2] /Y[8/4]\nM30\n", dialect=dialect)
    np.testing.assert_allclose(program.end[:, :2] * 1e3, [[1, 2], [3, 4], [3, 2]])
    assert [f.count for f in program.findings if f.code == "block-delete"] == [3]


def test_a_slash_between_values_stays_a_division_and_a_comment_a_comment() -> None:
    program = interpret("G21 G90\n#1=12\n#2=3\nG0 X[#1/#2] (A /Y9)\nX[#1/SIN[30]]\nM30\n", dialect="fanuc")
    assert (program.end[:, 0] * 1e3).tolist() == pytest.approx([4, 24])
    assert not any(f.code == "block-delete" for f in program.findings)
    for text in ("G0 X8/2", "G0 X1. /", "G0 X1 /G"):
        with pytest.raises(GCodeError):
            interpret(f"G21 G90\n{text}\nM30\n", dialect="fanuc")
    with pytest.raises(GCodeError):
        interpret("G21 G90\nG0 X1 /Y2\nM30\n", dialect="linuxcnc")
