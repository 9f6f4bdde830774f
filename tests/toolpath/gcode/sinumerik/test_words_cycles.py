"""Drilling, boring and tapping of Sinumerik controls: every move as the manual's sequence of operations has it."""

from __future__ import annotations

import numpy as np
import pytest

from robomill.errors import GCodeError
from robomill.toolpath.gcode import interpret
from tests.toolpath.gcode.sinumerik.moves import HEAD, ends, places


def heights(body: str) -> list[tuple[str, float]]:
    return [(kind, z) for kind, _, _, z in ends(body)]


def _at_feed(*heights: float) -> list[tuple[str, float]]:
    return [("F", z) for z in heights]


ABOVE = "G0 X0 Y0 Z50\n"
HOLES = [
    ("CYCLE81(50,0,2,-10)", [("R", 2), ("F", -10), ("R", 50)]),
    ("CYCLE81(50,0,2,,10)", [("R", 2), ("F", -10), ("R", 50)]),
    ("CYCLE81(2,0,2,-10)", [("R", 2), ("F", -10), ("R", 2)]),  # it may retract to no more than where it plunges from
    ("CYCLE82(50,1,2,-10,,0.5)", [("R", 3), ("F", -10), ("R", 50)]),
    ("CYCLE83(50,0,2,-10,,-4,,0,0,0,1,0)", [("R", 2), *_at_feed(-4, -3, -8, -7, -10), ("R", 50)]),
    ("CYCLE83(50,0,2,,10,,6,1,0,0,1,1)", [("R", 2), ("F", -6), ("R", 2), ("R", -5.4), ("F", -10), ("R", 50)]),
    (  # each peck is DAM less than the one before, and DAM at least: 6, 4, 2, and what is left in two halves
        "CYCLE83(50,0,2,,15,,6,2,0,0,1,0)",
        [("R", 2), *_at_feed(-6, -5, -10, -9, -12, -11, -13.5, -12.5, -15), ("R", 50)],
    ),
    (  # a factor: 6, 3, 1.5 and never less than MDEP, 1.2; the chip breaks by VRT, 0.5
        "CYCLE83(50,0,2,,14,,6,-.5,0,0,1,0,,1.2,.5)",
        [("R", 2), *_at_feed(-6, -5.5, -9, -8.5, -10.5, -10, -11.7, -11.2, -12.9, -12.4, -14), ("R", 50)],
    ),
    (  # DIS1 says how far above the depth a rapid ends that goes back into the hole; else a 50th of a deep one
        "CYCLE83(50,0,2,,10,,6,0,0,0,1,1,,,,,1.5)",
        [("R", 2), ("F", -6), ("R", 2), ("R", -4.5), ("F", -10), ("R", 50)],
    ),
    ("CYCLE83(50,0,2,,60,,40,0,0,0,1,1)", [("R", 2), ("F", -40), ("R", 2), ("R", -38.8), ("F", -60), ("R", 50)]),
    ("CYCLE83(50,0,2,,500,,400,0,0,0,1,1)", [("R", 2), ("F", -400), ("R", 2), ("R", -393), ("F", -500), ("R", 50)]),
    (  # not above where it came from
        "CYCLE83(50,0,2,,10,,6,0,0,0,1,1,,,,,9)",
        [("R", 2), ("F", -6), ("R", 2), ("F", -10), ("R", 50)],
    ),
    ("CYCLE84(50,0,2,-10,,0,5,,1.5)", [("R", 2), ("F", -10), ("F", 2), ("R", 50)]),
    ("CYCLE85(50,0,2,-10,,0,60,120)", [("R", 2), ("F", -10), ("F", 2), ("R", 50)]),
    ("CYCLE86(50,0,2,-10,,0.5,3)", [("R", 2), ("F", -10), ("R", 50)]),
    ("R1=50\nCYCLE81(R1,0,R1/25,-10)", [("R", 2), ("F", -10), ("R", 50)]),
]


@pytest.mark.parametrize(("call", "moves"), HOLES)
def test_a_cycle_drills_where_the_tool_stands(call: str, moves: list[tuple[str, float]]) -> None:
    assert heights(f"{ABOVE}{call}\n")[1:] == moves


def test_cycles_have_feeds_and_dwells_of_their_own() -> None:
    bored = interpret(f"{HEAD}{ABOVE}CYCLE85(50,0,2,-10,,0.5,60,120)\nM30\n", dialect="sinumerik")
    assert bored.v_f * 6e4 == pytest.approx([0, 0, 60, 120, 0])
    assert bored.dwell_time == pytest.approx(0.5)
    tapped = interpret(f"{HEAD}{ABOVE}CYCLE84(50,0,2,-10,,0,5,,1.5)\nM30\n", dialect="sinumerik")
    assert tapped.v_f[2] * 6e4 == pytest.approx(1.5 * 500)
    assert tapped.thread.tolist() == [False, False, True, True, False]


CYCLES = {  # RTP 50, RFP 1, SDIS 2, DP -10: each move's height, feed and dwell, as the manual's sequence of operations
    "CYCLE81(50,1,2,-10)": [(3, 0, 0), (-10, 100, 0), (50, 0, 0)],
    "CYCLE81(50,1,2,-10,,,0)": [(3, 0, 0), (-10, 100, 0), (50, 0, 0)],
    "CYCLE81(50,1,-2,,-11)": [(3, 0, 0), (-10, 100, 0), (50, 0, 0)],
    "CYCLE81(50,1,,-10)": [(1, 0, 0), (-10, 100, 0), (50, 0, 0)],
    "CYCLE82(50,1,2,-10,,0.5)": [(3, 0, 0), (-10, 100, 0), (50, 0, 0.5)],
    # DTB is waited at every depth, DTS above the hole where chips are brought out of it (VARI 1)
    "CYCLE83(50,1,2,-10,,-4,,0,0.5,9,1,0)": [
        *((3, 0, 0), (-4, 100, 0), (-3, 100, 0.5), (-9, 100, 0), (-8, 100, 0.5), (-10, 100, 0), (50, 0, 0.5)),
    ],
    "CYCLE83(50,1,2,-10,,-5,,0,0.5,9,1,0,,,2,1.5)": [  # DTD at the bottom
        *((3, 0, 0), (-5, 100, 0), (-3, 100, 0.5), (-10, 100, 0), (50, 0, 1.5)),
    ],
    "CYCLE83(50,1,2,-10,,-6,,0,0.5,2,1,1)": [
        *((3, 0, 0), (-6, 100, 0), (3, 0, 0.5), (-5.4, 0, 2), (-10, 100, 0), (50, 0, 0.5)),
    ],
    "CYCLE83(50,1,2,-10,,-4,,0,0,0,0.25,0)": [
        *((3, 0, 0), (-4, 25, 0), (-3, 100, 0), (-9, 100, 0), (-8, 100, 0), (-10, 100, 0), (50, 0, 0)),
    ],
    "CYCLE83(50,1,2,-10,,,20,0,0,0,0.25,0)": [(3, 0, 0), (-10, 25, 0), (50, 0, 0)],
    "CYCLE83(50,1,2,-10,,-6,,0,0,0,0,1)": [
        *((3, 0, 0), (-6, 100, 0), (3, 0, 0), (-5.4, 0, 0), (-10, 100, 0), (50, 0, 0)),
    ],
    "CYCLE83(50,1,2,-10,,-6,,0,0,0,0.5,1)": [
        *((3, 0, 0), (-6, 50, 0), (3, 0, 0), (-5.4, 0, 0), (-10, 100, 0), (50, 0, 0)),
    ],
    "CYCLE84(50,1,2,-10,,0.5,5,,-1.5)": [(3, 0, 0), (-10, 750, 0), (3, 750, 0.5), (50, 0, 0)],
    "CYCLE84(50,1,2,-10,,0,5,,.8,0,1000,2000)": [(3, 0, 0), (-10, 800, 0), (3, 1600, 0), (50, 0, 0)],
    "CYCLE84(50,1,2,-10,,0,5,,.8,0,1000,0,0,1)": [(3, 0, 0), (-10, 800, 0), (3, 800, 0), (50, 0, 0)],
    "CYCLE81(50,1,2,-10,,0.5)": [(3, 0, 0), (-10, 100, 0), (50, 0, 0.5)],
    "CYCLE81(50,1,2,-12,9)": [(3, 0, 0), (-8, 100, 0), (50, 0, 0)],
    "CYCLE81(50,1,2,-10,0)": [(3, 0, 0), (-10, 100, 0), (50, 0, 0)],
    "CYCLE85(50,1,2,-10,,0.5,60,120)": [(3, 0, 0), (-10, 60, 0), (3, 120, 0.5), (50, 0, 0)],
    "CYCLE86(50,1,2,-10,,0.5,3)": [(3, 0, 0), (-10, 100, 0), (50, 0, 0.5)],
    "CYCLE89(50,1,2,-10,,0.5)": [(3, 0, 0), (-10, 100, 0), (3, 100, 0.5), (50, 0, 0)],
}


@pytest.mark.parametrize("call", CYCLES)
@pytest.mark.parametrize("feed", ["F100", "G95 F0.2"])
def test_cycles_move_as_the_manual_says(call: str, feed: str) -> None:
    """840D sl, Programming cycles externally. FRF of CYCLE83 slows the way to the first depth alone (0 is 1)."""
    head = HEAD.replace("F100", feed)
    program = interpret(f"{head}{ABOVE}{call}\nM30\n", dialect="sinumerik")
    heights, feeds, waits = np.transpose(CYCLES[call])
    np.testing.assert_allclose(program.end[1:, 2] * 1e3, heights, atol=1e-9)
    np.testing.assert_allclose(program.v_f[1:] * 6e4, feeds)
    np.testing.assert_allclose(program.dwell[1:], waits)


def test_mcall_drills_behind_every_line_that_moves_until_it_ends() -> None:
    found = places(f"{ABOVE}MCALL CYCLE81(50,0,2,-10)\nX10\nY10\nZ60\nX20 Y20\nMCALL\nX30\n")
    assert [p[:2] for p in found if p[2] == -10] == [(10, 0), (10, 10), (10, 10), (20, 20)]
    assert found[-1] == (30, 20, 50)


@pytest.mark.parametrize(
    ("cycle", "last", "waits"),
    [
        ("CYCLE87(20,0,2,-6,,3)", [("R", 20.0)], 0.0),
        ("CYCLE88(20,0,2,-6,,0.5,3)", [("R", 20.0)], 0.5),
        ("CYCLE89(20,0,2,,6,0.5)", [("F", 2.0), ("R", 20.0)], 0.5),
    ],
)
def test_boring_with_a_stop_and_at_feed_both_ways(cycle: str, last: list[tuple[str, float]], waits: float) -> None:
    """840D sl, Cycles: 87 stops and leaves at rapid, 88 waits before, 89 leaves at the feed that it went in with."""
    assert heights(f"G0 Z20\n{cycle}\n")[-2 - len(last) :] == [("R", 2.0), ("F", -6.0), *last]
    assert interpret(f"{HEAD}{cycle}\nM30\n", dialect="sinumerik").dwell_time == pytest.approx(waits)


def test_the_last_two_pecks_of_a_degression_are_alike() -> None:
    """840D sl, CYCLE83: less by DAM each time, DAM at least, and what is less than twice DAM in two halves."""
    found = [z for kind, z in heights("G0 X5 Z50\nCYCLE83(20,0,2,-15,,,5,2,0,0,1,1)\n") if kind == "F"]
    assert found == [-5, -8, -10, -12, -13.5, -15]


def test_percentages_of_operate_are_read_as_such() -> None:
    """5 mm at 90 % of the feed, then 4.5, 4.05 and 3.645 mm; DAM of the older cycle is an amount, however deep."""
    operate = "CYCLE83(50,0,1,,20,,5,90,0,0,90,1,0,1.2,1.4,0,1.6,10,1,11211111)"
    program = interpret(f"{HEAD}G0 Z60\n{operate}\nM30\n", dialect="sinumerik")
    cuts = program.at_feed
    np.testing.assert_allclose(program.end[cuts, 2] * 1e3, [-5, -9.5, -13.55, -17.195, -20], atol=1e-9)
    np.testing.assert_allclose(program.v_f[cuts] * 6e4, [90, 100, 100, 100, 100])
    assert [(f.line, f.level) for f in program.findings if f.code == "cycle-percent"] == [(3, "warning")]
    found = [z for kind, z in heights("G0 Z50\nCYCLE83(20,0,2,-10,,,2,3,0,0,1,1)\n") if kind == "F"]
    assert found[:2] == [-2, -5]


def test_g331_taps_in_step_with_the_spindle_that_it_turns() -> None:
    """10 turns a second of 1.25 mm are 12.5 mm/s, down to Z and up again; a negative pitch is left-handed."""
    for sign, counter in (("", False), ("-", True)):
        body = f"G0 X5 Y0 Z2\nSPOS=0\nG331 Z-10 K{sign}1.25 S600\nG332 Z2 K={sign}1.25\nG0 Z50\n"
        program = interpret(f"G90 G71 G94 F99\n{body}M30\n", dialect="sinumerik")
        np.testing.assert_allclose(program.end[-3:, 2] * 1e3, [-10, 2, 50])
        assert program.v_f[-3:-1] * 1e3 == pytest.approx([12.5, 12.5])
        assert program.n_s[-3:-1] == pytest.approx([10, 10])
        assert program.ccw[-3:-1].tolist() == [counter, counter]
        assert program.thread[-3:-1].all()
    for pitch in ("", " K0", " K=0.0", " I1"):
        with pytest.raises(GCodeError, match="Line 3: G331 and G332 need K"):
            interpret(f"G90 G71 S600\nG0 Z2\nG331 Z-10{pitch} S600\n", dialect="sinumerik")


def test_a_cycle_that_mcall_holds_is_made_behind_every_line_that_moves() -> None:
    """840D sl, Job Planning, MCALL: after each block with a path movement; a Z alone and an arc are such, M is none."""
    text = f"{HEAD}G0 X0 Y0 Z20\nMCALL CYCLE81(10,0,2,-5)\nX10 Y10\nZ15\nM8\nG2 X20 Y20 CR=10\nMCALL\nG0 Z30\nM30\n"
    program = interpret(text, dialect="sinumerik")
    depths = program.end[program.kind == 1] * 1e3
    np.testing.assert_allclose(depths, [[10, 10, -5], [10, 10, -5], [20, 20, -5]], atol=1e-9)


@pytest.mark.parametrize(("size", "pitch"), [(8, 1.25), (10, 1.5), (3, 0.5), (48, 5.0)])
def test_a_thread_of_a_stated_size_has_its_coarse_pitch(size: int, pitch: float) -> None:
    """M8 taps with 1.25 mm a turn; at 120 turns a minute that is 2.5 mm/s."""
    head = "G71 G90\nG0 X0 Y0 Z9 S100 M3\n"
    program = interpret(f"{head}CYCLE84(9,0,1,-5,,0,3,{size},,0,120,120)\nM30\n", dialect="sinumerik")
    assert program.v_f[program.thread].max() == pytest.approx(2.0e-3 * pitch)
    with pytest.raises(GCodeError, match="needs PIT"):
        interpret(f"{head}CYCLE84(9,0,1,-5,,0,3,7.5,,0,120,120)\nM30\n", dialect="sinumerik")
