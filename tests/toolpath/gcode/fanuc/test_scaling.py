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


@pytest.mark.parametrize("plane", [17, 18, 19])
@pytest.mark.parametrize("before", [17, 18, 19])
@pytest.mark.parametrize("centre", ["", "G90.1 "])
@pytest.mark.parametrize("factors", [(2, 2, 2), (-1, 1, 1), (1, -1, 1), (1, 1, -1), (-2, 2, -2)])
def test_an_arc_of_any_plane_is_the_scaled_arc(plane: int, before: int, centre: str, factors: tuple[int, ...]) -> None:
    """Point by point: C + s (p - C) of the arc without scaling, along the whole of it; its line says its plane."""
    first, second, _ = {17: (0, 1, 2), 18: (2, 0, 1), 19: (1, 2, 0)}[plane]
    middle, begin = np.zeros(3), np.zeros(3)
    middle[first], middle[second], begin[first], begin[second] = 3.0, -4.0, 9.0, -4.0
    end = begin.copy()
    end[first], end[second] = 3.0, 2.0
    i = middle if centre else middle - begin
    turn = f"G{plane} {centre}G3 X{end[0]} Y{end[1]} Z{end[2]} {'IJK'[first]}{i[first]} {'IJK'[second]}{i[second]}\n"
    about = np.array([1.0, 2.0, -3.0])
    scaled = f"G51 X1. Y2. Z-3. I{factors[0]}. J{factors[1]}. K{factors[2]}.\n"
    start = f"G{before}\n" + "G0 X{} Y{} Z{}\n".format(*begin)
    plain, found = (interpret(f"G21 G90 F100\n{more}{start}{turn}M30\n", dialect="fanuc") for more in ("", scaled))
    share = np.linspace(0.0, 1.0, 9)
    points = plain.arcs_of(np.array([1])).at(np.zeros(9, dtype=int), share) * 1e3
    again = found.arcs_of(np.array([1])).at(np.zeros(9, dtype=int), share) * 1e3
    np.testing.assert_allclose(again, about + np.array(factors) * (points - about), atol=1e-9)


@pytest.mark.parametrize(
    ("body", "says"),
    [
        ("G51 P1001.5\n", "Line 2: G51 has a scale of 1001.5; expected 0.000001 to 1000"),
        ("G51 X0 Y0 P2.\nG50 X5\n", "Line 3: G50 with axis words sets a coordinate system"),
        ("G51 X0 Y0 P2.\nG5 X5 I1 J1 P1 Q1\n", "Line 3: G5 "),
        ("G51 X0 Y0 Z0 I1. J1. K-1.\nG81 X1 Z-3 R1\n", "Line 3: a cycle is read in G17, and not mirrored along Z"),
        ("G51 X0 Y0 P2.\nG18\nG81 X1 Y-3 R1\n", "Line 4: a cycle is read in G17"),
        ("G16\nG51 P2.\n", "Line 3: G51 inside of G68 or G16"),
        ("G51 X0 Y0 P2.\nG16\nG1 X9. Y30.\n", "Line 4: G16 while coordinates are scaled or mirrored is not read"),
        ("G51.1 X0\nG16\nG1 X9.\n", "Line 4: G16 while coordinates are scaled or mirrored is not read"),
        ("G90\nG91 G51 P2.\n", "Line 3: G51 is read in G90 alone"),
        ("G101\n", "Line 2: G101 needs the axes that it mirrors"),
    ],
)
def test_more_that_cannot_be_scaled_is_refused(body: str, says: str) -> None:
    with pytest.raises(GCodeError, match=says):
        read(body)


@pytest.mark.parametrize(
    ("said", "factor"), [("P100", 0.1), ("P99", 99), ("P99.5", 99.5), ("P500", 0.5), ("I1500 J1500 K1500", 1.5)]
)
def test_large_whole_factors_count_in_thousandths(said: str, factor: float) -> None:
    assert ends(f"G51 X0 Y0 Z0 {said}\nG1 X2.\n")[-1][0] == pytest.approx(2 * factor)


@pytest.mark.parametrize(
    ("said", "factor"),
    [("P.000001", 1e-6), ("P.0000009", None), ("P1000000", 1e3), ("P1001000", None), ("P999.5", 999.5), ("P-2.", -2.0)],
)
def test_a_scale_may_be_a_millionth_to_a_thousand(said: str, factor: float | None) -> None:
    body = f"G51 X0 Y0 Z0 {said}\nG1 X2.\n"
    if factor is None:
        with pytest.raises(GCodeError, match="expected 0.000001 to 1000"):
            read(body)
    else:
        assert read(body).end[-1, 0] == pytest.approx(2e-3 * factor, rel=1e-9)


def test_home_and_machine_places_are_not_scaled_and_mirrors_add_up() -> None:
    assert ends("G51 X0 Y0 Z0 P2.\nG1 X3.\nG28 X4.\n")[0] == [6, 0, 0]
    assert ends("G51.1 X0\nG51.1 Y0\nG1 X3. Y4.\nG50.1 X0 Y0\nX3. Y4.\n") == [[-3, -4, 0], [3, 4, 0]]
    assert ends("G51 X0 Y0 Z0 P2.\nG91 G1 X3. Y-5. Z.5\n") == [[6, -10, 1]]
    assert ends("G51.1 X0\nG1 X3. Y4. Z5.\n") == [[-3, 4, 5]]
    assert ends("G91 G1 X1.\nG90 G51 P2.\nX2.\n")[-1] == [3, 0, 0]  # about where the tool is


def test_each_axis_is_mirrored_and_straight_again_by_itself() -> None:
    """Fanuc's manual, programmable mirror image: one figure in four quarters, about X50 and Y50."""
    figure = np.array([[60.0, 60.0, 0.0], [100.0, 60.0, 0.0], [60.0, 100.0, 0.0]])
    calls = ["", "G51.1 X50.\n", "G51.1 Y50.\n", "G50.1 X0\n", "G50.1 Y0\n"]
    body = "".join(f"{call}M98 P9000\n" for call in calls)
    found = ends(f"{body}M30\nO9000\nG0 X60. Y60.\nG1 X100.\nX60. Y100.\nM99\n")
    for k, (x, y) in enumerate([(1, 1), (-1, 1), (-1, -1), (1, -1), (1, 1)]):
        about = np.array([50.0, 50.0, 0.0])
        expected = about + (figure - about) * [x, y, 1]
        np.testing.assert_allclose(found[3 * k : 3 * k + 3], expected, err_msg=calls[k])


def test_haas_ends_the_mirror_images_that_g100_names_and_g50_ends_none() -> None:
    body = "G101 X0\nG101 Y0\nG1 X3. Y4.\nG100 X0\nX3. Y4.\nG50\nX3. Y5.\nG100\nX3. Y4.\n"
    assert ends(body) == [[-3, -4, 0], [3, -4, 0], [3, -5, 0], [3, 4, 0]]
    assert ends("G51 X0 Y0 P2.\nG50.1 X0\nG1 X3. Y4.\n") == [[6, 8, 0]]


def test_mirror_images_within_scales_and_scales_within_mirror_images_are_refused() -> None:
    """Siemens' ISO milling: "do not specify G50.1 or G51.1 during scaling"."""
    with pytest.raises(GCodeError, match=r"Line 3: G51.1 while coordinates are scaled \(G51\) is not read"):
        read("G51 X0 Y0 P2.\nG51.1 X0\nG1 X3. Y4.\n")
    with pytest.raises(GCodeError, match=r"Line 3: G51 while coordinates are mirrored \(G51.1\) is not read"):
        read("G51.1 X0\nG51 X0 Y0 P2.\nG1 X3. Y4.\n")
