"""Holes by their laws: what taps goes a pitch a turn, in and out."""

from __future__ import annotations

import numpy as np
import pytest

from robomill.errors import GCodeError
from robomill.toolpath.gcode import interpret

HEAD = "G71 G90\nM3 S500 F100\nG0 X0 Y0 Z50\n"


@pytest.mark.parametrize(
    ("said", "pitch", "turns"),
    [
        (",,0.8,0,1000,2000", 0.8, (1000, 2000)),
        (",,-1.25,0,400,250", 1.25, (400, 250)),
        (",,0.8,0,1000", 0.8, (1000, 1000)),
        (",,1.5", 1.5, (500, 500)),
        (",8,,0,120,240", 1.25, (120, 240)),
    ],
)
def test_a_tap_goes_a_pitch_a_turn_as_fast_as_it_turns_in_and_out(said: str, pitch: float, turns: tuple) -> None:
    """CYCLE84 with its SST and SST1; what turned before and turns behind it is the spindle's S."""
    program = interpret(f"{HEAD}CYCLE84(50,1,2,-10,,0,5{said})\nG1 X9\nM30\n", dialect="sinumerik")
    tapped = program.thread
    assert np.flatnonzero(tapped).size == 2
    np.testing.assert_allclose(program.n_s[tapped] * 60.0, turns)
    np.testing.assert_allclose(program.v_f[tapped] / program.n_s[tapped], pitch * 1e-3)
    np.testing.assert_allclose(program.n_s[[0, -1]] * 60.0, 500.0)


@pytest.mark.parametrize(("retract", "drills"), [(3.0, True), (2.999, False), (50.0, True)])
def test_a_cycle_may_go_back_to_where_it_begins_and_no_lower(retract: float, drills: bool) -> None:
    """It begins 2 mm above a surface at 1 mm."""
    text = f"{HEAD}CYCLE81({retract},1,2,-10)\nM30\n"
    if not drills:
        with pytest.raises(GCodeError, match=r"expected RTP above RFP \+ SDIS"):
            interpret(text, dialect="sinumerik")
        return
    heights = interpret(text, dialect="sinumerik").end[-3:, 2] * 1e3
    np.testing.assert_allclose(heights[np.append(True, np.diff(heights) != 0.0)][-2:], [-10.0, retract])
