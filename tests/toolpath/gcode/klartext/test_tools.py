"""What a TOOL CALL of Heidenhain's dialogue changes, and what stays as it was."""

from __future__ import annotations

import numpy as np
import pytest

from robomill.errors import GCodeError
from robomill.toolpath.gcode import interpret


def feeds(body: str) -> list[float]:
    """mm/min of what moves at feed."""
    program = interpret(f"BEGIN PGM A MM\n{body}END PGM A MM\n")
    return (np.round(program.v_f[program.kind == 1] * 6e4, 6) + 0.0).tolist()


@pytest.mark.parametrize(
    ("call", "after"),
    [
        ("TOOL CALL DR+0", 50),  # says nothing of feed and turns
        ("TOOL CALL DL+0", 50),
        ("TOOL CALL S2000", 200),  # 0.1 mm a turn goes on at the new turns
        ("TOOL CALL FU0.2", 200),
        ("TOOL CALL S500 FU0.2", 100),
        ("TOOL CALL F70", 70),
        ("TOOL CALL F70 S2000", 70),
    ],
)
def test_a_call_takes_up_a_feed_where_it_says_one_or_new_turns(call: str, after: float) -> None:
    body = f"TOOL CALL 1 Z S1000 FU0.1\nL X+0 Y+0 Z+0 FMAX M3\nL X+1\nL X+2 F50\n{call}\nL X+3\n"
    assert feeds(body) == [100, 50, after]


def test_a_feed_per_turn_ends_with_its_tool_or_a_feed_a_minute() -> None:
    head = "TOOL CALL 1 Z S1000 FU0.1\nL X+0 Y+0 Z+0 FMAX M3\nL X+1\n"
    assert feeds(f"{head}TOOL CALL F70\nTOOL CALL S2000\nL X+2\n") == [100, 70]
    with pytest.raises(GCodeError, match="FAUTO is the feed of TOOL CALL, which has none"):
        feeds(f"{head}TOOL CALL 2 Z S2000\nL X+2 FAUTO\n")
    for none in ("TOOL CALL 1 Z FU0.1", "TOOL CALL 1 Z S0 FU0.1"):
        with pytest.raises(GCodeError, match="FU counts per turn, and TOOL CALL has no S"):
            feeds(f"{none}\nL X+1\n")
    with pytest.raises(GCodeError, match="DL.0.5, which is not read"):
        feeds("TOOL CALL 1 Z S9 F9 DL+0.5\nL X+1\n")
