"""APPR and DEP: where the cutter's centre goes, reckoned from the manual's rules by hand and by geometry."""

from __future__ import annotations

import cmath
import math

import numpy as np
import pytest

from robomill.errors import GCodeError
from robomill.toolpath.gcode import Program, Tool, interpret

TOOL = {1: Tool(1, 4e-3)}
"""A cutter of radius 2."""


def read(body: str, tools: dict[int, Tool] | None = TOOL) -> Program:
    head = "BEGIN PGM A MM\nTOOL CALL 1 Z S99 F100\nL X+40 Y+10 Z+5 R0 FMAX M3\n"
    return interpret(f"{head}{body}END PGM A MM\n", tools=tools)


def moves(program: Program) -> list[tuple[str, float, float, float]]:
    return [("RFA"[k], *(round(float(v) * 1e3, 6) + 0.0 for v in p)) for k, p in zip(program.kind, program.end)][1:]


@pytest.mark.parametrize(
    ("body", "expected"),
    [
        # up along X10, the cutter left of it at X8; the tangent is +Y, the normal -X
        (
            "APPR LT X+10 Y+20 LEN15 RL\nL Y+50\nDEP LT LEN5\n",
            [("R", 8, 5, 5), ("F", 8, 20, 5), ("F", 8, 50, 5), ("F", 8, 55, 5)],
        ),
        (
            "APPR LN X+10 Y+20 LEN15 RL\nL Y+50\nDEP LN LEN5 Z+9\n",
            [("R", -7, 20, 5), ("F", 8, 20, 5), ("F", 8, 50, 5), ("F", 3, 50, 5), ("F", 3, 50, 9)],
        ),
        # a quarter about (3, 20), counter-clockwise; away about (3, 50)
        (
            "APPR CT X+10 Y+20 Z-1 CCA90 R+5 RL\nL Y+50\nDEP CT CCA90 R+5\n",
            [("R", 3, 15, 5), ("F", 3, 15, -1), ("A", 8, 20, -1), ("F", 8, 50, -1), ("A", 3, 55, -1)],
        ),
        # from the other side: about (13, 20), clockwise
        (
            "APPR CT X+10 Y+20 CCA90 R-5 RL\nL IY+30\nDEP LT LEN1\n",
            [("R", 13, 15, 5), ("A", 8, 20, 5), ("F", 8, 50, 5), ("F", 8, 51, 5)],
        ),
        # without compensation a cutter of radius 0 stands right of the contour
        (
            "APPR CT X+10 Y+20 CCA90 R5 R0\nL Y+50\nDEP LN LEN5\n",
            [("R", 15, 15, 5), ("A", 10, 20, 5), ("F", 10, 50, 5), ("F", 15, 50, 5)],
        ),
        # on an arc: a circle of radius 20 about (30, 20), clockwise, the cutter outside of it
        (
            "CC X+30 Y+20\nAPPR LN X+10 Y+20 LEN3 RL\nC X+50 Y+20 DR-\nDEP LN LEN3\n",
            [("R", 5, 20, 5), ("F", 8, 20, 5), ("A", 52, 20, 5), ("F", 55, 20, 5)],
        ),
        (
            "APPR LT X+10 Y+20 LEN3 RL\nCR X+30 Y+40 R+20 DR-\nDEP LT LEN3\n",
            [("R", 8, 17, 5), ("F", 8, 20, 5), ("A", 30, 42, 5), ("F", 33, 42, 5)],
        ),
        # polar: the point 10 off the pole at 180 degrees, and on towards 90 degrees
        (
            "CC X+30 Y+20\nAPPR PLT PR+10 PA+180 LEN3 R0\nLP PA+90\nDEP LT LEN3\n",
            [
                ("R", 20 - 3 * math.sqrt(0.5), 20 - 3 * math.sqrt(0.5), 5),
                ("F", 20, 20, 5),
                ("F", 30, 30, 5),
                ("F", 30 + 3 * math.sqrt(0.5), 30 + 3 * math.sqrt(0.5), 5),
            ],
        ),
    ],
)
def test_where_the_centre_goes(body: str, expected: list[tuple[str, float, float, float]]) -> None:
    got = moves(read(body))
    assert [each[0] for each in got] == [each[0] for each in expected]
    np.testing.assert_allclose([each[1:] for each in got], [each[1:] for each in expected], atol=1e-6)


@pytest.mark.parametrize("side", ["0", "L", "R"])
@pytest.mark.parametrize("size", [5, -5])
@pytest.mark.parametrize("angle", [30, 90, 200, 360])
@pytest.mark.parametrize("course", [0, 50, -130])
def test_arcs_to_and_from_a_contour_touch_the_path_beside_it(side: str, size: int, angle: int, course: int) -> None:
    """In complex numbers: the circle of CT lies on the tool's side (R0: on the right) and, by R below 0, on the other;
    it is turned by CCA, a whole turn by 360."""
    along = cmath.exp(1j * math.radians(course))
    goal, length = 10 + 20j, 30.0
    across = 1j * along if side == "L" else -1j * along
    begin = goal + (2.0 * across if side != "0" else 0.0)
    centre = begin + size * across
    turn = (1.0 if side == "L" else -1.0) * (1.0 if size > 0 else -1.0)
    swept = cmath.exp(1j * turn * math.radians(angle))
    last = goal + length * along
    body = f"APPR CT X+10 Y+20 CCA{angle} R{size:+d} R{side}\nL X{last.real:+.9f} Y{last.imag:+.9f}\n"
    program = read(f"{body}DEP CT CCA{angle} R{size:+d}\n")
    ends = program.end[1:, 0] * 1e3 + 1j * program.end[1:, 1] * 1e3
    leave = last + (begin - goal)
    away = leave + size * across
    np.testing.assert_allclose(
        ends, [centre + (begin - centre) / swept, begin, leave, away + (leave - away) * swept], atol=1e-6
    )
    arcs = program.kind == 2
    assert arcs.tolist() == [False, False, True, False, True]
    np.testing.assert_allclose(program.centre[arcs] @ [1e3, 1e3j, 0], [centre, away], atol=1e-6)
    np.testing.assert_allclose(np.degrees(program.sweep[arcs]), turn * angle, atol=1e-5)


@pytest.mark.parametrize("side", ["0", "L", "R"])
@pytest.mark.parametrize("course", [0, 50, -130])
@pytest.mark.parametrize("form", ["LT", "LN"])
def test_lines_to_and_from_a_contour(side: str, course: int, form: str) -> None:
    """LT along the tangent, LN square to it from the tool's side (R0: from the right), in complex numbers."""
    along = cmath.exp(1j * math.radians(course))
    across = 1j * along if side == "L" else -1j * along
    begin = 10 + 20j + (2.0 * across if side != "0" else 0.0)
    leave, step = begin + 30 * along, 7.0 * (along if form == "LT" else across)
    last = 10 + 20j + 30 * along
    body = f"APPR {form} X+10 Y+20 LEN7 R{side}\nL X{last.real:+.9f} Y{last.imag:+.9f}\nDEP {form} LEN7\n"
    program = read(body)
    expected = [begin - step if form == "LT" else begin + step, begin, leave, leave + step]
    np.testing.assert_allclose(program.end[1:] @ [1e3, 1e3j, 0], expected, atol=1e-6)


@pytest.mark.parametrize("sense", ["+", "-"])
@pytest.mark.parametrize("first", ["C X+{0} Y+{1} DR{2}", "CP PA+90 DR{2}", "CR X+{0} Y+{1} R+20 DR{2}"])
def test_a_contour_that_begins_with_an_arc_begins_along_its_tangent(first: str, sense: str) -> None:
    """A quarter about (30, 20) from its left or right to its top: the tangent is square to the spoke."""
    goal = 10 if sense == "-" else 50
    # remarks and empty lines between are no contour; nor is CC, which counts
    body = f"APPR LT X+{goal} Y+20 LEN3 R0\n* - remark\n\nCC X+30 Y+20\n; more\n{first.format(30, 40, sense)}\n"
    program = read(body)
    np.testing.assert_allclose(program.end[1:3, :2] * 1e3, [[goal, 17], [goal, 20]], atol=1e-6)
    assert math.degrees(program.sweep[-1]) == pytest.approx(90 if sense == "+" else -90)


@pytest.mark.parametrize("sense", ["+", "-"])
@pytest.mark.parametrize("angle", [20, 130, -75])
def test_it_begins_along_the_tangent_of_an_arc_at_any_angle(angle: int, sense: str) -> None:
    """In complex numbers: the tangent is the spoke of the contour's first point, turned by a quarter the way round."""
    centre, spoke = 3 - 7j, 12 * cmath.exp(1j * math.radians(angle))
    turn = 1j if sense == "+" else -1j
    goal, end = centre + spoke, centre + spoke * turn
    words = [f"X{z.real:+.9f} Y{z.imag:+.9f}" for z in (goal, end)]
    firsts = (f"C {words[1]} DR{sense}", f"CP PA{math.degrees(cmath.phase(spoke * turn)):+.9f} DR{sense}")
    for first in (*firsts, f"CR {words[1]} R+12 DR{sense}", f"CR {words[1]} R12 DR{sense} RL"):
        program = read(f"CC X+3 Y-7\nAPPR LT {words[0]} LEN5 RL\n{first}\n")
        begin = goal + 2j * turn * spoke / 12
        np.testing.assert_allclose(program.end[1:3] @ [1e3, 1e3j, 0], [begin - 5 * turn * spoke / 12, begin], atol=1e-6)


@pytest.mark.parametrize("far", [1.0001, 1.2, 1.45, 5.0])
@pytest.mark.parametrize("side", ["L", "R", "0"])
def test_lct_touches_its_arc_from_however_near_and_refuses_within(side: str, far: float) -> None:
    """The touching point T: (T - centre) square to (T - start), by Thales; start at a multiple of R from the centre."""
    begin = 10 + 20j + {"L": -2, "R": 2, "0": 0}[side]
    centre = begin + (-5 if side == "L" else 5)
    for within in (False, True):
        away = 0.99 if within else far
        start = centre + 5 * away * cmath.exp(-1j)
        body = f"L X{start.real:+.9f} Y{start.imag:+.9f} FMAX\nAPPR LCT X+10 Y+20 R5 R{side}\nL Y+50\n"
        if within:
            with pytest.raises(GCodeError, match="need a point outside of their arc"):
                read(body)
            continue
        touch = complex(*read(body).end[2, :2] * 1e3)
        assert abs(touch - centre) == pytest.approx(5)
        assert ((touch - centre).conjugate() * (touch - start)).real == pytest.approx(0, abs=1e-5)
        cross = ((touch - centre).conjugate() * (touch - start)).imag
        assert cross > 0 if side == "L" else cross < 0


@pytest.mark.parametrize("line", ["APPR LT X+1 Y+2 LEN5 R0\nL Y+9\n", "L X+9 FMAX\nDEP LN LEN3\n"])
def test_approaches_need_a_feed_and_say_so(line: str) -> None:
    head = "BEGIN PGM A MM\nTOOL CALL 1 Z S99\nL X+40 Y+10 Z+5 R0 FMAX M3\n"
    with pytest.raises(GCodeError, match="Line [45]: APPR and DEP cut, and there is no feed rate; give F"):
        interpret(f"{head}{line}END PGM A MM\n", tools=TOOL)


@pytest.mark.parametrize("end", ["", "\n\n", "* - remark\n;\n"])
def test_a_program_that_ends_behind_its_approach_is_refused(end: str) -> None:
    head = "BEGIN PGM A MM\nTOOL CALL 1 Z S99 F100\nL X+40 Y+10 Z+5 R0 FMAX M3\n"
    with pytest.raises(GCodeError, match="Line 4: APPR needs the first element of its contour"):
        interpret(f"{head}APPR LT X+10 Y+20 LEN15 RL\n{end}", tools=TOOL)


def test_an_approach_cuts_by_its_own_feed_and_comes_at_rapid() -> None:
    program = read("APPR LN X+10 Y+20 Z-1 LEN5 R0 F77\nL Y+50\nDEP LT LEN5 Z+9 F88 M5\n")
    np.testing.assert_allclose(program.v_f[1:] * 6e4, [0, 77, 77, 77, 88, 88])
    np.testing.assert_allclose(program.end[1:, 2] * 1e3, [5, -1, -1, -1, -1, 9])
    for steps, depth in (("Z-1", -1), ("IZ-1", 4)):
        sunk = read(f"APPR LN X+10 Y+20 {steps} LEN5 R0 F77\nL Y+50\n")
        assert sunk.end[-1, 2] * 1e3 == pytest.approx(depth)
    inch = interpret(
        "BEGIN PGM A INCH\nTOOL CALL 1 Z S99 F100\nL X+4 Y+1 Z+5 R0 FMAX M3\n"
        "APPR LN X+1 Y+2 LEN5 R0 F77\nL Y+5\nEND PGM A INCH\n"
    )
    np.testing.assert_allclose(inch.v_f[2:] * 60 / 25.4e-3, 7.7)


def test_a_line_and_an_arc_meet_in_a_tangent() -> None:
    """LCT: the line from the start and the line to the end touch the arc, which touches the path beside the contour."""
    program = read("APPR LCT X+10 Y+20 R5 RL F200\nL Y+50\nDEP LCT X-20 Y+80 R6 F300\n")
    start, touch, begin, last, away, end = program.end[:, :2] * 1e3
    centre, other = (program.centre[k, :2] * 1e3 for k in (2, 4))
    np.testing.assert_allclose(centre, [3, 20], atol=1e-6)
    np.testing.assert_allclose(other, [2, 50], atol=1e-6)
    for spoke, ray, size in ((touch - centre, touch - start, 5.0), (away - other, end - away, 6.0)):
        assert np.linalg.norm(spoke) == pytest.approx(size)
        assert float(spoke @ ray) == pytest.approx(0.0, abs=1e-6)
        assert spoke[0] * ray[1] - spoke[1] * ray[0] > 0.0  # goes on in the sense of the arc
    np.testing.assert_allclose([begin, last, end], [[8, 20], [8, 50], [-20, 80]], atol=1e-6)
    np.testing.assert_allclose(program.v_f[1:] * 6e4, [200, 200, 200, 300, 300])
    assert program.sweep[2] > 0.0
    assert program.sweep[4] > 0.0


def test_the_manuals_own_circle() -> None:
    """C-CC of the TNC 640 manual: its R5 is smaller than the cutter's 12.5, so it is that of the centre's path."""
    program = interpret(
        "BEGIN PGM C-CC MM\nTOOL DEF 1 L+0 R+12.5\nTOOL CALL 1 Z S3150\nCC X+50 Y+50\nL Z+250 R0 F MAX\n"
        "L X-40 Y+50 R0 F MAX\nL Z-5 R0 F1000 M3\nAPPR LCT X+0 Y+50 R5 RL F300\nC X+0 DR-\n"
        "DEP LCT X-40 Y+50 R5 F1000\nL Z+250 R0 F MAX M2\nEND PGM C-CC MM\n"
    )
    whole = np.flatnonzero(np.abs(program.sweep) > 6.0)
    assert len(whole) == 1
    np.testing.assert_allclose(program.centre[whole[0], :2] * 1e3, [50, 50], atol=1e-9)
    np.testing.assert_allclose(program.end[whole[0]] * 1e3, [-12.5, 50, -5], atol=1e-9)
    assert np.hypot(
        *(program.end[program.kind == 2] - program.centre[program.kind == 2])[0, :2]
    ) * 1e3 == pytest.approx(5)
    assert len(program) == 9


@pytest.mark.parametrize(
    ("body", "says"),
    [
        ("APPR LT X+10 Y+20 LEN15 RL\nCALL LBL 3\n", "Line 4: APPR needs the first element of its contour"),
        ("APPR LT X+10 Y+20 LEN15 RL\nL Z-5\n", "Line 4: APPR needs the first element of its contour"),
        ("APPR LT X+10 Y+20 RL\nL Y+50\n", "Line 4: 'APPR LT .* needs LEN"),
        ("APPR CT X+10 Y+20 R5 RL\nL Y+50\n", "Line 4: .*APPR CT needs CCA and R"),
        *(
            (f"APPR CT X+10 Y+20 CCA{cca} R5 RL\nL Y+50\n", "Line 4: APPR CT needs CCA from 0 to 360")
            for cca in (0, -90, 360.5)
        ),
        ("APPR LT X+10 Y+20 LEN0 RL\nL Y+50\n", "Line 4: .* is not read; APPR LT needs LEN"),
        ("APPR CT X+10 Y+20 CCA90 R0.0 RL\nL Y+50\n", "Line 4: .* is not read; APPR CT needs CCA and R"),
        ("APPR LT X+10 Y+20 LEN15 RL\nC X+5 DR\n", "Line 4: APPR needs the first element of its contour"),
        ("APPR LT X+10 Y+20 LEN15 RL\nCR X+5 DR+\n", "Line 4: APPR needs the first element of its contour"),
        ("DEP LT LEN5\nDEP LT LEN5\n", "Line 5: DEP goes on from a contour"),
        ("APPR LCT X+10 Y+20 R-5 RL\nL Y+50\n", "Line 4: .*LCT a radius above 0"),
        ("APPR LCT X+60 Y+10 R50 RL\nL Y+50\n", "Line 4: APPR LCT and DEP LCT need a point outside of their arc"),
        ("L X+9 RL\nAPPR LT X+10 Y+20 LEN15 RL\nL Y+50\n", "Line 5: APPR begins compensation, which is on already"),
        ("L Z+0 FMAX M91\nAPPR LT X+10 Y+20 LEN15 RL\nL Y+50\n", "Line 5: APPR begins where only the machine knows"),
        ("DEP LT LEN5 LEN6 R\n", "Line 4: 'DEP LT LEN5 LEN6 R' is not read"),
        ("APPR LX X+10 LEN5\n", "Line 4: APPR LX X.10 LEN5 is not read; expected APPR or DEP with LT"),
        ("CYCL DEF 8.1 X\nAPPR LT X+1 Y+2 LEN5 RL\nL Y+9\n", "Line 5: APPR in a mirror image"),
    ],
)
def test_what_cannot_be_read_is_refused(body: str, says: str) -> None:
    with pytest.raises(GCodeError, match=says):
        read(body)


@pytest.mark.parametrize("form", ["CT", "LCT"])
def test_arcs_of_half_a_millimetre_and_half_a_degree_are_read(form: str) -> None:
    """The smallest of what is above 0: the arc ends at the contour, as wide and as long as it is said."""
    program = read(f"APPR {form} X+10 Y+20 {'CCA0.5 ' * (form == 'CT')}R0.5 R0\nL Y+50\n")
    (arc,) = np.flatnonzero(program.kind == 2)
    np.testing.assert_allclose(program.end[arc, :2] * 1e3, [10, 20], atol=1e-9)
    assert np.hypot(*(program.end - program.centre)[arc, :2]) * 1e3 == pytest.approx(0.5)
    if form == "CT":
        assert abs(np.degrees(program.sweep[arc])) == pytest.approx(0.5)


@pytest.mark.parametrize(("side", "diameter"), [("RL", 0.0), ("R0", 4e-3)])
def test_a_cutter_of_no_width_leaves_the_contour_where_it_stands(side: str, diameter: float) -> None:
    """As without compensation: up along X10, across to X30 and on from there, whatever led to the contour."""
    body = f"APPR LT X+10 Y+20 LEN15 {side}\nL Y+50\nL X+30\nL R0\nL Y+70\n"
    places = [(x, y) for _, x, y, _ in moves(read(body, {1: Tool(1, diameter)}))]
    assert places == [(10, 5), (10, 20), (10, 50), (30, 50), (30, 70)]


def test_a_cutter_without_a_radius_is_asked_for() -> None:
    with pytest.raises(GCodeError, match="Line 4: RL needs the diameter of tool 1; give a tool table"):
        read("APPR LT X+10 Y+20 LEN15 RL\nL Y+50\n", tools=None)


def test_a_tool_that_the_program_defines_fills_the_table_where_it_says_nothing() -> None:
    body = "BEGIN PGM A MM\nTOOL DEF 1 L+0 R+{}\nTOOL CALL 1 Z S9 F9\nL X+0 Y-20 FMAX\nL Y+0 RL\nL Y+9\nEND PGM A MM\n"
    assert interpret(body.format(3)).end[-1, 0] * 1e3 == pytest.approx(-3)
    assert interpret(body.format(3), tools=TOOL).end[-1, 0] * 1e3 == pytest.approx(-2)
    with pytest.raises(GCodeError, match="needs the diameter of tool 1"):
        interpret(body.format(0))
