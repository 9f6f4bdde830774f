"""Q parameters, shifts and turns of Heidenhain's dialogue, reckoned by hand."""

from __future__ import annotations

import math
import operator

import numpy as np
import pytest

from robomill.errors import GCodeError
from robomill.toolpath.gcode import Program, interpret
from robomill.toolpath.tools import Tool

HEAD = "BEGIN PGM Q MM\nTOOL CALL 1 Z S1000 F99\nL X+0 Y+0 Z+10 FMAX M3\n"


def read(body: str) -> Program:
    return interpret(f"{HEAD}{body}END PGM Q MM\n")


def ends(body: str) -> list[list[float]]:
    return (np.round(read(body).end[1:] * 1e3, 6) + 0.0).tolist()


@pytest.mark.parametrize(
    ("body", "x"),
    [
        ("FN 0: Q1 = +5\nL X+Q1\n", 5),
        ("FN0:Q1=-5\nL X-Q1\n", 5),
        ("FN 1: Q1 = +2 + +3\nFN 2: Q2 = +Q1 - -1\nL X+Q2\n", 6),
        ("FN 3: Q1 = +2 * +3\nFN 4: Q2 = +Q1 DIV +4\nL XQ2\n", 1.5),
        ("FN 5: Q1 = +16\nL X+Q1\n", 4),
        ("FN 6: Q1 = +30\nFN 7: Q2 = +60\nQ3 = Q1 + Q2\nL X+Q3\n", 1),
        ("FN 5: Q1 = SQRT +16\nL X+Q1\n", 4),
        ("FN5:Q1=SQRT 16\nL X+Q1\n", 4),
        ("QL5 = 16\nFN 5: Q1 = SQRT QL5\nL X+Q1\n", 4),
        ("FN 6: Q1 = SIN+30\nL X+Q1\n", 0.5),
        ("QL1 = 30\nFN 6: Q1 = SIN -QL1\nL X+Q1\n", -0.5),
        ("FN 7: Q1 = COS +60\nL X+Q1\n", 0.5),
        ("FN 1: Q1 = 2+3\nFN 2: Q2 = -Q1-+4\nL X+Q2\n", -9),
        ("FN 4: Q1 = +5DIV+2\nFN 8: Q2 = +Q1LEN+6\nL X+Q2\n", 6.5),
        ("FN 8: Q1 = +3 LEN +4\nL X+Q1\n", 5),
        ("FN 13: Q1 = +10 ANG +10\nL X+Q1\n", 45),
        ("FN 13: Q1 = +10 ANG -10\nFN13:Q2=-1 ANG 0\nL X+Q2\n", 270),
        ("Q1 = 2 * ( 3 + 1 ) - SQRT 4 + 2 ^ 3\nL X+Q1\n", 14),
        ("QL1 = SIN 30 + COS ( 60 ) + INT 2.7 + ABS -2\nL X+QL1\n", 5),
        ("Q1 = 0\nLBL 1\nQ1 = Q1 + 1\nFN 12: IF +Q1 LT +4 GOTO LBL 1\nL X+Q1\n", 4),
        ("Q1 = 1\nFN 9: IF +Q1 EQU +1 GOTO LBL 5\nL X+99\nLBL 5\nL X+7\n", 7),
        ("FN 10: IF +1 NE +2 GOTO LBL 2\nL X+1\nLBL 2\nL IX+5\n", 5),
        ("FN 10: IF +1 NE +1 GOTO LBL 2\nL X+1\nLBL 2\nL IX+5\n", 6),
        ("FN 11: IF+2GT+1GOTO LBL2\nL X+1\nLBL 2\nL IX+5\n", 5),
        ("Q1 = 1\nFN 10: IF +Q1 NEQU +1 GOTO LBL 5\nL X+99\nLBL 5\nFN 11: IF Q1 GT 0 GOTO LBL 6\nL X+1\nLBL 6\n", 99),
    ],
)
def test_q_parameters(body: str, x: float) -> None:
    assert ends(body)[-1][0] == pytest.approx(x)


COMPARED = {"9": ("EQU", operator.eq), "10": ("NE", operator.ne), "11": ("GT", operator.gt), "12": ("LT", operator.lt)}


@pytest.mark.parametrize("number", COMPARED)
@pytest.mark.parametrize(("a", "b"), [(1, 2), (2, 1), (2, 2), (-2, 1), (1, -2)])
def test_jumps_follow_what_is_compared(number: str, a: int, b: int) -> None:
    """As Python's own operator says: X+1 is passed over where it holds."""
    word, holds = COMPARED[number]
    body = f"FN {number}: IF {a:+d} {word} {b:+d} GOTO LBL 2\nL X+1\nLBL 2\nL IX+5\n"
    assert ends(body)[-1][0] == pytest.approx(5 if holds(a, b) else 6)


def test_shifts_and_turns() -> None:
    """X1 Y0 behind a shift of (10, 20) and a turn of 90 degrees is (10, 21)."""
    body = "CYCL DEF 7.0 DATUM SHIFT\nCYCL DEF 7.1 X+10\nCYCL DEF 7.2 Y+20\nL X+1 Y+0\n"
    body += "CYCL DEF 10.0 ROTATION\nCYCL DEF 10.1 ROT+90\nL X+1 Y+0\n"
    body += "CYCL DEF 10.1 ROT+0\nCYCL DEF 7.1 IX+5\nL X+1 Y+0\n"
    body += "CYCL DEF 7.1 X+0\nCYCL DEF 7.2 Y+0\nL X+1 Y+0\n"
    assert [row[:2] for row in ends(body)] == [[11, 20], [10, 21], [16, 20], [1, 0]]


def test_a_preset_ends_shift_turn_and_mirror_image() -> None:
    """CYCL DEF 247 ends what 7, 8 and 10 began: IX+60 behind a shift by -60 counts from the preset again."""
    preset = "CYCL DEF 247 PRESET ~\n  Q339=+1 ;NUMBER\n"
    assert ends(f"CYCL DEF 7.1 IX-60\nL X+1\n{preset}CYCL DEF 7.1 IX+60\nL X+1\n")[1][0] == 61
    assert ends(f"CYCL DEF 10.1 ROT+90\nL X+5 Y+0\n{preset}L X+5 Y+0\n")[1][:2] == [5, 0]
    assert ends(f"CYCL DEF 8.1 X\nL X+5\n{preset}L X+6\n")[1][0] == 6


def test_auto_is_the_feed_of_the_tool_call() -> None:
    cycle = "CYCL DEF 201 REAM ~\n Q200=2 ~\n Q201=-5 ~\n Q206= AUTO ~\n Q208=FAUTO ~\n Q203=+0 ~\n Q204=5\n"
    feeds = read(f"{cycle}L X+1 FMAX M99\n").v_f * 6e4
    assert feeds.round(6).tolist() == [0, 0, 0, 99, 99, 0]  # to X0, X1 and down at rapid; in, out; up


def test_a_remark_goes_on_in_lines_without_a_number() -> None:
    body = "3 ;POST -~\n4 ;OF A SHOP~\n that writes L X+9~\n and more\n5 L X+1 F9\nL X+2 ;NEXT~\n Y+3\n"
    assert [row[:2] for row in ends(body)] == [[1, 0], [2, 3]]


@pytest.mark.parametrize(
    ("formula", "value"),
    [
        ("SQ 3 + SQ ( 1 + 1 )", 13),
        ("NEG 2 + ATAN 1", 43),
        ("400 % 360", 40),
        ("FRAC -2.5", -0.5),
        ("INT -2.5", -2),
        ("SGN -7 * 3", -3),
        ("LOG 1000 + LN ( EXP 2 )", 5),
        ("SQ NEG 2", None),
        ("SQ ( 2 * ( 1 + 2 ) - SQ ( 2 ) ) + SQ 3", 13),
        ("PI * 2 - NEG ( ( 1 + 2 ) * 3 )", 2 * math.pi + 9),
    ],
)
def test_functions_of_formulas(formula: str, value: float | None) -> None:
    if value is None:
        with pytest.raises(GCodeError):
            read(f"Q1 = {formula}\nL X+Q1\n")
    else:
        assert read(f"Q1 = {formula}\nL X+Q1\n").end[-1, 0] * 1e3 == pytest.approx(value)


def test_a_preset_may_be_chosen_again_and_cycles_without_moves_are_passed_over() -> None:
    body = "CYCL DEF 247 PRESET Q339=+3\nL X+1 FMAX\nCYCL DEF 247 PRESET Q339=3\nCYCL DEF 32.0 TOLERANCE\n"
    body += "CYCL DEF 32.1 T0.05\nCYCL DEF 13.0 ORIENTATION\nCYCL DEF 13.1 ANGLE90\nL X+2 FMAX\n"
    assert [x for x, *_ in ends(body)] == [1, 2]


@pytest.mark.parametrize("kind", ["Q", "QL", "QR"])
@pytest.mark.parametrize("other", ["Q", "QL", "QR"])
def test_parameters_of_three_kinds_are_kept_apart(kind: str, other: str) -> None:
    """Q0, QL0, QR0, their neighbours and their last ones."""
    names = [f"{kind}{n}" for n in (0, 1, 2, 498, 499)] + [f"{other}{n}" for n in (0, 1, 2, 498, 499)]
    said = {name: 1 + i for i, name in enumerate(names)}
    body = "".join(f"{name} = {value}\n" for name, value in said.items())
    assert [x for x, *_ in ends(body + "".join(f"L X+{name} FMAX\n" for name in said))] == list(said.values())
    with pytest.raises(GCodeError, match=f"{kind}{2000 if kind == 'Q' else 500} does not exist"):
        read(f"{kind}{2000 if kind == 'Q' else 500} = 1\n")


def test_dwells_are_waited() -> None:
    assert read("CYCL DEF 9.0 DWELL TIME\nCYCL DEF 9.1 DWELL 1.5\n").dwell_time == pytest.approx(1.5)


@pytest.mark.parametrize(
    ("body", "says"),
    [
        ("L X+Q5\n", "Q5 is read before the program sets it"),
        ("L X+5 FMAX M99\n", "a cycle is called, but none is defined"),
        ("CYCL DEF 251 POCKET ~\nQ218=60\n", "CYCL DEF 251 POCKET is a cycle that is not read"),
        ("CYCL DEF 7.1 #5\n", "CYCL DEF 7 takes its shift from a table"),
        ("CYCL DEF 8.1 Z\n", "CYCL DEF 8.1 Z is not read; expected X, Y or both"),
        ("CYCL DEF 8.1 X\nCYCL DEF 7.1 X+3\n", "a datum shift or rotation inside of a mirror image"),
        ("CYCL DEF 220 ~\nQ241=4\n", "CYCL DEF 220 repeats a cycle, but none is defined"),
        ("CYCL DEF 200 ~\nQ200=2 ~\nQ201=-5\nCYCL DEF 221 Q242=0\n", "CYCL DEF 221 has Q242=0 repeats"),
        ("CYCL DEF 10.1 ROT+30\nCYCL DEF 7.1 X+3\nL X+1\n", "a datum shift inside of a rotation"),
        ("CYCL DEF 247 PRESET Q339=1\nCYCL DEF 247 PRESET Q339=2\n", "CYCL DEF 247 chooses a second preset"),
        ("CYCL DEF 204 BACK BORING Q200=2 Q249=5\n", r"CYCL DEF 204 BACK BORING is a cycle that is not read"),
        ("CYCL DEF 4.0 POCKET MILLING\n", r"CYCL DEF 4 POCKET MILLING is a cycle that is not read"),
        ("TRANS DATUM TABLE TABLINE5\n", "TRANS DATUM TABLE TABLINE5 takes its shift from a table"),
        ("TRANS DATUM AXIS X+5 A+30\n", r"TRANS DATUM has 'A.30'"),
        ("CYCL DEF 7.0 DATUM\nCYCL DEF 7.1 C+30\n", "CYCL DEF 7 has 'C.30'"),
        ("CYCL DEF 248 ~\nQ1=1\n", "CYCL DEF 248 is a cycle that is not read"),
        ("CYCL DEF 240 Q200=2 Q201=-3 Q343=1\nL X+1 FMAX M99\n", "CYCL DEF 240 counts by its diameter"),
        ("CYCL DEF 200 Q200=2 Q201=3\nL X+1 FMAX M99\n", "CYCL DEF 200 needs Q201, its depth"),
        ("CYCL DEF 200 Q200=1 Q201=-3 Q379=1\nL X+1 FMAX M99\n", "CYCL DEF 200 starts below the surface"),
        ("CYCL DEF 209 Q200=1 Q201=-3\nL X+1 FMAX M99\n", "CYCL DEF 209 needs Q239, its pitch"),
        ("CYCL DEF 200 Q200=1 Q201=-3 Q202=.0001\nL X+1 FMAX M99\n", "CYCL DEF 200 needs more than 10000 pecks"),
        ("CYCL DEF 200 Q200=1 Q201=-3\nCYCL DEF 221 Q242=101 Q243=100\n", "CYCL DEF 221 has more than 10000 holes"),
        ("CYCL DEF 200 ~\nQ200=2 ~\nQ201=5\nL X+1 FMAX M99\n", "Q201, its depth, below 0"),
        ("CYCL DEF 200 ~\nQ201=AUTO\n", "Q201=AUTO, which is not read"),
        ("CYCL CALL PAT FMAX\n", "CYCL CALL PAT"),
        ("FN 18: SYSREAD Q1 = ID270 NR1\n", "FN 18: SYSREAD is of Heidenhain's"),
        ("FN 14: Q1 = +3\n", "FN 14 is not read; expected FN 0 to 13"),
        ("FN 6: Q1 = COS +30\n", "FN 6 is SIN, found COS"),
        ("FN 10: IF +1 EQU +2 GOTO LBL 2\nLBL 2\n", "FN 10 compares by NE, found EQU"),
        ("FN 9: IF Q1 IS UNDEFINED GOTO LBL 2\nLBL 2\n", "FN 9: IF"),
        ("QL500 = 1\n", "QL500 does not exist"),
    ],
)
def test_what_is_not_read_is_named(body: str, says: str) -> None:
    with pytest.raises(GCodeError, match=rf"Line [4-8]: .*{says}"):
        read(body)


def test_a_mirror_image_about_the_datum() -> None:
    program = read(
        "CYCL DEF 7.1 X+100\nCYCL DEF 8.1 X\nL X+10 Y+5 F9\nL IX+5\nCC X+25 Y+5\nC X+25 Y+15 DR-\nCP IPA-90 DR-\n"
        "CYCL DEF 8.1\nCYCL DEF 7.1 X+0\nL X+1\n"
    )
    np.testing.assert_allclose(program.end[1:, :2] * 1e3, [[90, 5], [85, 5], [75, 15], [65, 5], [1, 5]], atol=1e-9)
    np.testing.assert_allclose(np.degrees(program.sweep[3:5]), [90, 90])


def test_a_plane_that_is_not_tilted_and_cycles_that_suit_the_control_move_nothing() -> None:
    """As hyperMILL writes a program of three axes for a DMG of five."""
    body = (
        "CYCL DEF 392 ATC~\n Q240=0 ;TUNING MODE~\n Q241=1 ;WEIGHT MODE\n"
        "PLANE SPATIAL SPA0 SPB0 SPC0 STAY SEQ+ TABLE ROT\nL A+Q120 C+Q122 R0 FMAX M126\nL X+5 FMAX\n"
    )
    program = read(body)
    assert program.end[-1, 0] * 1e3 == pytest.approx(5)
    assert not np.any(program.rotary)


@pytest.mark.parametrize("side", ["R0", "RL"])
def test_a_feed_behind_a_corner_is_that_of_the_corner_alone(side: str) -> None:
    """TNC 640, Conversational Programming: a feed in an RND or CHF block is effective in that block only."""
    head = "BEGIN PGM Q MM\nTOOL CALL 1 Z S1000 F99\nL X+0 Y+0 Z+10 FMAX M3\n"
    body = f"L X+10 Y+10 {side} F100\nL X+30\nRND R5 F20\nL Y+40\nCHF 2 F10\nL X+10\nRND R5\nL Y+12\nEND PGM Q MM\n"
    found = interpret(head + body, tools={1: Tool(1, diameter=2e-3)})
    np.testing.assert_allclose(found.v_f[found.kind > 0][1:] * 6e4, [100, 20, 100, 10, 100, 100, 100])
