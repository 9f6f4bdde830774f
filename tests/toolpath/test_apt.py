"""APT-CL files."""

from __future__ import annotations

import time

import numpy as np
import pytest

from robomill.errors import GCodeError
from robomill.toolpath.apt import is_apt, read_apt

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
        ("GOTO/0,0,0\nCYCLE/DRILL,5\n", "Line 2: CYCLE moves the tool"),
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
