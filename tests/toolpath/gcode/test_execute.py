"""What a line sets: tools and what is said of them."""

from __future__ import annotations

from itertools import product

import pytest

from robomill.toolpath.gcode import interpret


@pytest.mark.parametrize(("in_spindle", "selected", "on_line"), [*product([0, 4], [None, 0, 7], [None, 0, 9])])
def test_a_change_to_no_tool_is_told_only_where_none_was_named_and_none_was_there(in_spindle, selected, on_line):
    before = [f"M61 Q{in_spindle}"] if in_spindle else []
    before += [] if selected is None else [f"T{selected}"]
    change = "M6" if on_line is None else f"T{on_line} M6"
    program = interpret("\n".join(["G21", *before, change, "G0 X1", "M2\n"]))
    told = [f.line for f in program.findings if f.code == "no-tool"]
    nothing_named = not selected and on_line is None
    assert told == ([len(before) + 2] if nothing_named and not in_spindle else [])
    number = on_line if on_line is not None else selected or 0
    assert program.tool.tolist() == [number]
