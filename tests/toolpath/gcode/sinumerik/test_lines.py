"""AC( ) and IC( ) beside what is scaled."""

from __future__ import annotations

import numpy as np
import pytest

from robomill.toolpath.gcode import interpret


@pytest.mark.parametrize("scale", ["", "SCALE X2 Y2\n", "SCALE X0.5 Y0.5\n"])
@pytest.mark.parametrize(
    ("word", "angles"),
    [("A=IC(10)", [40, 20, -7]), ("G91 B=AC(25)", [30, 25, -7]), ("C=IC(-3)", [30, 20, -10]), ("A=AC(1)", [1, 20, -7])],
)
def test_steps_and_places_of_rotary_axes_are_those_said_where_lengths_are_scaled(
    scale: str, word: str, angles: list[float]
) -> None:
    program = interpret(f"G71 G90 G17 F100\nG0 X3 Y4 Z5 A30 B20 C-7\n{scale}G1 {word}\nM30\n", dialect="sinumerik")
    np.testing.assert_allclose(np.degrees(program.rotary[-1]), angles, atol=1e-9)
    np.testing.assert_allclose(program.end[-1] * 1e3, [3, 4, 5], atol=1e-9)
