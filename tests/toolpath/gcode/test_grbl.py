"""Words that grbl 1.1 does not know: refused where grbl is stated, said where it is only guessed."""

from __future__ import annotations

import pytest

from robomill.errors import GCodeError
from robomill.toolpath.gcode import interpret

KNOWN = [
    "G0 X1",
    "G01 X1.5 F10",
    "G00X1Y2",
    "G2 X1 I.5 F10",
    "G4 P1",
    "G10 L2 P1 X0",
    "G10L20P1X0",
    "G17 G21 G40 G49 G54 G80 G90 G91.1 G94",
    "G18\nG19\nG17",
    "G28.1",
    "G30.1",
    "G38.2 Z-5 F10",
    "G43.1 Z0",
    "G53 G0 X0",
    "G61",
    "G92 X0",
    "G92.1",
    "G93 G1 X1 F2",
    "M3 S100\nM7\nM8\nM9\nM5",
    "(G81 A1 #1) G0 X1 ; G95 B2",
    "$10=1\n$X",
    "G1 X1e-3 F10",
    "T1 M6",
]
UNKNOWN = [
    ("G90.1", "G90.1"),
    ("G81 X1 Z-1 R1 F9", "G81"),
    ("G 083 X1", "G083"),
    ("#1=5", "#"),
    ("G95 G1 X1 F1", "G95"),
    ("G0 X1 A5", "A"),
    ("O100 sub", "O"),
    ("G64", "G64"),
    ("G41 D1 G1 X1 F10", "G41"),
    ("G7", "G7"),
    ("G52 X1", "G52"),
    ("G59.1", "G59.1"),
    ("G98", "G98"),
    ("G1 X[1+2] F10", "["),
    ("M98 P100", "M98"),
    ("G43 H1", "G43"),
    ("@10 ^20", "@"),
]
"""grbl's README names what it knows; all these are missing there."""


@pytest.mark.parametrize("line", KNOWN)
def test_what_grbl_knows_is_read(line: str) -> None:
    interpret(f"G21 G90\n{line}\nM2\n", dialect="grbl")


@pytest.mark.parametrize(("line", "word"), UNKNOWN)
def test_what_grbl_does_not_know_is_refused_by_name_where_grbl_is_stated(line: str, word: str) -> None:
    with pytest.raises(GCodeError) as refused:
        interpret(f"G21 G90\nG0 X1\n{line}\nM2\n", dialect="grbl")
    assert str(refused.value).startswith(f"Line 3: {word} is not known to grbl 1.1, which stops there")


def test_where_grbl_is_only_guessed_it_is_read_and_that_is_said() -> None:
    """The settings tell grbl; G81 is of its descendants: over to X1, down to R1, Z-1 and up again."""
    program = interpret("$10=1\nG21 G90 F100\nG81 X1 Z-1 R1\nG80\nG81 X2 Z-1 R1\nM2\n")
    assert program.dialect == "grbl"
    assert [(f.line, f.message[:24]) for f in program.findings if f.code == "not-grbl"] == [
        (3, "G81 is not known to grbl")
    ]
    assert program.end[-1].tolist() == pytest.approx([2e-3, 0.0, 1e-3])


def test_behind_the_end_of_the_program_nothing_counts() -> None:
    assert len(interpret("G21 G90\nG0 X1\nM30\nG81 X1\n", dialect="grbl")) == 1
