"""What a line does, in the standard's order of execution."""

import math
from typing import Any

from robomill.toolpath.gcode import codes as modal, cutters, moves, offsets, splines, threads
from robomill.toolpath.gcode.codes import g_name
from robomill.toolpath.gcode.machine import Machine
from robomill.toolpath.gcode.program import PROBE
from robomill.toolpath.gcode.rules.cycle_rules import is_cycle
from robomill.toolpath.gcode.rules.mode_rules import set_modes, set_plane, set_rates, switch
from robomill.toolpath.gcode.rules.motion_rules import dwell
from robomill.toolpath.gcode.words import Block
from robomill.toolpath.tools import MOST, Tool


def execute(machine: Machine, block: Block, saved: dict[str, Any]) -> bool:
    """Execute a checked line; True if the program ends here. ``saved`` is where M70 keeps the modes."""
    words, g = block.words, block.g
    plain = moves.plain_words(block)
    stays = g.get(modal.NON_MODAL, -1) in (-1, 40, 280, 300, 530) and block.motion in (-1, 0, 10)
    if machine.leaving is not None and (not stays or modal.UNITS in g):
        machine.leaving = None  # what counts from elsewhere, and arcs and cycles, go on from the programmed point
    set_rates(machine, plain)
    if g.get(modal.SPINDLE_MODE) == 960:
        machine.note("surface-speed", "warning", "G96: the spindle speed follows the diameter and is not known")
    other_unit = g.get(modal.UNITS, machine.unit_code) != machine.unit_code
    if "f" in words and machine.feed_mode != 930 and other_unit and not machine.feed_in_block:
        machine.note(
            "feed-units", "suspicious", f"F and {g_name(g[modal.UNITS])} on one line: F counts in the units before it"
        )
    if "t" in words:
        offsets.known_tool(machine, block, round(words["t"]))
        machine.selected = round(words["t"])
        if machine.t_changes:
            _change_to(machine, block, machine.selected)
    if block.then >= 0 and modal.TOOL not in block.m:
        raise block.refuse(block.twice)
    _execute_m(machine, block, saved)
    if block.then > 0:
        machine.selected = block.then
    switch(machine, plain)
    _execute_g(machine, block, plain)
    if not machine.other_control and (modal.TOOL in block.m or block.m.get(modal.IO) == 66):
        if max(abs(p - s) for p, s in zip(machine.p, machine.sent)) > 1e-6:
            machine.note(
                "position-after-tool",
                "warning",
                "after the tool change, axes without a word go on from the last straight move",
            )
        machine.p = list(machine.sent)
    return modal.STOP in block.m and _stop(machine, block)


def _execute_m(machine: Machine, block: Block, saved: dict[str, Any]) -> None:
    m = block.m
    if modal.IO in m:
        machine.note("input-output", "ignored", f"M{m[modal.IO]}: inputs and outputs are left out")
        machine.store.numbered[5399] = -1.0
    if modal.TOOL in m:
        _change_tool(machine, block)
    spindle = m.get(modal.SPINDLE, -1)
    if spindle in (70, 73):
        saved.clear()
        saved.update(machine.save_modes(), automatic=spindle == 73)
    elif spindle == 71:
        saved.clear()
    elif spindle == 72:
        if not saved:
            raise block.refuse("M72 has nothing to restore; M70 or M73 comes first.")
        restore_modes(machine, block, saved)
    if modal.OVERRIDE in m:
        machine.need_compensation_off(block, f"M{m[modal.OVERRIDE]}")
    if modal.USER in m:
        machine.note("user-m", "ignored", f"M{m[modal.USER]} is made by the user of a machine and is left out")


def restore_modes(machine: Machine, block: Block, saved: dict[str, Any]) -> None:
    """Put back what M70 or M73 kept: units first, then everything else."""
    if saved["unit_code"] != machine.unit_code:
        machine.set_units(saved["unit_code"])
    if saved["system"] != machine.system:
        offsets.select_system(machine, block, saved["system"])
    shifted = machine.save_modes()["shifted"]
    if saved.get("shifted", shifted) != shifted:
        offsets.axis_offsets(machine, block, 922 if shifted else 923)
    for name, value in saved.items():
        if name not in ("unit_code", "system", "shifted", "automatic"):
            setattr(machine, name, value)


def _change_tool(machine: Machine, block: Block) -> None:
    if block.m[modal.TOOL] == 61:
        number = round(block.words.get("q", -1.0))
        if not 0 <= number <= MOST:
            raise block.refuse(f"M61 needs Q, a tool number of 0 or more, up to {MOST}.")
    else:
        if machine.selected == 0 and "t" not in block.words and machine.tool.number == 0 and not machine.tool_name:
            machine.note("no-tool", "warning", "M6 without a tool selected by T: no tool is in the spindle")
        machine.need_compensation_off(block, "M6")
        number = machine.selected
        machine.spindle = 0
    _change_to(machine, block, number)


def _change_to(machine: Machine, block: Block, number: int) -> None:
    machine.tool = offsets.known_tool(machine, block, number) if number else Tool(0)
    machine.in_spindle = number
    machine.note_length(machine.length_of)


def _execute_g(machine: Machine, block: Block, plain: list[float]) -> None:
    g = block.g
    if g.get(modal.NON_MODAL) == 40:
        dwell(machine, block.words["p"])
    if modal.PLANE in g:
        _check_plane(machine, block, g[modal.PLANE])
        set_plane(machine, plain)
    if modal.UNITS in g:
        kept = is_cycle(machine.motion) or machine.modal is not None
        if kept and g[modal.UNITS] != machine.unit_code and not machine.strict:
            raise block.refuse("units change while a cycle is in force, whose depths they would change; end it first.")
        machine.set_units(g[modal.UNITS])
    if modal.DIAMETER in g:
        diameter = g[modal.DIAMETER] == 70
        if diameter != machine.diameter_mode and "x" in block.words:
            block.words["x"] *= 0.5 if diameter else 2.0
        if diameter and not machine.strict:
            text = "G7: X counts as a diameter from here on, as on LinuxCNC's lathes; remove it from a mill's program"
            machine.note("diameters", "warning", text)
        machine.diameter_mode = diameter
    if modal.COMPENSATION in g:
        if g[modal.COMPENSATION] == 400:
            if machine.compensation is not None:
                machine.compensation.off(machine, block)
        else:
            cutters.compensation_on(machine, block)
    if modal.LENGTH in g:
        offsets.tool_length(machine, block, g[modal.LENGTH])
    if modal.COORDINATES in g:
        offsets.select_system(machine, block, offsets.SYSTEMS[g[modal.COORDINATES]])
    for group in (modal.CONTROL, modal.RETRACT):
        if group in g:
            machine.need_compensation_off(block, g_name(g[group]))
    set_modes(machine, plain)
    if modal.NON_MODAL in g:
        _non_modal(machine, block, g[modal.NON_MODAL])
    if block.motion >= 0:
        _move(machine, block)


def _check_plane(machine: Machine, block: Block, code: int) -> None:
    if code % 10:
        raise block.refuse(f"{g_name(code)}: this machine has no U, V, W axes; use G17, G18 or G19.")
    if machine.compensation is not None and code != 10 * machine.plane:
        raise block.refuse(f"{g_name(code)} cannot change the plane with cutter compensation on; use G40 first.")


def _non_modal(machine: Machine, block: Block, code: int) -> None:
    if code == 53:
        splines.finish(machine, block)
    elif code == 100:
        offsets.set_data(machine, block)
    elif code in (280, 300):
        moves.home(machine, block, code)
    elif code in (281, 301):
        moves.save_home(machine, block, code)
    elif code in (520, 920, 921, 922, 923):
        offsets.axis_offsets(machine, block, code)


def _move(machine: Machine, block: Block) -> None:
    code = block.motion
    moves.place(machine, block)
    if not is_cycle(code):
        machine.initial_level = math.nan
    if code in (0, 10, 20, 30):
        moves.move(machine, block)
    elif code in (330, 331):
        moves.in_step(machine, block)
    elif code == 800:
        machine.motion = 800
    elif is_cycle(code):
        moves.drill(machine, block)
    elif code in modal.PROBES:
        _probe(machine, block)
    elif code in (50, 51, 52):
        splines.spline(machine, block)
    elif code == 760:
        threads.thread(machine, block)
    else:
        raise block.refuse(f"{g_name(code)} is not supported; write the motion with G1, G2 and G3.")


def _probe(machine: Machine, block: Block) -> None:
    machine.need_compensation_off(block, g_name(block.motion))
    if machine.feed == 0.0:
        raise block.refuse(f"{g_name(block.motion)} needs a feed rate; give an F word above 0 first.")
    if machine.feed_mode == 950:
        raise block.refuse(f"{g_name(block.motion)} cannot be used in feed per revolution (G95).")
    end = moves.find_end(machine, block)
    if block.motion in (382, 384) and end == machine.p:
        raise block.refuse(f"{g_name(block.motion)} starts where it should end; move away first.")
    machine.go(PROBE, block.line, end)
    machine.note("probing", "warning", "probing: the probe is taken to travel its whole way")
    if not machine.is_fanuc:
        machine.store.put(5061, end)
    machine.store.numbered[5070] = 0.0
    machine.p = end
    machine.motion = block.motion if block.once < 0 else block.once


def _stop(machine: Machine, block: Block) -> bool:
    if machine.compensation is not None:
        machine.compensation.finish(machine, block)
    return block.m[modal.STOP] in (2, 30)
