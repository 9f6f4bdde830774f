"""Corners under cutter compensation: as if their arcs and chamfers had been written out."""

from __future__ import annotations

import numpy as np
import pytest

from robomill.errors import GCodeError
from robomill.toolpath.gcode import Program, Tool, interpret

TOOLS = {1: Tool(1, 10e-3)}
HEAD = "G21 G90 G17 T1 M6 F100\nG0 X-20 Y-20 Z0\n"
WRITTEN_OUT = {
    "outside": ("Y50 ,R10.\nX50\n", "Y40\nG2 X10 Y50 R10\nG1 X50\n"),
    "inside": ("Y50 ,R10.\nX-50\n", "Y40\nG3 X-10 Y50 R10\nG1 X-50\n"),
    "chamfer": ("Y50 ,C4.\nX50\n", "Y46\nX4 Y50\nX50\n"),
    "two": ("Y50 ,R10.\nX50 ,C4.\nY0\n", "Y40\nG2 X10 Y50 R10\nG1 X46\nX50 Y46\nY0\n"),
    "steps": ("G91 Y50 ,R10.\nX50\nG90\n", "Y40\nG2 X10 Y50 R10\nG1 X50\n"),
    "feed": ("Y50 ,R10. F200\nX50 F300\n", "Y40 F200\nG2 X10 Y50 R10\nG1 X50 F300\n"),
}


def read(body: str, dialect: str = "fanuc") -> Program:
    return interpret(f"{HEAD}{body}G40 X-80 Y90\nM30\n", dialect=dialect, tools=TOOLS)


@pytest.mark.parametrize("side", ["G41", "G42"])
@pytest.mark.parametrize("name", WRITTEN_OUT)
def test_it_is_the_contour_with_its_corners_written_out(side: str, name: str) -> None:
    short, long = (read(f"{side} D1 G1 X0 Y0\n{body}") for body in WRITTEN_OUT[name])
    np.testing.assert_array_equal(short.kind, long.kind)
    np.testing.assert_allclose(short.end, long.end, atol=1e-12)
    np.testing.assert_allclose(short.centre, long.centre, atol=1e-12)
    np.testing.assert_allclose(short.v_f, long.v_f, rtol=1e-12)


@pytest.mark.parametrize("name", ["outside", "inside"])
def test_sinumerik_and_heidenhain_say_the_same(name: str) -> None:
    short, _ = WRITTEN_OUT[name]
    across = short.split("\n")[1]
    fanuc = read(f"G41 D1 G1 X0 Y0\n{short}")
    sinumerik = f"G71 G90 T1 D1 F100\nM6\nG0 X-20 Y-20 Z0\nG41 G1 X0 Y0\nY50 RND=10\n{across}\nG40 X-80 Y90\nM30\n"
    klartext = f"TOOL CALL 1 Z F100\nL X-20 Y-20 Z0 FMAX\nL X0 Y0 RL F100\nL Y50\nRND R10\nL {across}\nL X-80 Y90 R0\n"
    for text in (sinumerik, f"BEGIN PGM A MM\n{klartext}END PGM A MM\n"):
        np.testing.assert_allclose(interpret(text, tools=TOOLS).end, fanuc.end, atol=1e-12)


@pytest.mark.parametrize(
    ("body", "says"),
    [
        ("G41 D1 G1 X0 Y0 ,R5.\nY50\n", "Line 3: the move that begins cutter compensation cannot end in such a corner"),
        (
            "G41 D1 G1 X0 Y0\nY50 ,R5.\nG2 X20 Y70 R20\n",
            "Line 5: a corner is rounded or chamfered between two straight",
        ),
        ("G41 D1 G1 X0 Y0\nY50 ,R5.\nG0 X20\n", "Line 5: a corner is rounded or chamfered between two straight"),
        ("G41 D1 G1 X0 Y0\nY50 ,R5.\n", "Line 4: a corner is rounded or chamfered between two straight"),
        ("G41 D1 G1 X0 Y0\nY50 ,R60.\nX90\n", "Line 4: a corner takes 60.000 mm of both cuts, and one has 50.000 mm"),
    ],
)
def test_what_cannot_be_is_refused(body: str, says: str) -> None:
    with pytest.raises(GCodeError, match=says):
        read(body)
