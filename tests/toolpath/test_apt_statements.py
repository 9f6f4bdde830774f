"""Statements of APT-CL files that share a line, units that feeds say, and cycles of CATIA by place."""

from __future__ import annotations

import numpy as np
import pytest

from robomill.errors import GCodeError
from robomill.toolpath.apt import read_apt
from robomill.toolpath.apt_statements import statements_of

PLAIN = "UNITS/MM\nFEDRAT/100,MMPM\nGOTO/0,0,5\nGOTO/50,0,5\nRAPID\nGOTO/50,0,-1\nGODLTA/10,0,0\nFINI\n"


@pytest.mark.parametrize(
    ("before", "after"),
    [
        ("GOTO/50,0,5", "N10 GOTO/50,0,5"),
        ("GOTO/50,0,5", "  20   GOTO / 50,0,5"),
        ("GOTO/50,0,5", "GO TO/50,0,5"),
        ("GOTO/50,0,5", "go  to / 50,0,5"),
        ("GOTO/50,0,5", "GOTO 50,0,5"),
        ("GOTO/50,0,5", "N30 GO TO 50,0,$\n 5"),
        ("GODLTA/10,0,0", "GODLTA 10,0,0"),
        ("RAPID\nGOTO", "RAPID; GOTO"),
        ("RAPID\nGOTO", "N40 RAPID;N50 GOTO"),
        ("GOTO/50,0,5\nRAPID\n", "GOTO/50,0,5;RAPID;"),
        ("UNITS/MM\nFEDRAT", "1 UNITS/MM\nN2 FEDRAT"),
        ("UNITS/MM", "PARTNO A; GOTO/9,9,9\nPPRINT/N10 GOTO 7,7,7\nUNITS/MM"),
    ],
)
def test_a_statement_is_the_same_wherever_it_stands(before: str, after: str) -> None:
    assert before in PLAIN
    plain, other = read_apt(PLAIN), read_apt(PLAIN.replace(before, after))
    np.testing.assert_array_equal(other.p, plain.p)
    np.testing.assert_array_equal(other.v_f, plain.v_f)
    assert other.findings == plain.findings


def test_statements_of_a_line_have_its_number() -> None:
    text = "GOTO/1,2,$\n3;RAPID\n10 GO TO/4,5,6 $$ end\n"
    assert statements_of(text) == [(1, "GOTO/1,2,3"), (1, "RAPID"), (3, "GOTO/4,5,6")]


@pytest.mark.parametrize(
    "line",
    ["RAPID $ GOTO/80,0,5", "A GOTO/80,0,5", "LBL1) GOTO/80,0,5", "GOTO X,80,0", "GOTO, 80,0,5", "RAPID GOTO/1,2,3"],
)
def test_what_may_be_a_move_is_never_left_out(line: str) -> None:
    with pytest.raises(GCodeError, match="Line 3: found .*, which may move the tool"):
        read_apt(f"UNITS/MM\nGOTO/0,0,5\n{line}\nGOTO/90,0,5\nFINI\n")


@pytest.mark.parametrize(
    ("rate", "unit", "level"),
    [
        ("10,IPM", "in", "suspicious"),
        ("IPM,10.0", "in", "suspicious"),
        ("0.01,IPR", "in", "suspicious"),
        ("254,MMPM", "mm", "info"),
        ("0.254,MMPR", "mm", "info"),
        ("10", "mm", "suspicious"),
        ("10,PERMIN", "mm", "suspicious"),
    ],
)
def test_a_feed_says_the_unit_where_nothing_else_does(rate: str, unit: str, level: str) -> None:
    """Whether it stands before the points or behind the first of them."""
    size = 25.4 if unit == "in" else 1.0
    for text in (f"FEDRAT/{rate}\nGOTO/1,0,0\n", f"GOTO/1,0,0\nFEDRAT/{rate}\n"):
        path = read_apt(f"PARTNO X\nSPINDL/1000,RPM,CLW\n{text}GOTO/3,4,0\nFINI\n")
        np.testing.assert_allclose(path.p * 1e3, np.array([[1, 0, 0], [3, 4, 0]]) * size)
        assert path.units == unit
        (finding,) = (each for each in path.findings if "UNITS" in each.message)
        assert finding.level == level
        assert ("is in " in finding.message) == ("M" in rate.replace("PERMIN", "") or "R" in rate.replace("PERMIN", ""))


def test_units_go_before_feeds_and_feeds_of_two_systems_say_nothing() -> None:
    moves = "GOTO/0,0,0\nFEDRAT/10,IPM\nGOTO/1,0,0\n"
    assert read_apt(f"UNITS/MM\n{moves}FINI\n").p[-1, 0] == pytest.approx(1e-3)
    mixed = read_apt(f"{moves}FEDRAT/9,MMPM\nGOTO/2,0,0\nFINI\n")
    assert mixed.p[-1, 0] == pytest.approx(2e-3)
    assert [each.level for each in mixed.findings if "UNITS" in each.message] == ["suspicious"]


@pytest.mark.parametrize(
    ("words", "heights", "rate"),
    [
        ("DRILL,  20.000000,   3.000000,  500.000000,MMPM", [3, -20, 3], 500.0),
        ("DRILL, 20., 3., 0.5, MMPR", [3, -20, 3], 500.0),
        ("TAP, 12, 5, 10, IPM", [5, -12, 5], 254.0),
        ("DRILL,DEEP, 8, 2, 100, MMPM, STEP, 5", [2, -3, 2, -3, -8, 2], 100.0),
        ("DRILL,DEEP,RAPTO,2,FEDTO,-8,STEP1,5.,MMPM,100", [2, -3, 2, -3, -8, 2], 100.0),
    ],
)
def test_depth_clearance_and_feed_stand_before_their_unit_in_catia(
    words: str, heights: list[float], rate: float
) -> None:
    path = read_apt(f"UNITS/MM\nSPINDL/1000,RPM,CLW\nFROM/0,0,50\nCYCLE/{words}\nGOTO/10,0,0\nCYCLE/OFF\nFINI\n")
    z = path.p[path.p[:, 0] > 5e-3, 2] * 1e3
    kept = np.flatnonzero(np.diff(z, prepend=1e3))
    assert z[kept][1:].tolist() == pytest.approx(heights)
    assert path.v_f[path.p[:, 2] < -7e-3] * 60e3 == pytest.approx([rate])
    assert any("depth, clearance and feed" in each.message for each in path.findings) == ("STEP1" not in words)


@pytest.mark.parametrize("top", [20.0, -20.0])
def test_a_hole_is_gone_to_at_the_height_where_the_tool_was(top: float) -> None:
    """Along the tool, whatever the height of the hole; from less than the clearance straight to it."""
    cycle = f"UNITS/MM\nFROM/0,0,50\nCYCLE/DRILL,DEPTH,4,MMPM,120,CLEAR,2\nGOTO/10,0,{top:g}\nGOTO/30,0,{top + 1:g}\n"
    path = read_apt(f"{cycle}CYCLE/OFF\nFINI\n")
    heights = [50, 50, top + 2, top - 4, top + 2, top + 3, top - 3, top + 3]
    np.testing.assert_allclose(path.p[:, 2] * 1e3, heights)
    np.testing.assert_allclose(path.p[:, 0] * 1e3, [0, 10, 10, 10, 10, 30, 30, 30])
