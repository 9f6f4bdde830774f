"""What a program can read of the machine: every value by its name, after lines that change it."""

from __future__ import annotations

import numpy as np
import pytest

from robomill.errors import GCodeError
from robomill.toolpath.gcode import interpret
from robomill.toolpath.gcode.machine import _PROVIDED
from robomill.toolpath.tools import Tool

TOOLS = {
    3: Tool(3, 6e-3, offset=(1e-3, 2e-3, 50e-3), orientation=4),
    7: Tool(7, 25.4e-3),
}
NURBS = "F60 G5.2 P1 X1 Y1\nX2 Y0 P1\nX3 Y3 P1\nG5.3"
SAID = {
    "_vmajor": [("", 2.9)],
    "_vminor": [("", 0)],
    "_line": [("", 4), ("G0", 4)],
    "_motion_mode": [("G0 X1", 0), ("F60 G1 X1", 10), ("G80", 800), (NURBS, -1)],
    "_plane": [("", 170), ("G18", 180), ("G19", 190)],
    "_ccomp": [("", 400), ("G41.1 D2", 410), ("G42.1 D2", 420)],
    "_metric": [("", 1), ("G20", 0)],
    "_imperial": [("", 0), ("G20", 1)],
    "_absolute": [("", 1), ("G91", 0)],
    "_incremental": [("", 0), ("G91", 1)],
    "_inverse_time": [("", 0), ("G93", 1), ("G95", 0)],
    "_units_per_minute": [("", 1), ("G93", 0), ("G95", 0)],
    "_units_per_rev": [("", 0), ("G95", 1), ("G93", 0)],
    "_coord_system": [("", 540), ("G56", 560), ("G59", 590), ("G59.1", 591), ("G59.3", 593)],
    "_tool_offset": [("", 0), ("G43 H3", 1), ("G43 H3\nG49", 0)],
    "_retract_r_plane": [("G99", 1), ("G98", 0)],
    "_retract_old_z": [("G99", 0), ("G98", 1)],
    "_spindle_rpm_mode": [("", 1), ("G96 S100", 0)],
    "_spindle_css_mode": [("", 0), ("G96 S100", 1), ("G96 S100\nG97 S9", 0)],
    "_ijk_absolute_mode": [("", 0), ("G90.1", 1)],
    "_lathe_diameter_mode": [("", 0), ("G7", 1)],
    "_lathe_radius_mode": [("", 1), ("G7", 0)],
    "_spindle_on": [("", 0), ("S9 M3", 1), ("S9 M4", 1), ("S9 M4\nM5", 0)],
    "_spindle_cw": [("", 0), ("S9 M3", 1), ("S9 M4", 0)],
    "_mist": [("", 0), ("M7", 1), ("M8", 0), ("M7\nM9", 0)],
    "_flood": [("", 0), ("M8", 1), ("M7", 0)],
    "_speed_override": [("", 1)],
    "_feed_override": [("", 1)],
    "_adaptive_feed": [("", 0)],
    "_feed_hold": [("", 1)],
    "_feed": [("", 0), ("F120", 120), ("F254\nG20", 10)],
    "_rpm": [("", 0), ("S300", 300)],
    "_current_tool": [("", 0), ("T3", 0), ("T3 M6", 3)],
    "_current_pocket": [("T3", 0), ("T3 M6", 3)],
    "_selected_pocket": [("", 0), ("T3", 3), ("T3 M6\nT7", 7)],
    "_selected_tool": [("", 0), ("T3", 3), ("T3 M6\nT7", 7)],
    **{name: [("", 0)] for name in ("_u", "_v", "_w", "_remap_level", "_task", "_call_level")},
    "_value": [("", 0), ("O1 sub\nO1 endsub [7]\nO1 call", 7)],
    "_value_returned": [("", 0), ("O1 sub\nO1 endsub [7]\nO1 call", 1), ("O1 sub\nO1 endsub\nO1 call", 0)],
    **{f"_{letter}": [(f"G0 {letter.upper()}7", 7)] for letter in "xyzabc"},
}
NUMBERED = {
    5400: [("", 0), ("T3 M6", 3)],
    5401: [("T3 M6", 1)],
    5402: [("T3 M6", 2)],
    5403: [("T3 M6", 50)],
    5410: [("T3 M6", 6), ("T7 M6", 25.4)],
    5411: [("T3 M6", 0)],
    5413: [("T3 M6", 4)],
    5420: [("G0 X4", 4)],
    5422: [("G0 Z4", 4)],
    5425: [("G0 C4", 4)],
    5426: [("G0 C4", 0)],
}


def read(lines: str, what: str) -> float:
    """The value as a move to it in mm."""
    plain = "G40 G49 G80 G21 G90 G94 G17 G8"
    program = interpret(f"G21\n\n{lines}\n#100=#{what}\n{plain}\nG0 Y#100\nM2\n", tools=TOOLS)
    return float(program.end[-1, 1] * 1e3)


CASES = [(f"<{name}>", lines, value) for name, cases in SAID.items() for lines, value in cases] + [
    (str(number), lines, value) for number, cases in NUMBERED.items() for lines, value in cases
]


@pytest.mark.parametrize(("what", "lines", "value"), CASES)
def test_a_program_reads_what_it_has_said(what: str, lines: str, value: float) -> None:
    assert read(lines, what) == pytest.approx(value, abs=1e-9)


def test_every_value_that_is_provided_is_read_here() -> None:
    assert set(_PROVIDED) <= set(SAID)


def test_the_position_is_not_read_beside_the_path() -> None:
    with pytest.raises(GCodeError, match="position cannot be read with cutter compensation on"):
        read("G41.1 D2", "5420")


@pytest.mark.parametrize(("tool", "length_of", "lift"), [(3, 7, (-1, -2, -50)), (7, 3, (1, 2, 50)), (3, 3, (0, 0, 0))])
def test_the_length_of_another_tool_lifts_the_tip(tool: int, length_of: int, lift: tuple[float, ...]) -> None:
    program = interpret(f"G21 T{tool} M6\nG0 X1\nG43 H{length_of}\nG0 X2\nX3\nG49\nG43 H{tool}\nX4\nM2\n", tools=TOOLS)
    np.testing.assert_allclose(program.lift[1:] * 1e3, [lift, lift, (0, 0, 0)], atol=1e-12)


def test_lengths_that_are_kept_change_their_unit() -> None:
    """A point, offsets, a shift and a length told in mm, gone on with in inches: the tip moves as it would in mm."""
    told = "G10 L2 P1 X10 Y-4\nG92 X3 Y5\nG43.1 Z20\nG0 X50.8 Y25.4 Z12.7 A90\n"
    metric = interpret(f"G21\n{told}G91 G0 X25.4\nG90 Z0\nG92.1 G49\nX0 Y0 Z0\nM2\n")
    mixed = interpret(f"G21\n{told}G20\nG91 G0 X1\nG90 Z0\nG92.1 G49\nX0 Y0 Z0\nM2\n")
    assert mixed.end == pytest.approx(metric.end)
    assert mixed.rotary == pytest.approx(metric.rotary)
    assert interpret("G21 F254\nG20\nG1 X1\nM2\n").v_f == pytest.approx([254e-3 / 60])


STEPS = {
    "sinumerik": (
        "G71 G90 G17 F100 S900 M3\nT1 M6\n{}G0 X5 Y-10 Z0\n"
        "G41 G1 X10 Y0\nY=IC(20)\nG91 X=AC(30)\nG90 G40 X30 Y40\nM30\n",
        {"": "", "X": "MIRROR X0\n", "Y": "MIRROR Y0\n", "XY": "MIRROR X0 Y0\n"},
    ),
    "heidenhain": (
        "BEGIN PGM A MM\nTOOL CALL 1 Z S900 F100\n{}L X+5 Y-10 Z+0 FMAX M3\nL X+10 Y+0 RL\nL IY+20\nL IX+20\n"
        "L X+30 Y+40 R0\nEND PGM A MM\n",
        {"": "", "X": "CYCL DEF 8.1 X\n", "Y": "CYCL DEF 8.1 Y\n", "XY": "CYCL DEF 8.1 X Y\n"},
    ),
}


@pytest.mark.parametrize("mirrored", ["", "X", "Y", "XY"])
@pytest.mark.parametrize("control", STEPS)
def test_steps_within_a_mirrored_contour_count_from_where_it_was_said_to_be(control: str, mirrored: str) -> None:
    """Left of a wall along +Y at X10 and one along +X at Y20 by a radius of 2; its image, whatever side that is on.

    The steps were counted from the place in the image: the tool went to the other side of zero.
    """
    text, images = STEPS[control]
    program = interpret(text.format(images[mirrored]), dialect=control, tools={1: Tool(1, diameter=4e-3)})
    ends = np.array([(8, 0), (8, 20), (10, 22), (30, 22), (30, 40)], dtype=float)
    ends *= [-1 if "X" in mirrored else 1, -1 if "Y" in mirrored else 1]
    np.testing.assert_allclose(program.end[1:, :2] * 1e3, ends, atol=1e-9)
