"""Programs in languages that are not read: the refusal names the line, the word and the language."""

from __future__ import annotations

import pytest

from robomill.errors import GCodeError
from robomill.toolpath.gcode import interpret


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
        ("N7 R1=5", "R1=", "Sinumerik"),
        ("G1 X=R1", "X=", "Sinumerik"),
        ("TOOL CALL 1 Z S1000", "TOOL", "Heidenhain"),
        ("G1 X10 FMAX", "FMAX", "Heidenhain"),
        ("G1 X10 SOFTLY", "SOFTLY", ""),
        ("G0 X[FOO[1]]", "FOO", ""),
    ],
)
def test_a_word_of_another_language_is_named(line: str, word: str, language: str, dialect: str) -> None:
    with pytest.raises(GCodeError) as caught:
        interpret(f"G21 G90 F100\n{line}\nM2\n", dialect=dialect)
    assert caught.value.line == 2
    assert str(caught.value).startswith(f"Line 2: {word}")
    assert language in str(caught.value)
