"""The table of tools: filled from a file or by hand; a tool that cuts and is not in it is asked for by its number."""

from collections.abc import Iterable
from dataclasses import replace
from functools import partial
from typing import Any

import numpy as np
import pandas as pd
import streamlit as st

from robomill.arrays import IntArray
from robomill.cutting.tool import Cutter
from robomill.cutting.tool_table import ASKED, TableTool, ToolTable
from robomill.errors import CuttingError, RobomillError
from robomill.io.declared import write_quantity
from robomill.io.setups.tool_tables import UNITS, read_tool_table, tools_from_table, tools_to_tables
from robomill.io.tables import Table
from robomill.quantities import Quantity, quantities
from robomill.simulation.tools import cutting_numbers
from robomill.toolpath.source import PathSource
from robomill.ui import pieces, session
from robomill.ui.entry import declared, grid, inputs
from robomill.ui.entry.box import NumberBox, box_of
from robomill.ui.work import cached, running
from robomill.units import unit_label

FILE, UNIT, TABLE, ODD = "milling.tools.file", "milling.tools.unit", "milling.tools.table", "milling.tools.odd"
OF_TOOL = ("number", "length")
OF_SHAPE = ("corner_radius", "tip_angle", "tip_diameter")
OF_CUTTER = ("kind", "diameter", "flutes", *OF_SHAPE, "helix_angle", "stick_out", "flute_length", "hand")
NAME = "name"
MAX_TABLE_MB = 2


def panel(*, ask: bool = True) -> None:
    """The table with its ways in, or the way to one where the set-up has one cutter for all; ``ask`` for the tools that
    are missing, where nothing else on the page does."""
    setup = session.project().setup
    for number in missing(setup.tools, _cut_with()) if ask else ():
        _ask(number)
    if setup.tools:
        _table(setup.tools)
    with st.popover("Tools from a file" if setup.tools else "Several tools", icon=":material/table:", width="stretch"):
        _ways_in(setup.tools)


def missing(tools: ToolTable, cut_with: Iterable[int]) -> list[int]:
    """Numbers of tools that cut and that nobody has described: none where one unnamed or single tool cuts."""
    wanted = sorted(number for number in set(cut_with) if number > 0)
    if not tools and len(wanted) < 2:
        return []
    return [number for number in wanted if number not in tools or tools[number].cutter is None]


def _cut_with() -> IntArray:
    """Numbers of the tools that the program cuts with, read without a table: one that lacks a tool refuses it."""
    setup = session.project().setup
    try:
        running.wait_for_path(setup)
        found = pieces.underway(_numbers_of, setup.source)
    except RobomillError:
        found = None
    return np.zeros(0, dtype=np.int64) if found is None else found


@cached.shared(lambda source: source, "Reading the program's tools")
def _numbers_of(source: PathSource) -> IntArray:
    return cutting_numbers(source.read())


def _ask(number: int) -> None:
    """A tool that is missing: its diameter makes it a row of the table, where the rest can be said."""
    words = f"Tool {number} cuts and nobody has said what it is."
    pieces.said("warning", words, "help")
    diameter = quantities(Cutter)["diameter"]
    unit = declared.in_view(diameter.unit)
    box = box_of(diameter, label=f"Diameter of tool {number}", unit=unit, optional=True, placeholder="type it")
    inputs.value(f"milling.tools.ask.{number}", box, None, partial(_add, number))


def _add(number: int, diameter: float | None) -> None:
    if diameter is None:
        return
    tools = session.project().setup.tools
    known = tools[number] if number in tools else TableTool(number)
    new = replace(known, cutter=Cutter("flat", diameter), assumed=ASKED)
    session.change(tools=ToolTable((*(t for t in tools.tools if t.number != number), new)))


def _table(tools: ToolTable) -> None:
    unit = session.project().view.length
    kinds, hands = (list(quantities(Cutter)[name].options) for name in ("kind", "hand"))
    special = {
        "kind": st.column_config.SelectboxColumn(options=kinds, width=92),
        "hand": st.column_config.SelectboxColumn(options=hands),
    }
    columns = {_head(q, unit): special[q.name] for q in _columns() if q.name in special}
    numbers = {_head(q, unit): _box(q, unit) for q in _columns() if q.name not in special}
    widths = {head: 72 if box.label == _columns()[0].label else 128 for head, box in numbers.items()}
    grid.table(
        TABLE,
        lambda: tool_frame(tools, unit),
        lambda frame: session.change(tools=tools_of(frame, unit, tools), from_editor=True),
        grid.Sheet(numbers, columns | {NAME: st.column_config.TextColumn("Name")}, width=widths, dynamic=True),
    )
    pieces.note(pieces.badge("user"), "An empty cell is not stated: kind, flutes and helix are then assumed.")
    for finding in (*session.kept(ODD, ()), *tools.notes(_cut_with().tolist())):
        pieces.note(pieces.badge("assumed"), finding.sentence)


def _ways_in(tools: ToolTable) -> None:
    look, take = inputs.Look(hint="A .tbl does not say its unit."), partial(inputs.reread, FILE, _take, UNIT)
    units = {unit: unit_label(unit) for unit in UNITS}
    inputs.choice("Unit of the file", UNIT, units, session.kept(UNIT, UNITS[0]), take, look)
    inputs.upload("Tool table (.tbl of LinuxCNC, .csv or .toml)", FILE, _take, most_MB=MAX_TABLE_MB)
    if tools:
        inputs.button("One cutter for all", "milling.tools.clear", "close", _clear)
    else:
        inputs.button("By hand, from this cutter", "milling.tools.make", "add", _make)


def _clear() -> None:
    session.drop(ODD)
    session.change(tools=ToolTable())


def _make() -> None:
    """A table that holds the cutter in force under the first number that cuts."""
    numbers = _cut_with().tolist() or [1]
    session.change(tools=ToolTable((TableTool(int(numbers[0]) or 1, session.project().setup.cutter),)))


def _take(data: bytes, name: str) -> None:
    """Read the file in the unit as it stands; it is kept, to be read again in another."""
    session.keep(FILE, (data, name))
    tools = read_tool_table(data, unit=session.kept(UNIT, UNITS[0]), name=name)
    session.change(tools=tools)
    session.keep(ODD, tools.findings)


# ---- between the table on the page and the tools -------------------------------------------------------------------


def _columns() -> list[Quantity]:
    tool, cutter = quantities(TableTool), quantities(Cutter)
    return [tool["number"], *(cutter[name] for name in OF_CUTTER), tool["length"]]


def _head(said: Quantity, unit: str) -> str:
    shown = unit_label(_shown(said, unit))
    return f"{said.label}, {shown}" if shown else said.label


def _shown(said: Quantity, unit: str) -> str:
    return unit if said.unit == "mm" else said.unit


def _box(said: Quantity, unit: str) -> NumberBox:
    """How a number of a tool is typed; only its number and its diameter have to be there."""
    return box_of(said, unit=_shown(said, unit), optional=said.name not in ("number", "diameter"))


def tool_frame(tools: ToolTable, unit: str) -> pd.DataFrame:
    """One row a tool with its declared numbers in SI, headed in ``unit``; what nobody has stated is empty."""
    columns: dict[str, list[Any]] = {_head(q, unit): [_cell(t, q) for t in tools.tools] for q in _columns()}
    return pd.DataFrame({**columns, NAME: [tool.name for tool in tools.tools]})


def _cell(tool: TableTool, said: Quantity) -> Any:
    cutter = tool.cutter
    owner = tool if said.name in OF_TOOL else cutter
    value = None if said.name in tool.assumed else getattr(owner, said.name, None)
    needless = said.name in OF_SHAPE and cutter is not None and said.name not in cutter.family.needs
    return None if needless else value


def tools_of(frame: pd.DataFrame, unit: str, before: ToolTable) -> ToolTable:
    """The tools of an edited table; an empty cell is not stated, and what has no column stays as it was ``before``.

    Raises CuttingError naming the row and the column.
    """
    shown = {said.key for said in _columns()} | {NAME, "assumed"}
    hidden = {
        row["number"]: {key: value for key, value in row.items() if key not in shown} for row in tools_to_tables(before)
    }
    rows: list[dict[str, Any]] = []
    for i in range(len(frame)):
        number = frame[_head(_columns()[0], unit)].iloc[i]
        row = {} if grid.empty(number) else dict(hidden.get(int(number), {}))
        for said in _columns():
            cell = frame[_head(said, unit)].iloc[i]
            if not grid.empty(cell):
                row[said.key] = int(cell) if said.kind == "whole" else write_quantity(said, cell)
        name = frame[NAME].iloc[i]
        rows.append(row if grid.empty(name) else {**row, "name": str(name)})
    return tools_from_table(Table({"tools": [row for row in rows if row]}, "Tool table", CuttingError))
