"""Where a program's lines end: how long one may be, and how a program goes back to who called it."""

from __future__ import annotations

import pytest

from robomill.errors import GCodeError
from robomill.toolpath.gcode import interpret
from robomill.toolpath.gcode.interpreter import MAX_LINE


@pytest.mark.parametrize("first", ["G0 X5", "#1=5 G0 X5"])
def test_a_line_may_be_so_long_and_no_longer(first):
    longest = first + " " * (MAX_LINE - len(first))
    assert interpret(f"G21\n{longest}\nM2\n").end[-1, 0] == pytest.approx(5e-3)
    with pytest.raises(GCodeError, match=f"Line 2: {MAX_LINE + 1} characters long"):
        interpret(f"G21\n{longest} \nM2\n")
