"""Shifts and turns on top of a coordinate system that changes beneath them."""

from __future__ import annotations

import random

import numpy as np
import pytest

from robomill.errors import GCodeError
from robomill.toolpath.gcode import interpret


@pytest.mark.parametrize("seed", range(20))
def test_a_frame_of_a_sinumerik_goes_on_in_another_coordinate_system(seed: int) -> None:
    """840D, Fundamentals: the programmable frame follows on the settable one. A place is the zero in force, and what
    TRANS, AROT and AMIRROR make of the word, here by complex numbers."""
    r = random.Random(seed)
    zeros = {f"G{54 + k}": complex(r.randint(-300, 300), r.randint(-300, 300)) for k in range(3)}
    lines = ["G71 G90 G17 F100 S60 M3"]
    lines += [f"G10 L2 P{k + 1} X{z.real} Y{z.imag}" for k, z in enumerate(zeros.values())]
    shift, angle, mirrored, system = 0j, 0.0, False, "G54"
    expected = []
    lines.append("G54")
    for _ in range(12):
        kind = r.randint(0, 3)
        if kind == 0:
            system = r.choice(list(zeros))
            lines.append(system)
        elif kind == 1:
            shift, angle, mirrored = complex(r.randint(-9, 9), r.randint(-9, 9)), 0.0, False
            lines.append(f"TRANS X{shift.real} Y{shift.imag}")
        elif kind == 2 and not mirrored:
            angle += 30.0
            lines.append("AROT RPL=30")
        elif not mirrored:
            mirrored = True
            lines.append("AMIRROR X0")
        word = complex(r.randint(1, 99), r.randint(1, 99))
        lines.append(f"G1 X{word.real} Y{word.imag}")
        seen = complex(-word.real, word.imag) if mirrored else word
        place = zeros[system] + shift + seen * np.exp(1j * np.radians(angle))
        expected.append((place.real, place.imag))
    program = interpret("\n".join([*lines, "M30"]), dialect="sinumerik")
    np.testing.assert_allclose(program.end[:, :2] * 1e3, expected, atol=1e-9)


def test_an_axis_that_is_not_said_stays_where_it_is() -> None:
    program = interpret(
        "G71 G90 G10 L2 P2 X100 Y50\nTRANS X10 Y5\nG0 X1 Y1\nG55\nG0 X1\nTRANS\nY2\nM30\n", dialect="sinumerik"
    )
    np.testing.assert_allclose(program.end[:, :2] * 1e3, [[11, 6], [111, 6], [111, 52]], atol=1e-9)


def test_elsewhere_a_turn_is_ended_first() -> None:
    with pytest.raises(GCodeError, match="^Line 2: G55 while coordinates are shifted or turned"):
        interpret("G21 G90 G68 X0. Y0. R30.\nG55 X1.\nM30\n", dialect="fanuc")
