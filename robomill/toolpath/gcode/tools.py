"""Tool tables: LinuxCNC's ``.tbl`` and CSV with columns ``tool,diameter_mm,length_mm``."""

from __future__ import annotations

import csv
import math
import re
from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path

from robomill.errors import GCodeError
from robomill.units import to_si

_WORD = re.compile(r"([A-Za-z])\s*([-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?)")


@dataclass(frozen=True)
class Tool:
    """A tool of the table, in m: ``offset`` x, y, z (z is the length), ``diameter``, lathe ``orientation`` 0..9."""

    number: int
    diameter: float = 0.0
    offset: tuple[float, float, float] = (0.0, 0.0, 0.0)
    orientation: int = 0

    def __post_init__(self) -> None:
        if not all(math.isfinite(v) for v in (self.diameter, *self.offset)) or self.number < 0:
            raise GCodeError(f"Tool {self.number}: expected a number of 0 or more and finite sizes.")

    def replace(self, **changes: object) -> Tool:
        """A changed copy."""
        return replace(self, **changes)  # type: ignore[arg-type]


ToolTable = Mapping[int, Tool]


def read_tool_table(path: str | Path) -> dict[int, Tool]:
    """Tools by number from a ``.tbl`` or ``.csv`` file, sizes in mm. Raises GCodeError naming the line."""
    file = Path(path)
    try:
        text = file.read_bytes().decode("utf-8-sig", "replace")
    except OSError as exc:
        raise GCodeError(f"{file}: cannot be read ({exc.strerror}); expected a tool table.") from exc
    lines = text.splitlines()
    tools = _from_csv(lines, file.name) if _is_csv(lines) else _from_tbl(lines, file.name)
    if not tools:
        raise GCodeError(f"{file.name}: found no tools; expected lines such as 'T1 P1 D3.0 Z12.5'.")
    return tools


def _is_csv(lines: list[str]) -> bool:
    first = next((line for line in lines if line.strip() and not line.startswith("#")), "")
    return "," in first and "tool" in first.lower()


def _from_csv(lines: list[str], name: str) -> dict[int, Tool]:
    rows = [(n, line) for n, line in enumerate(lines, 1) if line.strip() and not line.startswith("#")]
    columns = [c.strip().lower() for c in next(csv.reader([rows[0][1]]))]
    missing = {"tool", "diameter_mm", "length_mm"} - set(columns)
    if missing:
        raise GCodeError(f"{name}: column {sorted(missing)[0]} is missing; expected tool,diameter_mm,length_mm.")
    tools: dict[int, Tool] = {}
    for number, line in rows[1:]:
        values = dict(zip(columns, next(csv.reader([line]))))
        try:
            tool = Tool(
                int(values["tool"]),
                to_si(float(values["diameter_mm"]), "mm"),
                (0.0, 0.0, to_si(float(values["length_mm"]), "mm")),
            )
        except (KeyError, ValueError) as exc:
            raise GCodeError(
                f"{name}, line {number}: {exc}; expected tool,diameter_mm,length_mm.", line=number
            ) from exc
        if tool.number in tools:
            raise GCodeError(f"{name}, line {number}: tool {tool.number} is there twice.", line=number)
        tools[tool.number] = tool
    return tools


def _from_tbl(lines: list[str], name: str) -> dict[int, Tool]:
    tools: dict[int, Tool] = {}
    for number, line in enumerate(lines, 1):
        text = line.split(";")[0].strip()
        if not text:
            continue
        words = {letter.upper(): float(value) for letter, value in _WORD.findall(text)}
        if "T" not in words:
            raise GCodeError(f"{name}, line {number}: found {text[:30]!r}; expected 'T1 P1 D3.0 Z12.5'.", line=number)
        offset = tuple(to_si(words.get(axis, 0.0), "mm") for axis in "XYZ")
        tool = Tool(
            int(words["T"]), to_si(words.get("D", 0.0), "mm"), (offset[0], offset[1], offset[2]), int(words.get("Q", 0))
        )
        tools[tool.number] = tool
    return tools
