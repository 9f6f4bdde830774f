"""Canned cycles as Fanuc and Haas count them: K or L times, no time at all, without a dwell, and fine boring (G76)."""

import math

from robomill.toolpath.gcode import codes as modal
from robomill.toolpath.gcode.codes import P
from robomill.toolpath.gcode.cycle_rules import is_cycle, pecks, takes_dwell
from robomill.toolpath.gcode.machine import Machine
from robomill.toolpath.gcode.motion_rules import axes
from robomill.toolpath.gcode.words import Block

_THOUSANDTHS = 100.0
"""Nobody pecks so deep: controls count a Q without a point in steps of 0.001 mm (0.0001 in)."""
_FINE_BORING, _BORING, _BACK_BORING = 760, 860, 870


def as_bored(machine: Machine, block: Block) -> None:
    """G76 bores with a stopped spindle, as G86 does, and moves aside by Q in the hole, where it cuts nothing."""
    words, motion = block.words, block.g.get(modal.MOTION)
    if motion == _BACK_BORING and "q" in words:
        raise block.refuse("G87 bores from below on a Fanuc control, which is not read; write the moves out.")
    if motion == _FINE_BORING and {"z", "r"} <= words.keys() and not {"i", "k"} <= words.keys():
        block.g[modal.MOTION] = _BORING
        words.pop("q", None)
        machine.note("fine-boring", "info", "G76 is read as boring (G86); its step aside in the hole is left out")


def repeats(machine: Machine, block: Block) -> None:
    """K is how often a cycle is made, as L, and a dwell that is not given is none."""
    words, motion = block.words, block.motion
    if not is_cycle(motion) or motion == _BACK_BORING:
        return
    if "k" in words and "l" not in words:
        words["l"] = words.pop("k")
    if pecks(motion) and words.get("q", 0.0) >= _THOUSANDTHS and words["q"] == round(words["q"]):
        words["q"] /= 1000.0 if machine.unit == "mm" else 10_000.0
        machine.note("peck-thousandths", "info", "a depth per peck (Q) of 100 and more counts in the control's steps")
    if takes_dwell(motion) and "p" not in words and (machine.motion != motion or math.isnan(machine.cycle[P])):
        words["p"] = 0.0
    steps = block.g.get(modal.DISTANCE, 900 if machine.absolute else 910) == 910
    given = {"r", "xyz"[axes(machine.plane)[2]]} & words.keys()
    if not steps or machine.is_fanuc or not machine.keeps_heights or machine.motion != motion or machine.kept_steps:
        return
    if len(given) == 1:  # who gives one of them anew counts on the other's being added, too
        machine.keeps_heights = False
    elif not given:
        text = "holes in G91 are as deep as was said in G90, as on Fanuc and Haas; LinuxCNC adds R and Z at each anew"
        machine.note("cycle-heights", "suspicious", text)
