"""Where compensation of the cutter begins and ends: entries by lines and arcs, what they need, and their images."""

from __future__ import annotations

import math

import numpy as np
import pytest

from robomill.errors import GCodeError
from robomill.toolpath.gcode import Tool, interpret
from tests.toolpath.gcode.outlines import R, xy

ENTRIES = {  # where the cutter of 10 mm stands as the cut of the wall x = 0 begins, and where it meets the next wall
    "fanuc": "G21 G90 G17 T1 M6 F100\nG0 X{x} Y{y} Z0\nG41 D1 G1 X0 Y0\n{down}Y50\nX50\nG40 X80\nM30\n",
    "sinumerik": "G71 G90 G17 T1 D1 F100\nM6\nG0 X{x} Y{y} Z0\nG41 G1 X0 Y0\n{down}Y50\nX50\nG40 X80\nM30\n",
    "heidenhain": "BEGIN PGM A MM\nTOOL CALL 1 Z\nF9\nL X{x} Y{y} Z0 FMAX\nL X0 Y0 RL\n{down}L Y50\nL X50\nL X80 R0\n",
}


@pytest.mark.parametrize("dialect", ENTRIES)
@pytest.mark.parametrize("start", [(-20, 0), (-20, -20), (0, -20), (20, -20), (20, 0), (-2, -1)])
@pytest.mark.parametrize("down", ["", "{L}Z-3\n"])
def test_the_entry_ends_square_beside_the_start_of_the_contour(dialect: str, start, down: str) -> None:
    """Fanuc type A, Sinumerik NORM and Heidenhain RL: wherever it comes from, and with a plunge in between."""
    text = ENTRIES[dialect].format(x=start[0], y=start[1], down=down.format(L="L " if dialect == "heidenhain" else ""))
    program = interpret(text, dialect=dialect, tools={1: Tool(1, 10e-3)})
    places = [tuple(row) for row in (np.round(program.end[:, :2] * 1e3, 9) + 0.0).tolist()]
    cuts = places[[tuple(p) for p in places].index((-5.0, 0.0)) :]
    assert cuts[-4:] == [(-5, 50), (0, 55), (50, 55), (80, 50)]
    assert cuts[:-4] == [(-5, 0)] * (2 if down else 1)


def test_the_entry_before_an_arc_ends_square_to_its_start() -> None:
    text = "G21 G90 G17 T1 M6 F100\nG0 X-20 Y-20 Z0\nG42 D1 G1 X0 Y0\nG3 X20 Y20 I0 J20\nG40 G1 X40\nM30\n"
    program = interpret(text, dialect="fanuc", tools={1: Tool(1, 10e-3)})
    np.testing.assert_allclose(program.end[1:3, :2] * 1e3, [[0, -5], [25, 20]], atol=1e-9)


def test_compensation_said_once_more_changes_nothing() -> None:
    text = "G21 G90 G17 T1 M6 F100\nG0 X0 Y-20 Z0\nG41 D1 G1 X0 Y0\nG41 Y50\n{}G40 X-30\nM30\n"
    tools = {1: Tool(1, 10e-3), 2: Tool(2, 8e-3)}
    program = interpret(text.format(""), dialect="fanuc", tools=tools)
    np.testing.assert_allclose(program.end[1:, :2] * 1e3, [[-5, 0], [-5, 50], [-30, 50]], atol=1e-9)
    for other in ("G42 Y60\n", "G41 D2 Y60\n"):
        with pytest.raises(GCodeError, match="Line 5: G4[12] changes the side or the cutter without G40"):
            interpret(text.format(other), dialect="fanuc", tools=tools)


TURNED = "T1 D1 M6\n{0}\nG0 X0 Y-20\nG41 G1 X0 Y0\nY50\nX50\nG40 Y-20\nM30\n"


def test_g451_goes_on_to_where_the_offset_cuts_meet() -> None:
    """Sinumerik: a cutter of 10 mm beside the corner (0, 50), 90 degrees outside: (-5, 55), and no arc."""
    tools = {1: Tool(1, 10e-3)}
    head = "G71 G90 G17 F100\n"
    sharp = interpret(head + TURNED.format("G451"), dialect="sinumerik", tools=tools)
    np.testing.assert_allclose(sharp.end[1:, :2] * 1e3, [[-5, 0], [-5, 55], [50, 55], [50, -20]], atol=1e-9)
    assert not (sharp.kind == 2).any()
    for words in ("G450", "G451\nG450", ""):
        around = interpret(head + TURNED.format(words), dialect="sinumerik", tools=tools)
        assert (around.kind == 2).sum() == 1
    slant = "T1 D1 M6\nG451\nG0 X-20\nG42 G1 X0\nX50\nX100 Y50\nG40 Y80\nM30\n"
    corner = interpret(head + slant, dialect="sinumerik", tools=tools).end[2, :2] * 1e3
    np.testing.assert_allclose(corner, [50 + 5 * np.tan(np.radians(22.5)), -5], atol=1e-9)
    arc = "T1 D1 M6\nG451\nG0 X-20\nG42 G1 X0\nX50\nG3 X60 Y30 CR=30\nG40 G1 Y80\nM30\n"
    with pytest.raises(GCodeError, match="Line 7: an outside corner beside an arc under G451"):
        interpret(head + arc, dialect="sinumerik", tools=tools)


@pytest.mark.parametrize("dialect", ["fanuc", "sinumerik"])
def test_compensation_begins_on_a_straight_move_but_for_linuxcnc(dialect: str) -> None:
    text = "G21 G90 F100\nT1 M6\nG0 X-20. Y0\nG41 D1 G2 X0 Y20. I20. J0\nG40 G1 Y80.\nM30\n"
    with pytest.raises(GCodeError, match="Line 4: cutter compensation begins on a straight move"):
        interpret(text, dialect=dialect, tools={1: Tool(1, 10e-3)})
    assert len(interpret(text, dialect="linuxcnc", tools={1: Tool(1, 10e-3)}))


@pytest.mark.parametrize("code", ["G41.1", "G42.1"])
@pytest.mark.parametrize("turn", [1, -1])
@pytest.mark.parametrize("by_radius", [False, True])
@pytest.mark.parametrize("seed", range(4))
def test_an_entry_by_an_arc_ends_tangentially_beside_the_end_of_the_programmed_one(code, turn, by_radius, seed):
    """LinuxCNC: from where the tool is, about a centre on the spoke of the programmed end, one radius beside that."""
    rng = np.random.default_rng(seed)
    centre = complex(*rng.uniform(-30, 30, 2))
    start = centre + 9.0 * np.exp(1j * rng.uniform(-math.pi, math.pi))
    end = centre + (start - centre) * np.exp(1j * turn * rng.uniform(0.5, 2.8))
    how = "R9" if by_radius else f"I{(centre - start).real:.12f} J{(centre - start).imag:.12f}"
    spoke = (end - centre) / abs(end - centre)
    beyond = end + 8.0 * turn * 1j * spoke
    text = (
        f"G21 G90 G17 F600\nG0 {xy(start)}\n{code} D{2 * R}\nG{3 if turn > 0 else 2} {xy(end)} {how}\nG1 {xy(beyond)}\n"
    )
    program = interpret(f"{text}G40\nG1 X90 Y90\nM2\n")
    inside = (turn > 0) == (code == "G41.1")
    beside = end + (-R if inside else R) * spoke
    found, about = (places[1, :2] @ [1e3, 1e3j] for places in (program.end, program.centre))
    assert found == pytest.approx(beside, abs=1e-8)
    assert program.start[1, :2] @ [1e3, 1e3j] == pytest.approx(start, abs=1e-9)
    assert abs(about - start) == pytest.approx(abs(about - beside), abs=1e-8)
    assert ((about - beside) / spoke).imag == pytest.approx(0.0, abs=1e-8)
    assert ((about - beside) / spoke).real < 0.0
    assert about + (start - about) * np.exp(1j * program.sweep[1]) == pytest.approx(beside, abs=1e-8)
    assert program.sweep[1] * turn > 0.0
    assert program.end[2, :2] @ [1e3, 1e3j] == pytest.approx(beside + (beyond - end), abs=1e-8)


@pytest.mark.parametrize(("code", "turn"), [("G41.1", 3), ("G42.1", 2)])
@pytest.mark.parametrize("course", [1, 1j, -1, -1j])
@pytest.mark.parametrize("by_radius", [False, True])
def test_an_entry_around_the_tool_is_wider_than_the_cutter(code, turn, course, by_radius):
    """A half circle as wide as the cutter leaves no centre beside it, whichever way it leads; a wider one does."""
    for wide in (R, 1.125 * R):
        how = f"R{wide}" if by_radius else f"I{(wide * course).real} J{(wide * course).imag}"
        text = f"G21 G90 G17 F600\nG0 X0 Y0\n{code} D{2 * R}\nG{turn} {xy(2 * wide * course)} {how}\nG40\nG1 X99\nM2\n"
        if wide > R:
            begun = interpret(text).end[1, :2] @ [1e3, 1e3j]
            assert begun == pytest.approx((2 * wide - R) * course, abs=1e-9)
            continue
        with pytest.raises(GCodeError, match="^Line 4: the arc is not larger than the cutter"):
            interpret(text)


@pytest.mark.parametrize("code", ["G41.1", "G42.1"])
@pytest.mark.parametrize("course", [0.3, 2.0, -2.5])
@pytest.mark.parametrize("first", ["G1", "G2"])
def test_an_entry_leads_farther_than_the_cutters_radius(code, course, first):
    """From a place far from the origin; a straight one ends square beside its own end."""
    side = 1j if code == "G41.1" else -1j
    for length in (0.99 * R, 1.01 * R, 7.0):
        end = 30 + 40j + length * np.exp(1j * course)
        how = "" if first == "G1" else " R50"
        text = f"G21 G90 G17 F600\nG0 X30 Y40\n{code} D{2 * R}\n{first} {xy(end)}{how}\nG40\nG1 X99\nM2\n"
        if length < R:
            with pytest.raises(GCodeError, match="^Line 4: the first (move|arc) with cutter compensation"):
                interpret(text)
        elif first == "G1":
            beside = end + R * side * np.exp(1j * course)
            assert interpret(text).end[1, :2] @ [1e3, 1e3j] == pytest.approx(beside, abs=1e-9)
        else:
            interpret(text)


def test_an_arc_right_behind_g40_is_refused() -> None:
    text = "G21 G90 G17 F600\nG0 X-8 Y0\nG41.1 D2\nG1 X0 Y0\nX20\nG40\n{}\nM2\n"
    with pytest.raises(GCodeError, match="^Line 7: "):
        interpret(text.format("G2 X30 Y-10 J-10"))
    assert len(interpret(text.format("G1 X20 Y0\nG2 X30 Y-10 J-10")))


CONTOUR = "G1 X0 Y-10\nY40\nG3 X-10 Y50 {}\nG1 X-30\nG2 X-50 Y70 {}\nG1 Y90\n"


IMAGES = {
    "fanuc": ("G21 G90 F100\nT1 M6\nG0 X-30 Y-30 Z0\n{}G0 X-30 Y-30\n{} D1 {}G40 G1 X-90 Y99\nM30\n", "R10.", "R20."),
    "sinumerik": (
        "G71 G90 F100\nT1 D1\nM6\nG0 X-30 Y-30 Z0\n{}G0 X-30 Y-30\n{} {}G40 G1 X-90 Y99\nM30\n",
        "CR=10",
        "CR=20",
    ),
}


@pytest.mark.parametrize("side", ["G41", "G42"])
@pytest.mark.parametrize("axes", ["X", "Y", "XY"])
@pytest.mark.parametrize("dialect", IMAGES)
def test_beside_the_image_of_a_contour_is_the_image_of_what_is_beside_it(dialect: str, axes: str, side: str) -> None:
    """Mirrored along one axis the cutter goes on the other side and arcs turn the other way; along both they do not."""
    program, inner, outer = IMAGES[dialect]
    contour = CONTOUR.format(inner, outer)
    word = {"fanuc": "G51.1", "sinumerik": "MIRROR"}[dialect]
    image = f"{word} {' '.join(f'{axis}0' for axis in axes)}\n"
    tools = {1: Tool(1, 8e-3)}
    plain, mirrored = (
        interpret(program.format(said, side, contour), dialect=dialect, tools=tools) for said in ("", image)
    )
    flip = np.array([-1.0 if axis in axes else 1.0 for axis in "XYZ"])
    cuts = slice(-6, None)
    np.testing.assert_allclose(mirrored.end[cuts], plain.end[cuts] * flip, atol=1e-12)
    np.testing.assert_allclose(mirrored.centre[cuts], plain.centre[cuts] * flip, atol=1e-12)
    np.testing.assert_allclose(mirrored.sweep[cuts], plain.sweep[cuts] * (1.0 if len(axes) > 1 else -1.0), atol=1e-12)
    start = plain.end[-7, :2] * 1e3
    assert start[0] == pytest.approx(-4.0 if side == "G41" else 4.0)


@pytest.mark.parametrize("side", ["L", "R"])
def test_beside_the_image_of_a_heidenhain_contour(side: str) -> None:
    head, body = (
        "BEGIN PGM A MM\nTOOL CALL 1 Z F100\nL X-30 Y-30 Z0 FMAX\n",
        f"L X0 Y-10 R{side}\nL Y40\nCR X-10 Y50 R10 DR+\nL X-30\n",
    )
    texts = (f"{head}{said}L X-30 Y-30 FMAX\n{body}L X-60 Y99 R0\nEND PGM A MM\n" for said in ("", "CYCL DEF 8.1 X\n"))
    plain, mirrored = (interpret(text, tools={1: Tool(1, 8e-3)}) for text in texts)
    np.testing.assert_allclose(mirrored.end[-4:] * [-1, 1, 1], plain.end[-4:], atol=1e-12)
    assert plain.end[-5, 0] * 1e3 == pytest.approx(-4.0 if side == "L" else 4.0)


BESIDE = "O1\nG21 G90 S900 M3 F100\nT1 M6\nG0 X0 Y-10. Z{}\n{}Y20.\n{}M30\n"
START = "G41 D1 G1 X10. Y0\n"


def aside(height: float, start: str, end: str) -> list[list[float]]:
    """Where the moves behind the first one end (mm), beside a wall along +Y at X10 by a radius of 2."""
    program = interpret(BESIDE.format(height, start, end), dialect="fanuc", tools={1: Tool(1, diameter=4e-3)})
    return (np.round(program.end * 1e3, 6) + 0.0).tolist()[1:]


@pytest.mark.parametrize("end", ["G40 Z5.\nX30. Y20.\n", "G40\nZ5.\nX30.\n", "G40\nG91 Z5.\nG90 X30.\n"])
def test_behind_g40_a_fanuc_stays_beside_the_contour_until_it_moves_in_the_plane(end: str) -> None:
    """16/18, Operator's Manual: with G40 and no movement in the offset plane the vector stands square to the cut before
    and is cancelled in the next move. The tool went 2 mm into the wall as it rose."""
    assert aside(0, START, end) == [[8, 0, 0], [8, 20, 0], [8, 20, 5], [30, 20, 5]]


def test_behind_g40_a_fanuc_goes_home_from_beside_the_contour() -> None:
    found = aside(0, START, "G40\nG91 G28 Z0\nG90 G0 X30. Y20.\nZ5.\n")
    assert found[2][:2] == found[3][:2] == [8, 20]
    assert found[-1] == [30, 20, 5]
    with pytest.raises(GCodeError, match="the move after G40 must be straight"):
        aside(0, START, "G40 Z5.\nG2 X20. Y30. R10.\n")


@pytest.mark.parametrize("start", ["G41 D1\nG0 Z0\nG1 X10. Y0\n", "G41 D1 G0 Z0\nG1 X10. Y0\n"])
def test_cutter_compensation_of_a_fanuc_begins_on_a_move_in_its_plane(start: str) -> None:
    """It starts with the first block that names an axis of the plane: the tool went down 2 mm aside."""
    assert aside(10, start, "G40 X0\n") == [[0, -10, 0], [8, 0, 0], [8, 20, 0], [0, 20, 0]]


@pytest.mark.parametrize(
    ("dialect", "text"),
    [
        ("heidenhain", "BEGIN PGM A MM\nTOOL CALL 1 Z S9 F99\nL X+0 Y-9 Z+0 FMAX M3\nL X+10 Y+0 RL\nL Y+20\n{}"),
        ("sinumerik", "G71 G90 S9 M3 F99\nT1\nM6\nG0 X0 Y-9 Z0\nG41 G1 X10 Y0\n{}"),
    ],
)
def test_where_compensation_ends_along_z_alone_the_way_back_is_told(dialect: str, text: str) -> None:
    """What these controls do there is not known well enough to be read without a word."""
    ends = {"heidenhain": ("L Z+50 R0 FMAX\n", "L X+0 R0\nL Z+50 FMAX\n"), "sinumerik": ("G40 Z5\n", "G40 X0\nZ5\n")}
    for end, told in zip(ends[dialect], (1, 0)):
        program = interpret(text.format(end), dialect=dialect, tools={1: Tool(1, diameter=4e-3)})
        assert sum(finding.code == "ends-aside" for finding in program.findings) == told
