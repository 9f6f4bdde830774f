"""Programs that are refused: the first line of each file states the exact message ("<" and ">" for brackets)."""

from __future__ import annotations

import math
from pathlib import Path

import pytest

from robomill.errors import GCodeError
from robomill.toolpath.gcode import interpret

FILES = sorted((Path(__file__).parent / "data" / "refused").glob("*.ngc"))
SLOW = {"o_endless"}
STATED = {"motion_after_g80", "motion_missing", "cycle_without_dwell", "cycle_zero_repeats"}
"""What other controls take; LinuxCNC, where it is stated, does not."""


@pytest.mark.parametrize("file", [f for f in FILES if f.stem not in SLOW], ids=lambda f: f.stem)
def test_refused_with_the_message_on_its_first_line(file: Path) -> None:
    with pytest.raises(GCodeError) as caught:
        interpret(file, dialect="linuxcnc" if file.stem in STATED else "auto")
    message = str(caught.value)
    assert "(" + message.replace("(", "<").replace(")", ">") + ")" == file.read_text().splitlines()[0]
    assert message.startswith(f"Line {caught.value.line}: ")


def test_endless_loop_is_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("robomill.toolpath.gcode.interpreter.MAX_STEPS", 5000)
    with pytest.raises(GCodeError, match="may not end"):
        interpret(next(f for f in FILES if f.stem == "o_endless"))


def test_a_macro_of_many_short_passes_that_ends_is_read_and_a_longer_one_says_its_size(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Three lines a round; 4 000 rounds take one second or two, by the machine, 4 000 000 some minutes."""
    loop = "G21 G90 G0 X0 F100\n#1=0\nWHILE [#1 LT {}] DO1\n#1=#1+1\nG1 X[#1/1000]\nEND1\nM30\n"
    said = r"loops took longer than 1\.3 s after \d+ lines and \d+ moves; the program may not end\. If it does, let the"
    with pytest.raises(GCodeError, match=said):
        interpret(loop.format(4_000_000), dialect="fanuc")
    monkeypatch.setattr("robomill.toolpath.gcode.interpreter.LOOPING", 60.0)
    assert interpret(loop.format(4000), dialect="fanuc").end[-1, 0] == pytest.approx(4e-3)


@pytest.mark.parametrize("dialect", ["linuxcnc", "fanuc", "sinumerik", "heidenhain"])
def test_loops_end_by_time(monkeypatch: pytest.MonkeyPatch, dialect: str) -> None:
    """The clock counts what is computed once all lines were executed; straight reading has no limit."""
    monkeypatch.setattr("robomill.toolpath.gcode.interpreter.LOOPING", 0.0)
    loop = {
        "linuxcnc": "G21 F9\nO1 while [1]\nG1 X[#<_x>+1]\nM62 P1\nO1 endwhile\nM2\n",
        "fanuc": "G21 F9\nN1 G91 G1 X#1\n#1=1\nGOTO1\nM30\n",
        "sinumerik": "G71 F9\nLOOP\nG91 G1 X=1+1\nENDLOOP\nM30\n",
        "heidenhain": "BEGIN PGM A MM\nTOOL CALL 1 Z F9\nLBL 1\nL IX+1\nFN 9: IF 1 EQU 1 GOTO LBL 1\nEND PGM A MM\n",
    }[dialect]
    with pytest.raises(GCodeError, match=r"Line [2-5]: loops took longer than 0 s after 51\d lines"):
        interpret(loop, dialect=dialect)
    straight = {"heidenhain": "BEGIN PGM A MM\nTOOL CALL 1 Z F9\n" + "L IX+1\n" * 900}
    assert len(interpret(straight.get(dialect, "G21 G91 F9\n" + "G1 X1\n" * 900), dialect=dialect)) == 900


def test_repeats_of_cycles_count(monkeypatch: pytest.MonkeyPatch) -> None:
    """Moves are counted, not lines: six lines make few of them, or have a loop without end."""
    monkeypatch.setattr("robomill.toolpath.gcode.program.LOOPED_MOVES", 50_000)
    text = "G21 G90 F100\nO1 while [1]\nG81 X1 Y1 Z-5 R2 L1000\nO1 endwhile\nM2\n"
    with pytest.raises(GCodeError, match="Line 3: the program makes more than 50120 moves; end its loops, or split it"):
        interpret(text)


def test_there_are_many() -> None:
    assert len(FILES) > 140


@pytest.mark.parametrize(
    ("line", "x"),
    [
        ("G90 G0 X=AC(4)", 4.0),
        ("G91\nG90 X=AC(4)", 4.0),
        ("G91 X=AC(4)", 4.0),
        ("G91\nX=AC(4) ; G90", 4.0),
        ("X=IC(4)", 5.0),
        ("G91\nX=IC(4)", 5.0),
        ("G1 F100\nG2 X3 I=AC(2) J0", 3.0),
        ("G1 F100 G90.1\nG2 X3 I=AC(2) J=AC(0)", 3.0),
    ],
)
def test_a_place_is_one_on_a_sinumerik_and_a_step_a_step_whatever_mode_is_in_force(line, x):
    program = f"G21 G90 G0 X1 Y0\n{line}\nM2\n"
    assert interpret(program, dialect="sinumerik").end[-1, 0] == pytest.approx(x * 1e-3)


def test_the_centre_of_a_full_circle_may_be_a_place_on_a_sinumerik() -> None:
    circle = interpret("G71 G90 G0 X40 Y20\nG2 X40 Y20 I=AC(30) J=AC(20) F100\nM30\n", dialect="sinumerik")
    assert circle.centre[-1, :2] * 1e3 == pytest.approx([30, 20])
    assert circle.length[-1] * 1e3 == pytest.approx(20 * math.pi)


@pytest.mark.parametrize("most", [100, 101, 102, 103, 104, 105])
@pytest.mark.parametrize("rounds", [34, 35])
def test_as_many_lines_are_executed_in_loops_as_are_said(
    most: int, rounds: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Before the line that ends it this program executes its first, three a round, and the head of its loop again; it
    may execute each of its five lines once, and so many more."""
    monkeypatch.setattr("robomill.toolpath.gcode.interpreter.MAX_STEPS", most)
    text = f"G21\nO1 repeat [{rounds}]\nG0 X1\nO1 endrepeat\nM2\n"
    if 1 + 3 * rounds + 1 <= 5 + most:
        assert len(interpret(text).end) == rounds
    else:
        with pytest.raises(GCodeError, match=f"more than {most} lines were executed in loops"):
            interpret(text)


@pytest.mark.parametrize(
    "before", ["", "O1 if [1 GT 0]\nO1 endif\n", "O1 repeat [2]\nO3 if [#1 EQ 5]\nO3 endif\nO1 endrepeat\n"]
)
@pytest.mark.parametrize(("opens", "junk"), [("repeat [2]", "junk"), ("if [1]", "7junk"), ("while [1 GT 0]", "5x")])
def test_what_stands_behind_an_o_word_is_quoted_wherever_in_the_program_it_is(
    before: str, opens: str, junk: str
) -> None:
    word = opens.split()[0]
    line = 2 + before.count("\n")
    with pytest.raises(GCodeError) as refused:
        interpret(f"G21\n{before}O2 {opens} {junk}\nG0 X1\nO2 end{word}\nM2\n")
    assert str(refused.value) == f"Line {line}: found {junk!r} after O2 {word}; remove it."
