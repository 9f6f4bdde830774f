"""Where a line leads: polar words, machine coordinates, stored points; by complex numbers."""

from __future__ import annotations

import cmath
import math

import numpy as np
import pytest

from robomill.toolpath.gcode import interpret


def end(text):
    """Last end (x, y, z) mm."""
    return interpret(f"G21 G90 F100\n{text}\nM2\n").end[-1] * 1e3


@pytest.mark.parametrize(
    ("words", "z"),
    [
        ("@8 ^30", cmath.rect(8, math.radians(30))),
        ("@8", cmath.rect(8, math.atan2(4, -3))),
        ("^-70", cmath.rect(5, math.radians(-70))),
    ],
)
def test_polar_words_that_are_not_given_stay(words, z):
    np.testing.assert_allclose(end(f"G0 X-3 Y4 Z2\nG1 {words}"), [z.real, z.imag, 2], atol=1e-9)


@pytest.mark.parametrize(("words", "radius", "angle"), [("@3 ^25", 3, 25), ("@3", 3, 0), ("^25", 0, 25)])
def test_polar_words_in_steps_add_to_radius_and_angle(words, radius, angle):
    z = cmath.rect(5 + radius, math.atan2(4, -3) + math.radians(angle))
    np.testing.assert_allclose(end(f"G0 X-3 Y4 Z2\nG91 G1 {words}"), [z.real, z.imag, 2], atol=1e-9)


@pytest.mark.parametrize("rotation", [0.0, 35.0])
def test_machine_coordinates_are_those_of_no_system(rotation):
    """G53: what is named counts from the machine, what is not stays where it is in the machine."""
    start = f"G10 L2 P1 X7 Y-3 Z1 R{rotation}\nG0 X5 Y2 Z4\nG92 X1 Y1 Z1\nG43.1 Z6"
    here = end(start)
    np.testing.assert_allclose(end(f"{start}\nG53 G0 X20 Y30 Z40")[:2], [20, 30], atol=1e-9)
    np.testing.assert_allclose(end(f"{start}\nG53 G0 X20")[:2], [20, here[1]], atol=1e-9)
    np.testing.assert_allclose(end(f"{start}\nG53 G0 Y30")[:2], [here[0], 30], atol=1e-9)


@pytest.mark.parametrize("code", ["G28", "G30"])
def test_a_stored_point_is_come_back_to_by_way_of_the_words(code):
    """All axes without words; with words by way of them, and on with the named axes alone."""
    start = "G10 L2 P1 X7 Y-3 Z1\nG0 X5 Y2 Z4"
    stored = end(start)
    away = f"{start}\n{code}.1\nG0 X50 Y60 Z70"
    far = end(away)
    np.testing.assert_allclose(end(f"{away}\n{code}"), stored, atol=1e-9)
    np.testing.assert_allclose(end(f"{away}\n{code} Z80"), [*far[:2], stored[2]], atol=1e-9)
    moves = interpret(f"G21 G90 F100\n{away}\n{code} Z80\nM2\n").end * 1e3
    np.testing.assert_allclose(moves[-2], [*far[:2], 81], atol=1e-9)
