"""The tools of a program by number: what cuts, how long each is, and what of it nobody has stated. SI."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, field
from types import NoneType
from typing import TYPE_CHECKING

from robomill.arguments import asked, asking
from robomill.arrays import of_kind
from robomill.cutting.tool import WIDEST, Cutter
from robomill.errors import CuttingError
from robomill.lazy import cached_property
from robomill.provenance import Finding
from robomill.quantities import quantities, quantity, settle, whole
from robomill.spelled import in_units
from robomill.units import format_si

FARTHEST = 10.0  # m: hardly a machine counts as far: was it meant in mm?
ASKED = ("kind", "flutes", "helix_angle")
"""Fields of a cutter that a force needs and a table of a machine does not say; without a word they are assumed."""


@in_units(CuttingError, "Tool")
@dataclass(frozen=True)
class TableTool:
    """A tool as T and H words call it by its ``number``.

    ``cutter`` is None where the table does not say its diameter: such a tool can be measured and carried, not cut with.
    ``length`` is what G43 H counts along Z. ``compensates`` is the diameter that G41 and G42 count with where it is
    not the cutter's (below 0: to the other side). ``assumed`` names the fields of the cutter that nobody has stated.

    Examples
    --------
    >>> import robomill as rm
    >>> rm.TableTool(3, rm.Cutter("ball", diameter_mm=6, flutes=2), length_mm=50).diameter
    0.006
    """

    number: int = whole("Tool", least=0)
    cutter: Cutter | None = None
    length: float = quantity("Length", "mm", default=0.0, slip=FARTHEST)
    offset_x: float = quantity("Offset X", "mm", default=0.0, boxed=False, slip=FARTHEST)
    offset_y: float = quantity("Offset Y", "mm", default=0.0, boxed=False, slip=FARTHEST)
    orientation: int = whole("Orientation of the nose", default=0, least=0, most=9, boxed=False)
    compensates: float | None = quantity("Diameter of compensation", "mm", optional=True, boxed=False, slip=WIDEST)
    assumed: tuple[str, ...] = ()
    name: str = ""

    if TYPE_CHECKING:

        def __init__(
            self,
            number: int,
            cutter: Cutter | None = ...,
            length: float = ...,
            offset_x: float = ...,
            offset_y: float = ...,
            orientation: int = ...,
            compensates: float | None = ...,
            assumed: tuple[str, ...] = ...,
            name: str = ...,
            *,
            length_mm: float = ...,
            offset_x_mm: float = ...,
            offset_y_mm: float = ...,
            compensates_mm: float | None = ...,
        ) -> None: ...

    def __post_init__(self) -> None:
        settle(self, CuttingError, f"Tool {self.number}")
        give = 'rm.Cutter("flat", diameter_mm=8), or None'
        of_kind(self.cutter, (Cutter, NoneType), f"Tool {self.number}, cutter", give, CuttingError)
        unknown = sorted(set(self.assumed) - set(quantities(Cutter)))
        if unknown:
            known = ", ".join(quantities(Cutter))
            raise CuttingError(
                f"Tool {self.number}, assumed: a cutter has no {unknown[0]!r}; known are {known}.", where="assumed"
            )

    @property
    def diameter(self) -> float:
        """What G41 and G42 count with, m; 0 where it is not known."""
        if self.compensates is not None:
            return self.compensates
        return 0.0 if self.cutter is None else self.cutter.diameter

    @property
    def sized(self) -> bool:
        """Whether the table says what G41 and G42 count with."""
        return self.cutter is not None or self.compensates is not None

    @property
    def offset(self) -> tuple[float, float, float]:
        """What G43 counts along X, Y and Z, m."""
        return self.offset_x, self.offset_y, self.length


@asking
@dataclass(frozen=True)
class ToolTable(Mapping[int, TableTool]):
    """Tools by number, in the order of their numbers; empty: no table. ``findings`` say what was odd in its file.

    Raises CuttingError for a number that stands there twice.

    Examples
    --------
    >>> import robomill as rm
    >>> tools = rm.ToolTable((rm.TableTool(3, rm.Cutter("ball", diameter_mm=6, flutes=2)),))
    >>> tools.cutter(3)
    <Cutter 6.00 mm ball-nose mill, 2 flutes>
    """

    tools: tuple[TableTool, ...] = ()
    findings: tuple[Finding, ...] = field(default=(), compare=False)

    def __post_init__(self) -> None:
        object.__setattr__(self, "tools", tuple(sorted(self.tools, key=lambda tool: tool.number)))
        for before, after in zip(self.tools, self.tools[1:], strict=False):
            if before.number == after.number:
                raise CuttingError(f"Tool table: tool {after.number} is there twice; keep one.", where="number")

    @cached_property
    def _by_number(self) -> dict[int, TableTool]:
        return {tool.number: tool for tool in self.tools}

    def __getitem__(self, number: int) -> TableTool:
        return self._by_number[number]

    def __iter__(self) -> Iterator[int]:
        return iter(self._by_number)

    def __len__(self) -> int:
        return len(self.tools)

    @asked
    def called(self, number: int) -> str:
        """A tool in a few words: ``"T2 · 20.00 mm flat end mill, 4 flutes"``, ``"T1 · drill, 6.00 mm"``."""
        tool = self.get(number, TableTool(number))
        said = [tool.name] if tool.name else []
        if tool.cutter is not None:
            said.append(format_si(tool.cutter.diameter, "mm", 2) if said else tool.cutter.title)
        return " · ".join([f"T{number}", *([", ".join(said)] if said else [])])

    def cutter(self, number: int) -> Cutter:
        """What tool ``number`` cuts with. Raises CuttingError where the table does not hold it or does not know it."""
        if number not in self:
            known = ", ".join(str(n) for n in self)
            raise CuttingError(
                f"Tool {number} cuts and is not in the tool table (there are: {known or 'none'}); add it.",
                where=f"tool {number}",
            )
        cutter = self[number].cutter
        if cutter is None:
            raise CuttingError(
                f"Tool {number} cuts, but the tool table does not say its diameter; give it.", where=f"tool {number}"
            )
        return cutter

    def unstated(self, numbers: Iterable[int]) -> tuple[TableTool, ...]:
        """Tools among ``numbers`` whose flutes, which the force grows with, nobody has stated."""
        return tuple(self[n] for n in sorted({*numbers} & {*self}) if "flutes" in self[n].assumed)

    def notes(self, numbers: Iterable[int]) -> tuple[Finding, ...]:
        """What a reader must know of the tools ``numbers`` that cut: what of them is assumed, one finding a tool."""
        declared = quantities(Cutter)
        said = []
        for number in sorted({*numbers} & {*self}):
            tool = self[number]
            if tool.cutter is None or not tool.assumed:
                continue
            fields = (declared[name] for name in tool.assumed)
            assumed = ", ".join(
                f"{each.label.lower()} {each.short(getattr(tool.cutter, each.name))}" for each in fields
            )
            text = f"Tool {number}: {assumed} assumed; its table does not say."
            said.append(Finding("info", text, code="tool-assumed"))
        return tuple(said)
