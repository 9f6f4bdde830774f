"""Tools as a program knows them: numbers, lengths and diameters."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Protocol

from robomill.errors import ArgumentError

MOST = 2**31 - 1
"""No column of whole numbers holds more; nobody turns so often, or has so many tools."""


@dataclass(frozen=True)
class Tool:
    """A tool, in m: ``offset`` x, y, z (z is the length), ``diameter``, lathe ``orientation`` 0..9.

    ``name`` is what programs call it by that have names for tools. ``sized`` is whether anybody has said its diameter.
    """

    number: int
    diameter: float = 0.0
    offset: tuple[float, float, float] = (0.0, 0.0, 0.0)
    orientation: int = 0
    name: str = ""
    sized: bool = True


class Sized(Protocol):
    """What a table says of a tool; a Tool, or whatever else has these."""

    @property
    def diameter(self) -> float: ...
    @property
    def offset(self) -> tuple[float, float, float]: ...
    @property
    def orientation(self) -> int: ...
    @property
    def name(self) -> str: ...
    @property
    def sized(self) -> bool: ...


Tools = Mapping[int, Sized]


def own_copy(tools: Tools) -> dict[int, Tool]:
    """The tools of a table, to be changed by G10. Raises ArgumentError where one is no tool of a table."""
    for number, tool in tools.items():
        if not hasattr(tool, "offset"):
            give = f"rm.ToolTable((rm.TableTool({number}, cutter),))"
            raise ArgumentError(
                f"Tool {number}: found a {type(tool).__name__}, expected a tool of a table, as in {give}."
            )
    return {
        number: Tool(number, tool.diameter, tool.offset, tool.orientation, tool.name, tool.sized)
        for number, tool in tools.items()
    }
