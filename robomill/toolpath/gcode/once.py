"""Motions of their line alone, behind which the one before is in force again: G63 of Sinumerik, G31 of Fanuc.

G63 taps in a chuck that gives: down with the feed that is S times the pitch, up again by a G63 with the spindle turning
the other way. G31 goes until a probe, or another signal, stops it. (840D sl, Programming Manual, Fundamentals: tapping
with a compensating chuck; Fanuc 16/18, Operator's Manual: skip function.)
"""

from robomill.toolpath.gcode import codes as modal
from robomill.toolpath.gcode.codes import g_name
from robomill.toolpath.gcode.machine import Machine
from robomill.toolpath.gcode.rules.motion_rules import LINE
from robomill.toolpath.gcode.words import Block

_TAPS, _SKIPS, _PROBE = 630, 310, 382


def holds_once(machine: Machine, block: Block, code: int, control: str, macros: bool) -> bool:
    """Let the line tap or probe; False for other words. G31 is read where ``macros`` are, without P and Q, by which it
    waits for other signals than a probe's."""
    taps = code == _TAPS and control == "sinumerik"
    if not (taps or (code == _SKIPS and macros and not block.words.keys() & set("pq"))):
        return False
    if modal.MOTION in block.g:
        raise block.refuse(f"{g_name(code)} and {g_name(block.g[modal.MOTION])} are on one line; give one of them.")
    if taps:
        machine.need_compensation_off(block, "G63")
    block.once, block.g[modal.MOTION] = max(machine.motion, 0), LINE if taps else _PROBE
    return True
