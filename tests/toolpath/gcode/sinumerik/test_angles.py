"""Straight cuts of Sinumerik programs by their angle, reckoned by hand, and soft approaches, which are named."""

from __future__ import annotations

import math

import numpy as np
import pytest

from robomill.errors import GCodeError
from robomill.toolpath.gcode import interpret

T60 = math.sqrt(3.0)


def ends(body: str) -> list[list[float]]:
    program = interpret(f"G71 G90 G17 F100 S60 M3\nG0 X10 Y0\n{body}M30\n", dialect="sinumerik")
    return (np.round(program.end[1:, :2] * 1e3, 6) + 0.0).tolist()


@pytest.mark.parametrize(
    ("line", "end"),
    [
        ("G1 X20 ANG=45", [20, 10]),
        ("G1 Y20 ANG=45", [30, 20]),
        ("G1 X0 ANG=120", [0, 10 * T60]),
        ("G1 ANG=270 Y-5", [10, -5]),
        ("G1 X20 ANG=-45", [20, -10]),
        ("G91 G1 X5 ANG=45", [15, 5]),
        ("G1 X=IC(5) ANG=45", [15, 5]),
        ("R1=30 R2=45\nG1 X=R1 ANG=R2", [30, 20]),
        ("G1 X20 Y10 ANG=45", [20, 10]),
        ("G0 X20 ANG=45", [20, 10]),
    ],
)
def test_one_coordinate_and_the_angle_say_the_end(line: str, end: list[float]) -> None:
    """From (10, 0): at 45 degrees Y rises as X does; at 120 by the root of 3 for each mm to the left."""
    assert ends(f"{line}\n") == [pytest.approx(end, abs=1e-5)]


def test_two_cuts_meet_where_their_lines_cross() -> None:
    """From (10, 0) at 90 degrees, and at 0 degrees to (50, 20): they meet at (10, 20). At 45 and 135 to (10, 40) they
    meet half way up, at (30, 20); a bevel of 5 along each leaves out that corner."""
    assert ends("G1 ANG=90\nX50 Y20 ANG=0\n") == [[10, 20], [50, 20]]
    assert ends("G1 ANG=45 ; up\n; then\n\nN20 X10 Y40 ANG=135\nX0\n") == [[30, 20], [10, 40], [0, 40]]
    assert ends("R5=50\nG1 ANG=90 CHR=5\nX=R5 Y20 ANG=0\n") == [[10, 15], [15, 20], [50, 20]]
    assert ends("G1 ANG=90 RND=5\nX50 Y20 ANG=0\n") == [[10, 15], [15, 20], [50, 20]]


@pytest.mark.parametrize(
    ("body", "says"),
    [
        ("G1 X20 ANG=90\n", "Line 3: a cut at ANG=90 never comes to another X"),
        ("G1 Y20 ANG=0\n", "Line 3: a cut at ANG=0 never comes to another Y"),
        ("G1 X20 Y0 ANG=45\n", "Line 3: X and Y do not lie at ANG=45 from where the tool is"),
        ("G1 ANG=45\nX50\n", "Line 3: ANG= without X and Y needs a next line with all three"),
        ("G1 ANG=45\nX50 ANG=0\n", "Line 3: ANG= without X and Y needs a next line with all three"),
        ("G1 ANG=45\nG91 X50 Y5 ANG=0\n", "Line 3: ANG= without X and Y needs a next line with all three"),
        ("G1 ANG=45\nX50 Y5 ANG=225\n", "Line 3: two cuts at one angle do not meet"),
        ("G2 X20 ANG=45\n", "Line 3: ANG= is the angle of a straight cut"),
        ("G18 G1 X20 ANG=45\n", "Line 3: ANG= is the angle of a straight cut (G0, G1) in G17"),
        ("G1 G41 G147 DISR=5 X20\n", "Line 3: G147 approaches a contour on a straight line, which is not read; write"),
        ("G248 G340 DISR=5 X20\n", "Line 3: G248 leaves a contour on a quarter of a circle, which is not read"),
        ("G347 X20\n", "Line 3: G347 approaches a contour on a half circle"),
        ("G1 X20 DISCL=5\n", "Line 3: DISCL= belongs to a soft approach"),
    ],
)
def test_what_angles_cannot_say_is_refused(body: str, says: str) -> None:
    with pytest.raises(GCodeError) as refused:
        ends(body)
    assert str(refused.value).startswith(says)


@pytest.mark.parametrize(("off", "fits"), [(0.0, True), (0.002, True), (-0.002, True), (0.004, False), (-0.004, False)])
def test_an_end_may_lie_beside_its_angle_by_what_printing_rounds(off: float, fits: bool) -> None:
    """At 45 degrees an end that is too high by 0.004 mm lies 0.0028 mm beside."""
    line = f"G1 X20 Y{10 + off:.3f} ANG=45\n"
    if fits:
        assert ends(line) == [[20, pytest.approx(10 + off)]]
        return
    with pytest.raises(GCodeError, match="X and Y do not lie at ANG=45"):
        ends(line)


def test_modes_of_soft_approaches_move_nothing_by_themselves() -> None:
    assert ends("G141 G341\nG1 X20\n") == [[20, 0]]


def fanuc_ends(body: str) -> list[list[float]]:
    program = interpret(f"O1\nG21 G90 G17 F100 S60 M3\nG0 X10. Y0\n{body}M30\n")
    return (np.round(program.end[1:, :2] * 1e3, 6) + 0.0).tolist()


def test_the_angle_of_a_fanuc_control_leads_as_that_of_a_sinumerik() -> None:
    """From (10, 0): 45 degrees to X20 is (20, 10). From there up, and level to (50, 30): they meet at (20, 30), where a
    radius of 5 leaves out 5 of both. 45 degrees from (50, 30) and 135 degrees to (50, 50) meet at (60, 40)."""
    assert fanuc_ends("G1 X20.,A45.\n") == [[20, 10]]
    assert fanuc_ends("G1X20.,A45.(UP)\nN20 ,A90. ,R5. ; up\n(THEN)\nX50.Y30.,A0\n") == [
        [20, 10],
        [20, 25],
        [25, 30],
        [50, 30],
    ]
    assert fanuc_ends("G1 X50. Y30.\n,A45\nX50. Y50. ,A135.\nG91 X-10.,A180.\n") == [
        [50, 30],
        [60, 40],
        [50, 50],
        [40, 50],
    ]


@pytest.mark.parametrize(
    "line", ["G1 ,A45.", "G2 X20.,A45.", "G1 X20.,A90.", "G1 X20. Y30. ,A45.", "G18 G1 X20.,A45.", "G1 X20. ,A"]
)
def test_an_angle_that_leads_nowhere_is_refused(line: str) -> None:
    with pytest.raises(GCodeError, match=r"^Line 4: "):
        fanuc_ends(f"{line}\nM5\n")
    with pytest.raises(GCodeError, match=r"^Line 1: found ','"):
        interpret("G1 X20.,A45. F9\n", dialect="linuxcnc")
