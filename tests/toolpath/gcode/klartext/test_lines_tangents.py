"""CT needs a direction to go on in: which lines before it leave one, and which none."""

from __future__ import annotations

import numpy as np
import pytest

from robomill.errors import GCodeError
from robomill.toolpath.gcode import interpret

HEAD = "BEGIN PGM A MM\nTOOL CALL 1 Z S99 F100\nL X+0 Y+0 Z+5 R0 FMAX M3\n"


@pytest.mark.parametrize(
    ("before", "way"),
    [
        ("L X+20\n", 1),
        ("CC X+10 Y+0\nC X+20 Y+0 DR+\n", 1j),  # half around to (20, 0), where it goes up
        ("CC X+10 Y+0\nC X+20 Y+0 DR-\n", -1j),
        ("CR X+20 Y+0 R+10 DR+\n", 1j),
        ("CC X+9 Z+5\nC X+18 Z+5 DR+\nL X+20\n", 1),  # of the line behind the arc in ZX
    ],
)
def test_ct_goes_on_from_lines_and_arcs_in_its_plane(before: str, way: complex) -> None:
    """The spoke to the first point is square to the way there, and as long as that to the last."""
    program = interpret(f"{HEAD}{before}CT X+25 Y+7\nEND PGM A MM\n")
    start, end, centre = (complex(*place[-1, :2]) * 1e3 for place in (program.start, program.end, program.centre))
    np.testing.assert_allclose([start, end], [20, 25 + 7j], atol=1e-6)
    assert abs(start - centre) == pytest.approx(abs(end - centre))
    turn = -1.0 if program.sweep[-1] < 0.0 else 1.0
    assert 1j * turn * (start - centre) / abs(start - centre) == pytest.approx(way, abs=1e-6)


@pytest.mark.parametrize(
    "before",
    ["", "L Z+3\n", "CC X+10 Z+5\nC X+20 Z+5 DR+\n", "CC X+10 Y+0\nC X+20 Y+0 DR+\nL Z+3\n"],
)
def test_ct_behind_what_has_no_direction_in_the_plane_is_refused(before: str) -> None:
    line = 4 + before.count("\n")
    with pytest.raises(
        GCodeError, match=f"^Line {line}: CT goes on tangentially, and the line before has no direction"
    ):
        interpret(f"{HEAD}{before}CT X+25 Y+7\nEND PGM A MM\n")
