"""The rules of motion against closed forms and against symmetries: units, distance modes, planes, R versus I J K."""

from __future__ import annotations

import contextlib
import math

import numpy as np
import pytest

from robomill.errors import GCodeError
from robomill.toolpath.gcode import Program, interpret
from robomill.toolpath.gcode.chords import to_toolpath
from robomill.toolpath.gcode.rules.motion_rules import straight_length

# G17 written in another plane: x, y, z become first, second and third axis.
PERMUTED = {17: "XYZIJK", 18: "ZXYKIJ", 19: "YZXJKI"}
PROGRAM = """G0 X3 Y-2 Z5
G1 Z-1 F300
G1 X7.5 Y4
G2 X12 Y-1 I1.25 J-4.75
G3 X10 Y2 Z-2 R3
G3 X9 Y3 R-6
G2 I2 J1 Z-4 P2
G1 X0 Y0"""


def ends(text: str) -> Program:
    return interpret(text + "\nM2\n")


def in_letters(text: str, letters: str) -> str:
    return text.translate({ord(a): b for a, b in zip("XYZIJK", letters)})


@pytest.mark.parametrize("plane", PERMUTED)
def test_planes_are_the_same_geometry_on_other_axes(plane: int) -> None:
    flat, turned = ends("G21 G17\n" + _circles()), ends(f"G21 G{plane}\n" + in_letters(_circles(), PERMUTED[plane]))
    order = [("XYZ").index(letter) for letter in PERMUTED[plane][:3]]
    for name in ("start", "end", "centre"):
        assert getattr(turned, name)[:, order] == pytest.approx(getattr(flat, name), abs=1e-15), name
    assert turned.sweep == pytest.approx(flat.sweep, abs=1e-12)
    assert turned.length == pytest.approx(flat.length, rel=1e-12)
    assert np.array(turned.extents)[:, order] == pytest.approx(np.array(flat.extents), abs=1e-15)


def _circles() -> str:
    return "G0 X3 Y-2 Z5 F300\nG2 X5 Y0 I2 J0\nG3 X5 Y4 Z3 R2.5\nG3 X1 Y4 R-4\nG2 I2 J1 Z-4 P2\nG3 X1 Y2 Z1 I0 J-1 P3"


def test_inches_are_scaled_millimetres() -> None:
    metric = ends("G21\n" + _circles())
    words = [
        "".join(f"{word[0]}{float(word[1:]) / 25.4:.12f} " if word[0] in "XYZIJRF" else word + " " for word in line)
        for line in map(str.split, _circles().splitlines())
    ]
    imperial = ends("G20\n" + "\n".join(words))
    for name in ("end", "centre", "sweep", "v_f", "length"):
        assert getattr(imperial, name) == pytest.approx(getattr(metric, name), abs=1e-9), name


def test_a_change_of_units_moves_nothing() -> None:
    program = ends("G21 G0 X25.4 Y50.8\nG20\nF10 G1 Z-1\nG1 X2\nG91 X1\nG21 X25.4")
    assert program.end[:, 0] * 1e3 == pytest.approx([25.4, 25.4, 50.8, 76.2, 101.6])
    assert program.v_f[1:] * 60e3 == pytest.approx(254)


@pytest.mark.parametrize("third", ["", " Z3 A2 B-3 C4"])
def test_incremental_arcs_end_where_absolute_ones_do(third: str) -> None:
    absolute = ends(f"G21 F60 G0 X1 Y2\nG2 X4 Y5 I3 J0{third}\nG1 X0 Y1")
    incremental = ends(f"G21 F60 G0 X1 Y2\nG91 G2 X3 Y3 I3 J0{third}\nG1 X-4 Y-4")
    centred = ends(f"G21 F60 G0 X1 Y2\nG90.1 G2 X4 Y5 I4 J2{third}\nG91.1 G1 X0 Y1")
    for other in (incremental, centred):
        for name in ("end", "centre", "rotary", "sweep"):
            assert getattr(other, name) == pytest.approx(getattr(absolute, name), abs=1e-12), name


def test_an_arc_that_lacks_a_hair_of_a_full_turn_is_one() -> None:
    for code, y in (("G2", "1e-10"), ("G3", "-1e-10")):
        y = f"{float(y):.12f}"
        program = ends(f"G21 F60\n{code} X0 Y{y} I-5")
        assert abs(program.sweep[0]) == pytest.approx(2 * math.pi), code


@pytest.mark.parametrize("code", ["G2", "G3"])
@pytest.mark.parametrize("radius", [2.6, -2.6, 9.0, -9.0, 2.5, 2.4995, -2.4995])
@pytest.mark.parametrize("end", [(3.0, 4.0), (-5.0, 0.0), (0.0, -5.0), (4.0, -3.0)])
def test_a_radius_puts_the_centre_at_its_distance_on_the_right_side(
    code: str, radius: float, end: tuple[float, float]
) -> None:
    program = ends(f"G21 F60 G0 X1 Y1\n{code} X{1 + end[0]} Y{1 + end[1]} R{radius}")
    start, stop, centre = (getattr(program, name)[1, :2] * 1e3 for name in ("start", "end", "centre"))
    size = max(abs(radius), 2.5)
    assert math.dist(start, centre) == pytest.approx(size, abs=1e-6)
    assert math.dist(stop, centre) == pytest.approx(size, abs=1e-6)
    assert (program.sweep[1] > 0) == (code == "G3")
    minor = 2 * math.asin(2.5 / size)
    assert abs(program.sweep[1]) == pytest.approx(minor if radius > 0 else 2 * math.pi - minor, abs=1e-6)


def refused(text: str) -> bool:
    try:
        ends(text)
    except GCodeError:
        return True
    return False


@pytest.mark.parametrize(
    ("unit", "radius", "allowed"),
    [
        ("G21", 5.0, 0.02 * math.sqrt(2)),  # the flat figure
        ("G21", 1000.0, 1.0),  # a thousandth of the radius
        ("G21", 5000.0, 2 * math.sqrt(2)),  # a hundred times the flat figure
        ("G20", 0.5, 0.002 * math.sqrt(2)),
        ("G20", 50.0, 0.05),
        ("G20", 900.0, 0.2 * math.sqrt(2)),
    ],
)
def test_radii_may_differ_by_what_is_stated(unit: str, radius: float, allowed: float) -> None:
    for share, expected in ((0.99, False), (1.01, True)):
        longer = radius - share * allowed  # end nearer than start, the larger radius is known
        assert refused(f"{unit} F60\nG3 X{radius - longer:.9f} Y0 I{radius} J0") == expected
        text = f"{unit} F60\nG3 X{radius:.9f} Y{longer:.9f} I{radius:.9f} J0"
        assert refused(text) == expected


@pytest.mark.parametrize(("unit", "least"), [("G21", 0.00127), ("G20", 0.00005)])
def test_no_radius_and_radii_that_fall_short(unit: str, least: float) -> None:
    for share, expected in ((0.98, True), (1.02, False)):
        assert refused(f"{unit} F60\nG3 I{share * least:.9f}") == expected
        half = 1.0 + share * least
        assert refused(f"{unit} F60\nG3 X{2 * half:.9f} R1") != expected
    assert refused(f"{unit} F60\nG3 X1 R0")


def test_inverse_time_takes_the_minutes_that_it_says() -> None:
    text = (
        "G21 G93 G0 X1 Y1\nG1 X4 Y5 Z12 F2\nG3 X4 Y5 I2 J0 Z9 F4\nG2 X2 Y3 I-2 J0 F0.5\nG1 A10 B3 C-4 F2\nG1 X9 A20 F1"
    )
    program = ends(text)
    assert program.v_f[0] == 0
    f = np.array([2, 4, 0.5])
    assert program.length[1:4] / program.v_f[1:4] == pytest.approx(60 / f)
    assert program.v_f[4] * 60e3 == pytest.approx(math.hypot(10, 3, 4) * 2)  # degrees count where only they change
    assert program.v_f[5] * 60e3 == pytest.approx(7)
    assert ends("G21 G93\nG1 X0.001 F1").v_f[0] * 60e3 == pytest.approx(0.1)  # never slower than this
    with pytest.raises(GCodeError, match="F word on its line"):
        ends("G21 G93\nG1 X1 F1\nX2")


def test_feed_per_turn_and_speeds() -> None:
    program = ends("G21 G95 S120 M3 F0.5\nG1 X1\nG94 F90 X2\nS600 X3\nM5 X4\nG96 S100 D300 M3\nX5\nG97 S60 X6")
    assert program.v_f * 60e3 == pytest.approx([60, 90, 90, 90, 90, 90])
    assert program.n_s == pytest.approx([2, 2, 10, 0, math.nan, 1], nan_ok=True)  # at constant surface speed unknown
    for text, says in (("G95 S0\nG1 X1 F1", "spindle speed"), ("G95 S9\nG1 X1", "feed rate"), ("G1 X1", "feed rate")):
        with pytest.raises(GCodeError, match=says):
            ends("G21 " + text)


def test_frames_add_up() -> None:
    text = "G55 G0 X1 Y2 Z3 A1\nG92 X0 Y0 Z0 A0 B0 C0\nG1 X4 Y-1 Z2 A2 B3 C4\nG2 X6 I1"
    program = ends("G21 F60 G10 L2 P2 X10 Y20 Z30 A5 B6 C7 R30\n" + text)
    c, s = math.cos(math.radians(30)), math.sin(math.radians(30))
    turn, origin, here = np.array([[c, -s], [s, c]]), np.array([10, 20]), np.array([1, 2])
    for row, shift, point, z in ((0, 0, (1, 2), 33), (1, here, (4, -1), 35), (2, here, (6, -1), 35)):
        assert program.end[row] * 1e3 == pytest.approx([*(turn @ (np.array(point) + shift) + origin), z])
    assert program.centre[2] * 1e3 == pytest.approx([*(turn @ (np.array((5, -1)) + here) + origin), 35])
    # B and C stood at -6 and -7 of the system when they were called 0, A at 1.
    assert np.degrees(program.rotary) == pytest.approx(np.array([[6, 0, 0], [8, 3, 4], [8, 3, 4]]), abs=1e-9)
    assert program.rotary0[1:] == pytest.approx(program.rotary[:-1])
    assert program.start[1:] == pytest.approx(program.end[:-1])
    with pytest.raises(GCodeError, match="in no plane"):
        ends("G21 F60 G10 L2 P1 R5\nG18\nG2 X2 I1")


def test_modal_words_go_on() -> None:
    program = ends("G21 F60\nG2 X2 I1\nI1\nX4 I1\nG1 X5\nX6\nG0 X7\nX8\nF30\nG1")
    assert program.kind.tolist() == [2, 2, 2, 1, 1, 0, 0, 1]
    assert program.end[:, 0] * 1e3 == pytest.approx([2, 2, 4, 5, 6, 7, 8, 8])
    assert abs(program.sweep[:3]) == pytest.approx([math.pi, 2 * math.pi, math.pi])
    assert program.v_f[[0, -1]] * 60e3 == pytest.approx([60, 30])


def test_a_tap_goes_down_and_comes_back() -> None:
    program = ends("G21 S120 M3 G0 X1 Z2 A9\nG33.1 Z-4 K1.5\nG0 X3\nG33 Z-2 K0.5")
    assert program.end[:, 2] * 1e3 == pytest.approx([2, -4, 2, -2])
    assert program.start[:, 2] * 1e3 == pytest.approx([0, 2, 2, 2])
    assert np.degrees(program.rotary[:, 0]) == pytest.approx([9, 9, 9, 9])
    assert program.v_f * 1e3 == pytest.approx([0, 3, 0, 1])
    assert program.length[1] * 1e3 == pytest.approx(12)


def test_tools_and_lines_are_noted() -> None:
    program = ends("G21 F60\nG0 X1\nT3 M6\n\nG0 X2\nG2 X3 I0.5\nT4 M6 G0 X4")
    assert program.tool.tolist() == [0, 3, 3, 4]
    assert program.line.tolist() == [2, 5, 6, 7]


@pytest.mark.parametrize("fast", [False, True])
@pytest.mark.parametrize(
    "text",
    [
        "G93 G1 X1e F1",
        "G93 G1 X{huge} F1\nG2 X0 I5 F1",
        "G2 I1 P{huge} F9",
        "T{huge} M6 G0 X1",
        "G0 A{huge}\nG1 A-{huge} F9",
        "F{huge} G1 X5",
        "G2 X{huge} R{huge} F9",
        "G10 L2 P1 R{huge}\nG0 X{huge}",
    ],
)
def test_huge_numbers_are_read_or_refused(text: str, fast: bool, monkeypatch: pytest.MonkeyPatch) -> None:
    if fast:
        for name in ("LONG", "LOADED_LONG"):
            monkeypatch.setattr(f"robomill.toolpath.gcode.stretches.{name}", 0)
    for huge in ("9" * 15, "9" * 40, "9" * 308):
        with contextlib.suppress(GCodeError):
            path = to_toolpath(ends("G21 F1\n" + text.format(huge=huge)))
            assert np.isfinite(path.p).all()
            assert np.isfinite(path.v_f).all()


def test_a_feed_counts_along_the_way_of_the_tip_else_of_the_turning_axes() -> None:
    rng = np.random.default_rng(3)
    for moved in ([1, 1, 1, 1, 1, 1], [1, 0, 0, 0, 0, 0], [0, 1, 0, 1, 1, 0], [0, 0, 1, 0, 0, 0]):
        p, step = rng.normal(size=(2, 6))
        step *= moved
        assert straight_length(p, p + step) == pytest.approx(np.linalg.norm(step[:3]))
        assert straight_length(p, p + step * [0, 0, 0, 1, 1, 1]) == pytest.approx(np.linalg.norm(step[3:]))
        for tip in np.eye(6)[:3]:
            for small, counted in ((0.9e-7, np.linalg.norm(step[3:])), (1.1e-7, 1.1e-7)):
                start = np.concatenate([[0.0] * 3, p[3:]])
                for way in (1, -1):
                    end = start + step * [0, 0, 0, 1, 1, 1] + way * small * tip
                    assert straight_length(start, end) == pytest.approx(counted, rel=1e-6)


def test_what_is_allowed_is_a_share_of_the_larger_radius() -> None:
    """Radii of 1000 and 999 mm: a thousandth of the first, and a little more than that of the second."""
    for start, end in ((1000.0, 999.0), (999.0, 1000.0)):
        for off, expected in ((1e-4, False), (-5e-4, True)):  # nearer to one another, farther apart
            a, b = (start, end + off) if start > end else (start + off, end)
            assert refused(f"G21 F60\nG3 X{a:.9f} Y{b:.9f} I{a:.9f} J0") == expected


@pytest.mark.parametrize("plane", PERMUTED)
@pytest.mark.parametrize(("said", "centre"), [("X6", (3, 0)), ("Y8", (0, 4)), ("X6 Y8", (3, 4)), ("Z1", None)])
def test_half_a_turn_by_its_radius_says_either_place_of_its_plane_or_both(
    plane: int, said: str, centre: tuple[float, float] | None
) -> None:
    """From 0 the centre of half a turn is half-way to its end; without any place in the plane there is none."""
    radius = math.hypot(*(centre or (1.0, 0.0)))
    text = f"G21 F100 G{plane}\nG0 X0 Y0 Z0\nG2 {in_letters(said, PERMUTED[plane])} R{radius}"
    if centre is None:
        with pytest.raises(GCodeError, match="Line 3"):
            ends(text)
        return
    first, second = (("XYZ").index(letter) for letter in PERMUTED[plane][:2])
    np.testing.assert_allclose(ends(text).centre[-1][[first, second]] * 1e3, centre, atol=1e-6)


def test_dwells_are_counted_and_added_up() -> None:
    """Two of their own, and one at the bottom of each of three holes."""
    program = ends("G21 F100\nG4 P1\nG4 P2.5\nG82 X1 Z-1 R1 P0.25\nX2\nX3")
    assert program.dwells == 5
    assert program.dwell_time == pytest.approx(1 + 2.5 + 3 * 0.25)
