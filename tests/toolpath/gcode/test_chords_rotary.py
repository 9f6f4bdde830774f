"""Rotary axes that turn the part: {W} turns with it."""

from __future__ import annotations

import numpy as np
import pytest

from robomill.errors import GCodeError, ToolpathError
from robomill.toolpath.gcode import read_gcode
from robomill.toolpath.path import ROTARY_ASKED, TABLES
from robomill.toolpath.source import LEANS, GCodeSource

ROUND = "G21 G90 G0 X0 Y0 Z20 A0\nG1 Z10 F600\nG1 X50 A360\nM2\n"
"""A helix about X on a bar of radius 10: 50 along, one turn."""


@pytest.mark.parametrize(("table", "hand"), [("A", 1.0), ("-A", -1.0)])
def test_a_table_leads_the_tool_round_the_part(table: str, hand: float) -> None:
    """ISO 841: A counts as if the tool turned about +X, so the point (0, 0, 10) goes to (0, -10 sin A, 10 cos A)."""
    path = read_gcode(ROUND, table=table)
    on = path.p[path.p[:, 0] > 0.0] * 1e3
    a = np.radians(360.0) * on[:, 0] / 50
    np.testing.assert_allclose(on[:, 1], -hand * 10 * np.sin(a), atol=1e-9)
    np.testing.assert_allclose(on[:, 2], 10 * np.cos(a), atol=1e-9)
    outward = np.stack([0 * a, on[:, 1] / 10, on[:, 2] / 10], axis=1)
    np.testing.assert_allclose(path.k[path.p[:, 0] > 0.0], outward, atol=1e-9)
    chord = 0.01 * (1 - np.cos(np.radians(0.25)))
    assert chord < 1e-6
    assert not [f for f in path.findings if f.code == ROTARY_ASKED]


def test_a_move_on_a_table_takes_the_time_that_its_feed_gives_it_beside_the_machine() -> None:
    """50 mm at 600 mm/min are 5 s, for a helix of hypot(50, 20 pi) mm; 90 degrees at 600 degrees/min are 9 s."""
    path = read_gcode(ROUND, table="A")
    rows = path.block == 3
    length = path.step_length[rows].sum()
    assert length * 1e3 == pytest.approx(np.hypot(50, 20 * np.pi), rel=1e-4)
    assert (path.step_length[rows] / path.v_f[rows]).sum() == pytest.approx(5.0)
    alone = read_gcode("G21 G90 G0 Z10\nG1 A90 F600\nM2\n", table="A")
    assert alone.t[-1] == pytest.approx(9.0)
    inch = read_gcode("G20 G90 G0 Z10\nG1 A90 F600\nM2\n", table="A")
    assert inch.t[-1] == pytest.approx(9.0)


@pytest.mark.parametrize(
    ("table", "word", "end", "k"),
    [
        ("B", "B90", (30, 20, -10), (1, 0, 0)),
        ("C", "C90", (-20, 10, 30), (0, 0, 1)),
        ("A", "A90", (10, -30, 20), (0, -1, 0)),
    ],
)
def test_every_axis_turns_the_part_about_its_own(table: str, word: str, end: tuple, k: tuple) -> None:
    path = read_gcode(f"G21 G90 G0 X10 Y20 Z30 {word}\nM2\n", table=table)
    np.testing.assert_allclose(path.p[-1] * 1e3, end, atol=1e-9)
    np.testing.assert_allclose(path.k[-1], k, atol=1e-12)


@pytest.mark.parametrize(("degrees", "asked"), [(90, False), (91, True), (-91, True)])
def test_more_than_a_quarter_is_asked_for(degrees: int, asked: bool) -> None:
    path = read_gcode(f"G21 G90 G0 Z9\nG1 X5 B{degrees} F100\nM2\n")
    assert [f.line for f in path.findings if f.code == ROTARY_ASKED] == [2] * asked
    assert (
        "does it turn the part (a rotary table) or lean the tool?" in " ".join(f.message for f in path.findings)
    ) == asked


def test_it_is_said_in_the_set_up() -> None:
    asked = GCodeSource(ROUND).read()
    leans = GCodeSource(ROUND, table=LEANS).read()
    table = GCodeSource(ROUND, table="A").read()
    assert [[f.code for f in path.findings].count(ROTARY_ASKED) for path in (asked, leans, table)] == [1, 0, 0]
    np.testing.assert_array_equal(asked.p, leans.p)
    assert len(table.p) > len(asked.p)
    with pytest.raises(ToolpathError, match="rotary axis 'X'; expected one of A, -A"):
        GCodeSource(ROUND, table="X")
    with pytest.raises(GCodeError, match="Rotary table: found 'D'"):
        read_gcode(ROUND, table="D")
    assert TABLES[0] == ""
