"""Programs in languages that are not read: the refusal names the line, the word and the language."""

from __future__ import annotations

import numpy as np
import pytest

from robomill.errors import GCodeError
from robomill.toolpath.gcode import interpret

READ = {"GOTO", "TRANS", "ROT", "IF", "MCALL", "R1=", "X="}
"""Words that the dialect reads which they are of."""


@pytest.mark.parametrize("dialect", ["auto", "fanuc", "sinumerik"])
@pytest.mark.parametrize(
    ("line", "word", "language"),
    [
        ("WHILE[#100LT5]DO1", "WHILE", "Macro B"),
        ("N20 IF [#1 EQ 2] GOTO 5 (IF)", "IF", "Macro B"),
        ("GOTO 5", "GOTO", "Macro B"),
        ("END1", "END1", "Macro B"),
        ("TRANS X10 Y5", "TRANS", "Sinumerik"),
        ("N5 ROT RPL=45", "ROT", "Sinumerik"),
        ("IF R1<5 GOTOF OUT", "IF", "Sinumerik"),
        ("MCALL CYCLE81(5,0,1)", "MCALL", "Sinumerik"),
        ("POCKET4(1,2)", "POCKET4", "Sinumerik"),
        ("CUT3DC", "CUT3DC", "Sinumerik"),
        ("N7 R1=5", "R1=", "Sinumerik"),
        ("G1 X=R1", "X=", "Sinumerik"),
        ("TOOL CALL 1 Z S1000", "TOOL", "Heidenhain"),
        ("G1 X10 FMAX", "FMAX", "Heidenhain"),
        ("G1 X10 SOFTLY", "SOFTLY", ""),
        ("BSPLINE X1 Y2 PW=2", "BSPLINE", "Sinumerik's splines"),
        ("G6.2 P4 K0. X0. Y0.", "G6.2", ""),
        ("G0 X[FOO[1]]", "FOO", ""),
    ],
)
def test_a_word_of_another_language_is_named(line: str, word: str, language: str, dialect: str) -> None:
    read = word in READ or (language == "Macro B" and dialect != "sinumerik")
    stated = "linuxcnc" if read else dialect
    with pytest.raises(GCodeError) as caught:
        interpret(f"G21 G90 F100\n{line}\nM2\n", dialect=stated)
    assert caught.value.line == 2
    assert str(caught.value).startswith(f"Line 2: {word}")
    assert language in str(caught.value)


@pytest.mark.parametrize(
    ("text", "line", "name"),
    [
        ("&ACCESS RVP\nDEF MILL( )\nPTP HOME\n", 1, "KUKA KRL"),
        ("DEF part()\nLIN {X 1, Y 2}\nEND\n", 1, "KUKA KRL"),
        ("%%%\nVERSION:1\n%%%\nMODULE Mill\nMoveL p1, v100, fine, tool0;\n", 1, "ABB RAPID"),
        ("MODULE Mill\n", 1, "ABB RAPID"),
        ("/PROG  MILL\n/ATTR\n/MN\n1:J P[1] 100% FINE ;\n", 1, "Fanuc's robot language (TP)"),
        ("def mill():\n  movel(p[0,0,0,0,0,0])\nend\n", 1, "URScript"),
        ("! part\nPROC main()\n  MoveAbsJ home, v100, fine, tool0;\n", 3, "ABB RAPID"),
        ("/JOB\n//NAME TEST\n//POS\n", 1, "Yaskawa's INFORM"),
        (".PROGRAM test()\n  HOME\n", 1, "Kawasaki's AS"),
        ("1 MOV P1\n2 MVS P2\n", 1, "Mitsubishi's MELFA"),
        ("PROGRAM mill\nVAR p1: POSITION\nBEGIN\n", 1, "a robot's PDL2 or KAREL"),
        ("begin\n  movel(p1, tTool, mSpeed)\nend\n", 2, "URScript or VAL3"),
        ("$PART.MIN%\nO1\nG15 H1\n", 1, "Okuma's OSP"),
        ("O1 (PART)\nN1 G90 G15 H1 X0 Y0\nG56 Z50. H1\n", 2, "Okuma's OSP"),
        ("O2\nG90 G0 X0 Y0\nG56 Z50 H1\nG71 Z50\n", 3, "Okuma's OSP"),
        ("G21\nG71 Z50\nG81 X1 Y1 Z-5 R2 F99 M53\n", 3, "Okuma's OSP"),
        ("M104 S200\nG28\nG1 X10 E0.5 F1200\n", 1, "a 3D printer's G-code"),
        ("G21\nG92 E0.0\nG1 X10 E0.5 F1200\n", 2, "a 3D printer's G-code"),
        ("IN;SP1;PU0,0;PD10,10;\n", 1, "HPGL"),
        ("  0\nSECTION\n  2\nHEADER\n", 1, "a DXF drawing"),
        ("solid part\nfacet normal 0 0 1\n", 1, "an STL surface"),
        ("G04 board*\n%FSLAX24Y24*%\n%MOMM*%\n", 2, "Gerber"),
        ("M48\nMETRIC,TZ\nT1C0.8\n", 1, "Excellon"),
        ("M48\n;DRILL file\n;FORMAT={3:3}\nFMAT,2\nINCH\nT1C0.8\n", 1, "Excellon"),
        ("M48\nT01F00S00C0.8000\n%\nT01\nX5Y5\n", 1, "Excellon"),
        ("'part\nMS,1.0,0.5\nJZ,5\n", 2, "ShopBot's language"),
        ("\n<!DOCTYPE html>\n<html>\n", 2, "a page of the web"),
        ("version https://git-lfs.github.com/spec/v1\noid sha256:0\n", 1, "a pointer of Git LFS"),
        ("ISO-10303-21;\nHEADER;\n", 1, "STEP"),
    ],
)
def test_a_file_of_another_language_is_named_by_it_on_its_first_line(text: str, line: int, name: str) -> None:
    with pytest.raises(GCodeError) as caught:
        interpret(text)
    assert str(caught.value).startswith(f"Line {line}: this is {name}")
    assert "expected G-code, Heidenhain's dialogue or APT" in str(caught.value)


@pytest.mark.parametrize("preamble", ["M48\nG21 G90\n", "G21 G90\nM48\nT1 M6\n", "%\nO1\nM48\nG21 G90\nG0 C0.5\n"])
def test_overrides_that_m48_allows_are_no_file_of_holes(preamble: str) -> None:
    """M48, on a line of its own, turns the overrides of feed and spindle on: LinuxCNC, Fanuc and others."""
    program = interpret(f"{preamble}G0 X1\nG1 Z-1 F9\nM30\n")
    np.testing.assert_allclose(program.end[-1] * 1e3, [1, 0, -1], atol=1e-9)


def test_a_stated_control_is_believed_before_a_language_that_a_comment_looks_like() -> None:
    text = "G21 G90\n(CALL 100)\n(DIS, READY)\nG0 X1\nM30\n"
    assert len(interpret(text, dialect="fanuc")) == 1
    with pytest.raises(GCodeError, match="^Line 2: this is Fagor's language"):
        interpret(text)


@pytest.mark.parametrize("dialect", ["auto", "fanuc", "linuxcnc"])
@pytest.mark.parametrize(
    ("line", "says"),
    [
        ("G0 X0 Y0 E1", "E chooses a fixture .Fadal. or feeds filament"),
        ("L100", "L100 alone begins or calls a subprogram .Fadal, Sinumerik."),
        ("G71 P46 Q55 U0.005 W0 D0.025 F0.01", "G71 makes holes on an arc .Haas. or is a lathe's cycle"),
        ("G31 P99 Z-5. F50", "G31 goes until a probe or another signal stops it"),
        ("G37 Z-1 H1", "G37 measures a tool"),
        ("G7.1 B10", "G7.1 wraps a path about a cylinder"),
        ("G12.1", "G12.1 is of polar interpolation"),
        ("G254", "G254 lets the part's place follow the rotary table"),
        ("G72 P1 Q2 U1 W0 D1", "G72 makes holes on a line .Haas. or is a lathe's cycle"),
    ],
)
def test_words_that_must_not_be_left_out_are_named(line: str, says: str, dialect: str) -> None:
    with pytest.raises(GCodeError, match=f"Line 2: {says}"):
        interpret(f"G21 G90 F100\n{line}\nG1 X5\nM2\n", dialect=dialect)


@pytest.mark.parametrize("dialect", ["fanuc", "sinumerik", "grbl"])
def test_m70_to_m73_are_the_machine_makers_but_on_linuxcnc(dialect: str) -> None:
    """A vise that M70 closes and M72 opens keeps no G90, and there need be no M70 before."""
    kept = interpret("G21 G90\nM70\nG91\nG0 X5\nM72\nX5\nM30\n", dialect=dialect)
    assert (kept.end[:, 0] * 1e3).tolist() == pytest.approx([5, 10])
    assert {(f.code, f.line) for f in kept.findings} >= {("unknown-m", 2), ("unknown-m", 5)}
    assert len(interpret("G21 G90\nM72\nG0 X5\nM30\n", dialect=dialect)) == 1
    linuxcnc = interpret("G21 G90\nM70\nG91\nG0 X5\nM72\nX5\nM30\n", dialect="linuxcnc")
    assert (linuxcnc.end[:, 0] * 1e3).tolist() == pytest.approx([5, 5])


@pytest.mark.parametrize(
    ("text", "line", "name"),
    [
        ("%PRUEBA,MX,\nG0 X5\n", 1, "Fagor"),
        ("G0 X5\nN30 (RPT N20,N25)\n", 2, "Fagor"),
        ("G0 X5\n(CALL 10)\n", 2, "Fagor"),
        ("N1 G0 X5\nN2 (UTO,1,X100)\n", 2, "OSAI"),
        ("(RPT,3)\nG91 X5\n(ERP)\n", 1, "OSAI"),
    ],
)
def test_controls_whose_commands_stand_in_brackets_are_named(text: str, line: int, name: str) -> None:
    """Read as comments they would be left out without a word."""
    with pytest.raises(GCodeError, match=f"Line {line}: this is {name}"):
        interpret(text)
    assert len(interpret("(CALL 10 IF IT BREAKS)\n(RPT 3 TIMES)\nG0 X5\n")) == 1


@pytest.mark.parametrize("word", ["L3", "Q-2."])
def test_a_spiral_is_no_arc_with_a_word_too_many(word: str) -> None:
    """Fanuc, spiral interpolation: G02 X Y I J Q L, with Q the radius of a turn more and L the turns."""
    letter = word[0]
    with pytest.raises(GCodeError, match=f"Line 3: {letter} beside G2 or G3 makes a spiral or a cone"):
        interpret(f"O1\nG21 G90 F9\nG2 X20. Y0 I10. J0 {word}\nM30\n", dialect="fanuc")


@pytest.mark.parametrize("code", ["G43", "G43.1", "G43.4"])
def test_lengths_along_the_tool_move_it_to_the_tip_s_place(code: str) -> None:
    found = interpret(f"O1\nG21 G90 F9\nG0 Z50.\n{code} H1 Z20.\nG1 Z-1.\nM30\n", dialect="fanuc")
    assert (found.end[:, 2] * 1e3).round(9).tolist() == [50, 20, -1]


@pytest.mark.parametrize(
    "comment", ["DIS,SLOT", "CALL 200", "RPT,3", "GOTO N5 IF TOOL BROKEN", "UTO,1", "TMR,5", "ERP", "call 5551234"]
)
@pytest.mark.parametrize("number", ["O1000", "%\nO0012 (PLATE)", "o5"])
def test_what_stands_in_brackets_is_a_comment_behind_a_number_o(comment: str, number: str) -> None:
    """Fagor's and OSAI's programs have no such number; a control that has one never acts on brackets."""
    program = interpret(f"{number}\n({comment})\nG21 G90 G0 X0 Y0 S900 M3\nN5 G1 X5 F100\nM30\n")
    np.testing.assert_allclose(program.end[-1], [5e-3, 0.0, 0.0])


@pytest.mark.parametrize("dialect", ["auto", "fanuc"])
def test_g60_with_a_place_is_a_rapid_of_its_own_and_alone_it_is_nothing(dialect: str) -> None:
    """Fanuc's and Haas's positioning from one side: behind G1 it was read as a cut."""
    text = "O1000\nG21 G90 S9 M3\nG1 X1. F100\nG60{}\nG1 X9.\nM30\n"
    assert interpret(text.format(""), dialect=dialect).at_feed.all()
    with pytest.raises(GCodeError, match="Line 4: G60 with axis words goes there at rapid, from one side; write G0"):
        interpret(text.format(" X5."), dialect=dialect)
