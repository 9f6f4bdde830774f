"""Canned cycles as Fanuc and Haas count them: K or L times, no time at all, without a dwell, and fine boring (G76).

Haas's G70 and G71 drill the cycle in force around a circle whose centre the tool stands at, or that their line says,
G72 in a row that begins there (Yaskawa, YASNAC PC NC, Programming Manual, 4.1.2: hole machining pattern cycles);
Brother's G100 fetches a tool.
"""

import math

from robomill.toolpath.gcode import codes as modal
from robomill.toolpath.gcode.codes import P
from robomill.toolpath.gcode.fanuc.scaling import scales
from robomill.toolpath.gcode.machine import Machine
from robomill.toolpath.gcode.moves import drill
from robomill.toolpath.gcode.program import TRAVERSE
from robomill.toolpath.gcode.rules.cycle_rules import is_cycle, is_tap, pecks, takes_dwell
from robomill.toolpath.gcode.rules.motion_rules import RAPID
from robomill.toolpath.gcode.words import Block
from robomill.toolpath.plane import axes, polar

_THOUSANDTHS = 100.0
"""Nobody pecks so deep: controls count a Q without a point in steps of 0.001 mm (0.0001 in)."""
MOST_BOLTS = 10_000
_SHIFT, _CLAMP, _FETCH, _ROW = 920, 500, 1000, 720
_FINE_BORING, _BORING, _BACK_BORING = 760, 860, 870


def as_bored(machine: Machine, block: Block) -> None:
    """G76 bores with a stopped spindle, as G86 does, and moves aside by Q in the hole, where it cuts nothing."""
    words, motion = block.words, block.g.get(modal.MOTION)
    if motion == _BACK_BORING and "q" in words:
        raise block.refuse("G87 bores from below on a Fanuc control, which is not read; write the moves out.")
    whole = machine.is_fanuc or {"z", "r"} <= words.keys()  # on a Fanuc what a cycle before has said holds
    if motion == _FINE_BORING and whole and not {"i", "k"} <= words.keys():
        block.g[modal.MOTION] = _BORING
        for letter in "qij":
            words.pop(letter, None)
        machine.note("fine-boring", "info", "G76 is read as boring (G86); its step aside in the hole is left out")


def clamps(machine: Machine, block: Block) -> None:
    """G92 S and G50 S are the fastest that the spindle may turn, and neither its speed nor a place."""
    words, shifts = block.words, block.g.get(modal.NON_MODAL) == _SHIFT
    if "s" in words and (shifts or _CLAMP in block.unknown_g) and words.keys().isdisjoint("xyzabc"):
        del words["s"]
        if shifts:
            del block.g[modal.NON_MODAL]
        machine.note("harmless-g", "ignored", "S beside G92 or G50 is the fastest that the spindle may turn; left out")


def bolt_holes(machine: Machine, block: Block, code: int) -> bool:
    """G70 I radius J angle L holes, G71 with K, the angle between them; a negative I goes round clockwise. G72 I J L: a
    row of L holes from there on, I apart at an angle of J. False for other words, and without a cycle.

    On the line that begins the cycle they are drilled once that is in force, and none where the tool stands.
    """
    words, needs = block.words, {700: {"i", "j", "l"}, 710: {"i", "j", "k", "l"}, _ROW: {"i", "j", "l"}}.get(code)
    begins = is_cycle(block.g.get(modal.MOTION, -1))
    if needs is None or not needs <= words.keys() or not (begins or is_cycle(machine.motion)):
        return False
    count = round(words["l"])
    if machine.plane != 17 or not machine.is_absolute(block) or not 1 <= count <= MOST_BOLTS:
        raise block.refuse(f"G{code // 10} is read in G17 and G90, for 1 to {MOST_BOLTS} holes.")
    u, v = words.pop("x", machine.p[0]), words.pop("y", machine.p[1])
    size, angle, between = words.pop("i"), words.pop("j"), words.pop("k", 360.0 / count)
    del words["l"]
    if code == _ROW:
        block.bolts = [polar(k * size, math.radians(angle), u, v) for k in range(count)]
    else:
        if size < 0.0 and between < 0.0:
            raise block.refuse(f"G{code // 10} has I and K below 0, which both turn its way round; give I above 0.")
        between = math.copysign(1.0, size) * between
        block.bolts = [polar(abs(size), math.radians(angle + k * between), u, v) for k in range(count)]
    if begins:
        words["l"] = 0.0
    else:
        drill_bolts(machine, block)
    return True


def drill_bolts(machine: Machine, block: Block) -> None:
    """Drill the holes that a line has placed around a circle."""
    for place in block.bolts:
        drill(machine, Block(block.line, dict(zip("xy", place)), motion=machine.motion))
    block.bolts = []


def repeats(machine: Machine, block: Block) -> None:
    """K is how often a cycle is made, as L, but for Haas's falling pecks; a dwell that is not given is none."""
    words, motion = block.words, block.motion
    if not is_cycle(motion) or motion == _BACK_BORING:
        return
    if is_tap(motion) and 1.0 <= words.get("j", 0.0) <= 9.0 and not {"i", "k"} & words.keys():
        text = f"J{words.pop('j'):g} of a tap brings it out so many times as fast (Haas), which is left out"
        machine.note("tap-out", "info", text)
    block.falls = pecks(motion) and {"i", "j", "k"} <= words.keys() and "q" not in words
    if "k" in words and "l" not in words and not block.falls:
        words["l"] = words.pop("k")
    if pecks(motion) and words.get("q", 0.0) >= _THOUSANDTHS and words["q"] == round(words["q"]):
        words["q"] /= 1000.0 if machine.unit == "mm" else 10_000.0
        machine.note("peck-thousandths", "info", "a depth per peck (Q) of 100 and more counts in the control's steps")
    kept = machine.motion == motion or (machine.is_fanuc and is_cycle(machine.motion))
    if takes_dwell(motion) and "p" not in words and (not kept or math.isnan(machine.cycle[P])):
        words["p"] = 0.0
    steps = not machine.is_absolute(block)
    given = {"r", "xyz"[axes(machine.plane)[2]]} & words.keys()
    if not steps or machine.is_fanuc or not machine.keeps_heights or machine.motion != motion or machine.kept_steps:
        return
    if len(given) == 1:  # who gives one of them anew counts on the other's being added, too
        machine.keeps_heights = False
    elif not given:
        text = "holes in G91 are as deep as was said in G90, as on Fanuc and Haas; LinuxCNC adds R and Z at each anew"
        machine.note("cycle-heights", "suspicious", text)


def fetches_tool(machine: Machine, block: Block, code: int) -> bool:
    """G100 with T (Brother) changes to that tool, up where the machine does, and brings it to the place of its line at
    rapid; L is the tool to be held ready. False for other words."""
    if code != _FETCH or "t" not in block.words:
        return False
    block.m[modal.TOOL] = 6
    block.g[modal.MOTION] = RAPID
    block.words.pop("l", None)
    machine.set_away((*machine.away[:2], True))
    machine.go(TRAVERSE, block.line, machine.p)
    return True


FANUC_WORDS = (fetches_tool, scales, bolt_holes)
"""What follows a G word of ``machine``, ``block`` and its code, and says whether it is its own."""
