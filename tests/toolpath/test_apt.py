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
        ("GOTO/0,0,0\nGODLTA/1,1\n", "Line 2: GODLTA needs three steps, or one along the tool"),
        ("GOTO/0,0,0\nGODLTA/1,1,1,1\n", "Line 2: GODLTA needs three steps, or one along the tool"),
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


@pytest.mark.parametrize(
    ("behind", "ends"),
    [
        ("GODLTA/1,0,0\n", [(25.4, 0), (50.8, 0)]),
        ("GOTO/P1\n", [(25.4, 0), (0, 25.4)]),
        ("CIRCLE/0,0,0,0,0,1,1\nGOTO/0,1,0\n", [(25.4, 0), (0, 25.4)]),
    ],
)
def test_units_that_change_leave_what_was_written_before_where_it_is(behind: str, ends: list[tuple[float, ...]]):
    """At 25.4 mm the tool is 1 inch from zero, and so is a point at 25.4 mm that has a name."""
    path = read_apt(f"UNITS/MM\nP1=POINT/0,25.4,0\nFEDRAT/100,MMPM\nGOTO/25.4,0,0\nUNITS/INCHES\n{behind}FINI\n")
    np.testing.assert_allclose(path.p[[0, -1], :2] * 1e3, ends, atol=1e-9)
    if behind.startswith("CIRCLE"):
        np.testing.assert_allclose(np.hypot(*path.p[:, :2].T), 25.4e-3)
        assert path.p[:, :2].min() > -1e-9  # a quarter of it


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
        ("MSYS/0,0,0,1e200,0,0,0,1e200,0", "the axes of MSYS are not at right angles"),
        ("CSYS/1e200,0,0,0,0,1e200,0,0,0,0,1e200,0", "the axes of CSYS are not at right angles"),
        ("RETRCT", "RETRCT moves the tool in a way that is not read"),
    ],
)
def test_what_is_not_read_is_refused_by_name(lines: str, says: str) -> None:
    with pytest.raises(GCodeError) as caught, np.errstate(all="raise"):
        read_apt(f"{HEAD}FROM/10,0,0\n{lines}\nGOTO/1,0,0\nFINI\n")
    assert says in str(caught.value)


def test_one_step_of_godlta_is_along_the_tool() -> None:
    path = read_apt("UNITS/MM\nFEDRAT/100,MMPM\nGOTO/0,0,0,0,0.6,0.8\nGODLTA/10\nFINI\n")
    np.testing.assert_allclose(path.p[-1] * 1e3, [0, 6, 8], atol=1e-9)


def test_a_remark_that_goes_on_below_is_one() -> None:
    rows = "$$-> CSYS / 1.0, 0.0, 0.0, 0.0, $\n  0.0, 1.0, 0.0, 0.0, $\n  0.0, 0.0, 1.0, 0.0\n"
    path = read_apt(f"UNITS/MM\n{rows}$$ a remark $\nFEDRAT/100,MMPM\nGOTO/0,0,0\nGOTO/1,0,0\nFINI\n")
    assert len(path) == 2
    assert not path.findings


def test_the_reader_of_g_code_names_the_one_of_apt(tmp_path: Path) -> None:
    file = tmp_path / "blade.apt"
    file.write_text(FILE)
    with pytest.raises(
        GCodeError, match=r'this is APT \(cutter locations\), no G-code; rm.read_program\("blade.apt"\)'
    ):
        read_gcode(file)
    with pytest.raises(GCodeError, match=r'rm.read_program\("part.apt"\).read\(\) gives its path'):
        read_gcode(FILE)


@pytest.mark.parametrize(
    "word", ["GO/TO,L1", "HELIX/0,0,0,10,5", "NURBS/3", "SPLINE/0,0,0,1,1,1", "LOOPST", "JUMPTO/A"]
)
def test_motions_that_are_not_known_stop_the_reading(word: str) -> None:
    with pytest.raises(GCodeError, match="Line 3: .* moves the tool in a way that is not read"):
        read_apt(f"UNITS/MM\nFROM/0,0,0\n{word}\nFEDRAT/60\nGOTO/1,0,0\nFINI\n")


@pytest.mark.parametrize(("word", "said"), [("INSERT G0 X9. Z50.", [3]), ("INSERT M08", []), ("INSERT/ M08", [])])
def test_code_for_the_machine_that_may_move_it_is_said(word: str, said: list[int]) -> None:
    path = read_apt(f"UNITS/MM\nFROM/0,0,0\n{word}\nFEDRAT/60\nGOTO/1,0,0\nFINI\n")
    assert [f.line for f in path.findings if f.code == "insert"] == said


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


@pytest.mark.parametrize(("said", "shift"), [("10", (10, 0, 0)), ("10,-5", (10, -5, 0)), ("10,-5,2", (10, -5, 2))])
def test_a_shift_has_up_to_three_numbers(said: str, shift: tuple[float, ...]) -> None:
    path = read_apt(f"{HEAD}FROM/0,0,9\nTRANS/{said}\nGOTO/1,2,3\nFINI\n")
    np.testing.assert_allclose(path.p[-1] * 1e3, np.add([1, 2, 3], shift), atol=1e-9)
    with pytest.raises(GCodeError, match="TRANS has 4 numbers"):
        read_apt(f"{HEAD}FROM/0,0,9\nTRANS/10,-5,2,1\nGOTO/1,2,3\nFINI\n")
