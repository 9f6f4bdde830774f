"""Motions that hold on their line alone: G63 of Sinumerik, G31 of Fanuc and Mach3."""

from __future__ import annotations

import numpy as np
import pytest

from robomill.errors import GCodeError
from robomill.toolpath.gcode import Program, interpret
from robomill.toolpath.tools import Tool


def tapped(body: str) -> Program:
    return interpret(f"G71 G90 G17 S200 M3\nG0 X0 Y0 Z3\n{body}M30\n", dialect="sinumerik", tools={1: Tool(1, 0.01)})


@pytest.mark.parametrize("before", ["G0", "G1"])
def test_g63_taps_at_its_feed_and_the_motion_before_goes_on(before: str) -> None:
    """M5 x 0.8 at 200/min: 160 mm/min. Behind G63 the last of G0 to G3 is in force again (840D, Fundamentals)."""
    program = tapped(f"{before} X1 F500\nG63 Z-20 F160\nG63 Z3 M4\nX9 M3\nG63 Z-20\nG63 Z3 M4\n")
    assert (program.end[:, 2] * 1e3).tolist() == pytest.approx([3, 3, -20, 3, 3, -20, 3])
    assert program.thread.tolist() == [False, False, True, True, False, True, True]
    assert program.v_f[program.thread] * 6e4 == pytest.approx(160)
    assert program.ccw.tolist() == [False, False, False, True, False, False, True]
    assert program.kind[4] == (0 if before == "G0" else 1)


def test_g31_travels_its_whole_way_and_g0_goes_on() -> None:
    for dialect in ("fanuc", "auto"):
        text = "G21 G90 G0 X5. Z10.\nG31 Z-5. F100.\nG92 Z0\nZ20.\nG1 X9. F50.\nG91 G31 X-3.\nX1.\nM30\n"
        program = interpret(text, dialect=dialect)
        assert program.kind.tolist() == [0, 4, 0, 1, 4, 1]
        assert (program.end[:, 0] * 1e3).tolist() == pytest.approx([5, 5, 5, 9, 6, 7])
        np.testing.assert_allclose(program.end[2, 2], 0.02)  # G92 says where the probe has met the part
        assert {"probing", "probed-zero"} <= {f.code for f in program.findings}


@pytest.mark.parametrize(
    ("line", "dialect", "says"),
    [
        ("G1 G63 Z-5", "sinumerik", "G63 and G1 are on one line; give one of them"),
        ("G41 D1 X5\nG63 X9", "sinumerik", "G63 cannot be used with cutter compensation on"),
        ("G31 P99 Z-5.", "fanuc", "G31 goes until a probe or another signal stops it, which is read for"),
        ("G31 Z-5.\n#1=#5063", "fanuc", "#5063 is where a probe has met something, which is not known here"),
        ("#1=#5061", "fanuc", "#5061 is where a probe has met something"),
        ("G31 Z-5", "grbl", "G31"),
    ],
)
def test_what_is_not_read_is_named(line: str, dialect: str, says: str) -> None:
    with pytest.raises(GCodeError, match=says):
        interpret(f"G90 F100 G1 X1\n{line}\nM30\n", dialect=dialect, tools={1: Tool(1, 0.01)})
