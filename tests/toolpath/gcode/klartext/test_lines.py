"""Heidenhain's dialogue: each program with the places and forms that its lines say, by hand."""

from __future__ import annotations

import cmath
import math
import time

import numpy as np
import pytest

from robomill.errors import GCodeError
from robomill.toolpath.gcode import Program, Tool, interpret

HEAD = "0 BEGIN PGM PART MM\n1 BLK FORM 0.1 Z X+0 Y+0 Z-20\n2 TOOL CALL 1 Z S1000 ;mill\n3 L X+0 Y+0 Z+0 R0 FMAX M3\n"


def read(body: str, **more: object) -> Program:
    return interpret(f"{HEAD}{body}END PGM PART MM\n", **more)  # type: ignore[arg-type]


def ends(body: str) -> list[list[float]]:
    return (np.round(read(body).end[1:] * 1e3, 6) + 0.0).tolist()


def test_it_is_told_by_its_first_line_and_its_lines_are_counted_as_they_stand() -> None:
    program = read("4 L X+10 F100\n\n5 * - second\n6 L Y-5,5\n")
    assert program.dialect == "heidenhain"
    assert program.line.tolist() == [4, 5, 8]
    np.testing.assert_allclose(program.end[1:, :2] * 1e3, [[10, 0], [10, -5.5]])
    np.testing.assert_allclose(program.v_f[1:] * 6e4, 100.0)
    assert program.n_s[1] * 60 == pytest.approx(1000.0)


@pytest.mark.parametrize(("m", "left_out"), [(3, 0), (4, 0), (5, 0), (8, 0), (9, 0), (13, 0), (14, 0), (7, 0), (88, 1)])
def test_functions_of_the_machine_that_other_controls_have_too_are_not_left_out(m: int, left_out: int) -> None:
    program = read(f"4 L X+10 F100 M{m}\n5 L Y+5\n")
    assert [f.code for f in program.findings].count("unknown-m") == left_out


@pytest.mark.parametrize(
    ("body", "places"),
    [
        ("4 L IX+5 Y+2 F100\n5 L IX+5 IZ-1\n", [[5, 2, 0], [10, 2, -1]]),
        ("L Z+50 F MAX\nL X-3.5\n", None),
        ("L X 4 Y - 2 F300\nL X.5\n", [[4, -2, 0], [0.5, -2, 0]]),
    ],
)
def test_straight_lines(body: str, places: list[list[float]] | None) -> None:
    if places is None:
        with pytest.raises(GCodeError, match="Line 6: G1 needs a feed rate"):
            read(body)
    else:
        assert ends(body) == places


def test_fmax_holds_for_its_line_alone() -> None:
    assert read("L X+1 F100\nL X+2 FMAX\nL X+3\n").kind.tolist() == [0, 1, 0, 1]


def test_an_oversize_of_the_radius_counts_beside_a_contour_alone() -> None:
    assert ends("TOOL CALL 2 Z S100 DR+0.5\nL X+1 F9\nL X+2\n")[-2:] == [[1, 0, 0], [2, 0, 0]]


def test_ctp_ends_at_a_polar_place() -> None:
    """From (10, 0) along X, tangentially to (10, 20): a half circle about (10, 10); the pole is part zero."""
    program = read("L X+10 F9\nCC X+0 Y+0\nCTP PR+22.360679775 PA+63.434948823\n")
    np.testing.assert_allclose(program.end[-1] * 1e3, [10, 20, 0], atol=1e-6)
    np.testing.assert_allclose(program.centre[-1, :2] * 1e3, [10, 10], atol=1e-6)
    assert program.sweep[-1] == pytest.approx(np.pi)


def test_fauto_is_the_feed_of_the_last_tool_call() -> None:
    """F300 holds until FAUTO goes back to what TOOL CALL says, here in tenths of an inch a minute, and then 700."""
    body = "TOOL CALL 1 Z S1000 F500\nL X+1\nL X+2 F300\nL X+3\nL X+4 FAUTO\n"
    body += "TOOL CALL F700\nL X+5 F1\nL X+6 F AUTO\n"
    said = np.array([500, 300, 300, 500, 1, 700])
    assert read(body).v_f[-6:] * 6e4 == pytest.approx(said)
    inch = interpret(f"BEGIN PGM A INCH\nL X0 Y0 Z0 FMAX\n{body}END PGM A INCH\n")
    assert inch.v_f[-6:] * 6e4 == pytest.approx(said * 2.54)


def test_feeds_per_turn() -> None:
    """At 1000 turns a minute 0.2 mm a turn are 200 mm/min: by FU for its line and on, by M136 for every F till M137."""
    body = "L X+1 F500\nL X+2 FU0.2\nL X+3\nL X+4 F300\nM136\nL X+5 F0.1\nL X+6\nM137\nL X+7 F80\n"
    assert read(body).v_f[-7:] * 6e4 == pytest.approx([500, 200, 200, 300, 100, 100, 80])


def test_texts_and_messages_move_nothing() -> None:
    program = read('DECLARE STRING QS1 = "TEXT"\nQS2 = "X" || QS1\nFN 16: F-PRINT A.A / B.TXT\nL X+1 F9\n')
    assert program.end[-1, 0] == pytest.approx(1e-3)
    assert sum(f.count for f in program.findings if f.code == "harmless-word") == 4  # with BLK FORM


def test_inches_and_their_feed_in_tenths() -> None:
    program = interpret("0 BEGIN PGM A INCH\nL X+0 FMAX\nL X+1 F100\nEND PGM A INCH\n")
    assert program.units == "in"
    assert program.end[1, 0] == pytest.approx(25.4e-3)
    assert program.v_f[1] * 60 / 25.4e-3 == pytest.approx(10.0)


@pytest.mark.parametrize(
    ("body", "centre", "sweep_deg", "end"),
    [
        ("CC X+10 Y+0\nC X+20 Y+0 DR+ F99\n", (10, 0), 180, (20, 0, 0)),
        ("CC IX+10 IY+0\nC X+0 Y+0 DR- F99\n", (10, 0), -360, (0, 0, 0)),
        ("CC X+0 Y+5\nC IX+5 IY+5 DR- F99\n", (0, 5), -270, (5, 5, 0)),
        ("CC X+0 Y+5\nCP IPA-900 IZ-3 DR- F99\n", (0, 5), -900, (0, 10, -3)),
        ("CC X+0 Y+5\nCP PA+0 DR+ F99\n", (0, 5), 90, (5, 5, 0)),
        ("CC X+0 Y+5\nCC X+5\nCP IPA+90 DR+ F99\n", (5, 5), 90, (10, 0, 0)),
        ("L X+5 Y+9 F99\nCC\nL X+9\nCP IPA+90 DR+\n", (5, 9), 90, (5, 13, 0)),
        (
            "CC X+0 Y+5\nCP IPA+0.5 DR+ F99\n",
            (0, 5),
            0.5,
            (5 * math.sin(math.pi / 360), 5 - 5 * math.cos(math.pi / 360), 0),
        ),
        ("CC X+0 Y+5\nCP IPA+360 DR+ F99\n", (0, 5), 360, (0, 0, 0)),
        (
            "CC X+0 Y+5\nCP IPA+361 DR+ F99\n",
            (0, 5),
            361,
            (5 * math.sin(math.pi / 180), 5 - 5 * math.cos(math.pi / 180), 0),
        ),
        ("CC X+0 Y+5\nCP IPA-720 DR- F99\n", (0, 5), -720, (0, 0, 0)),
        ("CR X+10 Y+0 R+5 DR- F99\n", (5, 0), -180, (10, 0, 0)),
        ("CR X+5 Y+5 R-5 DR+ R0 F99\n", (0, 5), 90, None),
        ("L X+10 F99\nCT X+20 Y+10\n", (10, 10), 90, (20, 10, 0)),
        ("L X+10 F99\nCT X+20 Y-10\n", (10, -10), -90, (20, -10, 0)),
        ("L X+10 F99\nCT X+20 Y+10\nCT X+10 Y+20\n", (10, 10), 90, (10, 20, 0)),
    ],
)
def test_circles(body: str, centre: tuple[float, ...], sweep_deg: float, end: tuple[float, ...] | None) -> None:
    program = read(body)
    if end is None:  # the larger arc, on the other side of its chord
        centre, sweep_deg, end = (5, 0), -270 + 540, (5, 5, 0)
    np.testing.assert_allclose(program.centre[-1, :2] * 1e3, centre, atol=1e-9)
    np.testing.assert_allclose(program.end[-1] * 1e3, end, atol=1e-9)
    assert math.degrees(program.sweep[-1]) == pytest.approx(sweep_deg)


@pytest.mark.parametrize(
    ("body", "centre", "end", "sweep"),
    [
        ("L X+4 F99\nCC X+2 Z+0\nCP IPA+90 DR+\n", (2, 0, 0), (2, 0, -2), 90),
        ("L X+4 F99\nCC X+2 Z+0\nCP IPA-90 DR-\n", (2, 0, 0), (2, 0, 2), -90),
        ("L Y+4 F99\nCC Y+2 Z+0\nCP IPA+90 IX+1 DR+\n", (0, 2, 0), (1, 2, 2), 90),
        ("CC X+0 Z+5\nC X+5 Z+5 DR- F99\n", (0, 0, 5), (5, 0, 5), -90),
    ],
)
def test_circles_in_upright_planes(body: str, centre: tuple[float, ...], end: tuple[float, ...], sweep: float) -> None:
    """DR+ leads from Z to X and from Y to Z; a lead-in from the side goes down."""
    program = read(f"{body}L X+9 Y+9 Z+9\n")
    np.testing.assert_allclose(program.centre[-2] * 1e3, centre, atol=1e-9)
    np.testing.assert_allclose(program.end[-2] * 1e3, end, atol=1e-9)
    assert math.degrees(program.sweep[-2]) == pytest.approx(sweep)


@pytest.mark.parametrize("course", [0, 35, -110, 170])
@pytest.mark.parametrize("first", ["L", "LP", "C+", "C-", "CP+", "CP-", "CR+", "CR-"])
def test_ct_goes_on_as_the_line_before_ended(first: str, course: int) -> None:
    """In complex numbers: every place and course of the plan below is turned by ``course``; CT keeps on its course."""
    turn = cmath.exp(1j * math.radians(course))

    def place(z: complex) -> str:
        z = 3 - 8j + z * turn
        return f"X{z.real:+.9f} Y{z.imag:+.9f}"

    sense = first[-1]
    up = 1 if sense == "+" else -1
    polar = f"PR+10 PA{course + 0:+d}", f"PA{course:+d} DR{sense}"
    plan = {  # from 0 to 10, or from -10i round 0 to 10: what the line is, and its course at its end
        "L": (f"L {place(10)} F9", 0j, 1 + 0j),
        "LP": (f"LP {polar[0]} F9", 0j, 1 + 0j),
        "C": (f"C {place(10)} DR{sense} F9", -10j * up, 1j * up),
        "CP": (f"CP {polar[1]} F9", -10j * up, 1j * up),
        "CR": (f"CR {place(10)} R+10 DR{sense} F9", -10j * up, 1j * up),
    }
    line, start, on = plan[first.rstrip("+-")]
    ends = [10 + 6 * on + 4j * on, 10 + 9 * on + 17j * on]
    program = read(f"L {place(start)} FMAX\nCC {place(0)}\n{line}\n" + "".join(f"CT {place(z)}\n" for z in ends))
    kept = program.kind == 2
    kept[:-2] = False
    at, course_now = 10 + 0j, on
    for k, end in zip(np.flatnonzero(kept), ends, strict=True):
        centre = (complex(*program.centre[k, :2] * 1e3) - (3 - 8j)) / turn
        sweep = float(program.sweep[k])
        assert ((at - centre).conjugate() * course_now).real == pytest.approx(0, abs=1e-6)
        assert ((at - centre).conjugate() * course_now).imag * sweep > 0
        assert centre + (at - centre) * cmath.exp(1j * sweep) == pytest.approx(end, abs=1e-6)
        at, course_now = end, course_now * cmath.exp(1j * sweep)


def test_polar_lines() -> None:
    found = ends("CC X+10 Y+10\nLP PR+20 PA+90 F99\nLP IPA+90\nLP IPR-5\n")
    assert found == [[10, 30, 0], [-10, 10, 0], [-5, 10, 0]]


def test_corners_stand_between_their_lines() -> None:
    program = read("L X+20 F99\n; comment\nRND R5 F50\nL Y+20\nCHF 2\nL X+0\n")
    expected = [[15, 0], [20, 5], [20, 18], [18, 20], [0, 20]]
    np.testing.assert_allclose(program.end[1:, :2] * 1e3, expected, atol=1e-9)
    np.testing.assert_allclose(program.centre[2, :2] * 1e3, [15, 5], atol=1e-9)


def test_labels_are_subprograms_and_repeats() -> None:
    body = 'CALL LBL 7\nLBL 1\nL IX+1 F99\nCALL LBL 1 REP 2/2\nCALL LBL "UP"\nL X+0 FMAX M30\n'
    body += 'LBL 7\nL Y+4 F99\nLBL 0\nLBL "UP"\nL IZ+1\nCALL LBL 7\nLBL 0\n'
    assert ends(body) == [[0, 4, 0], [1, 4, 0], [2, 4, 0], [3, 4, 0], [3, 4, 1], [3, 4, 1], [0, 4, 1]]


def test_a_repeat_without_a_count_calls_once() -> None:
    assert ends("CALL LBL 7 REP\nL X+9 F99 M30\nLBL 7\nL Y+4 F99\nLBL 0\n") == [[0, 4, 0], [9, 4, 0]]


def test_repeats_within_repeats_begin_anew() -> None:
    body = "LBL 1\nLBL 2\nL IX+1 F99\nCALL LBL 2 REP1\nL IY+1\nCALL LBL 1 REP 1\n"
    assert ends(body)[-1] == [4, 2, 0]


def test_compensation_needs_a_tool_and_follows_its_side() -> None:
    body = "L X-10 Y+0 FMAX\nL X+0 Y+0 RL F99\nL Y+20\nL X+20\nL X+40 R0\n"
    with pytest.raises(GCodeError, match="Line 6: RL needs the diameter of tool 1; give a tool table"):
        read(body)
    program = read(body, tools={1: Tool(1, 6e-3)})
    np.testing.assert_allclose(program.end[-2, :2] * 1e3, [20, 23], atol=1e-9)


def test_places_in_the_machine_are_clear_of_the_part() -> None:
    program = read("L X+5 Z-1 F99\nL M140 MB MAX\nL X+9 Z+5 FMAX\nL Z+0 FMAX M91\n")
    assert program.away[:, 2].tolist() == [False, False, True, False, True]
    said = [f.message[:13] for f in program.findings if f.code == "machine-place"]
    assert sorted(said) == ["M140 goes to ", "M91 goes to a"]
    with pytest.raises(GCodeError, match="Line 6: IZ counts from a place that only the machine knows"):
        read("L M140 MB MAX\nL IZ-3 F99\n")
    assert ends("L Z-5 F99\nL M140 MB 30\n")[-1] == [0, 0, 25]


def test_a_retract_goes_along_the_tool() -> None:
    """TNC 640, M140: out of the contour along the tool axis."""
    lean = "M128\nL X+1 Y+2 Z-5 A+20 B+30 F99\n"
    a, b = np.radians([20, 30])
    axis = np.array([np.sin(b), -np.sin(a) * np.cos(b), np.cos(a) * np.cos(b)])
    program = read(f"{lean}L M140 MB 30\n")
    np.testing.assert_allclose(program.end[-1] * 1e3, [1, 2, -5] + 30 * axis, atol=1e-6)


def test_tool_axes_and_m_words() -> None:
    program = read("M128\nLN X+1 Y+2 Z+3 NX+0 NY+0 NZ+1 TX+0 TY-0.5 TZ+0.8660254 F99 M13\n")
    np.testing.assert_allclose(np.degrees(program.rotary[-1]), [30, 0, 0], atol=1e-5)
    assert [f.message for f in program.findings if f.code == "unknown-m"] == ["M128 is left out: it moves nothing"]


@pytest.mark.parametrize(
    ("body", "says"),
    [
        ("FL X+1 R5 RL\n", "FL X.1 R5 is of Heidenhain's and is not read"),
        ("FL AN+45\n", r"FL AN\+45 is of"),
        ("PLANE AXIAL B-45 TURN\n", "PLANE AXIAL is not read"),
        ("CALL PGM TNC:\\SUB.H\n", "CALL PGM TNC"),
        ("L X+1 FZ0.1\n", "FZ counts per tooth"),
        ("C X+1 Y+1 DR+ F9\n", "need their centre"),
        ("CC X+1 Y+1\nC X+2 Y+2 F9\n", r"C needs DR\+ or DR-"),
        ("CR X+1 Y+1 DR+ F9\n", "CR needs R"),
        ("CC X+0 Y+5\nCP IPA+90 DR- F9\n", "IPA against its DR"),
        ("CT X+5 Y+5 F9\n", "CT goes on tangentially"),
        ("L X+1 F9\nM8\nRND R5\n", "RND is read behind a cut alone"),
        ("CALL LBL 9\n", "LBL 9 is called, but there is no such label"),
        ("TOOL CALL 2 X S100\n", "TOOL CALL 2 X S100 is not read"),
        ("TOOL CALL 2 Z S F DL+0.5\n", r"DL\+0.5, which is not read"),
        ("TOOL CALL 2 Z S100 FZ0.1\n", "FZ counts per tooth"),
        ("STOP X+5\n", "found 'X.5' behind STOP"),
        ("CC X+1 Y+2 Q5\n", "found 'Q5' in a line that begins with CC"),
        ("TOOL CALL 2 Z S100 DL+0.5\n", r"DL\+0.5, which is not read"),
        ("CC X+1\n", "CC needs two of X, Y and Z"),
        ("CC X+1 Y+2 Z+3\n", "CC needs two of X, Y and Z"),
        ("CC A+1 Y+2\n", "CC needs two of X, Y and Z"),
        ("CC A+1\n", "CC needs two of X, Y and Z"),
        ("CC X+1 Z+2\nCC Y+5\n", "CC needs two of X, Y and Z"),
        ("L X+1 F9\nCR X+9 R+9 DR+\nCHF 1\n", "CHF is read between two straight cuts"),
        ("CC X+0 Y+5\nCP IPA-0.5 DR+ F9\n", "IPA against its DR"),
        ("TOOL CALL 2 Z S100 DR+0.5\nL X+1 F9\nL X+2 RL\n", r"RL with DR\+0.5 of TOOL CALL is not read"),
        ("L X+1 FAUTO\n", "FAUTO is the feed of TOOL CALL, which has none"),
        ("L X+1 F9\nTOOL CALL 2 Z S100\nL X+2 FAUTO\n", "FAUTO is the feed of TOOL CALL, which has none"),
        ("FN 18: SYSREAD Q1 = ID210 NR4\n", "FN 18: SYSREAD is of Heidenhain's and is not read"),
        ("M136\nCYCL DEF 200 Q200=2 Q201=-5 Q206=9\nL X+1 F1 M99\n", "M136 would count the feeds of a cycle"),
        ("M136\nAPPR LT X+9 Y+9 LEN5 RL F1\n", "APPR under M136 is not read"),
        ("L X+5 FMAX M140 MB MAX\n", "M140 beside a move"),
        ("LN X+1 TX+0 TY+0 TZ+0 F9\n", "TX TY TZ is 0"),
    ],
)
def test_what_is_not_read_is_named(body: str, says: str) -> None:
    with pytest.raises(GCodeError, match=rf"Line [5-7]: .*{says}"):
        read(body)


def test_blocks_too_long_to_be_looked_through_are_refused() -> None:
    for text in ("L " + "X+1 " * 400, "CYCL DEF 200 ~\n" + "Q200=1 ~\n" * 200):
        with pytest.raises(GCodeError, match="a block is over 1000 characters or 100 lines; split it"):
            read(f"{text}\n")


def test_lines_in_brackets_are_remarks() -> None:
    program = interpret(
        '($Message("for a simulator") )\nBEGIN PGM  MM\nL Z+5,5 R0 F9999 M13\n(x)\nL IZ-2,000\nEND PGM\n'
    )
    assert (program.end[:, 2] * 1e3).tolist() == pytest.approx([5.5, 3.5])


def test_another_program_is_asked_for_as_a_label() -> None:
    with pytest.raises(GCodeError, match=r"Line 2: CALL PGM TNC:\\PLAN.H calls another program; paste it in"):
        interpret("BEGIN PGM A MM\nCALL PGM TNC:\\Plan.h\nEND PGM A MM\n")


def test_a_line_of_digits_is_refused_at_once() -> None:
    began = time.process_time()
    with pytest.raises(GCodeError, match="a block is over"):
        interpret(f"BEGIN PGM A MM\nCYCL DEF 200 E Q1{'1' * 98_000}\nEND PGM A MM\n")
    assert time.process_time() - began < 2.0


def test_the_reach_of_the_handwheel_is_no_place() -> None:
    """TNC 640, M118: L X+0 Y+38.5 RL F125 M118 X1 Y1 lets the wheel move the axes by 1 mm beside the move."""
    program = read("L X+7 Y+38.5 R0 F125 M118 X1 Y1\nL Z+4 FMAX M118 Z2\nM118\n")
    assert (program.end[-2:] * 1e3).tolist() == [pytest.approx([7, 38.5, 0]), pytest.approx([7, 38.5, 4])]


@pytest.mark.parametrize(
    ("line", "says"),
    [
        ("L X+5 F99 X+6", "a place is said twice in this line"),
        ("L X+5 IX+6", "a place is said twice in this line"),
        ("L PR+5 PA+30", "PR and PA stand in LP and CP, not in L"),
        ("PLANE SPATIAL SPA+30 SPB+0 SPC+0 TURN FMAX\nL X+0 Y+0 Z+0 FMAX\nL X+7 F99 M130", "M130 gives a place"),
    ],
)
def test_places_that_count_otherwise_are_refused(line: str, says: str) -> None:
    with pytest.raises(GCodeError, match=says):
        read(f"{line}\n")
    assert len(read("L X+7 R0 F99 M130\n")) > 0


@pytest.mark.parametrize(
    "block", ["STOP M2", "STOP M30", "STOP M9 M30", "M30", "CC X+1 Y+1 M2", "L F50 M2", "12 STOP M02"]
)
def test_m2_and_m30_end_the_program_in_any_block(block: str) -> None:
    assert ends(f"L X+20 F200\n{block}\nL X+40\n") == [[20, 0, 0]]


@pytest.mark.parametrize("block", ["STOP", "STOP M9", "STOP M6", "STOP M0", "CC X+1 Y+1 M9"])
def test_other_stops_go_on(block: str) -> None:
    assert ends(f"L X+20 F200\n{block}\nL X+40\n") == [[20, 0, 0], [40, 0, 0]]


def test_a_stop_turns_the_spindle_off_by_its_m5() -> None:
    program = read("L X+20 F200\nSTOP M5\nL X+40\n")
    assert program.n_s[1:].round(3).tolist() == [round(1000 / 60, 3), 0.0]


@pytest.mark.parametrize(
    ("call", "feed"),
    [
        ("TOOL CALL 2 Z S2000 FU0.1", 200.0),
        ("TOOL CALL 2 Z FU0.1", 100.0),
        ("TOOL CALL 2 Z S F DR+0", None),
        ("TOOL CALL 2 Z S F70", 70.0),
        ("TOOL CALL 2 Z FU 0.1\nTOOL CALL S3000", 300.0),
        ("TOOL CALL 2 Z FU 0.1\nTOOL CALL S3000 F70", 70.0),
        ("TOOL CALL 2 Z FU 0.1\nTOOL CALL F70\nTOOL CALL S3000", 70.0),
    ],
)
def test_a_feed_per_turn_of_a_tool_is_that_times_its_turns(call: str, feed: float | None) -> None:
    """The head says S1000; without a number, S and F leave what is there."""
    body = f"{call}\nL X+5 F AUTO\n"
    if feed is None:
        with pytest.raises(GCodeError, match="FAUTO is the feed of TOOL CALL, which has none"):
            read(body)
    else:
        assert read(body).v_f[-1] * 6e4 == pytest.approx(feed)


def test_blocks_as_older_controls_print_them() -> None:
    """TNC 155 and 2500: the second half of a block on a line of its own, and R, F and M with nothing behind them."""
    pad = " " * 40
    text = (
        "0 BEGIN PGM 1 MM\n1 TOOL CALL 1 Z S 1000.000\n"
        f"2 L Z+50.000\n{pad}R0 F15000 M03\n3 L X+0.000 Y+0.000\n{pad}R F M\n4 L Z-1.000\n{pad}R F100 M08\n"
        f"5 CC X+10.000 Y+0.000\n6 C X+20.000 Y+0.000\n{pad}DR- R F M\n7 L X+30.000 R F M\n8 STOP M02\n9 END PGM 1 MM\n"
    )
    found = interpret(text, dialect="heidenhain")
    np.testing.assert_allclose(found.end[[0, -3, -2, -1]] * 1e3, [[0, 0, 50], [0, 0, -1], [20, 0, -1], [30, 0, -1]])
    np.testing.assert_allclose(found.v_f[-3:] * 60e3, 100)
    assert found.clockwise[-3:].tolist() == [False, True, False]


def test_a_straight_line_behind_an_arc_of_another_plane_is_followed_beside_in_the_plane_xy() -> None:
    """A quarter turn about Y, then along +X with the tool of 4 mm radius on the left: 4 more in Y."""
    body = "CC X+0 Z+5\nC X+5 Z+5 DR- F99\nL X+20 Y+0 RL F99\nL X+40\nL Y-20 R0\n"
    program = read(body, tools={1: Tool(1, diameter=8e-3)})
    np.testing.assert_allclose(program.end[-3:] * 1e3, [[20, 4, 5], [40, 4, 5], [40, -20, 5]], atol=1e-9)
