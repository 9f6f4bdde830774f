"""Corners, turned and polar coordinates and rigid taps of Fanuc and Haas, from plane geometry."""

from __future__ import annotations

import numpy as np
import pytest

from robomill.errors import GCodeError
from robomill.toolpath.gcode import Program, interpret

HEAD = "%\nO0001\nG21 G90 G0 X0 Y0 Z0\n"


def ends(body: str, dialect: str = "fanuc") -> list[list[float]]:
    program = interpret(f"{HEAD}{body}M30\n%\n", dialect=dialect)
    return [[round(float(v) * 1e3, 6) for v in p[:2]] for p in program.end[1:]]


@pytest.mark.parametrize("dialect", ["fanuc", "auto"])
def test_a_corner_is_rounded_with_its_radius(dialect: str) -> None:
    program = interpret(f"{HEAD}G1 X20 ,R5 F100\nY20\nM30\n%\n", dialect=dialect)
    np.testing.assert_allclose(program.end[1:, :2] * 1e3, [[15, 0], [20, 5], [20, 20]], atol=1e-9)
    np.testing.assert_allclose(program.centre[2, :2] * 1e3, [15, 5], atol=1e-9)
    assert program.length[2] * 1e3 == pytest.approx(2.5 * np.pi)
    assert [int(k) for k in program.kind] == [0, 1, 2, 1]
    assert not program.clockwise[2]
    assert (program.v_f[1:] == program.v_f[1]).all()
    assert program.turns.tolist() == [0, 0, 1, 0]


def test_corners_of_any_angle_touch_both_cuts() -> None:
    """Back by 60 degrees: the arc turns by 120, from points 5 / tan(30) off the corner, clockwise for a right turn."""
    program = interpret(f"{HEAD}G1 X40 ,R5 F100\nX30 Y[-10*SQRT[3]]\nM30\n%\n", dialect="fanuc")
    leg = 5 / np.tan(np.radians(30))
    np.testing.assert_allclose(
        program.end[1:3, :2] * 1e3, [[40 - leg, 0], [40 - leg / 2, -leg * np.sqrt(3) / 2]], atol=1e-9
    )
    assert program.sweep[2] == pytest.approx(np.radians(-120))
    centre = program.centre[2, :2] * 1e3
    np.testing.assert_allclose([np.hypot(*(centre - p[:2] * 1e3)) for p in program.end[1:3]], 5, atol=1e-9)


def test_a_chamfer_takes_its_length_off_both_cuts_and_corners_may_follow_one_another() -> None:
    assert ends("G1 X20 ,C5 F100\nY20 ,C4\nX0\n") == [[15, 0], [20, 5], [20, 16], [16, 20], [0, 20]]
    assert ends("G1 X20 ,R5 F100\nX30\n") == [[20, 0], [30, 0]]


CONTOURS = {
    "line, arc": "G1 X20 ,R{r} F100\nG3 X30 Y-10 I10 J0\n",
    "arc, line": "G2 X20 Y0 I10 J0 F100 ,R{r}\nG1 X60\n",
    "arc, arc outside": "G2 X20 Y0 I10 J0 F100 ,R{r}\nG2 X40 Y0 I10 J0\n",
    "arc, arc inside": "G3 X20 Y0 I10 J0 F100 ,R{r}\nG2 X20 Y-30 I30 J-15\n",
    "arc, arc of unlike sense": "G2 X20 Y0 I10 J0 F100 ,R{r}\nG3 X50 Y0 I15 J-8\n",
    "chain": "G1 X20 ,R{r} F100\nG3 X40 Y0 I10 J0 ,R{r}\nG1 X60 Y10 ,R{r}\nX0\n",
}


def _direction(program: Program, k: int, at_end: bool) -> np.ndarray:
    """Unit direction of travel (x, y) of move ``k`` at one of its ends, by geometry alone."""
    a, b, c = (v[k, :2] for v in (program.start, program.end, program.centre))
    if program.kind[k] == 1:
        along = b - a
    else:
        out = (b if at_end else a) - c
        along = np.array([out[1], -out[0]]) if program.clockwise[k] else np.array([-out[1], out[0]])
    return along / np.linalg.norm(along)


@pytest.mark.parametrize("radius", [0.5, 1.0, 2.0])
@pytest.mark.parametrize("name", CONTOURS)
def test_a_corner_beside_an_arc_touches_both_cuts(name: str, radius: float) -> None:
    """An arc of its radius, of less than half a turn, that both cuts go on into: each where it was, only shorter."""
    text = CONTOURS[name]
    sharp = interpret(f"{HEAD}{text.replace(',R{r}', '')}M30\n%\n", dialect="fanuc")
    program = interpret(f"{HEAD}{text.replace('{r}', f'{radius}')}M30\n%\n", dialect="fanuc")
    assert len(program) == len(sharp) + text.count(",R")
    middles = [*range(2, 2 * text.count(",R") + 1, 2)]
    for k in middles:
        for point in (program.start[k], program.end[k]):
            assert np.linalg.norm(point - program.centre[k]) * 1e3 == pytest.approx(radius)
        assert 0.0 < abs(program.sweep[k]) < np.pi
        for before in (k - 1, k):
            np.testing.assert_allclose(program.end[before], program.start[before + 1], atol=1e-12)
            along = _direction(program, before, True) @ _direction(program, before + 1, False)
            assert along == pytest.approx(1.0, abs=1e-9)
    kept = [k for k in range(1, len(program)) if k not in middles]
    np.testing.assert_allclose(program.end[-1], sharp.end[-1], atol=1e-12)
    np.testing.assert_array_equal(program.kind[kept], sharp.kind[1:])
    np.testing.assert_array_equal(program.clockwise[kept], sharp.clockwise[1:])
    arcs = sharp.kind[1:] == 2
    np.testing.assert_allclose(program.centre[kept][arcs], sharp.centre[1:][arcs], atol=1e-12)
    assert (program.length[kept] < sharp.length[1:]).all()


def test_a_corner_beside_an_arc_in_closed_form() -> None:
    """Radius 2 outside of a circle of 10 about (30, 0), below the line y = 0: the two centres are 12 apart."""
    u = 30 - np.sqrt(12**2 - 2**2)
    fanuc = f"{HEAD}G1 X20 ,R2 F100\nG3 X30 Y-10 I10 J0\nG1 X50\nM30\n%\n"
    sinumerik = "G71 G90 G0 X0 Y0 Z0\nG1 X20 RND=2 F100\nG3 X30 Y-10 I10 J0\nG1 X50\nM30\n"
    modal = "G71 G90 G0 X0 Y0 Z0\nRNDM=2\nG1 X20 F100\nG3 X30 Y-10 I10 J0\nRNDM=0 G1 X50\nM30\n"
    klartext = "BEGIN PGM A MM\nL X0 Y0 Z0 FMAX\nL X20 F100\nRND R2\nCC X30 Y0\nC X30 Y-10 DR+\nL X50\nEND PGM A MM\n"
    for text, dialect in ((fanuc, "fanuc"), (sinumerik, "sinumerik"), (modal, "sinumerik"), (klartext, "heidenhain")):
        program = interpret(text, dialect=dialect)
        joins = [30 + (u - 30) * 10 / 12, -2 * 10 / 12]
        np.testing.assert_allclose(program.end[-4:, :2] * 1e3, [[u, 0], joins, [30, -10], [50, -10]], atol=1e-9)
        np.testing.assert_allclose(program.centre[-3, :2] * 1e3, [u, -2], atol=1e-9)
        assert program.clockwise[-4:].tolist() == [False, True, False, False]


def test_a_corner_behind_an_arc_is_that_before_it_gone_the_other_way() -> None:
    u = 30 - np.sqrt(12**2 - 2**2)
    arc = "L X50 Y-10 Z0 FMAX\nL X30 F100\nCC X30 Y0\nC X20 Y0 DR-\n"
    program = interpret(f"BEGIN PGM A MM\n{arc}RND R2\nL X0\nEND PGM A MM\n", dialect="heidenhain")
    joins = [30 + (u - 30) * 10 / 12, -2 * 10 / 12]
    np.testing.assert_allclose(program.end[-3:, :2] * 1e3, [joins, [u, 0], [0, 0]], atol=1e-9)
    np.testing.assert_allclose(program.centre[-2, :2] * 1e3, [u, -2], atol=1e-9)
    with pytest.raises(GCodeError, match="CHF is read between two straight cuts"):
        interpret(f"BEGIN PGM A MM\n{arc}CHF 2\nL X0\nEND PGM A MM\n", dialect="heidenhain")


def test_no_corner_is_where_a_cut_and_an_arc_go_on_tangentially() -> None:
    assert ends("G1 X20 ,R2 F100\nG3 X30 Y10 I0 J10 ,R2\nG1 Y20\n") == [[20, 0], [30, 10], [30, 20]]


@pytest.mark.parametrize(
    ("body", "says"),
    [
        ("G1 X20 ,R5 F100\nG0 Y20\n", "Line 4: a corner is rounded between two cuts"),
        ("G0 X20 ,R5\nY20\n", "Line 4: a corner is rounded at the end of a cut"),
        ("G1 X20 ,R5 F100\nY3\n", "Line 4: a corner takes 5.000 mm of both cuts, and one has 3.000 mm"),
        (
            "G1 X20 ,C5 F100\nG3 X30 Y10 R10\n",
            "Line 4: a corner is rounded between two cuts (G1, G2, G3), and chamfered",
        ),
        ("G1 X20 ,R50 F100\nG3 X30 Y-10 I10\n", "Line 4: a corner of radius 50.000 mm does not fit"),
        (
            "G1 X20 ,R2 F100\nG3 X30 Y-10 Z-1 I10\n",
            "Line 4: a corner beside an arc is rounded in the plane of that arc",
        ),
        (
            "G3 X10 Y10 I0 J10 ,R2 F100\nG18 G3 X20 Z0 I5 K0\n",
            "Line 4: a corner beside an arc is rounded in the plane of that arc",
        ),
        (
            "G3 X10 Y10 I0 J10 ,C2 F100\nG1 X50\n",
            "Line 4: a corner is rounded at the end of a cut (G1, G2, G3), or chamfered at that of a G1 alone",
        ),
        ("M8 ,C5\n", "Line 4: a corner is rounded at the end of a cut"),
        ("G68 X0 Y0\n", "Line 4: G68 is read in G17, with R"),
        ("G18 G68 X0 Z0 R90.\nG1 X5 F100\n", "Line 4: G68 is read in G17, with R"),
        ("G91 G68 X0 Y0 R90.\nG91\nG68 R5.\n", "Line 6: G68 in G91 inside of G68 turns to R or by R"),
        ("G68 X0 Y0 R30.\nG91 G68 R30.\n", "Line 5: G68 in G91 inside of G68 turns to R or by R"),
        ("G68 X0 Y0 Z0 I1 J0 K0 R90.\n", "Line 4: G68 with Z, I, J or K turns coordinates in space"),
        ("G18 G16\nZ5 F100\n", "Line 5: G16 is read in G17 alone"),
        ("G18 G16 X5 Z90\n", "Line 4: G16 is read in G17 alone"),
        ("G68 X0 Y0 R30\nG55\n", "Line 5: G55 while coordinates are shifted or turned"),
        ("G16\nG91 X5 Y10\n", "Line 5: G16 counts X from where the tool is in G91, which is not read"),
        ("G16\nG18\nX5 Y10\n", "Line 6: G16 is read in G17 alone"),
        ("G51 X0 Y0\n", "Line 4: G51 needs P"),
    ],
)
def test_what_cannot_be_is_refused(body: str, says: str) -> None:
    with pytest.raises(GCodeError) as caught:
        ends(body)
    assert says in str(caught.value)


def test_g68_turns_what_follows_about_its_centre_until_g69() -> None:
    """(x, y) goes to c + R(90)((x, y) - c): about (10, 0), (20, 0) to (10, 10) and (20, 5) to (5, 10)."""
    body = "G68 X10 Y0 R90\nG1 X20 Y0 F100\nY5\nG91 X10\nG90 G69\nX1 Y2\n"
    assert ends(body) == [[10, 10], [5, 10], [5, 20], [1, 2]]
    assert ends("G1 X3 Y4 F9\nG68 R180\nX4 Y4\nG69\nY0\n") == [[3, 4], [2, 4], [2, 0]]
    # plane and mode of its own line hold, as in Fanuc's "G17 G68 X Y R"
    assert ends("G18\nG91\nG90 G17 G68 X0 Y0 R90\nG1 X5 Y1 F9\n") == [[-1, 5]]
    arc = interpret(f"{HEAD}G68 X0 Y0 R90\nG2 X10 Y0 I5 J0 F9\nM30\n%\n", dialect="fanuc")
    np.testing.assert_allclose(arc.centre[-1, :2] * 1e3, [0, 5], atol=1e-9)


def test_g68_in_g91_has_its_centre_at_a_place() -> None:
    """Mitsubishi's manual, G68.1: the centre is "not handled as an incremental value"; from 0, by R is to R.

    From (10, 0) about (5, 0): a step of (3, 1) turned by 90 degrees is (-1, 3), and (20, 0) goes to (5, 15).
    """
    for said in ("G91 G68 X5 Y0 R90\n", "G91\nG68 X5 Y0 R90\n"):
        assert ends(f"G1 X10 Y0 F9\n{said}X3 Y1\nG90 X20 Y0\nG69\n") == [[10, 0], [9, 3], [5, 15]]
    # without a centre about where the tool is; in G90 inside of G68 it turns to R
    assert ends("G1 X3 Y4 F9\nG91 G68 R180\nX1\nG90 X3 Y5\n") == [[3, 4], [2, 4], [3, 3]]
    assert ends("G91 G68 X0 Y0 R30\nG90 G68 X0 Y0 R90\nG1 X5 Y0 F9\n") == [[0, 5]]


def test_g68_of_mach3_calls_its_centre_a_and_b() -> None:
    assert ends("G1 X1 Y1 F9\nG68 A10 B0 R90\nX20 Y0\nG69\nX0\n") == [[1, 1], [10, 10], [0, 10]]
    program = interpret(f"{HEAD}G1 X1 F9\nG68 A10 B5 R90\nG69\nM30\n%\n", dialect="fanuc")
    assert not program.rotary.any()


def test_g16_makes_x_a_radius_and_y_an_angle_until_g15() -> None:
    root = round(20 / np.sqrt(2), 6)
    assert ends("G16\nG1 X20 Y45 F100\nY90\nX10\nG15\nX5 Y6\n") == [[root, root], [0, 20], [0, 10], [5, 6]]
    holes = interpret(f"{HEAD}G0 Z9\nG90 G17 G16\nG81 X20 Y0 Z-5 R1 F100\nY90\nG80\nG15\nM30\n%\n", dialect="fanuc")
    bottoms = holes.end[np.isclose(holes.end[:, 2], -5e-3)] * 1e3
    np.testing.assert_allclose(bottoms[:, :2], [[20, 0], [0, 20]], atol=1e-9)


def test_g84_turns_the_spindle_by_itself() -> None:
    program = interpret(f"{HEAD}M29 S500\nG98 G84 X5 Y0 Z-8 R2 F500\nG80\nM30\n%\n", dialect="fanuc")
    tapped = program.thread & (program.n_s > 0)
    assert tapped.sum() == 2
    assert program.n_s[tapped] * 60 == pytest.approx([500, 500])
    assert [f.line for f in program.findings if f.code == "tap-turns"] == [5]


def test_polar_angles_in_g91_go_on_from_hole_to_hole() -> None:
    """The second example of Fanuc's manual (G16): three holes at 100 mm, 120 degrees apart, equally deep."""
    text = "G17 G90 G16\nG99 G81 X100. Y30. Z-20. R-5. F200.\nG91 Y120.\nY120.\nG15 G80\n"
    program = interpret(f"{HEAD}{text}M30\n%\n", dialect="fanuc")
    angles = np.radians([30, 150, 270])
    expected = np.column_stack([100 * np.cos(angles), 100 * np.sin(angles), np.full(3, -20)])
    np.testing.assert_allclose(program.end[program.kind == 1] * 1e3, expected, atol=1e-9)
