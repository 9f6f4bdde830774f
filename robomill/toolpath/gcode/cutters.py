"""Which cutter is meant: D of this line or of one before, T that changes the tool at once, and what G41 makes of it."""

import re
from math import isclose

from robomill.toolpath.gcode import codes as modal
from robomill.toolpath.gcode.codes import COMPENSATION, g_name
from robomill.toolpath.gcode.compensation import Compensation
from robomill.toolpath.gcode.machine import Machine
from robomill.toolpath.gcode.offsets import known_tool
from robomill.toolpath.gcode.scan import COMMENT_BYTES
from robomill.toolpath.gcode.words import Block
from robomill.toolpath.plane import axes
from robomill.units import from_si

_CHANGE = re.compile(rb"M0?6(?!\d)|\bL0?6\b", re.IGNORECASE)


def never_changes(data: bytes) -> bool:
    """Whether no M6 (or L6, a maker's cycle for it) stands anywhere in a program: there T itself changes the tool."""
    return _CHANGE.search(COMMENT_BYTES.sub(b"", data)) is None


def keep_d(machine: Machine, block: Block) -> None:
    """D stays in force on Fanuc-like controls: alone on a line, or beside T, it is that of the G41 that comes."""
    if "d" not in block.words or block.g.get(modal.SPINDLE_MODE) == 960:
        return
    beside = block.g.get(COMPENSATION)
    if beside is None:
        machine.kept_d = block.words.pop("d")
        held = machine.compensation
        if held is not None and not isclose(abs(size_of(machine, block, "D")[0]), held.radius, abs_tol=1e-9):
            raise block.refuse(f"D{machine.kept_d:g} changes the cutter while G41 or G42 is on; use G40 first.")
    elif machine.is_fanuc and beside in (410, 420):
        machine.kept_d = block.words["d"]


def compensation_on(machine: Machine, block: Block) -> None:
    """G41, G42, G41.1 and G42.1."""
    code = block.g[COMPENSATION]
    name = machine.sides.get(code, g_name(code))
    if machine.plane not in (17, 18):
        raise block.refuse(f"{name} works in the planes G17 and G18 only.")
    if machine.compensation is not None and not machine.other_control:
        raise block.refuse(f"{name}: cutter compensation is on already; use G40 first.")
    orientation = 0
    if code in (411, 421):
        if "d" not in block.words:
            raise block.refuse(f"{name} needs D, the diameter.")
        if "l" in block.words and machine.plane != 18:
            raise block.refuse(f"{name} takes L in the plane G18 only.")
        radius = block.words["d"] / 2.0
        orientation = round(block.words.get("l", 0.0))
    else:
        radius, orientation = size_of(machine, block, name)
        if machine.plane != 18 and orientation not in (0, 9):
            raise block.refuse(f"{name} with a lathe tool works in the plane G18 only.")
    u, v, _ = axes(machine.plane)
    mirrored = machine.scale is not None and machine.scale.factors[u] * machine.scale.factors[v] < 0.0
    left = ((code in (410, 411)) == (radius >= 0)) != mirrored  # left of what is said is right of its image
    if radius == 0:
        machine.note("zero-diameter", "warning", f"{name} with a diameter of 0: the contour is followed as it is")
    before = machine.compensation
    if before is not None:  # said once more
        if (before.left, before.radius) != (left, abs(radius)):
            raise block.refuse(f"{name} changes the side or the cutter without G40; use G40 first.")
        return
    machine.compensation = Compensation(left, abs(radius), orientation, machine.plane)


def size_of(machine: Machine, block: Block, name: str) -> tuple[float, int]:
    """Radius (program units) and lathe orientation by D, of this line or before; none is the tool in the spindle.

    D0 of a Fanuc control always means 0, whatever tool is in the spindle (15i, Operator's Manual: cutter compensation).
    """
    said = block.words.get("d", machine.kept_d)
    number = 0.0 if said is None else said
    if abs(number - round(number)) > 1e-4 or number < 0:
        raise block.refuse(f"{name} has D{number:g}; expected the number of a tool.")
    if machine.is_fanuc and said == 0.0:
        return 0.0, 0
    tool = known_tool(machine, block, round(number))
    if machine.tools is None or not (tool.sized or machine.strict):
        named = f'tool "{machine.tool_name[:40]}"' if machine.tool_name else "the tool in the spindle"
        which = f"tool {tool.number}" if tool.number else named
        do = "give a tool table" if machine.tools is None else "write it into the tool table"
        raise block.refuse(f"{name} needs the diameter of {which}; {do}.")
    if tool.number and tool.number not in machine.tools:
        raise block.refuse(f"tool {tool.number} is not in the tool table; add it.")
    if not tool.number and machine.tool_name:
        raise block.refuse(f'tool "{machine.tool_name[:40]}" is not in the tool table; add it under that name.')
    return from_si(tool.diameter, machine.unit) / 2.0, tool.orientation
