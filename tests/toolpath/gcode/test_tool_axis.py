"""Directions of the tool as angles."""

from __future__ import annotations

import numpy as np
import pytest

from robomill.errors import GCodeError
from robomill.toolpath.gcode import interpret, read_gcode
from robomill.toolpath.gcode.chords import tool_axis
from robomill.toolpath.gcode.tool_axis import angles_of


def test_the_angles_stand_for_the_direction_whatever_its_length() -> None:
    rng = np.random.default_rng(5)
    for axis in [*rng.normal(size=(200, 3)), *np.eye(3), *-np.eye(3)]:
        a, b = angles_of(tuple(7.0 * axis), tuple(rng.uniform(-900, 900, 2)))
        k = tool_axis(np.radians([a, b, 0.0]))
        np.testing.assert_allclose(k, axis / np.linalg.norm(axis), atol=1e-12)


def test_an_axis_that_goes_round_steadily_has_angles_that_do() -> None:
    """Over the pole of A (the tool along X) and round by more than a turn: no angle ever jumps."""
    for turned in (
        lambda t: (np.sin(t), 0.02 * np.cos(t), np.cos(t)),
        lambda t: (0.3, np.cos(t), np.sin(t)),
        lambda t: (np.cos(t), 0.0, np.sin(t)),
    ):
        before = angles_of(turned(0.0), (0.0, 0.0))
        for t in np.linspace(0.0, 8.0, 4000)[1:]:
            now = angles_of(turned(t), before)
            assert max(abs(n - b) for n, b in zip(now, before)) < 20.0
            before = now


@pytest.mark.parametrize("frame", ["", "TRAORI\n"])
def test_a3_b3_c3_is_the_direction_of_the_tool_on_a_sinumerik(frame: str) -> None:
    """840D, Job planning, TRAORI: its length is of no significance, and what is not given is 0."""
    lines = "G1 X1 A3=0 B3=0 C3=1\nX2 A3=3 C3=4\nX3 B3=-0.6 C3=0.8\nX4 A3=-2\nY5\n"
    path = read_gcode(f"G71 G90 F500\n{frame}{lines}M30\n")
    for x, k in ((1, (0, 0, 1)), (2, (0.6, 0, 0.8)), (3, (0, -0.6, 0.8)), (4, (-1, 0, 0))):
        row = np.flatnonzero(np.isclose(path.p[:, 0], x * 1e-3))[-1]
        np.testing.assert_allclose(path.k[row], k, atol=1e-9)
        assert path.cutting[row]


@pytest.mark.parametrize(
    ("words", "says"),
    [
        ("A3=0 B3=0 C3=0", "the tool axis A3= B3= C3= is 0; expected a direction"),
        ("A2=10 B2=5", "A2= gives the tool's orientation in a way that is not read; write its direction as A3="),
        ("LEAD=5", "LEAD= gives the tool's orientation"),
        ("B5=1", "B5= gives the tool's orientation"),
    ],
)
def test_other_ways_to_say_it_are_refused_by_name(words: str, says: str) -> None:
    with pytest.raises(GCodeError, match=f"Line 2: {says}"):
        interpret(f"G71 G90 F500\nG1 X1 {words}\nM30\n", dialect="sinumerik")


@pytest.mark.parametrize("line", ["G90 G1 X2. I0 J0 K1.", "G90\nG1 X2. I0 J0 K1."])
def test_directions_of_a_line_that_goes_back_to_places_are_directions(line: str) -> None:
    """G90 on the same line, behind G91 G28 Z0: the angles of the direction are no steps from those before."""
    path = read_gcode(f"G21 G90 G94 F100\nG1 X1. I0.6 J0 K0.8\nG91 Z1.\n{line}\nM30\n", dialect="fanuc")
    np.testing.assert_allclose(path.k[-1], [0, 0, 1], atol=1e-12)
