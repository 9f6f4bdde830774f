"""Heidenhain's DIN/ISO: short programs with the places that its manual gives its words."""

import numpy as np
import pytest

from robomill.errors import GCodeError
from robomill.toolpath.gcode.program import FEED
from robomill.toolpath.gcode.reading import interpret
from robomill.toolpath.tools import Tool

HEAD = (
    "%PART G71 *\nN10 G30 G17 X+0 Y+0 Z-20*\nN20 G31 G90 X+100 Y+100 Z+0*\nN30 T1 G17 S900*\n"
    "N40 G00 G40 G90 X+10 Y+0 Z+0 M3*\n"
)
TOOLS = {1: Tool(1, diameter=8e-3)}


def ends(body: str) -> list[list[float]]:
    program = interpret(f"{HEAD}{body}N9999 %PART G71 *\n", tools=TOOLS)
    return ((program.end[1:] * 1e3).round(6) + 0.0).tolist()


BODIES = {
    # straight, in places and in steps, which may change within a block
    "N1 G01 X+20 Y+5 F100*\nN2 G91 X+5*\nN3 Y+1 G90 X+0*\nN4 G00 Z+9 M5*\n": [
        [20, 5, 0],
        [25, 5, 0],
        [0, 6, 0],
        [0, 6, 9],
    ],
    # arcs by I and J, the pole, which stays; by R, where a minus means the longer way; tangential
    "N1 G02 I+10 J+10 X+20 Y+10 F100*\nN2 G03 X+0 Y+10*\nN3 G02 X+10 Y+20 R+10*\n": [
        [20, 10, 0],
        [0, 10, 0],
        [10, 20, 0],
    ],
    "N1 G03 X+20 Y+10 R+10 F100*\nN2 G02 X+10 Y+20 R-10*\n": [[20, 10, 0], [10, 20, 0]],
    "N1 G01 X+20 F100*\nN2 G06 X+30 Y+10*\n": [[20, 0, 0], [30, 10, 0]],
    "N1 I+0 J+0*\nN2 G03 F100 I+0 J+0*\n": [[10, 0, 0]],
    "N1 G91 G03 I-10 J+0 X-10 Y+10 F100*\n": [[0, 10, 0]],
    # polar: R and H about the pole
    "N1 I+0 J+0*\nN2 G11 R+20 H+90 F100*\nN3 G10 R+5 H+0*\nN4 G13 H+90*\nN5 G12 G91 H-360 Z-2*\n": [
        [0, 20, 0],
        [5, 0, 0],
        [0, 5, 0],
        [0, 5, -2],
    ],
    # tangential to a polar place: on from (20, 0) along X, half way round to (20, 20)
    "N1 G01 X+20 F100*\nN2 I+0 J+0*\nN3 G16 R+28.2842712475 H+45*\n": [[20, 0, 0], [20, 20, 0]],
    # a chamfer leaves out 2 of both sides; labels, called and repeated; Q parameters
    "N1 G01 X+20 F100*\nN2 G24 R2*\nN3 Y+10*\n": [[18, 0, 0], [20, 2, 0], [20, 10, 0]],
    "N1 G01 F100*\nN2 G98 L1*\nN3 G91 X+5*\nN4 L1,2*\nN5 L2,0*\n"
    "N6 G90 G00 X+0 M2*\nN7 G98 L2*\nN8 G91 Y+1*\nN9 G98 L0*\n": [
        [15, 0, 0],
        [20, 0, 0],
        [25, 0, 0],
        [25, 1, 0],
        [0, 1, 0],
    ],
    "N1 D00 Q1 P01 +5*\nN2 D03 Q2 P01 +Q1 P02 +4*\nN3 G98 L1*\nN4 G01 X+Q2 F100*\nN5 D02 Q2 P01 +Q2 P02 +Q1*\n"
    "N6 D11 P01 +Q2 P02 +9 P03 1*\n": [[20, 0, 0], [15, 0, 0], [10, 0, 0]],
    # shift, turn, mirror
    "N1 G54 X+100 Y+0*\nN2 G01 X+1 Y+2 F9*\nN3 G54 X+0 Y+0*\nN4 G73 G90 H+90*\nN5 X+1 Y+2*\nN6 G73 H+0*\nN7 G28 X*\n"
    "N8 X+1 Y+2*\nN9 G28*\nN10 X+1*\n": [[101, 2, 0], [-2, 1, 0], [-1, 2, 0], [1, 2, 0]],
    # left of a contour along +X by the radius of 4
    "N1 G01 G41 X+20 Y+0 F100*\nN2 X+40*\nN3 G40 Y-20*\n": [[20, 4, 0], [40, 4, 0], [40, -20, 0]],
}


@pytest.mark.parametrize("body", BODIES)
def test_blocks_of_din_iso_lead_where_its_manual_says(body: str) -> None:
    assert ends(body) == BODIES[body]


def test_cycles_of_din_iso_drill_where_they_are_called() -> None:
    body = (
        "N1 G200 DRILLING Q200=2 ;SET-UP CLEARANCE Q201=-5 ;DEPTH Q206=120 Q202=5 Q210=0 Q203=+1 Q204=20 Q211=0*\n"
        "N2 X+30 Y+7 M99*\nN3 X+40*\nN4 G79 M8*\n"
    )
    program = interpret(f"{HEAD}{body}N9999 %PART G71 *\n")
    rows = program.kind == FEED
    np.testing.assert_allclose(program.end[rows] * 1e3, [[30, 7, -4], [40, 7, -4]], atol=1e-9)
    np.testing.assert_allclose(program.v_f[rows] * 60e3, 120)


def test_blocks_that_stand_alone() -> None:
    """G04 waits, G29 puts the pole where the tool is, G38 stops, G73 of a step adds its angle, G99 defines a tool."""
    waits = interpret(f"{HEAD}N1 G04 F1.5*\nN2 G01 X+5 F9*\nN9999 %PART G71 *\n")
    assert waits.dwell_time == pytest.approx(1.5)
    assert ends("N1 G29*\nN2 G38*\nN3 G11 R+5 H+90 F9*\n") == [[10, 5, 0]]
    assert ends("N1 G73 G91 H+40*\nN2 G73 G91 H+50*\nN3 G01 G90 X+1 Y+2 F9*\n") == [[-2, 1, 0]]
    assert ends("N1 G17 G54 X+100*\nN2 G01 X+1 F9*\n") == [[101, 0, 0]]
    own = "N1 G99 T5 L+0 R+3*\nN2 T5 G17 S900*\nN3 G01 G41 X+20 Y+0 F100*\nN4 X+40*\nN5 G40 Y-20*\n"
    assert ends(own) == [[20, 3, 0], [40, 3, 0], [40, -20, 0]]


def test_inches_feeds_and_rapids() -> None:
    """An F beside G00 is that of the cuts that come; 50 are 5 in a minute."""
    program = interpret("%P G70 *\nN1 G00 X+1 F50*\nN2 G01 Y+2*\nN3 Z-1 F100*\nN9 %P G70 *\n")
    np.testing.assert_allclose(program.end[-1] / 25.4e-3, [1, 2, -1])
    np.testing.assert_allclose(program.v_f * 60 / 25.4e-3, [0, 5, 10])
    assert program.units == "in"


@pytest.mark.parametrize(
    "block",
    [
        "G26 R5",
        "G83 P01 -2 P02 -20",
        "G18 X+5",
        "G01 X+5 X+6",
        "G02 X+5 Y+5 R+5 I+1",
        "G00 G01 X+5",
        "G01 X+5 R+5",
        "G01 X+5 H+5",
        "G11 R+5 H+5 F9",
        "G54 X+5 M3",
        "G54 G73 X+5",
        "G54 G01 X+5",
        "G00 G79",
        "G40 G41 X+5",
        "G00 G01",
        "L7,0",
        "D00 Q1",
        "G01 X+5 ?",
        "G55 X+1",
    ],
)
def test_blocks_that_are_not_read_are_refused(block: str) -> None:
    """For what they say: the feed of a cut is there."""
    why = "in (a|its) block of DIN/ISO|of Heidenhain's DIN/ISO|a block of DIN/ISO|beside other words|LBL 7|their centre"
    with pytest.raises(GCodeError, match=rf"^Line 7: .*({why})"):
        ends(f"N1 F500*\nN2 {block}*\n")


@pytest.mark.parametrize("word", ["M118 X1 Y1", "M118 Z2", "M103 F20", "M120 LA10", "M128 F1000"])
def test_what_belongs_to_an_m_word_is_no_place_and_no_feed(word: str) -> None:
    """As in the dialogue: M118 has the reach of the handwheel, M103 a share of the feed, M128 one of its own."""
    text = f"%A G71 *\nN10 T1 G17 S1000 *\nN20 G00 G90 X+0 Y+0 Z+50 M3*\nN30 G01 X+5 Y+6 F125 {word}*\nN9 M30*\n"
    program = interpret(f"{text}N99999999 %A G71 *\n")
    assert (program.end[-1] * 1e3).tolist() == pytest.approx([5, 6, 50])
    assert program.v_f[-1] * 6e4 == pytest.approx(125)
