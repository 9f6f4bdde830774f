"""Corners under cutter compensation: as if their arcs and chamfers had been written out."""

from __future__ import annotations

import numpy as np
import pytest

from robomill.errors import GCodeError
from robomill.toolpath.gcode import Program, Tool, interpret

TOOLS = {1: Tool(1, 10e-3)}
HEAD = "G21 G90 G17 T1 M6 F100\nG0 X-20 Y-20 Z0\n"
W = np.sqrt(12**2 - 2**2)
"""A circle of 2 touches one of 10 from outside and a line through its centre: their centres are 12 apart."""
TOUCHES, ASIDE = 60 - 10 / 12 * W, 2 * 10 / 12
WRITTEN_OUT = {
    "outside": ("Y50 ,R10.\nX50\n", "Y40\nG2 X10 Y50 R10\nG1 X50\n"),
    "inside": ("Y50 ,R10.\nX-50\n", "Y40\nG3 X-10 Y50 R10\nG1 X-50\n"),
    "chamfer": ("Y50 ,C4.\nX50\n", "Y46\nX4 Y50\nX50\n"),
    "two": ("Y50 ,R10.\nX50 ,C4.\nY0\n", "Y40\nG2 X10 Y50 R10\nG1 X46\nX50 Y46\nY0\n"),
    "steps": ("G91 Y50 ,R10.\nX50\nG90\n", "Y40\nG2 X10 Y50 R10\nG1 X50\n"),
    "line, arc": (
        "Y50 ,R2.\nG3 X10 Y60 J10\nG1 X40\n",
        f"Y{60 - W}\nG2 X{ASIDE} Y{TOUCHES} R2\nG3 X10 Y60 I{-ASIDE} J{60 - TOUCHES}\nG1 X40\n",
    ),
    "arc between corners": (
        "Y50 ,R2.\nG3 X10 Y60 J10 ,R2.\nG1 X40\n",
        f"Y{60 - W}\nG2 X{ASIDE} Y{TOUCHES} R2\nG3 X{10 / 12 * W} Y{60 - ASIDE} I{-ASIDE} J{60 - TOUCHES}\n"
        f"G2 X{W} Y60 R2\nG1 X40\n",
    ),
    "feed": ("Y50 ,R10. F200\nX50 F300\n", "Y40 F200\nG2 X10 Y50 R10\nG1 X50 F300\n"),
}


def read(body: str, dialect: str = "fanuc") -> Program:
    return interpret(f"{HEAD}{body}G40 X-80 Y90\nM30\n", dialect=dialect, tools=TOOLS)


@pytest.mark.parametrize(
    ("side", "name"),
    [("G41", name) for name in WRITTEN_OUT] + [("G42", name) for name in WRITTEN_OUT if "arc" not in name],
)
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
            "G41 D1 G1 X0 Y0\nY50 ,R5.\nG3 X10 Y60 Z5 J10\n",
            "Line 4: a corner beside an arc is rounded in the plane of that arc alone",
        ),
        ("G41 D1 G1 X0 Y0\nY50 ,R5.\nG0 X20\n", "Line 5: a corner is rounded between two cuts"),
        ("G41 D1 G1 X0 Y0\nY50 ,R5.\n", "Line 4: a corner is rounded between two cuts"),
        ("G41 D1 G1 X0 Y0\nY50 ,R60.\nX90\n", "Line 4: a corner takes 60.000 mm of both cuts, and one has 50.000 mm"),
    ],
)
def test_what_cannot_be_is_refused(body: str, says: str) -> None:
    with pytest.raises(GCodeError, match=says):
        read(body)
