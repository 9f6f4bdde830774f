"""Programs in languages that are not read: the refusal names the line, the word and the language."""

from __future__ import annotations

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
        ("%PART G71 *\nN10 G30 G17 X+0 Y+0 Z-20*\n", 1, "Heidenhain's DIN/ISO"),
        ("IN;SP1;PU0,0;PD10,10;\n", 1, "HPGL"),
        ("  0\nSECTION\n  2\nHEADER\n", 1, "a DXF drawing"),
        ("solid part\nfacet normal 0 0 1\n", 1, "an STL surface"),
        ("ISO-10303-21;\nHEADER;\n", 1, "STEP"),
    ],
)
def test_a_file_of_another_language_is_named_by_it_on_its_first_line(text: str, line: int, name: str) -> None:
    with pytest.raises(GCodeError) as caught:
        interpret(text)
    assert str(caught.value).startswith(f"Line {line}: this is {name}")
    assert "expected G-code, Heidenhain's dialogue or APT" in str(caught.value)
