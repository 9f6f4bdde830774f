"""Tool tables: LinuxCNC's ``.tbl``, CSV and TOML; the [[tools]] of a set-up. Each tool is read by its declared fields.

    [[tools]]                                  tool,kind,diameter_mm,flutes,length_mm
    number = 1                                 1,ball,6,2,62.5
    kind = "ball"
    diameter_mm = 6                            T1 P1 D6.0 Z62.5 ; a .tbl knows no kind and no flutes
    flutes = 2
    length_mm = 62.5

What force needs and the file does not say (``tool_table.ASKED``) is assumed as a cutter's default, and marked so.
"""

import re
from pathlib import Path
from typing import Any

from robomill.arguments import asked
from robomill.cutting.tool import Cutter
from robomill.cutting.tool_table import ASKED, TableTool, ToolTable
from robomill.errors import CuttingError
from robomill.files import TOOLS
from robomill.io.beside import ALONE, Beside
from robomill.io.columns import Layout, read_cells
from robomill.io.declared import from_table, to_table
from robomill.io.tables import Table, parse_toml
from robomill.io.texts import read_text
from robomill.provenance import Finding
from robomill.quantities import quantities
from robomill.typed_numbers import plain_number
from robomill.units import format_count, format_si, from_si, to_si

UNITS = ("mm", "in")
LAYOUT = Layout("Tool table", CuttingError, {}, "tool,kind,diameter_mm,flutes,length_mm")
NAMES = dict.fromkeys(("tool", "t", "tool_number", "tool_no", "no", "nr"), "number")
SHORT = {
    **dict.fromkeys(("d", "dia", "diameter"), "diameter_mm"),
    **dict.fromkeys(("l", "len", "length"), "length_mm"),
}
"""Usual headings without a unit, which is that of the table."""
ASSUMED_KIND = "flat"
LONGEST_LINE = 500  # characters of a tool in a .tbl
SMALL = 1.6e-3
"""m: a table whose largest cutter is smaller than this may count in inches."""

_WORD = re.compile(r"([A-Za-z])\s*([-+]?(?:\d+(?:\.\d*)?|\.\d+)(?:[eE][-+]?\d+)?)(?=$|[\s;A-Za-z])\s*")
_OF_TBL = {"T": "number", "X": "offset_x_mm", "Y": "offset_y_mm", "Z": "length_mm", "Q": "orientation"}
_SILENT = frozenset("PABCUVWIJ")
_LENGTHS = "XYZD"


@asked
def read_tool_table(given: str | Path | bytes, *, unit: str = "mm", name: str = "") -> ToolTable:
    r"""The tools of a machine's table.

    Parameters
    ----------
    given : str, Path or bytes
        A file, its text or its bytes.
    unit : str
        Of a ``.tbl``, and of columns such as D and L, which do not say it: "mm" or "in".
    name : str
        What refusals call it.

    Returns
    -------
    ToolTable
        Tools by number; what the table does not say of them is asked for where it matters.

    Raises
    ------
    CuttingError
        Naming the file and the line or tool.

    Examples
    --------
    >>> import robomill as rm
    >>> rm.read_tool_table("T1 P1 D8.0 Z50.0 ;end mill\n", name="tool.tbl").cutter(1).diameter
    0.008
    """
    text, name = read_text(given, CuttingError, TOOLS, name)
    place = name or "Tool table"
    if unit not in UNITS:
        raise CuttingError(f"{place}: the unit is {unit!r}; expected one of {', '.join(UNITS)}.")
    first = next((line.strip() for line in text.splitlines() if line.strip() and line.strip()[0] not in "#;"), "")
    if first.startswith("[") or "=" in first:
        return tools_from_table(Table(parse_toml(text, place, CuttingError), place, CuttingError))
    if re.search(r"[,;\t]", first) and not re.match(r"[Tt]\s*\d", first):
        tools, findings = _from_csv(text, name, unit)
    else:
        tools, findings = _from_tbl(text, place, unit), []
    if not tools:
        raise CuttingError(f"{place}: found no tools; expected lines such as 'T1 P1 D3.0 Z12.5'.")
    return _whole(tools, place, *findings)


def tools_from_table(top: Table, beside: Beside = ALONE) -> ToolTable:
    """The ``tools`` of a document: [[tools]] entries, or the name of a tool table's file; empty without.

    A ``.tbl`` counts in mm unless ``tools_unit`` says "in".
    """
    unit = top.choice("tools_unit", UNITS, "mm")
    if isinstance(top.data.get("tools"), str):
        data, name = beside.read(top, "tools", TOOLS)
        return read_tool_table(data, unit=unit, name=name)
    return _whole([_tool(entry) for entry in top.tables("tools")], top.where)


def tools_to_tables(tools: ToolTable) -> list[dict[str, Any]]:
    """The [[tools]] that ``tools_from_table`` reads back."""
    return [to_table(tool) | ({} if tool.cutter is None else to_table(tool.cutter)) for tool in tools.tools]


def _whole(tools: list[TableTool], place: str, *findings: Finding) -> ToolTable:
    sizes = [tool.cutter.diameter for tool in tools if tool.cutter is not None]
    largest = max(sizes, default=SMALL)
    if largest < SMALL:
        inches = format_si(to_si(from_si(largest, "mm"), "in"), "mm")
        shown = f"the largest tool is {format_si(largest, 'mm')} across; if the table counts in inches, it is {inches}"
        findings += (Finding("suspicious", shown, code="tool-units"),)
    try:
        return ToolTable(tuple(tools), findings)
    except CuttingError as exc:
        raise CuttingError(f"{place}: {exc}", where=exc.where) from None


def _tool(table: Table) -> TableTool:
    """A tool from its keys: the table's own and those of a Cutter beside them."""
    keys = {name: declared.key for name, declared in quantities(Cutter).items()}
    said = {key: value for key, value in table.data.items() if key in keys.values()}
    table.asked.update(keys.values())
    assumed, cutter = tuple(table.words("assumed")), None
    if said:
        assumed += tuple(name for name in ASKED if keys[name] not in said and name not in assumed)
        cutter = from_table(Table({keys["kind"]: ASSUMED_KIND} | said, table.where, table.error), Cutter)
    return from_table(table, TableTool, given={"cutter": cutter, "assumed": assumed})


def _from_tbl(text: str, place: str, unit: str) -> list[TableTool]:
    tools = []
    for line, raw in enumerate(text.splitlines(), 1):
        code, _, comment = raw.partition(";")
        if not code.strip():
            continue
        where = f"{place}, line {line}"
        if len(code) > LONGEST_LINE:
            raise CuttingError(
                f"{where}: it has {format_count(len(code))} characters; expected words such as 'T1 P1 D3.0 Z12.5'."
            )
        if not re.fullmatch(rf"(?:{_WORD.pattern})+", code.strip()):
            raise CuttingError(f"{where}: found {code.strip()[:40]!r}; expected words such as 'T1 P1 D3.0 Z12.5'.")
        words = {letter.upper(): float(value) for letter, value in _WORD.findall(code.strip())}
        unknown = sorted(set(words) - set(_OF_TBL) - _SILENT - {"D"})
        if "T" not in words or unknown:
            found = f"{unknown[0]}, which no tool has" if unknown else "no T, the tool's number"
            raise CuttingError(f"{where}: found {found}; expected words such as 'T1 P1 D3.0 Z12.5'.")
        lengths = {letter: from_si(to_si(words[letter], unit), "mm") for letter in _LENGTHS if letter in words}
        entry: dict[str, Any] = {
            _OF_TBL[letter]: value for letter, value in (words | lengths).items() if letter in _OF_TBL
        }
        entry |= {key: int(entry[key]) for key in ("number", "orientation") if key in entry and entry[key].is_integer()}
        diameter = lengths.get("D", 0.0)
        if diameter:
            entry["diameter_mm"] = abs(diameter)
        if "D" in lengths and diameter <= 0.0:  # D0: the program is of the cutter's centre
            entry["compensates_mm"] = diameter
        tools.append(_tool(Table({**entry, "name": comment.strip()}, where, CuttingError)))
    return tools


def _from_csv(text: str, name: str, unit: str) -> tuple[list[TableTool], list[Finding]]:
    """The tools, and what is to be said of their columns."""
    known = {declared.key for cls in (TableTool, Cutter) for declared in quantities(cls).values()} | {"name"}
    tools = []
    passed_over: dict[str, None] = {}
    short: dict[str, str] = {}
    for where, cells in read_cells(text, LAYOUT, name):
        entry: dict[str, Any] = {}
        for header, cell in cells.items():
            key = re.sub(r"[\s()\[\]]+", "_", header.lower()).strip("_")
            key = NAMES.get(key, key)
            value = cell if key == "name" else _value(cell)
            if key.endswith("_in") and isinstance(value, int | float):
                key, value = f"{key[:-2]}mm", from_si(to_si(float(value), "in"), "mm")
            if key in SHORT and SHORT[key] not in entry and isinstance(value, int | float):
                short[header] = f"{header} is {SHORT[key].partition('_')[0]}"
                key, value = SHORT[key], value if unit == "mm" else from_si(to_si(float(value), unit), "mm")
            if key in known:
                entry[key] = value
            else:
                passed_over[header] = None
        tools.append(_tool(Table(entry, where, CuttingError)))
    findings = []
    if short:
        said = f"{', '.join(short.values())}, in {unit}: the headings say no unit; write diameter_mm or diameter_in"
        findings.append(Finding("info", said, code="column-unit"))
    if passed_over:
        left_out = f"{', '.join(passed_over)}: not a column of a tool table, left out"
        findings.append(Finding("ignored", left_out, code="column-left-out"))
    return tools, findings


def _value(cell: str) -> int | float | str:
    """A cell as TOML would hold it."""
    for kind in (int, float):
        try:
            return plain_number(cell, kind)
        except ValueError:
            continue
    return cell.lower()
