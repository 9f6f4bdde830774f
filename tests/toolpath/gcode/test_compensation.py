"""Cutter compensation by what it is for: the centre stays one radius beside the programmed path, on its side."""

from __future__ import annotations

import math

import numpy as np
import pytest
from scipy.optimize import brentq

from robomill.errors import GCodeError
from robomill.toolpath.gcode import Tool, interpret
from robomill.toolpath.gcode.chords import to_toolpath
from tests.toolpath.gcode.outlines import Outline, R, check, moves_of, random_outline


@pytest.mark.parametrize("code", ["G41.1", "G42.1"])
@pytest.mark.parametrize("seed", range(24))
def test_the_centre_is_one_radius_beside_the_path(code, seed):
    check(random_outline(seed, math.radians(60.0 if seed % 2 else 110.0)), code)


@pytest.mark.parametrize("code", ["G41.1", "G42.1"])
@pytest.mark.parametrize("heading", np.linspace(-math.pi, math.pi, 9))
@pytest.mark.parametrize("turn", [90.0, -90.0, 45.0, 180.0, -180.0, 0.0])
def test_corners_at_every_heading(code, heading, turn):
    for kinds in ("ll", "la", "al", "aa"):
        outline = Outline((1.0, 2.0), heading)
        for kind in kinds:
            outline.line(10.0) if kind == "l" else outline.arc(6.0, 1.2 if heading > 0 else -1.2)
            outline.heading += math.radians(turn)
        outline.line(10.0)
        if abs(turn) == 180.0 and kinds != "ll":
            continue
        check(outline, code)


def turned(points, angle, mirror):
    return (np.conj(points) if mirror else points) * np.exp(1j * angle)


def off_polygon(points, corners):
    """How far each of the complex points is from the nearest side of an open polygon."""
    a, way = corners[:-1], np.diff(corners)
    there = np.abs(way) > 0.0
    a, way = a[there], way[there]
    share = np.clip(((points[:, None] - a) * np.conj(way)).real / np.abs(way) ** 2, 0.0, 1.0)
    return np.abs(points[:, None] - a - share * way).min(axis=1)


@pytest.mark.parametrize("seed", range(8))
def test_a_turned_or_mirrored_program_is_the_turned_or_mirrored_path(seed):
    outline = random_outline(seed, math.radians(80.0))
    points, line = moves_of(outline.program("G41.1"))
    for angle, mirror in ((0.7, False), (2.5, False), (-2.0, False), (0.0, True), (1.3, True)):
        other = Outline((0.0, 0.0), 0.0)
        for kind, start, end, centre, side in outline.pieces:
            centre = None if centre is None else turned(centre, angle, mirror)
            other.pieces.append(
                (kind, turned(start, angle, mirror), turned(end, angle, mirror), centre, -side if mirror else side)
            )
        other.at = other.pieces[-1][2]
        sign = -1 if mirror else 1
        other.heading = sign * outline.heading + angle
        found, at = moves_of(other.program("G42.1" if mirror else "G41.1"))
        assert at[at != np.roll(at, 1)].tolist() == line[line != np.roll(line, 1)].tolist()
        for number in set(line[1:]):
            expected = turned(points, angle, mirror)
            a, b = (np.flatnonzero(where == number) for where in (at, line))
            assert found[a[-1]] == pytest.approx(expected[b[-1]], abs=1e-7)
            corners = expected[np.append(b[0] - 1, b)]
            assert off_polygon(found[a], corners).max() < 2.1e-5  # of the chords of 2e-5 mm


def test_a_change_of_units_on_the_way_changes_nothing():
    """The same outline, from a line or an arc on in inches."""
    lines = [
        "G41.1 D4",
        "G1 X10 Y-2",
        "X30",
        "G2 X40 Y-12 J-10",
        "G1 Y-30",
        "G3 X50 Y-40 I10",
        "G1 X70",
        "G40",
        "G1 X80",
    ]

    def read(switch):
        out = []
        for i, line in enumerate(lines):
            words = line.split()
            if i >= switch:
                words = [w if w[0] == "G" else f"{w[0]}{float(w[1:]) / 25.4:.15g}" for w in words]
            out.append(("G20 " if i == switch else "") + " ".join(words))
        return to_toolpath(interpret("G21 G90 F100\nG0 X0 Y0 Z0\n" + "\n".join(out) + "\nM2\n")).p

    whole = read(99)
    for switch in range(2, 9):
        np.testing.assert_allclose(read(switch), whole, atol=1e-9)


def back(kind, turn):
    """How far before an inside corner (rad along an arc, mm along a line) the cutter touches both of its sides: its
    centre is one radius beside the next line, which begins at (radius, 0) of an arc about the origin."""
    if kind == "line":
        return R * math.tan(0.5 * turn)
    radius, way = (6.0, 1) if kind == "towards" else (6.0, -1)  # an arc that bends towards the cutter's side, or away
    normal = np.exp(1j * (turn + (math.pi if way > 0 else 0.0)))

    def beside(phi):
        centre = (radius - way * R) * np.exp(-1j * way * phi)
        return ((centre - radius) * np.conj(normal)).real - R

    return brentq(beside, 0.0, turn)


@pytest.mark.parametrize("code", ["G41.1", "G42.1"])
@pytest.mark.parametrize("kind", ["line", "towards", "away"])
@pytest.mark.parametrize("turn", [0.4, 1.0, 1.4])
def test_a_cutter_that_does_not_fit_into_a_corner_is_refused(code, kind, turn):
    """The piece before the corner is a little longer, or shorter, than the cutter needs."""
    side = 1 if code == "G41.1" else -1
    for fits in (True, False):
        outline = Outline((1.0, 2.0), 0.3)
        outline.line(10.0)
        need = back(kind, turn)
        if kind == "line":
            outline.heading -= side * 0.6  # an outside corner, so that the line begins where it is
            outline.line(need + (0.05 if fits else -0.05))
        else:
            outline.arc(6.0, side * (1 if kind == "towards" else -1) * (need + (0.03 if fits else -0.03)))
        outline.heading += side * turn
        outline.line(10.0)
        if fits:
            check(outline, code)
        else:
            with pytest.raises(GCodeError, match="does not fit") as refused:
                interpret(outline.program(code))
            assert refused.value.line == 7


#: Noses of lathe tools as the handbook draws them: which way the programmed point lies from the centre (z, x).
NOSES = {1: (1, -1), 2: (-1, -1), 3: (-1, 1), 4: (1, 1), 5: (1, 0), 6: (0, -1), 7: (-1, 0), 8: (0, 1), 9: (0, 0)}


@pytest.mark.parametrize("orientation", NOSES)
def test_a_lathe_tools_point_stands_beside_the_centre_of_its_nose(orientation):
    lines = "G1 X10 Z0\nZ-20\nG2 X15 Z-25 I5\nG1 X30\nG40\nG1 X40 Z5\nM2\n"

    def read(number):
        program = interpret(f"G21 G90 G18 F100\nG0 X10 Z20\nG42.1 D1.6 L{number}\n{lines}")
        return program.end[1:5, [2, 0]] * 1e3

    np.testing.assert_allclose(
        read(orientation) - read(0), np.broadcast_to(0.8 * np.array(NOSES[orientation]), (4, 2)), atol=1e-9
    )


@pytest.mark.parametrize("orientation", NOSES)
def test_a_lathe_tool_that_enters_by_an_arc_first_goes_straight_to_where_its_point_stands(orientation):
    """Then along the same arc, whole, beside that of a tool without an orientation."""

    def read(number):
        lines = "G2 X20 Z10 I10 K0\nG1 Z-20\nG40\nG1 X40 Z-25\nM2\n"
        program = interpret(f"G21 G90 G18 F100\nG0 X10 Z20\nG42.1 D1.6 L{number}\n{lines}")
        return program.line[1:], program.start[1:, [2, 0]] * 1e3, program.end[1:, [2, 0]] * 1e3

    (plain_line, plain_start, plain_end), (line, start, end) = read(0), read(orientation)
    shift = 0.8 * np.array(NOSES[orientation])
    more = len(line) - len(plain_line)
    assert more == shift.any()
    compensated = plain_line < 7
    np.testing.assert_allclose(end[more:][compensated], plain_end[compensated] + shift, atol=1e-9)
    np.testing.assert_allclose(start[more], plain_start[0] + shift, atol=1e-9)
    np.testing.assert_allclose(start[0], [20.0, 10.0], atol=1e-9)


def test_a_cutter_turns_back_outside_of_an_arc_and_is_refused_inside():
    """Along an arc and back: about its end from one side of it to the other, or into the corner between the two."""
    lines = "G1 X10 Y0\nG3 X0 Y10 I-10 J0\nG2 X10 Y0 I0 J-10\nG40\nG1 X30\nM2\n"
    program = interpret(f"G21 G90 G17 F600\nG0 X10 Y-8\nG42.1 D2\n{lines}")
    np.testing.assert_allclose(program.end[1:5, :2] * 1e3, [[11, 0], [0, 11], [0, 9], [9, 0]], atol=1e-9)
    with pytest.raises(GCodeError, match="about one centre") as refused:
        interpret(f"G21 G90 G17 F600\nG0 X10 Y-8\nG41.1 D2\n{lines}")
    assert refused.value.line == 6


@pytest.mark.parametrize("code", ["G41.1", "G42.1"])
@pytest.mark.parametrize(("radius", "fits"), [(0.9, False), (1.0, False), (1.2, True)])
@pytest.mark.parametrize("first", [True, False])
def test_an_arc_that_turns_about_the_cutters_side_is_larger_than_the_cutter(code, radius, fits, first):
    """On line 4 where the arc is the first compensated move, else on line 5."""
    way = 1 if code == "G41.1" else -1
    lead = "" if first else "G1 X0 Y0\n"
    start = "G0 X0 Y0" if first else "G0 X-8 Y0"
    text = (
        f"G21 G90 G17 F600\n{start}\n{code} D2\n{lead}"
        f"G{3 if way > 0 else 2} X0 Y{2 * way * radius} I0 J{way * radius}\nG40\nG1 X-20\nM2\n"
    )
    if fits:
        assert len(interpret(text).end)
    else:
        with pytest.raises(GCodeError, match="not larger than the cutter") as refused:
            interpret(text)
        assert refused.value.line == 4 + (not first)


@pytest.mark.parametrize("code", ["G41", "G42"])
def test_a_cutter_without_a_diameter_goes_on_the_path_and_is_noted(code):
    moves = "G1 X0 Y0\nX20\nY10\nG2 X10 Y20 I-5 J5\nG40\nG1 X0 Y40\nM2\n"
    plain = interpret(f"G21 G90 F600\nG0 X-8 Y0\n\n{moves}")
    found = interpret(f"G21 G90 F600\nG0 X-8 Y0\n{code}.1 D0\n{moves}")
    np.testing.assert_allclose(found.end[-6:], plain.end[-6:], atol=1e-12)
    assert [(note.level, note.line) for note in found.findings if note.code == "zero-diameter"] == [("warning", 3)]


@pytest.mark.parametrize("code", ["G41", "G42"])
@pytest.mark.parametrize("orientation", range(10))
def test_only_a_lathe_tool_is_held_to_its_plane(code, orientation):
    """0 and 9 are tools whose programmed point is the centre: they go in both planes."""
    tools = {1: Tool(1, 2e-3, (0.0, 0.0, 0.0), orientation)}
    text = f"G21 G90 F100\nT1 M6\nG{{}}\n{code}\nG1 X{{}}\nX40\nM2\n"
    assert len(interpret(text.format(18, 20), tools=tools).end)
    if orientation in (0, 9):
        assert len(interpret(text.format(17, 20), tools=tools).end)
    else:
        with pytest.raises(GCodeError, match=rf"^Line 4: {code} with a lathe tool works in the plane G18 only\.$"):
            interpret(text.format(17, 20), tools=tools)
    with pytest.raises(GCodeError, match=rf"^Line 4: {code} works in the planes G17 and G18 only\.$"):
        interpret(text.format(19, 20), tools=tools)


@pytest.mark.parametrize("number", ["1.001", "0.9", "-1"])
def test_the_cutter_is_named_by_the_number_of_a_tool(number):
    tools = {1: Tool(1, 2e-3)}
    with pytest.raises(GCodeError, match=rf"^Line 3: G41 has D{number}; expected the number of a tool\.$"):
        interpret(f"G21 G90 F100\nT1 M6\nG41 D{number}\nG1 X20\nM2\n", tools=tools)
    named = interpret("G21 G90 F100\nT1 M6\nG41 D1\nG1 X20\nX40\nM2\n", tools=tools)
    np.testing.assert_array_equal(named.end, interpret("G21 G90 F100\nT1 M6\nG41\nG1 X20\nX40\nM2\n", tools=tools).end)
    with pytest.raises(GCodeError, match=r"^Line 3: tool 7 is not in the tool table; add it\.$"):
        interpret("G21 G90 F100\nT1 M6\nG41 D7\nG1 X20\nM2\n", tools=tools)
    with pytest.raises(GCodeError, match=r"^Line 3: G41 needs the diameter of tool 1; give a tool table\.$"):
        interpret("G21 G90 F100\nT1 M6\nG41\nG1 X20\nM2\n")


@pytest.mark.parametrize("dialect", ["auto", "fanuc", "sinumerik"])
def test_a_tool_whose_table_does_not_say_its_diameter_is_none_to_compensate_with(dialect):
    """As without a table; LinuxCNC takes a D that is not written for 0, and a D of 0 is a program of the centre."""
    text = f"G21 G90 G17 F100\nT1{' D1' * (dialect == 'sinumerik')} M6\nG41\nG1 X20\nX40\nM2\n"
    with pytest.raises(GCodeError, match=r"^Line 3: G41 needs the diameter of tool 1; write it into the tool table\.$"):
        interpret(text, dialect=dialect, tools={1: Tool(1, sized=False)})
    text = text.replace(" D1", "")
    assert interpret(text, dialect="linuxcnc", tools={1: Tool(1, sized=False)}).end[-1, 0] == pytest.approx(40e-3)
    assert interpret(text, dialect="auto", tools={1: Tool(1)}).end[-1, 0] == pytest.approx(40e-3)


def test_g10_says_the_diameter_that_the_table_does_not():
    text = "G21 G90 G17 F100\nG10 L1 P1 {}\nT1 M6\nG41\nG1 X20\nX40\nM2\n"
    for tools in (None, {1: Tool(1, sized=False)}):
        with pytest.raises(GCodeError, match="G41 needs the diameter of tool 1"):
            interpret(text.format("Z5"), tools=tools)
        assert interpret(text.format("R5"), tools=tools).end[-1, 1] == pytest.approx(5e-3)


def test_g10_l12_and_l13_of_a_fanuc_are_a_radius_and_its_wear() -> None:
    text = "G21 G90 F9\n{}G0 X0 Y-20.\nG1 G41 D1 X0 Y0\nY50.\nG40 X-20.\nM30\n"
    for words, x in (("G10 L12 P1 R5.\n", -5), ("G10 L12 P1 R5.\nG10 L13 P1 R-.5\n", -4.5)):
        assert interpret(text.format(words), dialect="fanuc").end[1, 0] * 1e3 == pytest.approx(x)


@pytest.mark.parametrize("code", ["G41.1", "G42.1"])
@pytest.mark.parametrize("heading", np.linspace(-math.pi, math.pi, 11)[1:])
def test_lines_meet_arcs_at_every_heading(code, heading):
    for turn in (1.2, -1.2):
        for bend in (1.2, -1.2):
            for kinds in ("la", "aa"):
                outline = Outline((1.0, 2.0), heading)
                for kind in kinds:
                    outline.line(10.0) if kind == "l" else outline.arc(6.0, bend)
                    outline.heading += turn
                outline.line(10.0)
                check(outline, code)


@pytest.mark.parametrize("seed", range(4))
def test_the_path_in_another_plane_is_the_same_path(seed):
    """Z for X, X for Y and the height along Y, as G18 (ZX) has them."""
    outline = random_outline(seed, math.radians(80.0))
    text = outline.program("G42.1").replace(" Z0", "")
    lines = [f"{line} Z{-k}" if line[:2] in ("G1", "G2", "G3") else line for k, line in enumerate(text.splitlines())]
    other = [line.translate(str.maketrans("XYZIJ", "ZXYKI")).replace("G17", "G18") for line in lines]
    flat, upright = (interpret("\n".join(each) + "\n") for each in (lines, other))
    np.testing.assert_allclose(upright.end[:, [2, 0, 1]], flat.end, atol=1e-12)
    np.testing.assert_allclose(upright.sweep, flat.sweep, atol=1e-9)
    arcs = flat.kind == 2
    np.testing.assert_allclose(upright.centre[arcs][:, [2, 0]], flat.centre[arcs][:, :2], atol=1e-12)


@pytest.mark.parametrize("code", ["G41.1", "G42.1"])
@pytest.mark.parametrize(("angle", "arcs"), [(0.045, 0), (0.055, 1)])
def test_a_bend_of_a_twentieth_of_a_radian_is_a_corner(code, angle, arcs):
    """As LinuxCNC has it (TOLERANCE_CONCAVE_CORNER)."""
    outline = Outline((1.0, 2.0), 0.4)
    outline.line(10.0)
    outline.heading += angle * (-1 if code == "G41.1" else 1)
    outline.line(10.0)
    assert (interpret(outline.program(code)).kind == 2).sum() == arcs


@pytest.mark.parametrize("corner", [",R2.54", ",C2.54"])
def test_a_change_of_units_behind_a_corner_that_waits_for_its_second_cut_changes_nothing(corner: str) -> None:
    text = "G21 G90 F254.\nG0 X0 Y-20. Z0 A0\nG41 D1 G1 X0 Y0\nY50.8 A7. {corner}\n{unit}X{x}\nG40 X{far}\nM30\n"
    tools = {1: Tool(1, 10e-3)}
    plain = interpret(text.format(corner=corner, unit="", x="50.8", far="101.6"), dialect="fanuc", tools=tools)
    inch = interpret(text.format(corner=corner, unit="G20\n", x="2.", far="4."), dialect="fanuc", tools=tools)
    np.testing.assert_allclose(inch.end, plain.end, atol=1e-9)
    np.testing.assert_allclose(inch.rotary, plain.rotary, atol=1e-12)
    np.testing.assert_allclose(inch.v_f, plain.v_f)
    np.testing.assert_allclose(inch.sweep, plain.sweep)
