"""Words of a line: where each ends, what may stand beside it, and what is none."""

from __future__ import annotations

import pytest

from robomill.errors import GCodeError
from robomill.toolpath.gcode import interpret

SAME = [
    "G0 X1 Y5",
    "g0x1y5",
    "G0 (here) X1 (and) Y5",
    "G0(here)X1(and)Y5(there)",
    "G0 X1 Y5 ; Y7",
    "G0 X1 Y5;(Y7)",
    "/G0 X1 Y5",
    "/2 G0 X1 Y5",
    "/12N7G0X1Y5",
    "N10 G0 X1 Y5",
    "N10.5G0X1Y5",
    "N10 /2 G0 X1 Y5",
    "N10/G0X1Y5",
    "Y5 X1 G0",
    "G00 X+1. Y05",
    "G 0 X 1 Y 5",
    "#1=9 G0 X1 Y5 #<a>=3",
    "G0 X1 Y5 S100 T2 M3 M8",
]


@pytest.mark.parametrize("line", SAME)
def test_ways_to_write_one_move(line: str) -> None:
    program = interpret(f"G21 G90 F60\n{line}\nM2\n")
    assert len(program) == 1
    assert program.end[0] * 1e3 == pytest.approx((1, 5, 0))
    assert program.line[0] == 2


REFUSED = [
    ("G0 X1,5", "1,5 has a decimal comma"),
    ("G0 X1 N5", "N is not at the start of the line"),
    ("G0 X1O", "has a letter O among its digits"),
    ("G0 X1O.5", "has a letter O among its digits"),
    ("G0 O5 X1", "an O word is not at the start"),
    ("G0 X1 €", "found '€' where a word should start"),
    ("N G0 X1", "N is followed by 'g0x1'"),
    ("N", "N is followed by 'nothing'"),
    ("G0 X1 X2", "X is given twice"),
    ("G0 X1 T1.5", "expected a whole number"),
    ("T-1", "cannot be negative"),
    ("F-1", "cannot be negative"),
    ("S-1 M3", "cannot be negative"),
    ("G1000", "G1000 is not a G code"),
    ("G1e308 X1", "G1e+308 is not a G code"),
    ("G-1", "G-1 is not a G code"),
    ("G1.52 X1", "G1.52 is not a G code"),
    ("G0 G1 X1", "G0 and G1 are of one modal group"),
    ("G17 G18", "G17 and G18 are of one modal group"),
    ("M3 M4", "M3 and M4 are of one modal group"),
    ("M8 M9", "M8 and M9 are of one modal group"),
    ("M-3", "M-3 is not an M code"),
    ("M3 M8 M48 M101 M0", "more than 4 M codes"),
    ("#1 5", "after a parameter; expected ="),
    ("#1.5=2", "whole"),
]


@pytest.mark.parametrize(("line", "says"), REFUSED)
def test_what_is_no_word_is_refused_with_its_line(line: str, says: str) -> None:
    with pytest.raises(GCodeError) as refused:
        interpret(f"G21\n{line}\nM2\n")
    assert refused.value.line == 2
    assert says in str(refused.value)


def test_a_line_changes_to_one_tool_and_readies_one_more() -> None:
    """Fanuc: T1 M6 T2 has tool 1 in the spindle and 2 ready; a third T, or a second without M6, is a slip."""
    cuts = interpret("G21\nT1 M6 T2\nG1 X1 F9\nM6\nX2\nM30\n", dialect="fanuc")
    assert cuts.tool[cuts.kind == 1].tolist() == [1, 2]
    for line in ("T1 M6 T2 T3", "T1 T2 T3 M6", "T1 T2"):
        with pytest.raises(GCodeError, match=r"^Line 2: T is given twice"):
            interpret(f"G21\n{line}\nG1 X1 F9\nM30\n", dialect="fanuc")


def test_a_number_is_whole_within_a_ten_thousandth_and_a_code_within_a_hundredth() -> None:
    assert interpret("G21\nT3.00009\nG0 X#<_selected_tool>\nM2\n").end[-1, 0] * 1e3 == pytest.approx(3)
    with pytest.raises(GCodeError, match="expected a whole number"):
        interpret("G21\nT3.00011\nM2\n")
    assert interpret("G21\nG0.0009 X1\nM2\n").end[-1, 0] * 1e3 == pytest.approx(1)
    with pytest.raises(GCodeError, match="is not a G code"):
        interpret("G21\nG0.0011 X1\nM2\n")


def test_g80_may_stand_beside_a_motion_and_the_motion_is_made() -> None:
    for line in ("G80 G0 X1", "G0 G80 X1"):
        assert interpret(f"G21\n{line}\nM2\n").end[-1, 0] * 1e3 == pytest.approx(1)


def test_four_m_codes_are_the_most() -> None:
    assert len(interpret("G21\nG0 X1 M3 S9 M8 M48 M101\nM2\n")) == 1


def test_diameters_are_words_of_x_alone() -> None:
    for line, end in (("G0 X10 Z10", (5, 0, 10)), ("G91 G0 X10 Z10", (5, 0, 10))):
        assert interpret(f"G21 G18 G7\n{line}\nM2\n").end[-1] * 1e3 == pytest.approx(end)
