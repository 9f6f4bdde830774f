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


def test_the_tip_stands_a_tools_offset_from_machine_coordinates():
    """Along every axis: of the place named for the spindle, less the length in force; turned axes have none."""
    start = "G10 L2 P1 X7 Y-3 Z1 A4\nG0 X5 Y2 Z4\nG92 X1 Y1 Z1\nG43.1 X2 Y5 Z6"
    there = interpret(f"G21 G90\n{start}\nG53 G0 X20 Y30 Z40 A50 B60 C70\nM2\n")
    np.testing.assert_allclose(there.end[-1] * 1e3, [18, 25, 34], atol=1e-9)
    np.testing.assert_allclose(np.degrees(there.rotary[-1]), [50, 60, 70], atol=1e-9)
    here = end(start)
    for axis, (letter, value) in enumerate((("X", 18), ("Y", 25), ("Z", 34))):
        expected = [value if n == axis else here[n] - (2, 5, 6)[n] for n in range(3)]
        np.testing.assert_allclose(end(f"{start}\nG53 G0 {letter}{20 + 10 * axis}"), expected, atol=1e-9)


@pytest.mark.parametrize(("code", "parameter"), [("G28", 5161), ("G30", 5181)])
def test_a_stored_point_is_kept_in_millimetres_of_the_machine(code, parameter):
    text = f"G21 G90\nG10 L2 P1 X7 Y-3 Z1\nG43.1 Z6\nG0 X5 Y2 Z4 A9\nG92 Z1\nG20\n{code}.1\nG21\n"
    read = [end(f"{text}G92.1 G49\nG10 L2 P1 X0 Y0 Z0\nG0 X#{parameter + n}")[0] for n in range(4)]
    np.testing.assert_allclose(read, [12, -1, 11, 9], atol=1e-9)
    back = interpret(f"{text}G0 X90 Y91 Z92 A80\n{code} X95 A70\nM2\n")
    np.testing.assert_allclose(back.end[-1, 0] * 1e3, 12, atol=1e-9)
    np.testing.assert_allclose(np.degrees(back.rotary[-2:, 0]), [70, 9], atol=1e-9)


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
