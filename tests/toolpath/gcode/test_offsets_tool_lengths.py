"""The tip follows the length of the tool that is in the spindle; G43 says which length the machine counts with.

The truth is the machine's own arithmetic: the spindle's nose stands at the programmed height plus the length in force,
the tip that much below it as the tool in the spindle is long.
"""

from __future__ import annotations

import pytest

from robomill.toolpath.gcode import Tool, gcode_report, interpret
from robomill.toolpath.gcode.chords import to_toolpath

LENGTHS = {1: 50.0, 2: 80.0, 3: 30.0}
TOOLS = {n: Tool(n, 8e-3, (0.0, 0.0, length * 1e-3)) for n, length in LENGTHS.items()}


def cut(tool: int, words: str) -> str:
    return f"T{tool} M6\n{words}\nG0 X0 Z5\nG1 Z-2 F100\nG3 X10 Y0 I5 J0\nG0 Z5\n"


def floor_mm(text: str) -> float:
    program = interpret(f"G21 G90\n{text}M2\n", tools=TOOLS)
    path = to_toolpath(program)
    lowest = program.extents[0][2]
    assert path.extents[0][2] == pytest.approx(lowest)
    assert gcode_report(program)["extents_mm"][0][2] == pytest.approx(lowest * 1e3)
    return float(lowest) * 1e3


@pytest.mark.parametrize("tool", [1, 2, 3])
@pytest.mark.parametrize("length_of", [1, 2, 3])
def test_the_tip_is_where_the_spindle_carries_it(tool: int, length_of: int) -> None:
    nose = -2.0 + LENGTHS[length_of]
    assert floor_mm(cut(tool, f"G43 H{length_of}")) == pytest.approx(nose - LENGTHS[tool])


def test_right_lengths_put_every_tool_where_the_program_says() -> None:
    assert floor_mm("".join(cut(n, f"G43 H{n}") for n in (1, 3, 2))) == pytest.approx(-2.0)
    assert floor_mm(cut(2, "G43")) == pytest.approx(-2.0)
    assert floor_mm(cut(2, "G49")) == floor_mm(cut(2, "")) == pytest.approx(-2.0)  # the program says where the tip goes
    assert floor_mm(cut(2, "G43.1 Z71")) == pytest.approx(-2.0)


def test_a_forgotten_length_is_said_with_the_line_of_the_cut() -> None:
    program = interpret("G21 G90\n" + cut(1, "G43 H1") + cut(2, "(G43 H2 is missing)") + "M2\n", tools=TOOLS)
    (found,) = (f for f in program.findings if f.code == "wrong-length")
    assert (found.level, found.line) == ("warning", 11)
    assert "30.000 mm lower" in found.message
    other = interpret("G21 G90\n" + cut(1, "G43 H2") + "M2\n", tools=TOOLS)
    assert ["30.000 mm higher" in f.message for f in other.findings if f.code == "wrong-length"] == [True]
    assert program.extents[0][2] == pytest.approx((-2.0 + 50.0 - 80.0) * 1e-3)
    right = interpret("G21 G90\n" + cut(1, "G43 H1") + cut(2, "G43 H2") + "M2\n", tools=TOOLS)
    assert "wrong-length" not in {f.code for f in right.findings}


def test_without_a_table_nothing_is_known_of_lengths() -> None:
    program = interpret("G21 G90\n" + cut(2, "G43 H1") + "M2\n")
    assert not program.lift.any()
