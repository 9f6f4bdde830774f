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


DRILLS = (
    "3 2.5, 4 3.3, 5 4.2, 6 5, 8 6.8, 10 8.5, 12 10.2, 14 12, 16 14, 18 15.5, 20 17.5, 22 19.5, 24 21, 27 24, "
    "30 26.5, 33 29.5, 36 32, 39 35, 42 37.5, 45 40.5, 48 43"
)
"""Coarse metric threads and the drill for the tap of each, mm (DIN 336)."""


@pytest.mark.parametrize("thread", DRILLS.split(", "))
@pytest.mark.parametrize("inches", [False, True])
def test_a_tap_of_a_stated_size_fits_the_hole_that_is_drilled_for_it(thread: str, inches: bool) -> None:
    """A drill is a pitch smaller than its thread, to the tenth of a millimetre in which drills are sold."""
    size, drill = map(float, thread.split())
    head = HEAD.replace("G71", "G70") if inches else HEAD
    program = interpret(f"{head}CYCLE84(50,1,2,-10,,0,5,{size:g},,0,60,60)\nM30\n", dialect="sinumerik")
    pitch = program.v_f[program.thread].max() * 1e3  # one turn a second
    assert size - pitch == pytest.approx(drill, abs=0.051)
    assert pitch * 20 == pytest.approx(round(pitch * 20), abs=1e-9)


@pytest.mark.parametrize(("unit", "pitch"), [("", 25.4), (",,0", 25.4), (",,1", 1.0)])
def test_a_pitch_counts_in_the_units_of_the_program_or_in_millimetres(unit: str, pitch: float) -> None:
    """PIT 1 of a program in inches, with _PITA left out, 0 and 1."""
    text = f"{HEAD.replace('G71', 'G70')}CYCLE84(50,1,2,-10,,0,5,,1,0,60,60{unit})\nM30\n"
    program = interpret(text, dialect="sinumerik")
    assert program.v_f[program.thread].max() * 1e3 == pytest.approx(pitch)


@pytest.mark.parametrize(("step", "pecks"), [(4, 4), (5, 3), (3.9, None)])
def test_so_many_pecks_and_no_more_are_made(monkeypatch: pytest.MonkeyPatch, step: float, pecks: int | None) -> None:
    """The way to the bottom, 20 mm below the surface, is no peck."""
    monkeypatch.setattr("robomill.toolpath.gcode.sinumerik.holes.MAX_PECKS", 4)
    text = f"{HEAD}CYCLE83(50,0,2,,20,,{step},0,0,0,1,1)\nM30\n"
    if pecks is None:
        with pytest.raises(GCodeError, match="more than 4 pecks"):
            interpret(text, dialect="sinumerik")
        return
    depths = interpret(text, dialect="sinumerik").end[:, 2] * 1e3
    np.testing.assert_allclose(np.unique(depths[depths < 0.0])[0], -20.0)
    out = np.flatnonzero(np.diff(depths) > 0.0)
    assert len(out) == pecks + 1


@pytest.mark.parametrize(
    ("line", "drills"), [("G0 X9", 1), ("G1 X9", 1), ("G2 X9 CR=9", 1), ("G3 X9 CR=9", 1), ("M8", 0), ("G4 F1", 0)]
)
def test_a_cycle_that_mcall_holds_follows_whatever_moves(line: str, drills: int) -> None:
    program = interpret(f"{HEAD}MCALL CYCLE81(50,1,2,-10)\n{line}\nMCALL\nG1 X20\nM30\n", dialect="sinumerik")
    assert (program.end[:, 2] < -9e-3).sum() == drills


@pytest.mark.parametrize(
    ("cycle", "drills"),
    [
        ("CYCLE81(50,1,2,-10)", False),
        ("CYCLE85(50,1,2,-10,,0,60,120)", True),
        ("CYCLE84(50,1,2,-10,,0,5,,1)", True),
        ("CYCLE84(50,1,2,-10,,0,5,,1.5)", True),
    ],
)
@pytest.mark.parametrize("feed", ["", "F0.5", "F1"])
def test_a_hole_needs_a_feed_of_its_own_or_of_the_program(cycle: str, drills: bool, feed: str) -> None:
    """What taps has one by its pitch and turns."""
    text = f"G71 G90\nM3 S500 {feed}\nG0 X0 Y0 Z50\n{cycle}\nM30\n"
    if drills or feed:
        assert interpret(text, dialect="sinumerik").end[:, 2].min() == pytest.approx(-10e-3)
        return
    with pytest.raises(GCodeError, match="Line 4: a drilling cycle needs a feed rate"):
        interpret(text, dialect="sinumerik")


@pytest.mark.parametrize("feeds", [(60.0, 120.0), (0.5, 0.8), (1.0, 1.0), (0.0, 0.0)])
def test_a_bore_goes_in_and_out_at_feeds_however_slow(feeds: tuple[float, float]) -> None:
    """FFR and RFF of CYCLE85; in at the feed of the program where nothing is said, and out at rapid."""
    program = interpret(f"{HEAD}CYCLE85(50,1,2,-10,,0,{feeds[0]},{feeds[1]})\nM30\n", dialect="sinumerik")
    bottom = int(np.argmin(program.end[:, 2]))
    assert program.v_f[bottom] * 6e4 == pytest.approx(feeds[0] or 100.0)
    assert program.v_f[bottom + 1] * 6e4 == pytest.approx(feeds[1])
