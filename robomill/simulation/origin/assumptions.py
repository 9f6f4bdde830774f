"""Numbers that nobody measured or stated: assumed, carried over from another cut, taken as usual. In one list."""

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from typing import Any

from robomill.cutting.tool import Cutter
from robomill.cutting.tool_table import ToolTable
from robomill.provenance import MADE_UP, Finding, Provenance
from robomill.quantities import described, quantities
from robomill.robot.model import Robot
from robomill.simulation.origin.origins import MODEL, Source, robot_lengths, robot_sources, sources
from robomill.simulation.setup import SimulationSetup
from robomill.toolpath.findings import NO_UNITS, UNITS_OF_FEED
from robomill.units import format_many

MANY = 4  # lengths that are called by their symbols


@dataclass(frozen=True)
class Assumed:
    """``what`` is assumed, its ``value`` in short ("" where it is many), and ``why``: its source in words."""

    what: str
    value: str
    why: str

    def record(self) -> dict[str, str]:
        """As JSON carries it."""
        return vars(self).copy()


def assumed_of_robot(robot: Robot, compliances: bool = True) -> list[Assumed]:
    """Of a robot: geometry, lengths, limits, frames, and the ``compliances`` in force, where they are used."""
    rows = robot_sources(robot, robot.provenance)
    return [*_of_sources(rows if compliances else rows[1:], robot), *_of_base(robot)]


def _of_base(robot: Robot) -> Iterator[Assumed]:
    base = robot.provenance.get("base")
    if base is not None and base.kind == "assumed":
        yield Assumed("base frame", f"at {format_many(robot.T_base[:3, 3], 'mm', 1)}", base.source)


def assumed_of_setup(setup: SimulationSetup) -> list[Assumed]:
    """Of all that a run rests on."""
    rows, path = sources(setup), setup.toolpath
    found = [*_of_sources(rows, setup.robot), *_of_base(setup.robot)]
    if setup.stock is None and all(each.what != "stock" for each in found):
        value = next(row.value for row in rows if row.what == "Stock")
        found.append(Assumed("stock", value, "none is given: a block around what the path cuts"))
    found += assumed_of_tools(setup.tools, path.tool[path.cutting].tolist())
    found += [Assumed(what, value, said.source) for what, value, said in _beside(setup) if said.kind in MADE_UP]
    return found + assumed_of_program(path.findings)


def _beside(setup: SimulationSetup) -> Iterator[tuple[str, str, Provenance]]:
    """What is said of whatever has no row among the sources, with its value in short."""
    for spring in setup.springs:
        yield f"spring {spring.name}", described(spring), spring.provenance
    if setup.links is not None:
        yield "link masses", "", setup.links.provenance
    if setup.measured_map is not None:
        yield "measured map", "", setup.provenance.get("measured_map", setup.measured_map.provenance)
    if "part" in setup.provenance:
        yield "part zero", format_many(setup.T_MW[:3, 3], "mm", 1), setup.provenance["part"]


def assumed_of_tools(tools: ToolTable, numbers: Iterable[int]) -> list[Assumed]:
    """Of the tools ``numbers``: what their table does not say of them."""
    declared, found = quantities(Cutter), []
    for number in sorted({*numbers} & {*tools}):
        tool = tools[number]
        for name in tool.assumed if tool.cutter is not None else ():
            value = declared[name].short(getattr(tool.cutter, name))
            found.append(Assumed(f"{declared[name].label.lower()} of tool {number}", value, "its table does not say"))
    return found


def assumed_of_program(findings: Iterable[Finding]) -> list[Assumed]:
    """Of a program: the unit of its lengths, where it does not say one."""
    taken = {NO_UNITS: "mm", UNITS_OF_FEED: "that of its feeds"}
    known = [each for each in findings if each.code in taken][:1]
    return [Assumed("unit of the program", taken[each.code], each.message) for each in known]


def assumed_of_tests(tests: Any) -> list[Assumed]:
    """Of load tests: that nobody has measured them, where they are made up."""
    said = tests.provenance
    return [Assumed(f"load tests ({said.kind})", "", said.source)] if said.kind in MADE_UP else []


def _of_sources(rows: Sequence[Source], robot: Robot) -> list[Assumed]:
    chosen = [row for row in rows if row.provenance.kind in MADE_UP and row.provenance is not MODEL]
    return [Assumed(_words(row, robot), row.value, row.provenance.source) for row in chosen]


def _words(row: Source, robot: Robot) -> str:
    what, lengths = row.what, list(robot_lengths(robot))
    if what == "Link lengths" and len(lengths) <= MANY:
        return f"link lengths {', '.join(lengths)}"
    said = f"{what[0].lower()}{what[1:]}" if what[1].islower() else what
    return f"{said} (synthetic)" if row.provenance.kind == "synthetic" else said
