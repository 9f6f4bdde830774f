"""Polar places and arcs by their angle of Sinumerik programs: places reckoned by hand."""

from __future__ import annotations

import numpy as np
import pytest

from robomill.errors import GCodeError
from robomill.toolpath.gcode import Program, Tool, interpret


def read(body: str) -> Program:
    return interpret(f"G71 G90 G17 F100\nG0 X0 Y0\n{body}M30\n", dialect="sinumerik")


def ends(body: str) -> list[list[float]]:
    return (np.round(read(body).end[1:, :2] * 1e3, 6) + 0.0).tolist()


@pytest.mark.parametrize(
    ("body", "places"),
    [
        ("G111 X10 Y20\nG1 AP=90 RP=5\nAP=180\n", [[10, 25], [5, 20]]),
        ("G0 X3 Y4\nG110 X1 Y1\nG1 AP=0 RP=2\nG112 X10 Y0\nAP=0 RP=1\n", [[3, 4], [6, 5], [15, 5]]),
        ("G1 X20\nCT X30 Y10\nG111 X10 Y10\nG1 AP=90 RP=10\n", [[20, 0], [30, 10], [10, 20]]),  # no arc to the pole
        ("G111 X0 Y0\nG1 AP=30 RP=10\nAP=IC(60)\n", [[8.660254, 5], [0, 10]]),
        ("R1=2\nG111 X=R1 Y0\nG1 RP=R1*2 AP=R1*90 Z-1\n", [[-2, 0]]),
        ("TRANS X100\nG111 X0 Y0\nG1 AP=90 RP=5\n", [[100, 5]]),
        ("G111 X10 Y20\nG111 X1 Y2\nG1 AP=0 RP=5\nG110 X1 Y1\nAP=90 RP=1\n", [[6, 2], [7, 4]]),
        ("G111 X0 Y0\nG0 AP=0 RP=10\nG3 AP=90 RP=10\nG2 AP=0\n", [[10, 0], [0, 10], [10, 0]]),
    ],
)
def test_places_about_a_pole(body: str, places: list[list[float]]) -> None:
    assert ends(body) == places


def test_a_polar_arc_turns_about_its_pole_or_as_it_says() -> None:
    program = read("G111 X5 Y0\nG0 AP=0 RP=10\nG3 AP=270 RP=10\nG2 CR=-10 AP=0\n")
    np.testing.assert_allclose(program.end[1:, :2] * 1e3, [[15, 0], [5, -10], [15, 0]], atol=1e-9)
    np.testing.assert_allclose(program.centre[2:, :2] * 1e3, [[5, 0], [5, 0]], atol=1e-9)
    np.testing.assert_allclose(np.degrees(program.sweep[2:]), [270, -270], atol=1e-6)


def test_arcs_by_their_angle_beside_end_or_centre() -> None:
    program = read(
        "G0 X10\nG3 X0 Y10 AR=90\nG2 X10 Y0 AR=270\nG3 I-10 J0 AR=90\nG2 I=AC(0) J=AC(0) AR=180\nG91 G3 J10 AR=90\n"
    )
    places = [[10, 0], [0, 10], [10, 0], [0, 10], [0, -10], [10, 0]]
    np.testing.assert_allclose(program.end[1:, :2] * 1e3, places, atol=1e-9)
    np.testing.assert_allclose(np.degrees(program.sweep[2:]), [90, -270, 90, -180, 90], atol=1e-6)
    centres = [[0, 0], [10, 10], [0, 0], [0, 0], [0, 0]]
    np.testing.assert_allclose(program.centre[2:, :2] * 1e3, centres, atol=1e-9)


@pytest.mark.parametrize(
    ("body", "says"),
    [
        ("G111 X5\n", "Line 3: G111 needs X and Y"),
        ("G112 X5 Y5\n", "Line 3: G112 needs X and Y, and G112 a pole before it"),
        ("G111 X0 Y0\nG91 G1 AP=0 RP=1\n", "Line 4: AP and RP in G91 are not read"),
        ("G111 X0 Y0\nG1 AP=0\n", "Line 4: a polar place needs its angle AP and radius RP"),
        ("G111 X0 Y0\nG1 AP=IC(5) RP=1\n", r"Line 4: a polar place needs .* AP=IC\( \) needs an AP before it"),
        ("G1 X5\nCT X10 Y5\nAP=30 RP=5\n", "Line 5: AP is read in G17, from a known place and beside G0 to G3 alone"),
        ("G18\nG111 X0 Y0\n", "Line 4: G111 is read in G17"),
        ("G1 X5 AR=90\n", "Line 3: AR is the angle of G2 or G3"),
        ("G2 X5 I2 AR=90\n", "Line 3: AR is the angle of G2 or G3"),
        ("G2 X5 AR=360\n", "Line 3: AR is the angle of G2 or G3"),
    ],
)
def test_what_cannot_be_reckoned_is_refused(body: str, says: str) -> None:
    with pytest.raises(GCodeError, match=says):
        read(body)


def test_without_a_pole_it_is_the_zero_of_the_part() -> None:
    program = interpret(
        "G71 G90 G17\nTRANS X5 Y1\nG0 X0 Y0 Z5\nG1 AP=90 RP=20 F100\nAP=180\nM30\n", dialect="sinumerik"
    )
    np.testing.assert_allclose(program.end[-2:] * 1e3, [[5, 21, 5], [-15, 1, 5]], atol=1e-9)


@pytest.mark.parametrize("side", ["G41", "G42"])
def test_places_about_a_pole_are_offset_as_the_same_places_by_x_and_y(side: str) -> None:
    """Where the tool is, for G110, is where the part's outline is, however far the cutter stands beside it."""
    start, end = f"T1 D1 M6\n{side} G1 X10 Y0\nX20\n", "G40 X0 Y60\n"
    polar = "G110 X5 Y5\nAP=90 RP=10\nG112 X0 Y5\nAP=180 RP=20\n"
    told = "X25 Y15\nX5 Y10\n"
    tools = {1: Tool(1, 4e-3)}
    found, expected = (
        interpret(f"G71 G90 G17 F100\nG0 X0 Y-9\n{start}{body}{end}M30\n", dialect="sinumerik", tools=tools)
        for body in (polar, told)
    )
    assert np.abs(found.end[2, 1]) == pytest.approx(2e-3)
    np.testing.assert_allclose(found.end, expected.end, atol=1e-12)


@pytest.mark.parametrize("angle", [0.5, 90.0, 179.5, 180.5, 270.0, 359.5])
@pytest.mark.parametrize("way", [2, 3])
@pytest.mark.parametrize("by", ["end", "centre"])
def test_an_arc_turns_by_its_angle_however_small_or_large(angle: float, way: int, by: str) -> None:
    """In complex numbers: from (30, 0) about (10, 0)."""
    turn = np.exp(1j * np.radians(angle if way == 3 else -angle))
    end = 10.0 + 20.0 * turn
    said = f"X{end.real:.9f} Y{end.imag:.9f}" if by == "end" else "I-20 J0"
    program = read(f"G0 X30\nG{way} {said} AR={angle}\n")
    np.testing.assert_allclose(program.end[-1, :2] * 1e3, [end.real, end.imag], atol=1e-6)
    np.testing.assert_allclose(program.centre[-1, :2] * 1e3, [10, 0], atol=1e-4)
    assert np.degrees(program.sweep[-1]) == pytest.approx(angle if way == 3 else -angle, abs=1e-3)


@pytest.mark.parametrize("angle", [0, 360, -90, 400])
def test_an_arc_by_no_angle_or_a_whole_turn_is_refused(angle: float) -> None:
    for said in ("X0 Y10", "I-10 J0"):
        with pytest.raises(GCodeError, match="between 0 and 360"):
            read(f"G0 X10\nG3 {said} AR={angle}\n")


def test_a_radius_of_nothing_leads_to_the_pole_and_none_leads_further() -> None:
    assert ends("G111 X10 Y20\nG1 AP=0 RP=5\nAP=30 RP=0\n") == [[15, 20], [10, 20]]
    assert ends("G1 AP=90 RP=5\n") == [[0, 5]]  # without a pole about the zero of the part
    with pytest.raises(GCodeError, match="a radius of 0 or more"):
        read("G111 X10 Y20\nG1 AP=0 RP=-1\n")


def test_a_pole_is_read_from_a_known_place_in_the_plane_whatever_the_height() -> None:
    """G75 leads an axis to the machine's fixed point, and only the machine knows where that is."""
    assert ends("G0 X3 Y4\nG75 Z1=0\nG110 X1 Y1\nG0 AP=0 RP=2\n")[-1] == [6, 5]
    for axis in "XY":
        with pytest.raises(GCodeError, match="Line 5: G110 is read in G17, from a known place"):
            read(f"G0 X3 Y4\nG75 {axis}1=0\nG110 X1 Y1\nG0 AP=0 RP=2\n")
