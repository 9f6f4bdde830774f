"""Canned cycles of APT: where they drill, how fast, how long they wait; what can mean two things is refused."""

from __future__ import annotations

import numpy as np
import pytest

from robomill.errors import GCodeError
from robomill.toolpath.apt import read_apt

HEAD = "PARTNO/X\nUNITS/MM\nFEDRAT/600\n"


def test_a_feed_per_turn_of_a_cycle_follows_the_spindle_too() -> None:
    """0.2 mm a turn: at 10 turns a second 2 mm/s, at 20 4 mm/s; where the spindle stands there is no feed."""
    cycle, holes = "CYCLE/DRILL,DEPTH,4,MMPR,0.2,CLEAR,2\n", "GOTO/1,0,0\nSPINDL/1200,CLW\nGOTO/2,0,0\nCYCLE/OFF\n"
    for head in (f"{cycle}SPINDL/600,CLW\n", f"SPINDL/600,CLW\n{cycle}"):
        path = read_apt(f"UNITS/MM\nFROM/0,0,9\n{head}{holes}FINI\n")
        np.testing.assert_allclose(path.v_f[path.cutting] * 1e3, [2, 4])
        np.testing.assert_allclose(path.p[path.cutting, 2] * 1e3, -4)
    with pytest.raises(GCodeError, match="Line 4: the cycle's feed counts per turn, and the spindle stands"):
        read_apt(f"UNITS/MM\nFROM/0,0,9\n{cycle}{holes}FINI\n")


CYCLES = [
    ("DRILL, 20, MMPM, 120, 2", [(2, 0), (-20, 120), (2, 0)]),
    ("DRILL, DEPTH, 20, MMPM, 120, CLEAR, 2", [(2, 0), (-20, 120), (2, 0)]),
    ("DRILL, FEDTO, -20, RAPTO, 2, RTRCTO, 7, MMPM, 120", [(7, 0), (2, 0), (-20, 120), (2, 0), (7, 0)]),
    ("BORE, DEPTH, 20, MMPM, 120, CLEAR, 2", [(2, 0), (-20, 120), (2, 120)]),
    ("DEEP, DEPTH, 4, MMPM, 120, CLEAR, 2, STEP, 4", [(2, 0), (-2, 120), (2, 0), (-2, 0), (-4, 120), (2, 0)]),
    ("DRILL,DEEP, DEPTH, 4, IPM, 5, CLEAR, 2, STEP, 9", [(2, 0), (-4, 127), (2, 0)]),
]


@pytest.mark.parametrize(("words", "moves"), CYCLES)
def test_a_cycle_drills_at_every_point_along_the_tool(words: str, moves: list[tuple[float, float]]) -> None:
    text = f"{HEAD}FROM/0,0,50\nCYCLE/{words}\nGOTO/10,0,0\nGOTO/30,0,0,1,0,0\nCYCLE/OFF\nGOTO/0,0,60,0,0,1\nFINI\n"
    path = read_apt(text)
    found = [(round(z, 9), round(v, 9)) for z, v in zip(path.p[:, 2] * 1e3, path.v_f * 6e4)]
    assert found[:2] == [(50, 0), (50, 0)]
    assert path.p[1] * 1e3 == pytest.approx([10, 0, 50])
    assert found[2 : 2 + len(moves)] == [pytest.approx(move) for move in moves]
    along_x = path.p[2 + len(moves) : -1, 0] * 1e3 - 30
    assert [pytest.approx(height) for height, _ in moves] == list(along_x)[-len(moves) :]
    assert path.cutting[-1]


def test_a_tool_dwells_at_the_bottom_of_each_hole_alone() -> None:
    cycle = "CYCLE/DRILL,DEPTH,4,MMPM,120,CLEAR,0.5,DWELL,1.5,RTRCTO,0.8"
    path = read_apt(f"{HEAD}FROM/0,0,50\n{cycle}\nGOTO/10,0,0\nGOTO/30,0,0\nCYCLE/OFF\nGOTO/0,0,60\nFINI\n")
    assert (path.p[path.dwell > 0.0, 2] * 1e3).tolist() == pytest.approx([0.5, 0.5])  # waited before it came out
    assert path.dwell.sum() == pytest.approx(3.0)
    between = (path.p[:, 0] > 9e-3) & (path.p[:, 0] < 31e-3) & (path.p[:, 2] < 49e-3)
    assert path.p[between, 2].max() * 1e3 == pytest.approx(0.8)


BY_WORD = [
    ("CYCLE/DRILL,RAPTO,3.0,FEDTO,-33.0,RTRCTO,AUTO,MMPM,250.0", [3, -33, 3], 250),
    ("CYCLE/DRILL,12.,200.,MMPM,2.", [2, -12, 2], 200),  # the rate before its unit
    ("CYCLE/DRILL,12.,MMPM,200.,2.", [2, -12, 2], 200),
    ("CYCLE/TAP,DEPTH,10,PITCH,1.5,CLEAR,2", [2, -10, 2], 1500),
]


@pytest.mark.parametrize(("cycle", "heights", "rate"), BY_WORD)
def test_numbers_of_a_cycle_by_word_and_by_place(cycle: str, heights: list[float], rate: float) -> None:
    path = read_apt(f"UNITS/MM\nSPINDL/1000,RPM,CLW\nGOTO/0,0,2\n{cycle}\nGOTO/10,0,0\nFINI\n")
    down = path.p[path.p[:, 0] > 5e-3, 2] * 1e3
    assert down[-3:] == pytest.approx(heights)
    assert path.v_f[path.p[:, 2] < 0.0] * 60e3 == pytest.approx([rate])


@pytest.mark.parametrize(
    ("cycle", "says"),
    [
        ("CYCLE/DRILL,126,85,1,MMPR,2", "CYCLE/DRILL has 3 numbers without a word"),
        ("CYCLE/DEEP,20,INCR,5,MMPM,100,2", "CYCLE/DEEP has 'INCR', which is not read"),
    ],
)
def test_a_cycle_that_can_mean_two_things_is_refused(cycle: str, says: str) -> None:
    with pytest.raises(GCodeError, match=f"Line 3: {says}"):
        read_apt(f"UNITS/MM\nGOTO/0,0,2\n{cycle}\nGOTO/10,0,0\nFINI\n")


def test_cycles_of_solidworks_cam() -> None:
    """CYCLE/INIT says nothing; DEEP2 pecks 5 first and then 2 at a time, from 3 above the hole to 10 below it."""
    path = read_apt(
        "UNIT/MM\nSPINDL/2000,RPM,CLW\nRAPID/\nGOTO/15,15,25\nCYCLE/INIT\n"
        "CYCLE/DEEP2,FEDTO,10,1STPECK,5.,SUBPECK,4.,MMPM,200,RAPTO,3.,RTRCTO,25.\nGOTO/15,15,0\nCYCLE/OFF\nFINI\n"
    )
    feeds = [round(float(z) * 1e3, 6) for z, cut in zip(path.p[:, 2], path.cutting) if cut]
    assert feeds == [-2, -6, -10]
    assert path.p[-1, 2] * 1e3 == pytest.approx(25)


def test_the_way_to_a_lower_hole_leads_across_at_the_height_where_the_tool_stands() -> None:
    """After a hole at 0 the tool is at RAPTO 3: over a hole at -5 it goes across at 3, and down to -2 only there."""
    cycle = "CYCLE/DRILL,RAPTO,3,FEDTO,-10,RTRCTO,AUTO,MMPM,250"
    path = read_apt(f"UNITS/MM\nRAPID\nGOTO/0,0,50\n{cycle}\nGOTO/10,0,0\nGOTO/20,0,-5\nCYCLE/OFF\nFINI\n")
    wanted = [(0, 50), (10, 50), (10, 3), (10, -10), (10, 3), (20, 3), (20, -2), (20, -15), (20, -2)]
    np.testing.assert_allclose(path.p[:, [0, 2]] * 1e3, wanted, atol=1e-9)


def test_the_way_to_a_lower_hole_is_as_level_in_another_coordinate_system() -> None:
    """MSYS lies 100 lower and its x axis is y of the first: what is 3 above its zero is 97 below that of the first."""
    cycle = "CYCLE/DRILL,RAPTO,3,FEDTO,-10,MMPM,250"
    frames = "MSYS/0,0,0,1,0,0,0,1,0\nRAPID\nGOTO/0,0,50\nMSYS/0,0,-100,0,1,0,-1,0,0\n"
    path = read_apt(f"UNITS/MM\n{frames}{cycle}\nGOTO/10,0,0\nGOTO/20,0,-5\nCYCLE/OFF\nFINI\n")
    assert path.p[1] * 1e3 == pytest.approx([0, 10, 50])
    np.testing.assert_allclose(path.p[5:7] * 1e3, [(0, 20, -97), (0, 20, -102)], atol=1e-9)


def test_pecks_that_come_out_even_end_at_the_bottom_once() -> None:
    """12 mm in steps of 3 are four pecks, though 0.009 / 0.003 is a little more than 3 in binary."""
    path = read_apt(f"{HEAD}FROM/0,0,50\nCYCLE/DEEP,DEPTH,10,MMPM,60,CLEAR,2,STEP,3\nGOTO/1,0,0\nFINI\n")
    np.testing.assert_allclose(path.p[path.cutting, 2] * 1e3, [-1, -4, -7, -10], atol=1e-9)


def test_a_table_of_pecks_is_refused() -> None:
    """Creo writes several STEP and feeds, each for some of the pecks (Peck Table); the last of them counted for all."""
    cycle = "CYCLE/DEEP,DEPTH,12,STEP,4,STEP,3,IPM,12,STEP,1,IPM,10,CLEAR,1"
    with pytest.raises(GCodeError, match=r"Line 5: CYCLE/DEEP gives STEP more than once \(a table of pecks\)"):
        read_apt(f"{HEAD}FROM/0,0,50\n{cycle}\nGOTO/10,0,0\nCYCLE/OFF\nFINI\n")
