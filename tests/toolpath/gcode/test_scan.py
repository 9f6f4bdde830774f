"""Words of a line where they stand."""

import pytest

from robomill.toolpath.gcode.scan import joined, scan, uncalled, unscaled, without

LINES = [
    "N10 G01 X-1.5Y+.25 Z 3. F100 (a comment; with X9) M8 ; and Y1",
    "/N20G2X1Y2I.5J0",
    "G1 X[#1+[2*3]] Y#2 Z#<deep> F[#3]",
    "X=R1*2 Y=IC(5) CR=8 RND=2",
    "G1 X20.,R3. Y1",
    "G1 X40 (finish (slot) X9) F1500",
    "",
]


@pytest.mark.parametrize("line", LINES)
def test_what_is_taken_apart_is_what_was_written(line: str) -> None:
    tokens = scan(line)
    assert tokens is not None
    assert joined(tokens) == line


def test_words_have_letters_values_and_codes() -> None:
    tokens = scan(LINES[0]) or []
    words = {token.letter: token.value for token in tokens if token.letter}
    assert words == {"N": 10.0, "G": 1.0, "X": -1.5, "Y": 0.25, "Z": 3.0, "F": 100.0, "M": 8.0}
    assert [token.code for token in tokens if token.code] == ["G1", "M8"]
    assert [token.text for token in tokens if token.is_comment] == ["(a comment; with X9)", "; and Y1"]


def test_computed_words_have_no_value() -> None:
    for line in LINES[2:4]:
        assert all(token.value is None for token in scan(line) or () if token.letter and token.letter != "G")
    assert [token.letter for token in scan(LINES[3]) or () if token.letter] == ["X", "Y", "CR=", "RND="]
    assert "R=" in [token.letter for token in scan(LINES[4]) or ()]


@pytest.mark.parametrize("line", ['MSG("hello")', "GOTO 10", "o100 while [#1 LT 3]", "L X+10 R0 FMAX {"])
def test_what_is_no_line_of_words_is_none(line: str) -> None:
    assert scan(line) is None


def test_a_word_goes_with_the_space_before_it_and_gets_another_number() -> None:
    tokens = scan("G1 X10 Y20 F5") or []
    at = [token.letter for token in tokens].index("Y")
    assert joined(without(tokens, {at})) == "G1 X10 F5"
    assert tokens[at].said("-3.5").text == "Y-3.5"


@pytest.mark.parametrize(
    ("text", "left"),
    [("N7 MIRROR X0", ["N7 TRANS"]), ("scale", ["TRANS"]), (" AMIRROR Y0", []), ("ASCALE X2", []), ("G1 X5", None)],
)
def test_what_is_left_of_lines_that_mirror_and_scale(text: str, left: list[str] | None) -> None:
    assert unscaled(text) == left


def test_a_comment_within_a_comment_holds_no_words() -> None:
    tokens = scan("G1 X40 (finish (slot) X9) F1500") or []
    assert [token.letter for token in tokens if token.letter] == ["G", "X", "F"]
    assert [token.text for token in tokens if token.is_comment] == ["(finish (slot) X9)"]


@pytest.mark.parametrize(
    ("line", "left"),
    [
        ("N5 G0 X10. M98 P200 L2 (so)", "N5 G0 X10. (so)"),
        ("G43 H1 Z5. M98 P200", "G43 H1 Z5."),
        ("X4. M99", "X4."),
        ("N5 M98 P200 L2", "N5 M98 P200 L2"),
        ("G4 P500", "G4 P500"),
        ("M99 P20", "M99 P20"),
    ],
)
def test_words_beside_a_call_are_left_without_it(line: str, left: str) -> None:
    assert uncalled(line) == left
