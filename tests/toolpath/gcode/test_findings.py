"""What people's programs do without a word of theirs is said: cuts with a spindle that stands still, and the like."""

from __future__ import annotations

import pytest

from robomill.errors import GCodeError
from robomill.toolpath.gcode import interpret


def said(text: str) -> set[str]:
    return {finding.code for finding in interpret(text).findings}


@pytest.mark.parametrize(
    ("text", "code"),
    [
        ("G21 S9 M3\nG1 X99 F1\nM5\nG1 X10\nM2\n", "spindle-stopped"),
        ("G21 T1 M6 S9 M3\nG1 X99 F1\nT2 M6\nG1 X10\nM2\n", "spindle-stopped"),  # a tool change stops it
        ("G21 M3\nG1 X99 F1\nM2\n", "no-spindle"),
        ("G21 S900\nG1 X99 F1\nM2\n", "no-spindle"),
        ("G21 T3\nS900 M3\nG1 X99 F1\nM2\n", "no-change"),
        ("G21 M6\nS900 M3\nG1 X99 F1\nM2\n", "no-tool"),
        ("G21 S9 M3\nG1 X99 F1\nM30\nG1 Z-5\n", "after-end"),
    ],
)
def test_it_is_said(text: str, code: str) -> None:
    assert code in said(text)


def test_nothing_is_said_of_what_is_in_order() -> None:
    codes = {"spindle-stopped", "no-spindle", "no-change", "no-tool", "after-end"}
    good = "%\nO1000\nG21 T1 M6\nT2\nS9 M3\nM98 P2\nM6\nS9 M4\nG1 X9\nM5\nG0 Z9\nM30\nO2\nG1 X99 F1\nM99\n%\n"
    assert not codes & said(good)
    assert not codes & said("G21 G96 S9 M3\nG1 X99 F1\nM2\n(the end)\n")


def test_each_stretch_with_the_spindle_stopped_counts_once() -> None:
    text = "G21 S9 M3 F1\nG1 X99\nM5\nX1\nX2\nM3\nX3\nM5\nX4\nX5\nM2\n"
    (found,) = (f for f in interpret(text).findings if f.code == "spindle-stopped")
    assert (found.line, found.count) == (4, 2)


@pytest.mark.parametrize(
    ("text", "dialect", "seconds"),
    [
        ("G04 P1500\n", "fanuc", 1.5),  # milliseconds where there is no point
        ("G4 P1.5\n", "fanuc", 1.5),
        ("G04 X1.5\n", "fanuc", 1.5),
        ("G4 P1500\n", "linuxcnc", 1500.0),
        ("G4 F1.5\n", "sinumerik", 1.5),
    ],
)
def test_dwells_count_as_their_control_counts_them(text: str, dialect: str, seconds: float) -> None:
    assert interpret(text, dialect=dialect).dwell_time == pytest.approx(seconds)


def test_smoothing_of_fanuc_and_haas_moves_nothing() -> None:
    program = interpret("O1000\nG21 G05.1 Q1\nG187 P3\nS9 M3\nG1 X5 F1\nG05.1 Q0\nM30\n", dialect="fanuc")
    assert len(program) == 1
    assert sum(f.count for f in program.findings if f.code == "harmless-g") == 3


@pytest.mark.parametrize(
    ("text", "says"), [("T2147483648 M6\n", "tool number"), ("F9\nG2 I1 P1e1\nG2 I1 P" + "9" * 308, "turns")]
)
def test_numbers_that_no_machine_has_are_refused(text: str, says: str) -> None:
    with pytest.raises(GCodeError, match=says):
        interpret(text.replace("P1e1", "P1") + "\n")
