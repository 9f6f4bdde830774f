"""Scaled and mirrored coordinates, with the places that the rule C + s (X - C) gives by hand."""

from __future__ import annotations

import numpy as np
import pytest

from robomill.errors import GCodeError
from robomill.toolpath.gcode import Program, interpret


def read(body: str) -> Program:
    return interpret(f"G21 G90 F100\n{body}M30\n", dialect="fanuc")


def ends(body: str) -> list[list[float]]:
    return (np.round(read(body).end * 1e3, 9) + 0.0).tolist()


@pytest.mark.parametrize("factor", ["P2.", "P2000", "I2. J2. K2."])
def test_places_steps_and_arcs_are_scaled(factor: str) -> None:
    body = f"G0 X0 Y0 Z5\nG51 X10 Y0 Z0 {factor}\nG1 X20 Y5 Z-1\nG91 X1\nG90 G2 X30 Y5 I4.5 J0\nG50\nG1 X0\n"
    program = read(body)
    assert ends(body) == [[0, 0, 5], [30, 10, -2], [32, 10, -2], [50, 10, -2], [0, 10, -2]]
    np.testing.assert_allclose(program.centre[3] * 1e3, [41, 10, -2])
    assert any(f.code == "scale-thousandths" for f in program.findings) == (factor == "P2000")


def test_radii_and_cycles_are_scaled_and_pecks_are_not() -> None:
    assert read("G0 X0 Y0\nG51 X0 Y0 P3.\nG3 X0 Y10 R5\n").length[1] * 1e3 == pytest.approx(15 * np.pi)
    heights = [row[2] for row in ends("G0 Z20\nG51 X0 Y0 Z0 P2.\nG99 G83 X5 Y0 Z-3 R2 Q5\nG80\n")]
    assert heights == [20, 20, 4, -1, 4, pytest.approx(-0.746), -6, 4]


def test_axes_scaled_unlike() -> None:
    assert ends("G51 X0 Y0 Z0 I2. J0.5 K1.\nG1 X20 Y5 Z1\n") == [[40, 2.5, 1]]
    with pytest.raises(GCodeError, match="Line 3: an arc scaled unlike along its two axes is none"):
        read("G51 X0 Y0 Z0 I2. J0.5 K1.\nG2 X20 Y5 R50\n")


def test_a_mirror_turns_arcs_round_and_lets_the_programmed_word_stay() -> None:
    body = "G0 X10 Y0\nG2 X20 Y10 I10 J0\nG51.1 X5\nG1 X20 Y10\n"
    body += "G2 X30 Y0 I0 J-10\nX40 Y10 I10 J0\nG50.1 X5\nX-20 Y10 I5 J0\n"
    program = read(body)
    np.testing.assert_allclose(program.end[2:, :2] * 1e3, [[-10, 10], [-20, 0], [-30, 10], [-20, 10]], atol=1e-9)
    assert program.clockwise.tolist() == [False, True, False, False, False, True]


@pytest.mark.parametrize(
    ("body", "says"),
    [
        ("G51 X0\n", "Line 2: G51 needs P"),
        ("G51 P0\n", "Line 2: G51 has a scale of 0"),
        ("G51.1 P2\n", "Line 2: G51.1 needs the axes"),
        ("G51 P2.\nG68 X0 Y0 R5\n", "Line 3: G68 while coordinates are scaled"),
        ("G68 X0 Y0 R5\nG51 P2.\n", "Line 3: G51 inside of G68 or G16"),
        ("G51 P2.\nG92 X0\n", "Line 3: G92 while coordinates are scaled"),
        ("G91\nG51 P2.\n", "Line 3: G51 is read in G90 alone"),
        ("G51.1 X0\nT1 M6\nG41 D1\n", "Line 4: G41 while coordinates are mirrored"),
    ],
)
def test_what_cannot_be_scaled_is_refused(body: str, says: str) -> None:
    with pytest.raises(GCodeError, match=says):
        read(body)


def test_haas_mirrors_about_part_zero_by_g101_until_g100() -> None:
    """Mill Operator's Manual, G101: about the zero of the work offset, whatever stands behind X."""
    assert ends("G0 X5. Y1.\nG101 X7.\nG1 X10. Y2.\nG100 X0\nX3.\n") == [[5, 1, 0], [-10, 2, 0], [3, 2, 0]]


def test_units_may_change_while_coordinates_are_scaled() -> None:
    assert ends("G51 X10 Y0 Z0 P2.\nG20\nG1 X1\n") == [[pytest.approx(10 + 2 * 15.4), 0, 0]]
