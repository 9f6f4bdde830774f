"""Bore milling of Heidenhain's dialogue, against a helix that is written out here.

As its manual for cycles says it: to the set-up clearance at rapid, to the bore's wall, down in a helix that is Q334
deep a turn, once around at the depth, to the middle, and out at rapid.
"""

from __future__ import annotations

import math

import numpy as np
import pytest

from robomill.errors import GCodeError
from robomill.toolpath.gcode import Program, interpret, read_gcode
from robomill.toolpath.tools import Tool

TOOLS = {1: Tool(1, 0.012)}
HEAD = "BEGIN PGM Q MM\nTOOL CALL 1 Z S1000 F99\nL X+0 Y+0 Z+60 FMAX M3\n"
CYCLE = "CYCL DEF 208 BORE MILLING ~\n" + " ~\n".join(
    ("Q200=2", "Q201=-20", "Q206=150", "Q334=4", "Q203=+5", "Q204=50", "Q335={bore}", "Q342={rough}", "Q351={way}\n")
)


def text(body: str, bore: float = 20, rough: float = 0, way: str = "+1") -> str:
    return f"{HEAD}{CYCLE.format(bore=bore, rough=rough, way=way)}{body}END PGM Q MM\n"


def read(body: str, **more: object) -> Program:
    return interpret(text(body, **more), tools=TOOLS)  # type: ignore[arg-type]


@pytest.mark.parametrize(("way", "sense"), [("+1", 1.0), ("-1", -1.0)])
def test_the_path_is_a_helix_and_a_circle(way: str, sense: float) -> None:
    """22 mm at 4 mm a turn are 5.5 turns about X 10 Y 7, 4 mm from the middle; a point has the angle of its depth."""
    path = read_gcode(text("L X+10 Y+7 FMAX M99\n", way=way), tools=TOOLS)
    p = path.p * 1e3 - [10, 7, 0]
    wall = np.abs(np.hypot(p[:, 0], p[:, 1]) - 4.0) < 1e-3
    falls = wall & (p[:, 2] > -15.0)
    angle = sense * 2 * np.pi * (7.0 - p[falls, 2]) / 4.0
    np.testing.assert_allclose(p[falls, :2], 4 * np.column_stack([np.cos(angle), np.sin(angle)]), atol=1e-6)
    floor = p[wall & (p[:, 2] < -15.0 + 1e-9)]
    assert math.hypot(*(floor[-1] - floor[0])) < 1e-6
    assert np.linalg.norm(np.diff(floor, axis=0), axis=1).sum() == pytest.approx(8 * np.pi, rel=1e-3)
    assert path.v_f[path.cutting] * 6e4 == pytest.approx(150)
    assert p[-1].tolist() == pytest.approx([0, 0, 55])


def test_at_each_place_of_a_pattern_and_turned_with_it() -> None:
    program = read("CYCL DEF 10.1 ROT+90\nPATTERN DEF POS1 (X+30 Y+0 Z+0) POS2 (X+60 Y+0 Z+0)\nCYCL CALL PAT FMAX\n")
    arcs = program.kind == 2
    np.testing.assert_allclose(program.centre[arcs, :2] * 1e3, [[0, 30], [0, 30], [0, 60], [0, 60]], atol=1e-9)
    np.testing.assert_allclose(np.degrees(program.sweep[arcs]), [1980, 360, 1980, 360])
    np.testing.assert_allclose(program.start[arcs][0] * 1e3, [0, 34, 7], atol=1e-9)


def test_turns_that_come_out_even_are_as_many() -> None:
    program = read("Q334 = 5.5\nL X+10 Y+7 FMAX M99\n")
    assert np.degrees(program.sweep[program.kind == 2]) == pytest.approx([1440, 360])


def test_a_bore_as_wide_as_the_tool_is_drilled() -> None:
    program = read("L X+10 Y+7 FMAX M99\n", bore=12)
    assert not (program.kind == 2).any()
    assert (program.end[2:, 2] * 1e3).tolist() == pytest.approx([7, -15, 55])


@pytest.mark.parametrize(
    ("more", "before", "says"),
    [
        ({"bore": 10}, "", "CYCL DEF 208 has Q335=10; expected one to two times the tool's 12"),
        (
            {"bore": 30},
            "",
            "CYCL DEF 208 has Q335=30; expected one to two times the tool's 12, or the bore that is there",
        ),
        ({}, "Q334 = 0\n", "CYCL DEF 208 needs Q334"),
        ({}, "Q334 = .001\n", "CYCL DEF 208 needs more than 10000 turns"),
        ({}, "Q370 = 1.2\n", "CYCL DEF 208 clears its bore in several paths .Q370., which is not read"),
        ({}, "TOOL CALL DR+0.5\n", "CYCL DEF 208 with DR.0.5 of TOOL CALL is not read"),
        ({}, "TOOL CALL 2 Z S99\n", "tool 2 is not in the tool table|CYCL DEF 208 needs the diameter of tool 2"),
    ],
)
def test_what_is_not_read_is_named(more: dict[str, float], before: str, says: str) -> None:
    with pytest.raises(GCodeError, match=says):
        read(f"{before}L X+10 Y+7 FMAX M99\n", **more)
    assert len(read("L X+10 Y+7 FMAX M99\n", bore=30, rough=20)) > 4
    with pytest.raises(GCodeError, match="CYCL DEF 208 needs the diameter of tool 1; give a tool table"):
        interpret(text("L X+10 FMAX M99\n"))
