"""Subprograms by number, line and name: they run where the file holds them, and are refused by name where not."""

from __future__ import annotations

import numpy as np
import pytest

from robomill.errors import GCodeError
from robomill.toolpath.gcode import interpret


def xs(text: str, dialect: str = "auto") -> list[float]:
    return [round(float(x) * 1e3, 9) for x in interpret(text, dialect=dialect).end[:, 0]]


HEAD = "%\nO00011\nG21 G90 G1 F100 X1.\n"
RUN = [
    # Haas Mill Operator's Manual, M97: the line of that number in the same program, L times, up to M99
    (HEAD + "M97 P1000 L3\nX9.\nM30\nN1000 G91 X1.\nG90\nM99\n%\n", [1, 2, 3, 4, 9]),
    (HEAD + "M97 P5\nM97 P5\nM30\nN5 G91 X2.\nG90\nM99\n%\n", [1, 3, 5]),
    # Fanuc, M99 P: back to that line of the caller
    (HEAD + "M98 P7\nX5.\nN20 X6.\nM30\nO7\nX2.\nM99 P20\n%\n", [1, 2, 6]),
    (HEAD + "M198 P7\nX5.\nM30\nO7\nX2.\nM99\n%\n", [1, 2, 5]),
    # M99 P in the main program goes on at that line; the one behind, where two have the number
    (HEAD + "M99 P20\nX5.\nN20 X6.\nM30\n%\n", [1, 6]),
    (HEAD + "N20 X7.\nM99 P20\nX5.\nN20 X6.\nM30\n%\n", [1, 7, 6]),
    (HEAD + "X3.\nM99\nX5.\nM30\n%\n", [1, 3]),
    # a macro's #1 to #33 are its own, and its caller's are there again behind it; #34 and on do not exist there
    (HEAD + "#33=8\n#100=2\nG65 P7 A4.\nX#33\nX#100\nM30\nO7\nX#1\n#33=5\n#100=3\nX#33\nM99\n%\n", [1, 4, 5, 8, 3]),
    (HEAD + "#33=8\nM98 P7\nX#33\nM30\nO7\n#33=5\nM99\n%\n", [1, 5]),
    # a program of five digits (Haas) is no repeat of one of four
    (HEAD + "M98 P20007\nX5.\nM30\nO20007\nX3.\nM99\n%\n", [1, 3, 5]),
    (HEAD + "M98 P20007\nX5.\nM30\nO0007\nX3.\nG91 X1.\nG90\nM99\n%\n", [1, 3, 4, 3, 4, 5]),
]


@pytest.mark.parametrize(("text", "places"), RUN)
def test_calls_by_number_and_line_are_followed(text: str, places: list[float]) -> None:
    assert xs(text, "fanuc") == places


BESIDE = [
    # Fanuc, Operator's Manual, subprogram: "X1000.0 M98 P1200" calls behind the movement in X
    ("X3. M98 P7\nX9.\n", "G91 X1.\nG90\n", [1, 3, 4, 9]),
    # what is modal beside the call holds from there on
    ("G91 M98 P7\n", "X1.\nX1.\n", [1, 2, 3]),
    ("G10 L2 P2 X100. Y0 Z0\nG55 M98 P7\n", "X1.\n", [1, 101]),
    ("G43 H2 Z5. M98 P7 L2\n", "G91 X1.\nG90\n", [1, 1, 2, 3]),
    # a move beside M99 is made before the return, in what G66 calls, too
    ("G66 P7\nX9.\nG67\n", "X4. ", [1, 9, 4]),
    ("M98 P7\nX9.\n", "X4. ", [1, 4, 9]),
]


@pytest.mark.parametrize(("calls", "called", "places"), BESIDE)
def test_words_beside_a_call_and_a_return_are_executed_before_it(calls: str, called: str, places: list[float]) -> None:
    assert xs(f"{HEAD}{calls}M30\nO7\n{called}M99\n%\n", "fanuc") == places


def test_the_number_of_another_program_ends_the_one_before_it() -> None:
    """A subprogram without M99 would go on into the next one, and a main program without M30 into its subprograms."""
    with pytest.raises(GCodeError, match=r"Line 7: O7 goes on into O8; close it with M99 before that line."):
        interpret(HEAD + "M98 P7\nM30\nO7\nO8\nX4.\nM99\n%\n", dialect="fanuc")
    text = HEAD + "M98 P7\nX9.\nO7\nX2.\nM99\n%\n"
    assert xs(text, "fanuc") == [1, 2, 9]
    found = interpret(text, dialect="fanuc").findings
    assert [(f.line, f.level) for f in found if f.code == "no-end"] == [(6, "warning")]


def test_a_move_beside_a_call_that_a_macro_would_follow_is_refused() -> None:
    with pytest.raises(GCodeError, match=r"Line 5: M98 beside other words, and a macro or cycle that every move calls"):
        interpret(HEAD + "G66 P7\nX9. M98 P7\nM30\nO7\nX4.\nM99\n%\n", dialect="fanuc")


def test_a_cycle_beside_a_call_is_refused_where_both_want_a_word() -> None:
    with pytest.raises(GCodeError, match=r"Line 4: M98 and a cycle on one line both want L or Q"):
        interpret(HEAD + "G83 Z-4. R1. Q2. M98 P7\nM30\nO7\nX4.\nM99\n%\n", dialect="fanuc")


SINUMERIK = [
    ("L100 P2\nX9\nM30\n%_N_L100_SPF\nG91 X1\nG90\nM17\n", [1, 2, 3, 9]),
    ("N20 L0100\nX9\nM30\n%_N_L0100_SPF\n;$PATH=/_N_SPF_DIR\nX4\nRET\n", [1, 4, 9]),
    ("CONTOUR\nX9\nM30\n%_N_CONTOUR_SPF\nX4\nM17\n", [1, 4, 9]),
    ("Contour() P=2\nX9\nM30\n%_N_CONTOUR_SPF\nX4\nX5\nM2\n", [1, 4, 5, 4, 5, 9]),
    ('CALL "POCKET"\nX9\nM30\nPROC POCKET\nX4\nRET\n', [1, 4, 9]),
    ("L1\nX9\nM30\n%_N_L1_SPF\nL2\nX3\nM17\n%_N_L2_SPF\nX2\nM17\n", [1, 2, 3, 9]),
    ("X9\nM17\n", [1, 9]),
    ("L1 P2\nX9\nM30\n%_N_L1_SPF\nG91 X3\nG90 X2 M17\n", [1, 4, 2, 5, 2, 9]),
]


BEGUN = {
    "P2 Q20": ([2], "call-begins"),
    "P2 Q20 L2": ([2, 3], "call-begins"),
    "P2 H20": ([2], "call-begins"),
    "P2 Q2": ([11, 12, 22, 23], "call-counts"),
    "P2": ([11, 12], ""),
    "H50 L2": ([6, 11], ""),
}
"""What is behind X1 by G91: N10 adds 10, N20 adds 1, N50 adds 5."""


@pytest.mark.parametrize("call", BEGUN)
def test_q_of_a_call_is_the_line_where_it_begins_or_a_count_where_there_is_none(call: str) -> None:
    text = f"O1\nG21 G90 G1 F100 X1.\nM98 {call}\nM30\nN50 G91 X5.\nG90 M99\nO2\nN10 G91 X10.\nN20 G91 X1.\nG90 M99\n"
    places, code = BEGUN[call]
    assert xs(text, "auto") == [1, *places]
    said = {f.code for f in interpret(text).findings} & {"call-begins", "call-counts"}
    assert said == ({code} if code else set())


@pytest.mark.parametrize("call", ["P2 Q3 L2", "P2 H30", "P2 Q1.5", "P2 Q0"])
def test_a_line_that_a_call_names_and_that_is_not_there_is_refused(call: str) -> None:
    with pytest.raises(GCodeError, match=r"^Line 2: [QH][\d.]+ of M98 names a line"):
        interpret(f"O1\nM98 {call}\nM30\nO2\nN10 G91 X10.\nM99\nN30 X9\n")


@pytest.mark.parametrize(("text", "places"), SINUMERIK)
def test_calls_by_name_are_followed_on_a_sinumerik(text: str, places: list[float]) -> None:
    for head in ("", "%_N_MAIN_MPF\n;$PATH=/_N_WKS_DIR\n"):
        assert xs(f"{head}G71 G90 G1 F100 X1\n{text}", "sinumerik") == places


REFUSED = [
    (HEAD + "M97 P1000\nM30\n%\n", "fanuc", "Line 4: M97 calls line N1000, but no line has that number"),
    (HEAD + "M98 P7 Q3\nM30\nO7\nM99\n%\n", "fanuc", "Line 4: Q3 of M98 names a line of what it calls"),
    (HEAD + "M98\nM30\n%\n", "fanuc", "Line 4: M98 needs P, the number of the program to call"),
    (HEAD + "M97\nM30\n%\n", "fanuc", "Line 4: M97 needs P, the line to call"),
    (HEAD + "M198 P55\nM30\n%\n", "fanuc", "Line 4: M198 calls O55, but there is no O55 in the program; paste it in"),
    (HEAD + "M98 P2\nM30\n%\nO0002\nX9.\nM99\n", "fanuc", "Line 4: M98 calls O2, which stands behind the % that ends"),
    (HEAD + "M99 P3\nM30\n%\n", "fanuc", "Line 4: M99 goes back to line N3, but no line has that number"),
    ("G71 G1 F9 X1\nL100 P2\nM30\n", "sinumerik", "Line 2: L100 calls a subprogram that is not in this file; paste"),
    ('G71 G1 F9 X1\nCALL "A1"\nM30\n', "sinumerik", "Line 2: A1 calls a subprogram that is not in this file"),
    ("G71\nSUB(3)\nM30\n%_N_SUB_SPF\nX1\nM17\n", "sinumerik", "Line 2: SUB is called with values"),
]


@pytest.mark.parametrize(("text", "dialect", "says"), REFUSED)
def test_a_subprogram_is_never_left_out(text: str, dialect: str, says: str) -> None:
    with pytest.raises(GCodeError, match=says):
        interpret(text, dialect=dialect)


def test_what_stands_behind_the_closing_percent_is_not_called_by_o_words_either() -> None:
    text = "%\nG21 G1 F9 X1\nO1 call\nM2\n%\nO1 sub\nX9\nO1 endsub\n"
    with pytest.raises(GCodeError, match="Line 3: O1 is called, but there is no O1 sub"):
        interpret(text)
    assert xs(text.replace("%\nO1 sub", "O1 sub")) == [1, 9]


def test_subprograms_that_call_themselves_are_refused() -> None:
    for text, dialect in (("O5\nG21\nM98 P5\nM30\n", "fanuc"), ("N5 M97 P5\nM30\n", "fanuc")):
        with pytest.raises(GCodeError, match="levels deep"):
            interpret(text, dialect=dialect)


def test_repeats_cut_as_often_as_they_are_said() -> None:
    program = interpret(HEAD + "M97 P3 L4\nM30\nN3 G91 X1.\nG90 M99\n%\n", dialect="fanuc")
    np.testing.assert_allclose(program.end[:, 0] * 1e3, [1, 2, 3, 4, 5])


def test_lines_behind_the_end_that_are_called_are_not_called_unread() -> None:
    text = "%\nG21 G90 G1 F100 X1.\nM97 P1000\nM30\nN1000 X2.\nM99\n%\n"
    assert not [f for f in interpret(text, dialect="fanuc").findings if f.code == "after-end"]


@pytest.mark.parametrize("dialect", ["auto", "fanuc"])
def test_a_colon_begins_a_program_as_an_o_does(dialect: str) -> None:
    text = "%\n:0123\nG21 G90 G1 F100 X1.\nM98 P456\nM30\n:0456 (SUB)\nX2.\nM99\n%\n"
    assert xs(text, dialect) == [1, 2]


@pytest.mark.parametrize("deep", range(1, 12))
def test_subroutines_may_call_one_another_nine_deep(deep: int) -> None:
    """As RS274/NGC has ten levels, of which the program itself is one."""
    subs = [f"o{k} sub\n{f'o{k + 1} call' if k < deep else 'X7'}\no{k} endsub\n" for k in range(deep, 0, -1)]
    text = f"{''.join(subs)}G21 G90 G1 F100 X1\no1 call\nX9\nM2\n"
    if deep <= 9:
        assert xs(text, "linuxcnc") == [1, 7, 9]
    else:
        with pytest.raises(GCodeError, match="more than 9 levels deep"):
            xs(text, "linuxcnc")


def test_a_program_begins_below_the_subprograms_that_a_control_writes_above_it():
    step = "O9000 (STEP)\nG91 G1 X1. F100\nG90\nM99\n"
    main = "O0001 (MAIN)\nG21 G90\nG0 X0 Y0 Z5.\nM98 P{call}\nG1 Y7. F100\nM30\n"
    for call in ("9000 L2", "29000", "00029000"):
        found = interpret(f"%\n{step}{main.format(call=call)}%\n")
        assert np.round(found.end * 1e3, 9).tolist()[-3:] == [[1, 0, 5], [2, 0, 5], [2, 7, 5]]
        said = [f for f in found.findings if f.code == "begins-at-main"]
        assert [(f.line, f.message[:26]) for f in said] == [(6, "the program begins at O1: ")]
    below = main.format(call="9000 L2") + step
    assert not any(f.code == "begins-at-main" for f in interpret(f"%\n{below}%\n").findings)
    loop = (
        "O9000\nG21 G90\nG0 X0 Y0 Z5.\nG1 X3. F100\nM99\nO9001\nG1 X9.\nM30\n"  # two parts, of which the first recurs
    )
    assert interpret(f"%\n{loop}%\n").end[-1, 0] == pytest.approx(0.003)


def test_a_macro_that_measures_is_named_as_such():
    with pytest.raises(GCodeError, match="Line 3: G65 calls O9810, a macro that measures with a probe and cuts noth"):
        interpret("O1\nG21 G90\nG65 P9810 Z10. F500.\nG0 X1.\nM30\n", dialect="fanuc")
