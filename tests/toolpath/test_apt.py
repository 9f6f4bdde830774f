"""APT-CL files."""

from __future__ import annotations

import time
from pathlib import Path

import numpy as np
import pytest

from robomill.errors import GCodeError
from robomill.toolpath.apt import read_apt
from robomill.toolpath.gcode import read_gcode
from robomill.toolpath.text import is_apt

FILE = """PARTNO/ BLADE
$$ a comment
UNITS/INCHES
LOADTL/7
SPINDL/RPM,6000,CLW
MULTAX/ON
FROM/0,0,2
RAPID
GOTO/0,0,0.1,0,0,2
FEDRAT/10,IPM
GOTO/1,0,-0.1,$
 0,0.6,0.8
GODLTA/0,1,0
COOLNT/ON
WHATEVER/1
FINI
GOTO/9,9,9
"""


def test_points_axes_feeds_and_units() -> None:
    path = read_apt(FILE)
    inch = 25.4e-3
    assert path.p / inch == pytest.approx(np.array([[0, 0, 2], [0, 0, 0.1], [1, 0, -0.1], [1, 1, -0.1]]))
    assert path.k[-1] == pytest.approx((0, 0.6, 0.8))
    assert path.v_f == pytest.approx([0, 0, 10 * inch / 60, 10 * inch / 60])
    assert path.cutting.tolist() == [False, False, True, True]
    assert path.block.tolist() == [7, 9, 11, 13]
    assert path.n_s[-1] == pytest.approx(100)
    assert path.tool.tolist() == [7, 7, 7, 7]
    assert [(f.level, f.line) for f in path.findings] == [("ignored", 15)]


def test_apt_files_are_told_from_programs() -> None:
    assert is_apt(FILE.encode())
    assert not is_apt(b"G21\nG0 X1 (GOTO/1,2,3)\nM2\n")


@pytest.mark.parametrize(
    ("text", "says"),
    [
        ("GOTO/0,0,0\nGOTO/1,1,1\n", "Line 2: a cut needs a feed"),
        ("GOTO/0,0\n", "Line 1: found 2 numbers"),
        ("GOTO/0,0,x\n", "Line 1: GOTO has 'x'"),
        ("GOTO/0,0,0,0,0,0\n", "Line 1: the tool axis"),
        ("GOTO/0,0,1e999\n", "Line 1: GOTO has a number that is too large"),
        ("GOTO/0,0,0\nCYCLE/DRILL,5\n", "Line 2: CYCLE/DRILL needs its depth"),
        ("UNITS/FURLONGS\n", "Line 1: UNITS"),
        ("FEDRAT/-5\n", "Line 1: FEDRAT"),
        ("PARTNO/X\nFINI\n", "fewer than two"),
        ("GODLTA/1,1,1\n", "Line 1: GODLTA"),
    ],
)
def test_refusals(text: str, says: str) -> None:
    with pytest.raises(GCodeError) as caught:
        read_apt(text)
    assert says in str(caught.value)


def test_apt_says_it_too() -> None:
    path = read_apt(
        "UNITS/MM\nSPINDL/600,RPM,CCLW\nFEDRAT/60\nGOTO/0,0,0\nGOTO/1,0,0\nDELAY/1.5\nSPINDL/600,CLW\nGOTO/2,0,0\n"
        "DELAY/5,REV\nGOTO/3,0,0\nSPINDL/OFF\nGOTO/4,0,0\nFINI\n"
    )
    assert path.ccw.tolist() == [True, True, False, False, False]
    assert path.dwell.tolist() == [0.0, 0.0, 1.5, 0.5, 0.0]


@pytest.mark.parametrize(
    ("units", "feed", "speed_mm_s"),
    [
        ("MM", "FEDRAT/600", 10),
        ("INCHES", "FEDRAT/6", 2.54),
        ("MM", "FEDRAT/6,IPM", 2.54),
        ("INCHES", "FEDRAT/MMPM,600", 10),
        ("MM", "FEDRAT/0.5,MMPR", 5),
        ("MM", "FEDRAT/0.1,IPR", 25.4),
        ("INCHES", "FEDRAT/0.1,PERREV", 25.4),
        ("MM", "FEDRAT/0.5,PERREV", 5),
    ],
)
def test_feeds_per_minute_and_per_turn(units: str, feed: str, speed_mm_s: float) -> None:
    path = read_apt(f"PARTNO/X\nUNITS/{units}\nSPINDL/600,CLW\n{feed}\nFROM/0,0,10\nGOTO/1,0,0\nFINI\n")
    assert path.v_f[-1] * 1e3 == pytest.approx(speed_mm_s)


@pytest.mark.parametrize("unit", ["MMPR", "PERREV", "IPR"])
def test_a_feed_per_turn_follows_the_spindle_whichever_is_said_first(unit: str) -> None:
    """0.5 a turn at 10 turns a second is 5 a second; at 20, 10; CATIA writes FEDRAT before SPINDL."""
    size = 25.4e-3 if unit == "IPR" else 1e-3
    feed, moves = f"FEDRAT/0.5,{unit}\n", "FROM/0,0,0\nGOTO/1,0,0\nSPINDL/1200,CLW\nGOTO/2,0,0\n"
    for head in (f"{feed}SPINDL/600,RPM,CLW\n", f"SPINDL/600,RPM,CLW\n{feed}"):
        path = read_apt(f"UNITS/MM\n{head}{moves}FEDRAT/60\nGOTO/3,0,0\nSPINDL/OFF\nGOTO/4,0,0\nFINI\n")
        np.testing.assert_allclose(path.v_f, [0, 5 * size, 10 * size, 1e-3, 1e-3])
    with pytest.raises(
        GCodeError, match="Line 4: its feed counts per turn, and the spindle stands; SPINDL comes first"
    ):
        read_apt(f"UNITS/MM\n{feed}FROM/0,0,0\nGOTO/1,0,0\nFINI\n")


def test_a_feed_per_turn_of_a_cycle_follows_the_spindle_too() -> None:
    """0.2 mm a turn: at 10 turns a second 2 mm/s, at 20 4 mm/s; where the spindle stands there is no feed."""
    cycle, holes = "CYCLE/DRILL,DEPTH,4,MMPR,0.2,CLEAR,2\n", "GOTO/1,0,0\nSPINDL/1200,CLW\nGOTO/2,0,0\nCYCLE/OFF\n"
    for head in (f"{cycle}SPINDL/600,CLW\n", f"SPINDL/600,CLW\n{cycle}"):
        path = read_apt(f"UNITS/MM\nFROM/0,0,9\n{head}{holes}FINI\n")
        np.testing.assert_allclose(path.v_f[path.cutting] * 1e3, [2, 4])
        np.testing.assert_allclose(path.p[path.cutting, 2] * 1e3, -4)
    with pytest.raises(GCodeError, match="Line 4: the cycle's feed counts per turn, and the spindle stands"):
        read_apt(f"UNITS/MM\nFROM/0,0,9\n{cycle}{holes}FINI\n")


@pytest.mark.parametrize("seed", range(8))
@pytest.mark.parametrize("turn", [1, -1])
@pytest.mark.parametrize("size", [1.0, 0.02])
def test_an_arc_of_catia_is_the_circle_through_its_start_along_its_tangent(seed: int, turn: int, size: float) -> None:
    """In complex numbers; every chord within a hundredth of a millimetre of the circle, and the whole as long as it."""
    rng = np.random.default_rng(seed)
    centre, radius = complex(*rng.uniform(-40, 40, 2)), size * rng.uniform(5, 30)
    begin, sweep = rng.uniform(-3, 3), rng.uniform(0.3, 6.0)
    start, end = (centre + radius * np.exp(1j * (begin + turn * t)) for t in (0.0, sweep))
    along = 1j * turn * np.exp(1j * begin)
    text = (
        f"UNITS/MM\nFEDRAT/100,MMPM\nFROM/{start.real:.9f},{start.imag:.9f},5\n"
        f"INDIRV/{along.real:.9f},{along.imag:.9f},0\n"
        f"TLON,GOFWD/(CIRCLE/{centre.real:.9f},{centre.imag:.9f},5,{radius:.9f}),ON,"
        f"(LINE/{centre.real:.9f},{centre.imag:.9f},5,{end.real:.9f},{end.imag:.9f},5)\nFINI\n"
    )
    points = read_apt(text).p @ [1e3, 1e3j, 0]
    np.testing.assert_allclose(points[[0, -1]], [start, end], atol=1e-6)
    np.testing.assert_allclose(abs(points - centre), radius, atol=1e-6)
    turned = np.angle((points[1:] - centre) / (points[:-1] - centre))
    assert (turned * turn > 0).all()
    assert abs(turned).sum() == pytest.approx(sweep, abs=1e-6)
    assert (radius * (1 - np.cos(turned / 2))).max() < 0.01


def test_a_rapid_counts_for_one_point() -> None:
    path = read_apt("PARTNO/X\nUNITS/MM\nFEDRAT/600\nFROM/0,0,9\nFEDRAT/RAPID\nGOTO/1,0,0\nGOTO/2,0,0\nFINI\n")
    assert path.cutting.tolist() == [False, False, True]


def test_spindle_on_and_off_and_its_sense() -> None:
    lines = "SPINDL/600,CLW\nGOTO/1,0,0\nSPINDL/OFF\nGOTO/2,0,0\nSPINDL/-300,CCLW\nGOTO/3,0,0\nSPINDL/ON\nGOTO/4,0,0\n"
    path = read_apt(f"PARTNO/X\nUNITS/MM\nFEDRAT/600\nFROM/0,0,9\n{lines}FINI\n")
    assert path.n_s[1:] == pytest.approx([10, 0, 5, 5])
    assert path.ccw[1:].tolist() == [False, False, True, True]


@pytest.mark.parametrize(
    ("line", "found"),
    [
        ("FEDRAT/-1", "expected one rate of 0 or more"),
        ("FEDRAT/IPM", "expected one rate of 0 or more"),
        ("FEDRAT/1,2", "expected one rate of 0 or more"),
        ("SPINDL/SFM,300,CLW", "says the speed of the surface; expected turns per minute"),
        ("FEDRAT/0.1,MMPT", "FEDRAT counts by MMPT, which is not read"),
        ("FEDRAT/0.1,INVERS", "FEDRAT counts by INVERS, which is not read"),
        ("FEDRAT/100,MMPS", "FEDRAT counts by MMPS, which is not read"),
        ("SPINDL/FAST", "expected a speed or OFF"),
    ],
)
def test_rates_that_are_none_are_refused(line: str, found: str) -> None:
    with pytest.raises(GCodeError, match=f"Line 2: .*{found}"):
        read_apt(f"PARTNO/X\n{line}\nFROM/0,0,9\nFINI\n")


def test_a_number_of_a_hundred_thousand_digits_is_refused_at_once():
    """It took minutes: every way to split the digits was tried."""
    began = time.process_time()
    with pytest.raises(GCodeError):
        read_apt(f"GOTO/0,0,0\nGOTO/{'1' * 98_000}x,0,0\nGOTO/1,0,0\n")
    assert time.process_time() - began < 1.0


@pytest.mark.parametrize(("said", "scale"), [("", 1e-3), ("UNITS/MM\n", 1e-3), ("UNITS/INCHES\n", 25.4e-3)])
def test_without_a_word_about_units_lengths_are_millimetres_and_that_is_said(said: str, scale: float) -> None:
    path = read_apt(f"PARTNO/X\n{said}FEDRAT/600\nFROM/0,0,9\nGOTO/1,2,3\nFINI\n")
    np.testing.assert_allclose(path.p[-1], np.array([1, 2, 3]) * scale)
    notes = [note.level for note in path.findings if "UNITS" in note.message]
    assert notes == ["suspicious"] * (not said)


@pytest.mark.parametrize("count", [4, 5, 6])
def test_a_file_has_so_many_points_at_most(count: int, monkeypatch) -> None:
    monkeypatch.setattr("robomill.toolpath.apt.MAX_POINTS", 5)
    text = "UNITS/MM\nFEDRAT/100,MMPM\n" + "".join(f"GOTO/{k},0,0\n" for k in range(count)) + "FINI\n"
    if count <= 5:
        assert len(read_apt(text).p) == count
    else:
        with pytest.raises(GCodeError, match=r"^Line 8: more than 5 points; split the file\.$"):
            read_apt(text)


HEAD = "PARTNO/X\nUNITS/MM\nFEDRAT/600\n"


@pytest.mark.parametrize("said", ["UNIT/INCH", "UNITS/INCH", "UNITS / INCHES", "UNIT/IN"])
def test_inches_are_heard_however_they_are_said(said: str) -> None:
    path = read_apt(f"PARTNO/X\n{said}\nFEDRAT/600\nFROM/0,0,1\nGOTO/1,2,3\nFINI\n")
    np.testing.assert_allclose(path.p[-1], np.array([1, 2, 3]) * 25.4e-3)
    assert path.units == "in"


def test_tlaxis_is_the_axis_of_the_points_behind_it_and_multax_off_keeps_the_last() -> None:
    path = read_apt(
        f"{HEAD}FROM/0,0,9\nTLAXIS/0,3,4\nGOTO/1,0,0\nMULTAX/ON\nGOTO/2,0,0,0.8,0,0.6\nMULTAX/OFF\nGOTO/3,0,0\n"
    )
    np.testing.assert_allclose(path.k, [[0, 0, 1], [0, 0.6, 0.8], [0.8, 0, 0.6], [0.8, 0, 0.6]])
    assert [f.line for f in path.findings if f.code == "axis-kept"] == [9]


def test_trans_shifts_the_points_behind_it_and_says_so() -> None:
    path = read_apt(f"{HEAD}FROM/0,0,9\nTRANS/10,-5,2\nGOTO/1,0,0\nTRANS/0,0,0\nGOTO/2,0,0\nFINI\n")
    np.testing.assert_allclose(path.p[1:] * 1e3, [[11, -5, 2], [2, 0, 0]], atol=1e-12)
    assert [(f.level, f.line) for f in path.findings if f.code == "trans"] == [("warning", 5)]


MSYS = "MSYS/100,0,0,0,1,0,-1,0,0\n"
"""An origin at X100, turned by a quarter about Z; as CSYS its rows are (0, -1, 0, 100), (1, 0, 0, 0), (0, 0, 1, 0)."""


@pytest.mark.parametrize("other", [MSYS, "CSYS/0,-1,0,100,1,0,0,0,0,0,1,0\n"])
def test_points_of_another_coordinate_system_are_taken_into_the_first(other: str) -> None:
    alone = read_apt(f"{HEAD}{other}FROM/0,0,9\nGOTO/1,2,3\nFINI\n")
    np.testing.assert_allclose(alone.p[-1] * 1e3, [1, 2, 3])
    path = read_apt(f"{HEAD}MSYS/0,0,0,1,0,0,0,1,0\nFROM/0,0,9\n{other}GOTO/1,2,3,1,0,0\nFINI\n")
    np.testing.assert_allclose(path.p[-1] * 1e3, [98, 1, 3], atol=1e-9)
    np.testing.assert_allclose(path.k[-1], [0, 1, 0], atol=1e-12)
    assert [f.level for f in path.findings if f.code == "frame"] == ["warning"]


def test_tools_modes_and_homes() -> None:
    path = read_apt(
        f"{HEAD}LOAD/TOOL,12,ADJUST,1\nFROM/0,0,9\nGOTO/1,0,0\nMODE/INCR\nGOTO/2,0,0\nGOHOME\nGOTO/3,0,9\nFINI\n"
    )
    assert path.tool.tolist() == [12] * 4
    np.testing.assert_allclose(path.p[:, 0] * 1e3, [0, 1, 2, 3])
    assert path.cutting.tolist() == [False, True, True, False]
    assert {f.code: f.line for f in path.findings} == {"mode-incr": 7, "home": 9}


@pytest.mark.parametrize(
    ("arc", "turn"),
    [
        ("CIRCLE/0,0,5,0,0,1,10", 90),
        ("CIRCLE/0,0,5,0,0,-1,10,0.01,0.5,8,0", -270),
        ("MOVARC/0,0,5,0,0,1,10,ANGLE,90", 90),
        ("MOVARC/0,0,5,0,0,1,10,ANGLE,270", -270),
        ("MOVARC/CENTER,0,0,5,AXIS,0,0,1,RADIUS,10", 90),
        ("CIRCLE/0,0,5,0,0,2,10,TIMES,3", 810),
    ],
)
def test_arcs_lead_round_their_axis_to_the_next_point(arc: str, turn: float) -> None:
    """From (10, 0) to (0, 10), climbing by 6: every point lies on the helix, as long as sqrt((r a)^2 + h^2)."""
    path = read_apt(f"{HEAD}FROM/10,0,5\n{arc}\nGOTO/0,10,11\nFINI\n")
    p = path.p * 1e3
    angle = np.unwrap(np.arctan2(p[:, 1], p[:, 0]))
    assert np.degrees(angle[-1]) == pytest.approx(turn)
    np.testing.assert_allclose(np.hypot(p[:, 0], p[:, 1]), 10.0, atol=1e-9)
    np.testing.assert_allclose(p[:, 2], 5 + 6 * angle / angle[-1], atol=1e-9)
    assert path.s[-1] * 1e3 == pytest.approx(np.hypot(10 * np.radians(turn), 6), rel=1e-3)
    assert 10 * (1 - np.cos(np.abs(np.diff(angle)).max() / 2)) <= 1e-3 + 1e-9  # mm: how far chords are within the arc
    assert path.cutting.tolist() == [False] + [True] * (len(p) - 1)


def test_an_arc_that_ends_where_it_starts_is_a_full_one() -> None:
    path = read_apt(f"{HEAD}FROM/10,0,5\nCIRCLE/0,0,5,0,0,1,10\nGOTO/10,0,5\nFINI\n")
    assert path.s[-1] * 1e3 == pytest.approx(20 * np.pi, rel=1e-3)


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


@pytest.mark.parametrize(
    ("lines", "says"),
    [
        ("TLON,GOFWD/ (CIRCLE/1,2,3,4),ON,2,INTOF,(LINE/1,2,3,4,5,6)", "Line 5: TLON,GOFWD needs INDIRV"),
        ("MOVARC/0,0,0,0,0,1,10,ANGLE,45\nGOTO/0,10,0", "Line 6: the arc turns by 45 degrees, which does not lead to"),
        ("CIRCLE/0,0,0,0,0,1,9\nGOTO/0,10,0", "Line 6: the arc's ends lie 10.0000 mm and 10.0000 mm from its centre"),
        ("CIRCLE/0,0,0,0,0,0,9", "an arc needs an axis i,j,k and a radius above 0"),
        ("CIRCLE/0,0,0", "an arc needs its centre, axis and radius"),
        ("CYCLE/MILL,5", "CYCLE/MILL is not read; expected DRILL"),
        ("CYCLE/DRILL,5", "CYCLE/DRILL needs its depth and its feed"),
        ("CYCLE/DRILL,DEPTH,0,MMPM,120", "CYCLE/DRILL needs its depth and its feed"),
        ("CYCLE/DRILL,DEPTH,4,MMPM,0", "CYCLE/DRILL needs its depth and its feed"),
        ("CYCLE/DRILL,DEPTH,4,MMPM,120,MMPR,0.2", "CYCLE/DRILL needs its depth and its feed"),
        ("CYCLE/DRILL,MMPM,120,CLEAR,2", "CYCLE/DRILL needs its depth and its feed"),
        ("TLAXIS/0,0,0", "the tool axis i,j,k is 0"),
        ("TLAXIS/0,1", "TLAXIS has 2 numbers"),
        ("CSYS/1,2", "CSYS has 2 numbers"),
        ("MSYS/0,0,0,1,0,0,1,0,0", "the axes of MSYS are not at right angles"),
        ("RETRCT", "RETRCT moves the tool in a way that is not read"),
    ],
)
def test_what_is_not_read_is_refused_by_name(lines: str, says: str) -> None:
    with pytest.raises(GCodeError) as caught:
        read_apt(f"{HEAD}FROM/10,0,0\n{lines}\nGOTO/1,0,0\nFINI\n")
    assert says in str(caught.value)


CYCLES = [
    ("CYCLE/DRILL,RAPTO,3.0,FEDTO,-33.0,RTRCTO,AUTO,MMPM,250.0", [3, -33, 3], 250),
    ("CYCLE/DRILL,12.,200.,MMPM,2.", [2, -12, 2], 200),  # the rate before its unit
    ("CYCLE/DRILL,12.,MMPM,200.,2.", [2, -12, 2], 200),
    ("CYCLE/TAP,DEPTH,10,PITCH,1.5,CLEAR,2", [2, -10, 2], 1500),
]


@pytest.mark.parametrize(("cycle", "heights", "rate"), CYCLES)
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


def test_one_step_of_godlta_is_along_the_tool() -> None:
    path = read_apt("UNITS/MM\nFEDRAT/100,MMPM\nGOTO/0,0,0,0,0.6,0.8\nGODLTA/10\nFINI\n")
    np.testing.assert_allclose(path.p[-1] * 1e3, [0, 6, 8], atol=1e-9)


def test_a_remark_that_goes_on_below_is_one() -> None:
    rows = "$$-> CSYS / 1.0, 0.0, 0.0, 0.0, $\n  0.0, 1.0, 0.0, 0.0, $\n  0.0, 0.0, 1.0, 0.0\n"
    path = read_apt(f"UNITS/MM\n{rows}$$ a remark $\nFEDRAT/100,MMPM\nGOTO/0,0,0\nGOTO/1,0,0\nFINI\n")
    assert len(path) == 2
    assert not path.findings


def test_arcs_without_a_radius_have_that_of_their_start() -> None:
    """As SolidWorks CAM and Creo write them: centre and axis, and the circle goes through the point before."""
    arc = "UNITS/MM\nFEDRAT/600\nFROM/10,0,0\nCIRCLE/0,0,0,0,0,-1\nGOTO/{}\nFINI\n"
    path = read_apt(arc.format("0,10,0"))
    np.testing.assert_allclose(np.hypot(*path.p[:, :2].T), 10e-3, atol=1e-8)
    assert path.p[1, 1] < 0.0  # clockwise, three quarters round
    np.testing.assert_allclose(path.p[-1] * 1e3, [0, 10, 0], atol=1e-9)
    with pytest.raises(
        GCodeError, match="Line 5: the arc's ends lie 10.0000 mm and 9.0000 mm from its centre; expected one radius"
    ):
        read_apt(arc.format("0,9,0"))


def test_cycles_of_solidworks_cam() -> None:
    """CYCLE/INIT says nothing; DEEP2 pecks 5 first and then 2 at a time, from 3 above the hole to 10 below it."""
    path = read_apt(
        "UNIT/MM\nSPINDL/2000,RPM,CLW\nRAPID/\nGOTO/15,15,25\nCYCLE/INIT\n"
        "CYCLE/DEEP2,FEDTO,10,1STPECK,5.,SUBPECK,4.,MMPM,200,RAPTO,3.,RTRCTO,25.\nGOTO/15,15,0\nCYCLE/OFF\nFINI\n"
    )
    feeds = [round(float(z) * 1e3, 6) for z, cut in zip(path.p[:, 2], path.cutting) if cut]
    assert feeds == [-2, -6, -10]
    assert path.p[-1, 2] * 1e3 == pytest.approx(25)


CATIA = """UNITS/MM
FEDRAT/600,MMPM
P1     =POINT/ 10.0, 0.0, 5.0
L1=LINE/ 0,0,0,1,0,0
GOTO/P1
GOTO/ 10.0, 0.0, 0.0
AUTOPS
INDIRV/ 0.00000, 1.00000, 0.00000
TLON,GOFWD/ (CIRCLE/ 0.00000, 0.00000, 0.00000,$
10.00000),ON,(LINE/ 0.00000, 0.00000, 0.00000,$
0.00000, 10.00000, 0.00000)
INDIRV/ -1,0,0
TLON,GOFWD/ (CIRCLE/ 0,0,0,10),ON,2,INTOF,(LINE/ 0,0,0,10,0,0)
GODLTA/ 5,0,0
FINI
"""


def test_arcs_of_catia_leave_along_their_tangent_and_end_where_their_line_does() -> None:
    """A quarter to the left of +Y about (0, 0): 5 pi mm; then from (0, 10) along -X, three quarters: 15 pi mm."""
    path = read_apt(CATIA)
    length = {
        line: 1e3 * float(np.linalg.norm(np.diff(path.p, axis=0), axis=1)[path.block[1:] == line].sum())
        for line in (9, 13)
    }
    assert length == {9: pytest.approx(5 * np.pi, rel=2e-4), 13: pytest.approx(15 * np.pi, rel=2e-4)}
    quarter, rest = path.p[path.block == 9], path.p[path.block == 13]
    assert quarter[-1] * 1e3 == pytest.approx((0, 10, 0))
    assert (quarter[:, :2] >= -1e-12).all()
    assert rest[:, 0].min() * 1e3 == pytest.approx(-10, abs=2e-3)
    assert rest[-1] * 1e3 == pytest.approx((10, 0, 0))
    assert path.p[0] * 1e3 == pytest.approx((10, 0, 5))
    assert path.p[-1] * 1e3 == pytest.approx((15, 0, 0))
    assert [(f.code, f.line) for f in path.findings if f.level == "ignored"] == [("definition", 4)]


def test_an_arc_of_catia_may_stand_upright() -> None:
    """About (0, 0, 10) in the plane XZ, from its lowest point along +X to (10, 0, 10)."""
    lines = "GOTO/0,0,0\nINDIRV/1,0,0\nTLON,GOFWD/ (CIRCLE/0,0,10,10),ON,(LINE/0,0,10,10,0,10)\n"
    path = read_apt(f"UNITS/MM\nFEDRAT/60,MMPM\nFROM/0,0,9\n{lines}FINI\n")
    arc = path.p[path.block == 6] * 1e3
    assert np.hypot(arc[:, 0], arc[:, 2] - 10) == pytest.approx(10.0)
    assert arc[-1] == pytest.approx((10, 0, 10))
    assert arc[:, 1] == pytest.approx(0.0)


@pytest.mark.parametrize(
    ("lines", "says"),
    [
        ("GOTO/P9", "GOTO has 'P9', which no POINT/ before it has named"),
        ("P1=POINT/1", "POINT has 1 numbers"),
        ("M1=MACRO/A,B", "MACRO moves the tool in a way that is not read"),
        ("TLON,GOFWD/ (CIRCLE/0,0,0,10),ON,(LINE/0,0,0,0,10,0)", "TLON,GOFWD needs INDIRV"),
        ("INDIRV/0,1,0\nTLON,GOFWD/ (CYLNDR/0,0,0,0,0,1,10),ON,(LINE/0,0,0,0,10,0)", "TLON,GOFWD has '(CYLNDR"),
        ("INDIRV/1,0,0\nTLON,GOFWD/ (CIRCLE/0,0,0,10),ON,(LINE/0,0,0,0,10,0)", "INDIRV is not along the circle"),
        ("INDIRV/0,1,0\nTLON,GOFWD/ (CIRCLE/0,0,0,10),ON,(LINE/0,0,0,0,11,0)", "the arc's ends lie 10.0000 mm and 11"),
        ("TLLFT,GOLFT/L1", "TLLFT,GOLFT moves the tool"),
    ],
)
def test_what_catia_writes_otherwise_is_refused_by_name(lines: str, says: str) -> None:
    with pytest.raises(GCodeError) as caught:
        read_apt(f"UNITS/MM\nFEDRAT/60\nFROM/10,0,0\n{lines}\nGOTO/1,0,0\nFINI\n")
    assert says in str(caught.value)


def test_the_reader_of_g_code_names_the_one_of_apt(tmp_path: Path) -> None:
    file = tmp_path / "blade.apt"
    file.write_text(CATIA)
    with pytest.raises(
        GCodeError, match=r'this is APT \(cutter locations\), no G-code; rm.read_program\("blade.apt"\)'
    ):
        read_gcode(file)
    with pytest.raises(GCodeError, match=r'rm.read_program\("part.apt"\).read\(\) gives its path'):
        read_gcode(CATIA)


@pytest.mark.parametrize("word", ["GO/TO,L1", "HELIX/0,0,0,10,5", "NURBS/3", "SPLINE/0,0,0,1,1,1"])
def test_motions_that_are_not_known_stop_the_reading(word: str) -> None:
    with pytest.raises(GCodeError, match="Line 3: .* moves the tool in a way that is not read"):
        read_apt(f"UNITS/MM\nFROM/0,0,0\n{word}\nFEDRAT/60\nGOTO/1,0,0\nFINI\n")


def test_cuts_with_a_spindle_that_was_stopped_are_told() -> None:
    head, cuts = (
        "PARTNO PART OPERATION.1\nUNITS/MM\nFEDRAT/60\nSPINDL/600,CLW\nFROM/0,0,0\n",
        "GOTO/1,0,0\nGOTO/2,0,0\n",
    )
    found = read_apt(f"{head}{cuts}SPINDL/OFF\nGOTO/3,0,0\nGOTO/4,0,0\nFINI\n").findings
    assert [(each.code, each.line, each.count) for each in found if each.level == "warning"] == [
        ("spindle-stopped", 9, 2)
    ]
    assert not read_apt(f"{head}{cuts}FINI\n").findings


@pytest.mark.parametrize(
    ("text", "apt"),
    [
        ("N1 PARTNO/T\nN2 UNITS/MM\nN4 GOTO/0,0,0\n", True),
        ("UNITS/MM;FEDRAT/600,MMPM;GOTO/0,0,0;GOTO/10,0,-1;\n", True),
        ("RAPID;GOTO/0,0,5\n", True),
        ("GO TO/0,0,0\n", True),
        ("GOTO 0,0,0\nGOTO 10,0,-1\n", True),
        ("O1\nN5 X1\nGOTO 20\nN20 G0 X2\n", False),  # Fanuc's macros
        ("N10 GOTO 20\nIF [#1 EQ 2] GOTO 30\n", False),
        ("G0 X1 ; GOTO/1,2,3\n(A;GOTO/1,2,3)\n", False),
    ],
)
def test_files_of_apt_are_told_by_their_statements(text: str, apt: bool) -> None:
    assert is_apt(text.encode()) == apt
