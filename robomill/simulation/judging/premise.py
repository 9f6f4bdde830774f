"""What the numbers of a run rest on that nobody has said of its path: then nothing is judged by them."""

from typing import NamedTuple

from robomill.simulation.judging.seen import Run
from robomill.simulation.origin.doubts import unit_slips
from robomill.surface.stock_unit import OUTSIDE, unit_doubt
from robomill.units import format_count, format_si


class Premise(NamedTuple):
    """``"if the tool is pushed with 100 N"``, and the sentence that asks for it; both "" where all is said."""

    words: str
    asked: str


NONE = Premise("", "")


def premise(result: Run, left: bool) -> Premise:
    """What pushes the tool, where that was stated for another path; how much joints give of which nobody has said it;
    numbers that were certainly meant in another unit; the unit of a stock that hardly holds the path and of which
    nothing is ``left`` to measure; flutes that nobody has counted, where the force follows them."""
    setup = result.setup
    if result.worst < 0:
        return NONE
    if setup.carried_from:
        return Premise(_pushed(result), "Nobody has said yet what this path cuts: not judged.")
    if setup.robot.assumes_compliances and setup.measured_map is None:
        asked = "Nobody has given the compliances of this arm's joints: not judged."
        return Premise("if its joints give as much as is assumed", asked)
    slips = unit_slips(setup, result.path, result.F[result.judged & result.conditions.engaged])
    if slips:
        return Premise("if its numbers are in their units", f"{slips[0].message} Not judged.")
    if not left and _outside(result):
        asked = "The path hardly touches the stock, which would hold it in another unit: not judged."
        return Premise("if the unit of the stock is right", asked)
    return _uncounted(result) if setup.force.follows_cut else NONE


def _pushed(result: Run) -> str:
    force = result.setup.force
    if force.follows_cut:
        return f"if it cuts {force.numbers}"
    return f"if the tool is pushed with {format_si(float(result.force_size[result.worst]), 'N', 0)}"


def _outside(result: Run) -> bool:
    """Whether most of the path lies outside of a stock that would hold it in another unit."""
    setup = result.setup
    if setup.stock is None:
        return False
    found = unit_doubt(setup.stock, setup.toolpath.p, setup.toolpath.cutting)
    return any(finding.code == OUTSIDE for finding in found)


def _uncounted(result: Run) -> Premise:
    tools = result.setup.tools.unstated(result.path.tool[result.path.cutting].tolist())
    counts = {tool.number: format_count(tool.cutter.flutes, "flute") for tool in tools if tool.cutter is not None}
    if not counts:
        return NONE
    rests = " and ".join(f"tool {number} has {flutes}" for number, flutes in counts.items())
    numbers = " and ".join(map(str, counts))
    asked = f"Nobody has said how many flutes tool {numbers} has, and its force grows with them: not judged."
    return Premise(f"if {rests}", asked)
