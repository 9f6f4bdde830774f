"""Coordinate systems: what turns is not a length, what is measured is; words that a line does not take are refused."""

from __future__ import annotations

import numpy as np
import pytest

from robomill.errors import GCodeError
from robomill.toolpath.gcode import interpret
from robomill.toolpath.gcode.chords import to_toolpath


@pytest.mark.parametrize("shift", ["G10 L2 P1", "G10 L20 P1", "G92", "G52"])
@pytest.mark.parametrize("back", ["", "G55\nG54\n"])  # as it is set, and as it is kept
def test_degrees_are_degrees_in_inches_too(shift, back):
    found = {}
    for unit, size in (("G21", 25.4), ("G20", 1.0)):
        before = f"{unit} G90 G94 F100\nG0 X{size} Y0 A5 B0\n{shift} X{2 * size} A30 B-12\n{back}"
        program = interpret(f"{before}G1 X{3 * size} Y{size} A10 B4\nM2\n")
        found[unit] = to_toolpath(program)
    np.testing.assert_allclose(found["G20"].k, found["G21"].k, atol=1e-12)
    np.testing.assert_allclose(found["G20"].p, found["G21"].p, atol=1e-12)
    assert np.ptp(found["G21"].k[:, 1]) > 0.1, "the axes do turn"


@pytest.mark.parametrize("kind", [2, 20])
@pytest.mark.parametrize("letters", ["I1", "J1", "I1 J2"])
def test_a_system_takes_no_centre(kind, letters):
    with pytest.raises(GCodeError, match=f"Line 2: G10 L{kind} takes no I or J"):
        interpret(f"G21\nG10 L{kind} P1 X1 {letters}\nM2\n")


def read(text, *numbers):
    """What the parameters hold at the end of a program, as moves of X."""
    kept = " ".join(f"#{101 + i}=#{number}" for i, number in enumerate(numbers))
    shown = "".join(f"G53 G0 X#{101 + i}\n" for i in range(len(numbers)))
    program = interpret(f"{text}{kept}\n{shown}M2\n")
    return program.end[-len(numbers) :, 0] * 1e3


HERE = (5420, 5421, 5422)


@pytest.mark.parametrize("rotation", [0.0, 30.0, -115.0])
@pytest.mark.parametrize("g92", ["", "G92 X11 Y-4 Z2\n"])
def test_where_the_tool_stands_becomes_what_g10_l20_says(rotation, g92):
    start = f"G21 G90\nG10 L2 P1 X7 Y-3 Z1 R{rotation}\nG54\nG0 X5 Y3 Z2\n{g92}"
    x, y, z = read(start, *HERE)
    np.testing.assert_allclose(read(f"{start}G10 L20 P1 X1 Y2\n", *HERE), [1, 2, z], atol=1e-9)
    # What is not named stays as it is read.
    np.testing.assert_allclose(read(f"{start}G10 L20 P1 X1\n", *HERE), [1, y, z], atol=1e-9)
    np.testing.assert_allclose(read(f"{start}G10 L20 P1 Z-6\n", *HERE), [x, y, -6], atol=1e-9)
    # The tool has not moved, in this system nor in another.
    for system, code in ((1, "G54"), (2, "G55")):
        turned = f"G10 L2 P2 R{2 * rotation}\n" if system == 2 else ""
        program = interpret(f"{start}{turned}G10 L20 P{system} X1 Y2 Z3\n{code}\nG0 X1 Y2 Z3\nM2\n")
        np.testing.assert_allclose(program.end[-1], program.start[-1], atol=1e-12)


def test_a_shift_put_aside_and_taken_up_again_is_the_same():
    shift = "G21 G90\nG0 X5 Y6 Z7\nG92 X1 Y20 Z300 A4 B5\n"
    there = interpret(f"{shift}G0 X2 Y3 Z4\nM2\n").end[-1]
    again = interpret(f"{shift}G92.2\nG0 X9 Y9 Z9\nG92.3\nG0 X2 Y3 Z4\nM2\n").end
    np.testing.assert_allclose(again[-1], there, atol=1e-12)
    np.testing.assert_allclose(again[-2], [9e-3, 9e-3, 9e-3], atol=1e-12)
    np.testing.assert_allclose(there, [6e-3, -11e-3, -289e-3], atol=1e-12)
