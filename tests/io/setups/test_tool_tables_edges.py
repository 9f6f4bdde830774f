"""Tool tables at their edges: no tool with a diameter, one of none, one as small as is not yet doubted."""

from __future__ import annotations

import pytest

from robomill.errors import CuttingError
from robomill.io.setups.tool_tables import LONGEST_LINE, SMALL, read_tool_table


def test_a_table_without_diameters_is_not_doubted() -> None:
    table = read_tool_table("T1 Z2.5\nT2 Z12\n")
    assert [tool.cutter for tool in table.tools] == [None, None]
    assert table.findings == ()


@pytest.mark.parametrize(("share", "doubted"), [(0.99, True), (1.0, False), (1.01, False)])
def test_units_are_doubted_by_the_largest_tool(share: float, doubted: bool) -> None:
    found = read_tool_table(f"T1 D0.1 Z2\nT2 D{share * SMALL * 1e3:.6f} Z2\n").findings
    assert [(each.code, each.line) for each in found] == [("tool-units", 0)] * doubted


def test_a_diameter_of_nothing_is_none_and_one_below_it_compensates_to_the_other_side() -> None:
    table = read_tool_table("T1 D0 Z2\nT2 D-6 Z2\nT3 D6 Z2\n")
    assert [tool.compensates for tool in table.tools] == [0.0, pytest.approx(-6e-3), None]
    assert [tool.diameter for tool in table.tools] == pytest.approx([0.0, -6e-3, 6e-3])
    assert table[1].cutter is None
    assert table[2].cutter is not None
    assert table[2].cutter.diameter == pytest.approx(6e-3)


@pytest.mark.parametrize("longer", [0, 1])
def test_a_tool_fills_a_line_of_the_longest_and_no_longer_one_save_with_words_for_people(longer: int) -> None:
    tool = "T1 D6 Z2"
    line = tool + " " * (LONGEST_LINE - len(tool) + longer) + ";" + 600 * "a"
    if longer:
        with pytest.raises(CuttingError, match=rf"line 1: it has {LONGEST_LINE + 1} characters"):
            read_tool_table(line + "\n")
    else:
        assert read_tool_table(line + "\n")[1].diameter == pytest.approx(6e-3)
