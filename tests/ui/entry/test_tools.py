"""The table of tools on the page against the tools it stands for, and which tools are asked for."""

from __future__ import annotations

import dataclasses

import pytest

from robomill.cutting.tool import Cutter
from robomill.cutting.tool_table import TableTool, ToolTable
from robomill.errors import CuttingError
from robomill.io.setups.tool_tables import read_tool_table
from robomill.ui.entry.tools import missing, tool_frame, tools_of

TBL = "T1 P1 D8 Z50 ; roughing\nT2 P2 D-20 Z62.5 X1.5 Q3\n"
KNOWN = ToolTable(
    (
        TableTool(3, Cutter("bull", 0.012, corner_radius=0.001, flutes=4, helix="left", stick_out=0.03), length=0.07),
        TableTool(5, Cutter("ball", 0.006, flutes=2, hand="left"), name="finisher"),
        TableTool(7, Cutter("chamfer", 0.01, tip_angle=1.5, tip_diameter=0.001)),
        TableTool(9, length=0.1),
    )
)


@pytest.mark.parametrize("unit", ["mm", "in"])
@pytest.mark.parametrize("tools", [read_tool_table(TBL), KNOWN], ids=["from a file", "by hand"])
def test_a_table_that_nobody_edits_stays_what_it_is(tools: ToolTable, unit: str) -> None:
    back = tools_of(tool_frame(tools, unit), unit, tools)
    assert [t.number for t in back.tools] == [t.number for t in tools.tools]
    for a, b in zip(back.tools, tools.tools, strict=True):
        assert dataclasses.replace(a, cutter=None) == dataclasses.replace(b, cutter=None)
        for name in ("kind", "flutes", "helix", "hand") if b.cutter else ():
            assert getattr(a.cutter, name) == getattr(b.cutter, name)
        for name in ("diameter", "corner_radius", "tip_diameter") if b.cutter else ():
            assert getattr(a.cutter, name) == getattr(b.cutter, name)


def test_cells_are_headed_in_the_unit_of_the_page_and_hold_si() -> None:
    frame = tool_frame(KNOWN, "in")
    assert frame["Diameter, in"].iloc[0] == 0.012
    assert frame["Length, in"].iloc[0] == 0.07
    frame.loc[0, "Diameter, in"] = 0.0127
    assert tools_of(frame, "in", KNOWN)[3].cutter.diameter == 0.0127


def test_what_is_not_stated_is_empty_and_assumed_until_it_is() -> None:
    tools = read_tool_table(TBL)
    frame = tool_frame(tools, "mm")
    assert frame["Flutes"].iloc[0] is None
    frame.loc[0, "Flutes"] = 3
    changed = tools_of(frame, "mm", tools)[1]
    assert changed.cutter.flutes == 3
    assert set(changed.assumed) == {"kind", "helix_angle"}


def test_a_row_without_a_diameter_is_refused_by_its_row() -> None:
    frame = tool_frame(KNOWN, "mm")
    frame.loc[1, "Diameter, mm"] = None
    with pytest.raises(CuttingError, match="tools 2, diameter_mm"):
        tools_of(frame, "mm", KNOWN)


@pytest.mark.parametrize(
    ("tools", "cut_with", "asked"),
    [
        (ToolTable(), [0], []),
        (ToolTable(), [4], []),
        (ToolTable(), [1, 2], [1, 2]),
        (ToolTable(), [0, 2], []),
        (KNOWN, [3, 5], []),
        (KNOWN, [3, 4], [4]),
        (KNOWN, [9], [9]),
    ],
)
def test_tools_that_cut_unknown_are_asked_for(tools: ToolTable, cut_with: list[int], asked: list[int]) -> None:
    assert missing(tools, cut_with) == asked
