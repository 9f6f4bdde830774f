"""Canned cycles as Fanuc and Haas count them: K or L times, no time at all, without a dwell, and fine boring (G76)."""

import math

from robomill.toolpath.gcode import codes as modal
from robomill.toolpath.gcode.codes import I, J, K, P, Q, R, Z
from robomill.toolpath.gcode.cycle_rules import is_cycle, takes_dwell
from robomill.toolpath.gcode.machine import Machine
from robomill.toolpath.gcode.moves import plain_words
from robomill.toolpath.gcode.words import Block

_FINE_BORING, _BORING, _BACK_BORING = 760, 860, 870


def as_bored(machine: Machine, block: Block) -> None:
    """G76 bores with a stopped spindle, as G86 does, and moves aside by Q in the hole, where it cuts nothing."""
    words, motion = block.words, block.g.get(modal.MOTION)
    if motion == _BACK_BORING and "q" in words:
        raise block.refuse("G87 bores from below on a Fanuc control, which is not read; write the moves out.")
    if motion == _FINE_BORING and {"z", "r"} <= words.keys():
        block.g[modal.MOTION] = _BORING
        words.pop("q", None)
        machine.note("fine-boring", "info", "G76 is read as boring (G86); its step aside in the hole is left out")


def repeats(machine: Machine, block: Block) -> bool:
    """K is how often a cycle is made, as L; True where that is not at all: the cycle is kept, and nothing moves."""
    words, motion = block.words, block.motion
    if not is_cycle(motion) or motion == _BACK_BORING:
        return False
    if "k" in words and "l" not in words:
        words["l"] = words.pop("k")
    if takes_dwell(motion) and "p" not in words and (machine.motion != motion or math.isnan(machine.cycle[P])):
        words["p"] = 0.0
    if words.get("l") != 0.0:
        return False
    kept = plain_words(block)
    for column in (R, P, Q, I, J, K, Z):
        if not math.isnan(kept[column]):
            machine.cycle[column] = kept[column]
    machine.motion = motion
    if math.isnan(machine.initial_level):
        machine.initial_level = machine.p[2]
    return True
