"""A table of tools as a value: order, what is missing, what is assumed."""

from __future__ import annotations

import pytest

from robomill.arrays import digest
from robomill.cutting.tool import Cutter
from robomill.cutting.tool_table import TableTool, ToolTable
from robomill.errors import CuttingError

SIX, EIGHT = Cutter("flat", 6e-3), Cutter("ball", 8e-3)


def test_tools_stand_in_the_order_of_their_numbers() -> None:
    one, two = TableTool(1, SIX), TableTool(2, EIGHT)
    assert list(ToolTable((two, one))) == [1, 2]
    assert ToolTable((two, one)) == ToolTable((one, two))
    assert digest(ToolTable((two, one))) == digest(ToolTable((one, two))) != digest(ToolTable((one,)))
    assert not ToolTable()


def test_what_is_missing_is_asked_for_by_number() -> None:
    table = ToolTable((TableTool(1, SIX), TableTool(3)))
    assert table.cutter(1) == SIX
    for held, numbers in ((table, "1, 3"), (ToolTable(), "none")):
        with pytest.raises(CuttingError, match=f"Tool 2 cuts and is not in the tool table .*: {numbers}"):
            held.cutter(2)
    with pytest.raises(CuttingError, match="Tool 3 cuts, but the tool table does not say its diameter"):
        table.cutter(3)
    with pytest.raises(CuttingError, match="tool 1 is there twice"):
        ToolTable((TableTool(1, SIX), TableTool(1, EIGHT)))


def test_what_is_assumed_is_said_of_the_tools_that_cut() -> None:
    table = ToolTable((TableTool(1, SIX, assumed=("kind", "flutes")), TableTool(2, EIGHT), TableTool(3, SIX)))
    (note,) = table.notes([2, 1, 1])
    assert note.message.startswith("Tool 1:")
    assert "flutes 2" in note.message
    assert (note.line, note.code) == (0, "tool-assumed")
    assert table.notes([2, 3, 9]) == ()


def test_the_diameter_of_compensation() -> None:
    assert TableTool(1, SIX).diameter == 6e-3
    assert TableTool(1, SIX, compensates=-6e-3).diameter == -6e-3
    assert TableTool(1, length=0.05, offset_x=1e-3).offset == (1e-3, 0.0, 0.05)
    assert TableTool(1).diameter == 0.0
    assert TableTool(1, SIX).offset == (0.0, 0.0, 0.0)


def test_a_tool_is_called_by_what_the_table_says() -> None:
    table = ToolTable((TableTool(1, SIX), TableTool(2, EIGHT, name="finisher"), TableTool(3)))
    assert [table.called(n) for n in (2, 3, 9)] == ["T2 · finisher, 8.00 mm", "T3", "T9"]
    assert table.called(1).startswith("T1 · 6.00 mm flat")


def test_a_number_that_stands_there_twice_is_found_anywhere() -> None:
    for numbers in ((5, 1, 5), (1, 2, 2), (0, 0)):
        with pytest.raises(CuttingError, match=f"tool {max(set(numbers), key=numbers.count)} is there twice"):
            ToolTable(tuple(TableTool(n, SIX) for n in numbers))
    assert len(ToolTable(tuple(TableTool(n, SIX) for n in (3, 2, 1)))) == 3


def test_what_nobody_said_of_a_tool() -> None:
    plain = TableTool(4)
    assert (plain.cutter, plain.length, plain.orientation, plain.compensates) == (None, 0.0, 0, None)
    assert TableTool(0, orientation=9).number == 0
    for wrong in ({"number": -1}, {"number": 1, "orientation": 10}, {"number": 1, "assumed": ("colour",)}):
        with pytest.raises(CuttingError):
            TableTool(**wrong)  # type: ignore[arg-type]


def test_a_tool_is_sized_where_the_table_says_what_compensation_counts_with() -> None:
    tools = (TableTool(1), TableTool(2, SIX), TableTool(3, compensates=6e-3), TableTool(4, SIX, compensates=0.0))
    assert [tool.sized for tool in tools] == [False, True, True, True]
    assert [tool.diameter for tool in tools] == [0.0, 6e-3, 6e-3, 0.0]


def test_tools_whose_flutes_nobody_has_stated_are_those_of_the_table_that_cut() -> None:
    assumed = (("flutes",), ("kind",), ("kind", "flutes"), (), ("flutes",))
    table = ToolTable(tuple(TableTool(n, SIX, assumed=each) for n, each in enumerate(assumed, 1)))
    assert [tool.number for tool in table.unstated([9, 3, 2, 1, 3])] == [1, 3]
    assert table.unstated([]) == table.unstated([9]) == table.unstated([2, 4]) == ()
    assert [tool.number for tool in table.unstated(range(9))] == [1, 3, 5]
