"""A tool of which nobody says more than its number is a point on the spindle's nose."""

from __future__ import annotations

import numpy as np
import pytest

from robomill.errors import GCodeError
from robomill.toolpath.gcode import Tool, interpret

MOVES = "G21 G90 F100\nT1 M6\n{}\nG0 X1 Y2 Z3\nG1 X9\n{}\nG1 Y8\nX20\nM2\n"


@pytest.mark.parametrize(("on", "off"), [("G43", "G49"), ("G43 H1", "G49"), ("G41", "G40"), ("G41 D1", "G40")])
def test_a_tool_of_no_size_leads_where_the_program_says(on: str, off: str) -> None:
    plain = interpret(MOVES.format("", ""))
    found = interpret(MOVES.format(on, off), tools={1: Tool(1)})
    np.testing.assert_allclose(found.end, plain.end, atol=1e-12)


@pytest.mark.parametrize("axis", range(3))
def test_a_tool_stands_by_its_offset_behind_what_is_said(axis: int) -> None:
    """Of LinuxCNC's tool table: 5 mm along an axis put the spindle as far beyond, and the tip where it is told to."""
    offset = tuple(5e-3 if k == axis else 0.0 for k in range(3))
    text = "G21 G90 F100\nT1 M6\nG0 X1 Y2 Z3\n{}G0 X9 Y9 Z9\nM2\n"
    at = [interpret(text.format(word), tools={1: Tool(1, 0.0, offset)}).end[-1] for word in ("", "G43\n")]  # type: ignore[arg-type]
    np.testing.assert_allclose(at[1] - at[0], 0.0, atol=1e-12)


def test_a_tool_that_nobody_measured_is_told_from_one_of_no_width() -> None:
    text = MOVES.format("G41 D1", "G40")
    assert len(interpret(text, tools={1: Tool(1, 0.0)}))
    with pytest.raises(GCodeError, match=r"^Line 3: G41 needs the diameter of tool 1; write it into the tool table\.$"):
        interpret(text, tools={1: Tool(1, 0.0, sized=False)}, dialect="fanuc")
