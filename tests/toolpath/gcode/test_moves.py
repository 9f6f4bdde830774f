"""Where a line leads: polar words, machine coordinates, stored points; by complex numbers."""

from __future__ import annotations

import cmath
import math

import numpy as np
import pytest

from robomill.errors import GCodeError
from robomill.toolpath.gcode import interpret, read_gcode


def end(text):
    """Last end (x, y, z) mm."""
    return interpret(f"G21 G90 F100\n{text}\nM2\n").end[-1] * 1e3


@pytest.mark.parametrize(
    ("words", "z"),
    [
        ("@8 ^30", cmath.rect(8, math.radians(30))),
        ("@8", cmath.rect(8, math.atan2(4, -3))),
        ("^-70", cmath.rect(5, math.radians(-70))),
    ],
)
def test_polar_words_that_are_not_given_stay(words, z):
    np.testing.assert_allclose(end(f"G0 X-3 Y4 Z2\nG1 {words}"), [z.real, z.imag, 2], atol=1e-9)


@pytest.mark.parametrize(("words", "radius", "angle"), [("@3 ^25", 3, 25), ("@3", 3, 0), ("^25", 0, 25)])
def test_polar_words_in_steps_add_to_radius_and_angle(words, radius, angle):
    z = cmath.rect(5 + radius, math.atan2(4, -3) + math.radians(angle))
    np.testing.assert_allclose(end(f"G0 X-3 Y4 Z2\nG91 G1 {words}"), [z.real, z.imag, 2], atol=1e-9)


@pytest.mark.parametrize("rotation", [0.0, 35.0])
def test_machine_coordinates_are_those_of_no_system(rotation):
    """G53: what is named counts from the machine, what is not stays where it is in the machine."""
    start = f"G10 L2 P1 X7 Y-3 Z1 R{rotation}\nG0 X5 Y2 Z4\nG92 X1 Y1 Z1\nG43.1 Z6"
    here = end(start)
    np.testing.assert_allclose(end(f"{start}\nG53 G0 X20 Y30 Z40")[:2], [20, 30], atol=1e-9)
    np.testing.assert_allclose(end(f"{start}\nG53 G0 X20")[:2], [20, here[1]], atol=1e-9)
    np.testing.assert_allclose(end(f"{start}\nG53 G0 Y30")[:2], [here[0], 30], atol=1e-9)


def test_the_tip_stands_a_tools_offset_from_machine_coordinates():
    """Along every axis: of the place named for the spindle, less the length in force; turned axes have none."""
    start = "G10 L2 P1 X7 Y-3 Z1 A4\nG0 X5 Y2 Z4\nG92 X1 Y1 Z1\nG43.1 X2 Y5 Z6"
    there = interpret(f"G21 G90\n{start}\nG53 G0 X20 Y30 Z40 A50 B60 C70\nM2\n")
    np.testing.assert_allclose(there.end[-1] * 1e3, [18, 25, 34], atol=1e-9)
    np.testing.assert_allclose(np.degrees(there.rotary[-1]), [50, 60, 70], atol=1e-9)
    here = end(start)
    for axis, (letter, value) in enumerate((("X", 18), ("Y", 25), ("Z", 34))):
        expected = [value if n == axis else here[n] - (2, 5, 6)[n] for n in range(3)]
        np.testing.assert_allclose(end(f"{start}\nG53 G0 {letter}{20 + 10 * axis}"), expected, atol=1e-9)


@pytest.mark.parametrize(("code", "parameter"), [("G28", 5161), ("G30", 5181)])
def test_a_stored_point_is_kept_in_millimetres_of_the_machine(code, parameter):
    text = f"G21 G90\nG10 L2 P1 X7 Y-3 Z1\nG43.1 Z6\nG0 X5 Y2 Z4 A9\nG92 Z1\nG20\n{code}.1\nG21\n"
    read = [end(f"{text}G92.1 G49\nG10 L2 P1 X0 Y0 Z0\nG0 X#{parameter + n}")[0] for n in range(4)]
    np.testing.assert_allclose(read, [12, -1, 11, 9], atol=1e-9)
    back = interpret(f"{text}G0 X90 Y91 Z92 A80\n{code} X95 A70\nM2\n")
    np.testing.assert_allclose(back.end[-1, 0] * 1e3, 12, atol=1e-9)
    np.testing.assert_allclose(np.degrees(back.rotary[-2:, 0]), [70, 9], atol=1e-9)


@pytest.mark.parametrize("code", ["G28", "G30"])
def test_a_stored_point_is_come_back_to_by_way_of_the_words(code):
    """All axes without words; with words by way of them, and on with the named axes alone."""
    start = "G10 L2 P1 X7 Y-3 Z1\nG0 X5 Y2 Z4"
    stored = end(start)
    away = f"{start}\n{code}.1\nG0 X50 Y60 Z70"
    far = end(away)
    np.testing.assert_allclose(end(f"{away}\n{code}"), stored, atol=1e-9)
    np.testing.assert_allclose(end(f"{away}\n{code} Z80"), [*far[:2], stored[2]], atol=1e-9)
    moves = interpret(f"G21 G90 F100\n{away}\n{code} Z80\nM2\n").end * 1e3
    np.testing.assert_allclose(moves[-2], [*far[:2], 81], atol=1e-9)


def shown(text: str) -> list[tuple[float, float, float, bool]]:
    path = read_gcode(text)
    return [(*(round(float(v) * 1e3, 6) for v in p), bool(c)) for p, c in zip(path.p, path.cutting)]


BEFORE = "G21 G90 G0 X10 Y10 Z50\nG1 Z-5 F100\nX40\n"
AFTER = "G90 G0 X70 Y70\nZ3\nG1 Z-5\nM30\n"
CUT = [(0, 0, 0, False), (10, 10, 50, False), (10, 10, -5, True), (40, 10, -5, True)]
DOWN = [(70, 70, 50, False), (70, 70, 3, False), (70, 70, -5, True)]


@pytest.mark.parametrize("line", ["G91 G28 Z0", "G91 G30 Z0", "G53 G0 Z0", "G53 G0 Z-12.7"])
def test_a_home_that_only_the_machine_knows_is_clear_of_the_part(line: str) -> None:
    """Straight up, as high as the program ever goes, and down again where Z is given: no dive to part zero."""
    beyond = [(40, 10, -5, False)] * ("28" in line or "30" in line)
    assert shown(f"{BEFORE}{line}\n{AFTER}") == [*CUT, *beyond, (40, 10, 50, False), *DOWN]


def test_the_way_home_leads_by_the_point_that_is_given() -> None:
    found = shown(f"{BEFORE}G28 X30 Y20 Z8\n{AFTER}")
    assert found == [*CUT, (30, 20, 8, False), (30, 20, 50, False), *DOWN]
    assert shown(f"{BEFORE}G0 Z9\nG28 X30 Y20\n{AFTER}")[-5:-2] == [
        (30, 20, 9, False),
        (30, 20, 9, False),
        (70, 70, 9, False),
    ]


def test_a_home_that_the_program_stores_and_a_zero_that_it_places_are_known() -> None:
    assert shown("G21 G90 G0 X1 Y2 Z30\nG28.1\nG1 F9 Z-5\nG91 G28 Z0\nM2\n")[-1] == (1, 2, 30, False)
    assert shown("G21 G90 G10 L2 P1 Z5\nG1 F9 Z-5\nG53 G0 Z40\nM2\n")[-1] == (0, 0, 40, False)


def test_cuts_from_where_only_the_machine_knows_are_no_cuts_and_that_is_said() -> None:
    path = read_gcode(f"{BEFORE}G91 G28 Z0\nG90 G1 X99\nG91 X5\nG90 G0 Z5\nG1 Z-1\nM30\n")
    assert [int(b) for b in path.block[path.cutting]] == [2, 3, 8]
    assert [(f.level, f.line, f.count) for f in path.findings if f.code == "cut-unplaced"] == [("warning", 5, 2)]
    assert [f.line for f in path.findings if f.code == "machine-place"] == [4]


def test_sideways_from_a_home_in_x_and_y_nothing_is_cut() -> None:
    path = read_gcode("G21 G90 G0 X1 Y1 Z-1\nG28 X5 Y5\nG1 X9 Y9 F100\nX12\nM30\n")
    assert [int(b) for b in path.block[path.cutting]] == [4]


@pytest.mark.parametrize("dwell", ["", " P100"])
@pytest.mark.parametrize("dialect", ["auto", "fanuc"])
def test_a_retract_by_hand_is_said_whether_or_not_the_line_waits(dwell: str, dialect: str) -> None:
    program = interpret(f"G21 G90 S100 M3\nG0 X0. Y0. Z9.\nG88 X1. Z-1. R1. F9.{dwell}\nG80\nM30\n", dialect=dialect)
    assert [each.line for each in program.findings if each.code == "manual-retract"] == [3]
    np.testing.assert_allclose(program.end[-1] * 1e3, [1, 0, -1])


@pytest.mark.parametrize("code", [82, 86, 88, 89])
@pytest.mark.parametrize("dialect", ["auto", "linuxcnc"])
def test_a_cycle_that_waits_at_the_bottom_waits_for_p_and_needs_it_on_linuxcnc(code: int, dialect: str) -> None:
    """Every hole, the second with what the first one said."""
    text = f"G21 G90 S100 M3\nG0 X0 Y0 Z9\nG{code} X1 Z-1 R1 F9{{}}\nX5\nG80\nM2\n"
    assert interpret(text.format(" P2.5"), dialect=dialect).dwell_time == pytest.approx(5.0)
    if dialect == "linuxcnc":
        with pytest.raises(GCodeError, match=f"Line 3: G{code} needs P, its dwell in seconds"):
            interpret(text.format(""), dialect=dialect)


@pytest.mark.parametrize("dialect", ["linuxcnc", "sinumerik"])
@pytest.mark.parametrize(
    ("words", "says"),
    [
        ("S60 M3\nG33 Z-9 K2", ""),
        ("S60 M3\nG33 Z-9 K-2", ""),
        ("S60 M3\nG33 Z-9 K0", "Line 5: G33 needs S and K above 0"),
        ("M3\nG33 Z-9 K2", "Line 5: G33 needs S and K above 0"),
        ("S60\nG33 Z-9 K2", "Line 5: G33 needs a turning spindle"),
        ("S60 M3\nG33 Z-9", "Line 5: G33 needs K"),
    ],
)
def test_a_thread_has_a_pitch_and_a_speed(words: str, says: str, dialect: str) -> None:
    """One turn a second of 2 mm."""
    text = f"G21 G90 G17 F900\nG1 X0 Y0\nZ1\n{words}\nM2\n"
    if not says:
        program = interpret(text, dialect=dialect)
        assert (program.end[-1, 2] * 1e3, program.v_f[-1] * 1e3) == pytest.approx((-9, 2))
        return
    with pytest.raises(GCodeError, match=f"^{says}"):
        interpret(text, dialect=dialect)
