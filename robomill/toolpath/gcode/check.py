"""Checks on a line before it is executed: which motion it makes, and that every word has a use."""

import math

from robomill.toolpath.gcode import codes as modal
from robomill.toolpath.gcode.codes import g_name
from robomill.toolpath.gcode.dialects import Dialect
from robomill.toolpath.gcode.machine import Machine
from robomill.toolpath.gcode.rules.cycle_rules import is_cycle
from robomill.toolpath.gcode.rules.motion_rules import implied_motion, is_arc, keep_motion
from robomill.toolpath.gcode.tool_axis import UNIT, angles_of
from robomill.toolpath.gcode.words import Block

_AXES = "xyzabcuvw"
_SPECIAL = frozenset("dehijklpqr")
"""Words that only some codes use, as ``_uses`` says."""
MOST_TURNS = 10_000
"""Turns of one arc."""
_LINUXCNC = Dialect("linuxcnc", guessed=False)
_COMPENSATION_ON = frozenset({410, 411, 420, 421})


def choose_motion(machine: Machine, block: Block, dialect: Dialect = _LINUXCNC) -> None:
    """Set ``block.motion``. Raises GCodeError if axis words have no use or two."""
    words = block.words
    if machine.polar_words:
        _read_polar(machine, block)
    if block.g.get(modal.MOTION) in (740, 840) and machine.spindle == 0 and dialect.has_macros:
        block.m.setdefault(modal.SPINDLE, 3 if block.g[modal.MOTION] == 840 else 4)
        machine.note(
            "tap-turns", "info", f"{g_name(block.g[modal.MOTION])} turns the spindle by itself (rigid tapping)"
        )
    polar = "@" in words or "^" in words
    axes = any(letter in words for letter in _AXES)
    if polar:
        if machine.plane != 17:
            raise block.refuse("polar coordinates work in the plane G17 only.")
        for letter in "xy":
            if letter in words:
                raise block.refuse(f"polar coordinates and {letter.upper()} are on one line; give one of them.")
    if block.g.get(modal.NON_MODAL) == 530 and not (axes or polar or dialect.strict):
        del block.g[modal.NON_MODAL]
        machine.note("harmless-g", "ignored", "G53 without axis words is left out: it moves nothing")
    non_modal, motion = block.g.get(modal.NON_MODAL, -1), block.g.get(modal.MOTION, -1)
    covets = non_modal in modal.NEEDS_AXES
    if covets and (polar or (not axes and non_modal in (520, 920))):
        raise block.refuse(f"{g_name(non_modal)} needs axis words such as X0.")
    if non_modal in (520, 920) and machine.before_turn is not None and not words.keys().isdisjoint("xy"):
        raise block.refuse(f"{g_name(non_modal)} while coordinates are turned (G68) is not read; end that first (G69).")
    if motion == 800:
        if (axes or polar) and not covets:
            motion = _ends_and_moves(machine, block, dialect)
    elif motion >= 0:
        if non_modal in (280, 300) and motion in (0, 10) and not dialect.strict:
            keep_motion(machine, motion)
            motion = -1
        elif covets:
            raise block.refuse(
                f"{g_name(non_modal)} and {g_name(motion)} both want the axis words; put them on two lines."
            )
        weighs_start = motion == 52 and "p" in words  # the first line of a NURBS may say the weight of its start alone
        if not axes and not polar and motion not in (-1, 0, 10, 20, 30) and not weighs_start:
            raise block.refuse(f"{g_name(motion)} needs axis words such as X0.")
    if motion >= 0:
        block.motion = motion
    elif not covets and block.g.get(modal.LENGTH) != 431:
        if (axes or polar) and machine.motion in (-1, 800):
            if machine.motion == -1 or not dialect.keeps_motion(machine):
                raise block.refuse("axis words without a motion; give G0, G1, G2 or G3 first.")
            machine.motion = machine.straight = dialect.first_motion(machine, "f" in words)
            text = f"axis words without a motion are read as {g_name(machine.straight)}, {dialect.kept(machine)}"
            machine.note("motion-kept", "info", text)
        block.motion = implied_motion(machine, axes or polar, any(letter in words for letter in "ijk"))
    if not dialect.strict:
        _read_tool_axis(machine, block)
    if non_modal == 530 and not machine.is_absolute(block):
        if not dialect.has_macros or machine.system in machine.placed:
            raise block.refuse("G53 needs absolute coordinates; use G90 first.")
        text = "G53 in G91 is read as a place in the machine; Fanuc controls leave the line out: write G90 before it"
        machine.note("g53-incremental", "warning", text)
    for letter in "uvw":
        if letter in words:
            raise block.refuse(f"this machine has no {letter.upper()} axis; write X, Y, Z, A, B or C.")


def _ends_and_moves(machine: Machine, block: Block, dialect: Dialect) -> int:
    """G80 beside places: where a dialect keeps the motion before the cycle, that is what is left of the line (-1)."""
    if not dialect.has_macros:
        raise block.refuse("G80 ends a cycle and takes no axis words; move with G0 or G1.")
    del block.g[modal.MOTION]
    machine.motion = 800
    return -1


def _read_polar(machine: Machine, block: Block) -> None:
    """With G16 X is the distance from part zero and Y the angle, which G91 adds to the angle of where the tool is."""
    words = block.words
    if block.g.get(modal.NON_MODAL) is not None or not words.keys() & {"x", "y", "z"}:
        return
    if block.g.get(modal.PLANE, 10 * machine.plane) != 170:
        raise block.refuse("G16 is read in G17 alone; write the moves out.")
    if not words.keys() & {"x", "y"}:
        return
    if "x" in words and not machine.is_absolute(block):
        raise block.refuse("G16 counts X from where the tool is in G91, which is not read; give the radius in G90.")
    for letter, polar in (("x", "@"), ("y", "^")):
        if letter in words:
            words[polar] = words.pop(letter)


def _read_tool_axis(machine: Machine, block: Block) -> None:
    """I J K of length 1 on a straight move are the direction of the tool, as robot and five-axis posts write it."""
    words = block.words
    if block.motion not in (0, 10) or not {"i", "j", "k"} <= words.keys() or "a" in words or "b" in words:
        return
    axis = words["i"], words["j"], words["k"]
    if abs(math.hypot(*axis) - 1.0) > UNIT:
        return
    before = machine.p[3], machine.p[4]
    angles = angles_of(axis, before)
    for letter in "ijk":
        del words[letter]
    absolute = machine.is_absolute(block)
    words["a"], words["b"] = (now - (0.0 if absolute else old) for now, old in zip(angles, before))
    machine.note("tool-axis", "info", "I J K of a straight move are read as the direction of the tool")


def check_words(block: Block) -> list[tuple[str, str]]:
    """Words without a use, as (letter, who would use it). Raises GCodeError for senseless combinations."""
    words, motion = block.words, block.motion
    non_modal = block.g.get(modal.NON_MODAL, -1)
    if non_modal == 40:
        if "p" not in words:
            raise block.refuse("G4 needs P, its dwell in seconds.")
        if words["p"] < 0.0:
            raise block.refuse(f"G4 has P{words['p']:g}; a dwell cannot be negative.")
        if is_arc(motion):
            raise block.refuse("G4 and an arc on one line both use P; put them on two lines.")
    if non_modal == 530 and motion not in (0, 10):
        raise block.refuse("G53 needs G0 or G1.")
    if is_cycle(motion):
        for letter in "abc":
            if letter in words:
                raise block.refuse(f"{g_name(motion)} takes no {letter.upper()}; turn the axis on a line before.")
    if is_arc(motion) and "p" in words and (abs(words["p"] - round(words["p"])) > 1e-3 or round(words["p"]) < 1):
        raise block.refuse(f"{g_name(motion)} has P{words['p']:g}; expected a whole number of turns, 1 or more.")
    if is_arc(motion) and words.get("p", 1.0) > MOST_TURNS:
        raise block.refuse(f"{g_name(motion)} has P{words['p']:g}; at most {MOST_TURNS} turns are made.")
    if motion in (330, 331):
        if "k" not in words:
            raise block.refuse(f"{g_name(motion)} needs K, the distance per turn.")
        if "f" in words:
            raise block.refuse(f"{g_name(motion)} takes no F; K says the distance per turn.")
    if block.g.get(modal.SPINDLE_MODE) == 960 and "s" not in words:
        raise block.refuse("G96 needs S, the surface speed.")
    if words.keys().isdisjoint(_SPECIAL):
        return []
    return [(letter, use) for letter, used, use in _uses(block) if letter in words and not used]


def _uses(block: Block) -> list[tuple[str, bool, str]]:
    motion, g, m = block.motion, block.g, block.m
    non_modal, compensation = g.get(modal.NON_MODAL, -1), g.get(modal.COMPENSATION, -1)
    data = non_modal == 100
    arc, spline, thread = is_arc(motion), motion in (50, 51), motion == 760
    cycle = is_cycle(motion)
    sized = motion == 870 or block.falls
    io, user, orient = m.get(modal.IO, -1), modal.USER in m, m.get(modal.SPINDLE) == 19
    return [
        ("d", compensation in _COMPENSATION_ON or g.get(modal.SPINDLE_MODE) == 960, "G41, G42 or G96"),
        ("e", thread or io in (66, 67, 68), "G76, M66, M67 or M68"),
        ("h", g.get(modal.LENGTH) in (430, 432) or thread, "G43"),
        ("i", arc or spline or thread or sized or data, "G2, G3 or G87"),
        ("j", arc or spline or thread or sized or data, "G2, G3 or G87"),
        ("k", arc or motion in (330, 331, 760) or sized, "G2, G3, G33 or G87"),
        ("l", cycle or thread or data or motion == 52 or compensation in _COMPENSATION_ON or io == 66, "G10, a cycle"),
        (
            "p",
            data
            or non_modal == 40
            or g.get(modal.CONTROL) == 640
            or arc
            or thread
            or motion in (50, 52)
            or motion in (740, 820, 840, 860, 880, 890)
            or modal.OVERRIDE in m
            or io in range(62, 67)
            or orient
            or user,
            "G2, G3, G4, G10, G64 or a cycle with a dwell",
        ),
        (
            "q",
            motion in (730, 830, 50, 760)
            or data
            or m.get(modal.TOOL) == 61
            or g.get(modal.CONTROL) == 640
            or io in (66, 67, 68)
            or orient
            or user,
            "G10, G64, G73, G83 or M61",
        ),
        ("r", arc or thread or cycle or data or compensation in (411, 421) or orient, "G2, G3, G10 or a cycle"),
    ]
