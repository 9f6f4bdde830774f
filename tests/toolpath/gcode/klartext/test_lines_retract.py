"""M140: back along the tool, at a feed of its own or at rapid (iTNC 530, User's Manual: M140, blocks 250 and 251)."""

from __future__ import annotations

import numpy as np
import pytest

from robomill.errors import GCodeError
from robomill.toolpath.gcode import Program, interpret

HEAD = "TOOL CALL 1 Z S1000 F300\nL X+0 Y+38.5 Z+5 FMAX M3\nL Z-5 F100\n"


def read(body: str, unit: str = "MM") -> Program:
    return interpret(f"BEGIN PGM Q {unit}\n{HEAD}{body}END PGM Q {unit}\n")


def told(body: str, unit: str = "MM") -> list[tuple[float, ...]]:
    """Where the moves behind the plunge end (program units) and their feeds (mm/min), 0 for a rapid."""
    program, size = read(body, unit), 25.4 if unit == "INCH" else 1.0
    rows = np.column_stack([program.end * 1e3 / size, program.v_f * 6e4])[2:]
    return [tuple(row) for row in rows.round(6).tolist()]


@pytest.mark.parametrize("block", ["M140 MB50 F750", "L M140 MB 50 F750", "L X+0 Y+38.5 F100 M140 MB 50 F750"])
def test_its_feed_is_that_of_the_way_back_alone(block: str) -> None:
    """The manual's block 250; the cut behind it goes on at 100."""
    assert told(f"{block}\nL X+3\n") == [(0, 38.5, 45, 750), (3, 38.5, 45, 100)]


@pytest.mark.parametrize("feed", ["", " FMAX", " F MAX"])
def test_without_a_feed_it_is_a_rapid(feed: str) -> None:
    assert told(f"M140 MB 50{feed}\nL X+3\n") == [(0, 38.5, 45, 0), (3, 38.5, 45, 100)]


def test_fauto_is_the_feed_of_the_tool_call_and_counts_as_any_feed() -> None:
    """In inches feeds count in tenths of an inch a minute: 300 is 30 in/min, 762 mm/min."""
    assert told("M140 MB 2 F AUTO\n") == [(0, 38.5, -3, 300)]
    assert told("M140 MB 2 F AUTO\n", "INCH") == [(0, 38.5, -3, 762)]


def test_to_the_end_of_its_way_beside_the_place_where_the_tool_is() -> None:
    """The manual's block 251 says the place once more: where the retract ends only the machine knows."""
    program = read("L X+0 Y+38.5 F125 M140 MB MAX\n")
    assert program.away[-1].tolist() == [False, False, True]


@pytest.mark.parametrize("move", ["L X+1 Y+38.5 F125", "L IZ+1", "CC X+0 Y+0\nC X+0 Y+38.5 DR+"])
def test_beside_a_move_it_is_refused(move: str) -> None:
    with pytest.raises(GCodeError, match="M140 beside a move is not read; put it on a line of its own"):
        read(f"{move} M140 MB 50 F750\n")


def test_a_feed_per_turn_is_refused() -> None:
    with pytest.raises(GCodeError, match="Line 6: M136 would count the F of M140 per turn"):
        read("L X+0 F0.2 M136\nM140 MB 50 F750\n")
