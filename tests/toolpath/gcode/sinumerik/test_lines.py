"""AC( ) and IC( ) beside what is scaled; G500 beside G54."""

from __future__ import annotations

import numpy as np
import pytest

from robomill.toolpath.gcode import interpret


@pytest.mark.parametrize("scale", ["", "SCALE X2 Y2\n", "SCALE X0.5 Y0.5\n"])
@pytest.mark.parametrize(
    ("word", "angles"),
    [("A=IC(10)", [40, 20, -7]), ("G91 B=AC(25)", [30, 25, -7]), ("C=IC(-3)", [30, 20, -10]), ("A=AC(1)", [1, 20, -7])],
)
def test_steps_and_places_of_rotary_axes_are_those_said_where_lengths_are_scaled(
    scale: str, word: str, angles: list[float]
) -> None:
    program = interpret(f"G71 G90 G17 F100\nG0 X3 Y4 Z5 A30 B20 C-7\n{scale}G1 {word}\nM30\n", dialect="sinumerik")
    np.testing.assert_allclose(np.degrees(program.rotary[-1]), angles, atol=1e-9)
    np.testing.assert_allclose(program.end[-1] * 1e3, [3, 4, 5], atol=1e-9)


def test_places_behind_g500_are_the_machine_s_until_a_zero_is_chosen_again() -> None:
    """G500 ends G54: Z400 is no height above the part, and 500 before the first zero is none either."""
    head, cut = "G71 G90 G17 G500\nG0 Z500 D0\n", "G0 X5 Y6\nZ10\nG1 Z-1 F100\nG0 Z10\n"
    text = f"{head}G505\n{cut}N90 G500\nG0 Z400\nX600 Y300 ; G505\nG505 G0 X1 Y2\nZ5\nM30\n"
    program = interpret(text, dialect="sinumerik")
    away = {int(line): row.tolist() for line, row in zip(program.line, program.away)}
    lost, known = [False, False, True], [False] * 3
    assert away == {2: lost, 4: lost, 5: known, 6: known, 7: known, 9: lost, 10: [True] * 3, 11: lost, 12: known}
    assert [(f.line, "G500" in f.message) for f in program.findings if f.code == "machine-place"] == [(2, True)]


def test_a_program_that_knows_no_other_zero_has_its_own_in_g500() -> None:
    """Comments choose none; a step from a known place is known in G500, too."""
    program = interpret("G71 G90 G17 G500 ; not G54\nG0 X1 Y2 Z3\nM30\n", dialect="sinumerik")
    assert not program.away.any()
    program = interpret("G71 G90 G17 G54\nG0 X1 Y2 Z3\nG500\nG91 Z10\nM30\n", dialect="sinumerik")
    assert not program.away.any()
    np.testing.assert_allclose(program.end[-1] * 1e3, [1, 2, 13], atol=1e-9)


def test_another_edge_of_a_tool_is_told() -> None:
    text = "G71 G90 G17 G54\nT1 M6\nG0 X1 Y2 D1\nT2 M6\nG0 Z3 d2\nG0 Z400 D0\nM30\n"
    program = interpret(text, dialect="sinumerik")
    assert [(f.line, f.level) for f in program.findings if f.code == "tool-edge"] == [(5, "warning")]
    np.testing.assert_allclose(program.end * 1e3, [[1, 2, 0], [1, 2, 3], [1, 2, 400]], atol=1e-9)


@pytest.mark.parametrize(
    ("line", "said"),
    [
        ('MSG("DRILL (1)") G1 X4 Y5', "DRILL [1]"),
        ('N20 G1 X4 MSG("DRILL") Y5 ; Y9', "DRILL"),
        ('G1 X4 Y5 MSG ("X="<<R1, 1)', "X=<<R1, 1"),
        ("G1 X4 MSG() Y5", ""),
    ],
)
def test_words_beside_a_message_are_executed(line: str, said: str) -> None:
    """MSG may stand in a block with others (840D sl, Fundamentals: MSG); what is behind it was lost."""
    program = interpret(f"G71 G90 G17 F100\nR1=2\n{line}\nX6\nM30\n", dialect="sinumerik")
    np.testing.assert_allclose(program.end * 1e3, [[4, 5, 0], [6, 5, 0]], atol=1e-9)
    assert program.messages[0] == (3, said)


@pytest.mark.parametrize(
    ("text", "dialect", "feed", "code"),
    [
        # 802D sl, G70: feeds stay in the basic system, which this program shows nothing of: Hurco's, say, is inch
        ("%\nG00 G17 G40 G80 G90 G70\nT1 M6\nG01 X1.0 F10.0\nM02\nE\n", "auto", 254.0, "feeds-inch"),
        ("G70 G90\nG1 X1 F10\nM30\n", "sinumerik", 10.0, "feeds-metric"),
        ('G70 G90\nMSG("x")\nG1 X1 F10\nM30\n', "auto", 10.0, "feeds-metric"),
        ("G700 G90\nG1 X1 F10\nM30\n", "sinumerik", 254.0, ""),
    ],
)
def test_feeds_beside_g70_are_inches_where_nothing_else_shows_a_sinumerik(
    text: str, dialect: str, feed: float, code: str
) -> None:
    program = interpret(text, dialect=dialect)
    assert program.dialect == "sinumerik"
    np.testing.assert_allclose(program.end[-1] * 1e3, [25.4, 0, 0], atol=1e-9)
    assert program.v_f[-1] * 6e4 == pytest.approx(feed)
    assert [(f.code, f.level) for f in program.findings if "feeds" in f.code] == ([(code, "warning")] if code else [])


@pytest.mark.parametrize(
    ("body", "end", "said"),
    [
        # 840D sl, setting data 42440, 1 as delivered: X1 would lead to 11, where it is read as one step
        ("TRANS X10\nG91 X1\n", [1, 0, 0], [4]),
        ("TRANS X10\nX=IC(1)\n", [1, 0, 0], [4]),
        ("MIRROR X0\nG0 X5\nMIRROR\nG91 Y1 X1\n", [-4, 1, 0], [6]),
        ("TRANS X10\nG91 Y1\n", [0, 1, 0], []),
        ("TRANS X10\nX0\nG91 X1\n", [11, 0, 0], []),
        ("G91 X1\nTRANS\nX1\n", [2, 0, 0], []),
    ],
)
def test_a_step_behind_a_frame_is_said(body: str, end: list[float], said: list[int]) -> None:
    program = interpret(f"G71 G90 G17 F100\nG0 X0 Y0 Z0\n{body}M30\n", dialect="sinumerik")
    np.testing.assert_allclose(program.end[-1] * 1e3, end, atol=1e-9)
    assert [f.line for f in program.findings if f.code == "step-behind-frame"] == said
