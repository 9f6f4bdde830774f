"""Q parameters, shifts and drilling cycles of Heidenhain's dialogue, reckoned by hand."""

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


def test_a_hole_may_begin_on_the_surface() -> None:
    """Q200=0, as countersinks in a shop have it: down to the surface at rapid, in 1 mm and back by Q204."""
    cycle = "CYCL DEF 200 SINK ~\n Q200=+0 ~\n Q201=-1 ~\n Q206=30 ~\n Q202=1 ~\n Q203=-3.5 ~\n Q204=20\n"
    assert [row[2] for row in ends(f"{cycle}L X+1 Y+0 FMAX M99\n")] == [10, -3.5, -4.5, 16.5]


def test_auto_is_the_feed_of_the_tool_call() -> None:
    cycle = "CYCL DEF 201 REAM ~\n Q200=2 ~\n Q201=-5 ~\n Q206= AUTO ~\n Q208=FAUTO ~\n Q203=+0 ~\n Q204=5\n"
    feeds = read(f"{cycle}L X+1 FMAX M99\n").v_f * 6e4
    assert feeds.round(6).tolist() == [0, 0, 0, 99, 99, 0]  # to X0, X1 and down at rapid; in, out; up


def test_a_remark_goes_on_in_lines_without_a_number() -> None:
    body = "3 ;POST -~\n4 ;OF A SHOP~\n that writes L X+9~\n and more\n5 L X+1 F9\nL X+2 ;NEXT~\n Y+3\n"
    assert [row[:2] for row in ends(body)] == [[1, 0], [2, 3]]


DRILL = "CYCL DEF 200 HOLE ~\n  Q200=2 ;CLEARANCE ~\n  Q201=-6 ~\n  Q206=+120 ~\n  Q202=4 ~\n  Q203=+1 ~\n  Q204=8\n"


def test_drilling_where_m99_leads() -> None:
    """Surface 1: clear at 3, pecks to -3 (and back to 2 above that), bottom at -5, back to 9."""
    program = read(f"{DRILL}L X+5 Y+5 FMAX M99\nL X+15 FMAX M99\n")
    heights = (np.round(program.end[1:7, 2] * 1e3, 6)).tolist()
    assert heights == [10, 3, -3, 3, -1, -5]
    assert program.end[7, 2] * 1e3 == pytest.approx(9)
    drilled = program.end[(program.kind == 1) & (program.end[:, 2] < -4.9e-3), :2] * 1e3
    np.testing.assert_allclose(drilled, [[5, 5], [15, 5]])
    np.testing.assert_allclose(program.v_f[program.kind == 1] * 6e4, 120.0)


@pytest.mark.parametrize(
    "body",
    [
        f"{DRILL}L X+5 Y+5 FMAX\nCYCL CALL M3\nL X+15 FMAX\nCYCL CALL\n",
        f"L X+5 Y+5 FMAX\n{DRILL}L FMAX M99\nL X+15 FMAX M99\n",
        f"{DRILL}CYCL CALL POS X+5 Y+5 Z+0 FMAX\nCYCL CALL POS X+15 Y+5 Z+0 FMAX\n",
        f"{DRILL}L X+5 Y+5 FMAX M89\nL X+15 FMAX M99\nL X+50 FMAX\n",
        DRILL.replace("~", "") + "L X+5 Y+5 FMAX M99\nL X+15 FMAX M99\n",
    ],
)
def test_a_cycle_is_called_in_many_ways(body: str) -> None:
    program = read(body)
    drilled = program.end[(program.kind == 1) & (program.end[:, 2] < -4.9e-3), :2] * 1e3
    np.testing.assert_allclose(drilled, [[5, 5], [15, 5]])


def test_a_called_position_shifts_the_cycle_by_its_z_and_is_gone_to_in_the_plane_first() -> None:
    """TNC 640, Cycle Programming, CYCL CALL POS: the coordinate in the tool axis is an additional datum shift."""
    program = read(f"{DRILL}CYCL CALL POS X+5 Y+0 Z-2 FMAX\nCYCL CALL POS X+15 Y+0 Z+0 FMAX M3\nL X+9 FMAX M99\n")
    moves = np.column_stack([program.kind, np.round(program.end * 1e3, 6)[:, [0, 2]]]).tolist()
    first = [[0, 5, 10], [0, 5, 1], [1, 5, -5], [0, 5, 1], [0, 5, -3], [1, 5, -7], [0, 5, 7]]
    assert moves[1:8] == first
    assert moves[8:10] == [[0, 15, 7], [0, 15, 3]]
    assert moves[12] == [0, 15, -1]
    assert min(z for _, x, z in moves if x == 9) == -5
    with pytest.raises(GCodeError, match="Line [0-9]+: CYCL CALL POS has IZ"):
        read(f"{DRILL}CYCL CALL POS X+5 Y+0 IZ-2 FMAX\n")


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


def test_tapping_goes_by_its_pitch() -> None:
    program = read("CYCL DEF 207 TAPPING ~\nQ200=2 ~\nQ201=-8 ~\nQ239=+1.5 ~\nQ203=+0 ~\nQ204=5\nL X+1 FMAX M99\n")
    assert program.thread[program.kind == 1].all()
    np.testing.assert_allclose(program.v_f[program.kind == 1] * 6e4, 1500.0)


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
        ("CYCL DEF 11.1 SCL 0.9\n", "scales"),
        ("CYCL DEF 10.1 ROT+30\nCYCL DEF 7.1 X+3\n", "a datum shift inside of a rotation"),
        ("CYCL DEF 247 PRESET Q339=1\nCYCL DEF 247 PRESET Q339=2\n", "CYCL DEF 247 chooses a second preset"),
        ("CYCL DEF 202 BORING Q200=2 Q201=-9\n", r"CYCL DEF 202 BORING is a cycle that is not read"),
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


def test_a_drill_that_leaves_at_rapid_says_so_by_max() -> None:
    """Q208= MAX, as posts write it, is the default: out of the hole at rapid."""
    cycle = "CYCL DEF 203 ~\nQ200=2 ~\nQ201=-4 ~\nQ206=150 ~\nQ202=0 ~\nQ203=0 ~\nQ204=5 ~\nQ208= {}\nL X+1 FMAX M99\n"
    for value, height in (("MAX ;RETRACTION", -4.0), ("500", 2.0)):
        program = read(cycle.format(value))
        assert program.end[program.kind == 1, 2][-1] * 1e3 == pytest.approx(height)


RAPID = 0.0
TABLE = {
    # what is said beside the common words: depths of the plunges below the surface, feed down and out, whether it taps
    "200 Q202=3": ([3, 6], 120, RAPID, False),
    "200 Q202=4": ([4], 120, RAPID, False),
    "200 Q202=8": ([], 120, RAPID, False),
    "200 Q202=0 Q212=1 Q208=77 Q239=2": ([], 120, RAPID, False),
    "201 Q208=77": ([], 120, 77, False),
    "201 Q208=0 Q202=3": ([], 120, 120, False),
    "201 Q208=MAX": ([], 120, RAPID, False),
    "203 Q202=3 Q212=0 Q205=0 Q208=500": ([3, 6], 120, 500, False),
    "203 Q202=3 Q212=0.5 Q205=0 Q208=0": ([3, 5.5, 7.5], 120, 120, False),
    "203 Q202=3 Q212=0.5 Q205=2.25 Q208=MAX": ([3, 5.5, 7.75], 120, RAPID, False),
    "203 Q202=3 Q212=2 Q205=0 Q208=99999": ([3, 5, 7], 120, RAPID, False),
    "205 Q202=3 Q212=0.5 Q205=2": ([3, 5.5, 7.5], 120, RAPID, False),
    "205 Q202=3 Q212=0.5 Q205=2 Q258=0.5 Q259=0.9": ([3, 5.5, 7.5], 120, RAPID, False),
    "205 Q202=5 Q212=0 Q205=2 Q208=0": ([5], 120, 120, False),
    "205 Q202=5 Q212=0 Q205=2 Q208=300": ([5], 120, 300, False),
    "206 Q208=77 Q202=3 Q239=2": ([], 120, 120, True),
    "207 Q239=+1.5": ([], 1500, 1500, True),
    "207 Q239=-1.25": ([], 1250, 1250, True),
    "209 Q239=2 Q202=3": ([], 2000, 2000, True),
    "240 Q343=0 Q202=3 Q239=2 Q208=77": ([], 120, RAPID, False),
}


@pytest.mark.parametrize("unit", ["MM", "INCH"])
@pytest.mark.parametrize("name", TABLE)
def test_cycles_move_as_the_manual_says(name: str, unit: str) -> None:
    """TNC 640, Cycle Programming: heights about a surface at 1, set-up clearance 2, depth 8, second clearance 9."""
    plunges, down, out, thread = TABLE[name]
    number, *more = name.split(" ")
    cycle = " ~\n".join(
        [f"CYCL DEF {number}", "Q200=2", "Q201=-8", "Q206=120", "Q211=0.5", "Q210=0.25", "Q203=1", "Q204=9", *more]
    )
    head = HEAD.replace("MM", unit).replace("Z+10", "Z+30")
    program = interpret(f"{head}{cycle}\nL X+5 FMAX M99\nEND PGM Q {unit}\n")
    size = {"MM": 1e-3, "INCH": 25.4e-3}[unit]
    tenth = 10.0 if unit == "INCH" and number not in ("207", "209") else 1.0
    expected = [(30.0, RAPID), (3.0, RAPID)]
    for k, depth in enumerate(plunges):  # back into the hole at rapid: not quite to where it was
        near = 0.5 + 0.2 * k if "Q258" in name else 0.0 if number == "205" else 2.0
        expected += [(1.0 - depth, down), (3.0, out), (1.0 - depth + near, RAPID)]
    back = [2 + 3 * k + 2 for k in range(len(plunges))]  # into the hole again, behind Q210 above it
    expected += [(-7.0, down), *([(3.0, out)] if out else []), (10.0, RAPID)]
    np.testing.assert_allclose(program.end[1:, 2] / size, [z for z, _ in expected], atol=1e-9)
    np.testing.assert_allclose(program.v_f[1:] * 60 / size * tenth, [v for _, v in expected], rtol=1e-9)
    assert (program.kind[1:] == [int(v != RAPID) for _, v in expected]).all()
    assert program.thread[1:].tolist() == [thread and v > 0 for _, v in expected]
    waits = [0.0] * len(expected)
    waits[-2 if out else -1] = 0.5
    for k in back if number in ("200", "203") else ():
        waits[k] = 0.25
    assert program.dwell[1:].tolist() == waits


def test_a_retraction_feed_of_an_earlier_cycle_is_not_that_of_a_later_one_without() -> None:
    """Cycle 205 knows Q208 since software 34059x-04: older programs do not say it, and leave the hole at FMAX."""
    first = "CYCL DEF 203 Q200=2 Q201=-4 Q206=150 Q202=0 Q203=0 Q204=5 Q208=500\nL X+1 FMAX M99\n"
    program = read(f"{first}CYCL DEF 205 Q200=2 Q201=-4 Q206=150 Q202=0 Q203=0 Q204=5\nL X+2 FMAX M99\n")
    feeds = [np.round(program.v_f[(program.end[:, 0] == x) & (program.kind == 1)] * 6e4) for x in (1e-3, 2e-3)]
    assert [each.tolist() for each in feeds] == [[150, 500], [150]]


@pytest.mark.parametrize(
    ("word", "rpm", "left_out"),
    [("", 0, 0), ("M3", 1000, 0), ("M4", -1000, 0), ("M13", 1000, 0), ("M14", -1000, 0), ("M8", 0, 0), ("M77", 0, 1)],
)
def test_a_call_obeys_the_m_behind_it_as_any_line_does(word: str, rpm: float, left_out: int) -> None:
    """TNC 640: CYCL CALL takes a miscellaneous function, e.g. M3 to switch the spindle on; M13 is M3 and M8."""
    program = read(f"L M5\n{DRILL}CYCL CALL {word}\n")
    down = program.end[:, 2] < -4.9e-3
    assert down.any()
    np.testing.assert_allclose(np.abs(program.n_s[down] * 60), abs(rpm))
    assert sum(f.code == "unknown-m" for f in program.findings) == left_out


PATTERN = {
    "a whole circle": (
        "CYCL DEF 220 ~\nQ216=50 ~\nQ217=50 ~\nQ244=40 ~\nQ245=0 ~\nQ246=360 ~\nQ247=0 ~\nQ241=4\n",
        [[70, 50], [50, 70], [30, 50], [50, 30]],
    ),
    "a quarter, both its ends": (
        "CYCL DEF 220 ~\nQ216=0 ~\nQ217=0 ~\nQ244=40 ~\nQ245=0 ~\nQ246=90 ~\nQ247=0 ~\nQ241=3 ~\nQ301=0\n",
        [[20, 0], [14.142136, 14.142136], [0, 20]],
    ),
    "about another place, by its step": (
        "CYCL DEF 220 ~\nQ216=30 ~\nQ217=-7 ~\nQ244=-40 ~\nQ245=90 ~\nQ246=17 ~\nQ247=-90 ~\nQ241=3\n",
        [[30, 13], [50, -7], [30, -27]],
    ),
    "a whole circle the other way round, from an angle": (
        "CYCL DEF 220 ~\nQ216=1 ~\nQ217=2 ~\nQ244=2 ~\nQ245=90 ~\nQ246=-270 ~\nQ247=0 ~\nQ241=4\n",
        [[1, 3], [2, 2], [1, 1], [0, 2]],
    ),
    "one hole": (
        "CYCL DEF 220 ~\nQ216=1 ~\nQ217=2 ~\nQ244=2 ~\nQ245=0 ~\nQ246=90 ~\nQ247=0 ~\nQ241=1\n",
        [[2, 2]],
    ),
    "three rows, there, back and there": (
        "CYCL DEF 221 ~\nQ225=0 ~\nQ226=0 ~\nQ237=5 ~\nQ238=7 ~\nQ242=2 ~\nQ243=3 ~\nQ224=0\n",
        [[0, 0], [5, 0], [5, 7], [0, 7], [0, 14], [5, 14]],
    ),
    "by its step": (
        "CYCL DEF 220 ~\nQ216=0 ~\nQ217=0 ~\nQ244=40 ~\nQ245=90 ~\nQ246=0 ~\nQ247=-90 ~\nQ241=2\n",
        [[0, 20], [20, 0]],
    ),
    "lines, there and back": (
        "CYCL DEF 221 ~\nQ225=10 ~\nQ226=20 ~\nQ237=5 ~\nQ238=7 ~\nQ242=2 ~\nQ243=2 ~\nQ224=90\n",
        [[10, 20], [10, 25], [3, 25], [3, 20]],
    ),
}


@pytest.mark.parametrize("name", PATTERN)
def test_patterns_drill_at_once(name: str) -> None:
    body, places = PATTERN[name]
    program = read(f"CYCL DEF 200 ~\nQ200=2 ~\nQ201=-10 ~\nQ206=100 ~\nQ203=0 ~\nQ204=20\n{body}")
    drilled = program.end[program.end[:, 2] < -9.9e-3, :2] * 1e3
    np.testing.assert_allclose(drilled, places, atol=1e-6)
    away = program.end[(np.arange(len(program)) > 0) & (program.kind == 0), 2]
    assert away.min() * 1e3 == pytest.approx(2)  # no rapid below the set-up clearance


@pytest.mark.parametrize(("between", "height"), [("", 20), ("Q301=1", 20), ("Q301=0", 2)])
@pytest.mark.parametrize("start", ["L Z+1 FMAX\n", "L Z+30 FMAX\n", "L Z+0 FMAX M91\n"])
def test_between_the_holes_of_a_pattern_the_tool_is_as_high_as_it_says(start: str, between: str, height: int) -> None:
    """TNC 640, cycle 220, Q301: 0 moves at the set-up clearance, 1 at the second one; the last hole ends at that."""
    lines = "CYCL DEF 221 ~\nQ225=10 ~\nQ226=20 ~\nQ237=5 ~\nQ238=7 ~\nQ242=3 ~\nQ243=1 ~\nQ224=0"
    program = read(
        f"{start}CYCL DEF 200 ~\nQ200=2 ~\nQ201=-10 ~\nQ206=100 ~\nQ204=20\n{lines} ~\n{between}\nL Y+1 FMAX\n"
    )
    across = (np.abs(np.diff(program.end[:, 0])) > 1e-9) & (program.kind[1:] == 0)
    heights = program.end[1:][across, 2] * 1e3
    np.testing.assert_allclose(heights[1:], height)
    assert program.end[-1, 2] * 1e3 == pytest.approx(20)
    if "M91" not in start:
        assert heights[0] == pytest.approx(30 if "30" in start else 20)
    else:
        assert program.away[1:][across, 2].tolist() == [True, False, False]  # over the first hole where M91 led to


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
