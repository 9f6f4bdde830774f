"""Canned cycles G73, G74, G81 to G89: drilling, tapping and boring at one or many places."""

from __future__ import annotations

import math

from robomill.toolpath.gcode.machine import Machine
from robomill.toolpath.gcode.mode_rules import dwell
from robomill.toolpath.gcode.motion_rules import axes
from robomill.toolpath.gcode.moves import polar, polar_step
from robomill.toolpath.gcode.program import FEED, TRAVERSE
from robomill.toolpath.gcode.words import Block

PECK_CLEARANCE = {"in": 0.010, "mm": 0.254}
"""How far above the last bottom the rapid stops in G73 and G83, in program units."""

MAX_REPEATS = 100_000
MAX_PECKS = 100_000
_NEEDS_P = frozenset({820, 860, 880, 890})
_TAPS = frozenset({740, 840})
_NEEDS_Q = frozenset({730, 830})
_NEEDS_SPINDLE = frozenset({860, 870, 880})


class _Hole:
    """One place: moves in the plane (a, b) and along the third axis (c)."""

    def __init__(self, machine: Machine, line: int) -> None:
        self.machine = machine
        self.line = line
        self.axes = axes(machine.plane)

    def go(self, kind: int, a: float, b: float, c: float) -> None:
        end = list(self.machine.p)
        end[self.axes[0]], end[self.axes[1]], end[self.axes[2]] = a, b, c
        self.machine.go(kind, self.line, end)

    def tap(self, a: float, b: float, c: float) -> None:
        """Outside of G17 the reference taps along permuted axes; read as that machine would."""
        if self.machine.plane == 17:
            self.go(FEED, a, b, c)
            return
        end = list(self.machine.p)
        end[:3] = [c, a, b] if self.machine.plane == 18 else [b, c, a]
        self.machine.go(FEED, self.line, end)


def cycle(machine: Machine, block: Block) -> None:
    """A canned cycle: L times at the place of the line. Raises GCodeError for missing or senseless words."""
    words, kept = block.words, machine.cycle
    same = machine.motion == block.motion
    name = f"G{block.motion // 10}"
    _check(machine, block, name, same)
    first, second, third = axes(machine.plane)
    for letter, key in (("r", "r"), ("xyz"[third], "bottom"), ("p", "p"), ("q", "q")):
        if letter in words:
            kept[key] = words[letter]
    for letter in "ijk":
        if letter in words:
            kept[letter] = words[letter]
    current = machine.p[third]
    if math.isnan(machine.initial_level):
        machine.initial_level = current
    level = machine.initial_level
    clearance, bottom = kept["r"], kept["bottom"]
    if not machine.absolute:
        clearance += level
        bottom += clearance
    if clearance < bottom:
        axis = "XYZ"[third]
        raise block.refuse(f"{name}: R is below {axis}, the bottom of the hole; R must not be below it.")
    hole = _Hole(machine, block.line)
    a, b = machine.p[first], machine.p[second]
    if level < clearance:
        hole.go(TRAVERSE, a, b, clearance)
        level = current = clearance
    clear = clearance if machine.retract_r else level
    place = _place(machine, block, first, second)
    repeats = int(words.get("l", 1))
    for repeat in range(repeats):
        a, b = _next_place(machine, block, a, b, place)
        if repeat == 0 and current > clearance:
            hole.go(TRAVERSE, a, b, current)
            hole.go(TRAVERSE, a, b, clearance)
        else:
            hole.go(TRAVERSE, a, b, clear)
            if clear > clearance:
                hole.go(TRAVERSE, a, b, clearance)
        _one(machine, block, hole, a, b, clearance, clear, bottom)
    machine.p[first], machine.p[second], machine.p[third] = a, b, clear
    machine.motion = block.motion


def _check(machine: Machine, block: Block, name: str, same: bool) -> None:
    words, kept = block.words, machine.cycle
    if machine.feed == 0.0:
        raise block.refuse(f"{name} needs a feed rate; give an F word above 0 first.")
    if machine.feed_mode == 930:
        raise block.refuse(f"{name} cannot be used in inverse time mode (G93); use G94 first.")
    machine.need_compensation_off(block, name)
    axis = "XYZ"[axes(machine.plane)[2]]
    if "r" not in words and not (same and "r" in kept):
        raise block.refuse(f"{name} needs R, its clearance plane.")
    if axis.lower() not in words and not (same and "bottom" in kept):
        raise block.refuse(f"{name} needs {axis}, the bottom of the hole.")
    if not 1 <= words.get("l", 1.0) <= MAX_REPEATS:
        raise block.refuse(f"{name} has L{words['l']:g}; expected 1 to {MAX_REPEATS} repeats.")
    if block.motion in _NEEDS_P and "p" not in words and not (same and "p" in kept):
        raise block.refuse(f"{name} needs P, its dwell in seconds.")
    if block.motion in _NEEDS_Q:
        if "q" not in words and not (same and "q" in kept):
            raise block.refuse(f"{name} needs Q, its depth per peck.")
        if words.get("q", kept.get("q", 0.0)) <= 0:
            raise block.refuse(f"{name} has Q{words.get('q', 0.0):g}; the depth per peck must be above 0.")
    if block.motion == 870 and not same:
        for letter in "ijk":
            if letter not in words:
                raise block.refuse(f"G87 needs {letter.upper()}.")
    if block.motion in _NEEDS_SPINDLE and machine.spindle == 0:
        raise block.refuse(f"{name} needs a turning spindle; start it with M3 or M4.")
    if block.motion in (740, 840) and machine.spindle != (1 if block.motion == 840 else -1):
        raise block.refuse(f"{name} needs the spindle turning with {'M3' if block.motion == 840 else 'M4'}.")


def _place(machine: Machine, block: Block, first: int, second: int) -> tuple[float, float] | None:
    """Absolute place in the plane, or None if each repeat adds the words of the line."""
    if not machine.absolute:
        return None
    a, b = machine.p[first], machine.p[second]
    if "@" in block.words or "^" in block.words:
        return polar(block, a, b)
    return block.words.get("xyz"[first], a), block.words.get("xyz"[second], b)


def _next_place(
    machine: Machine, block: Block, a: float, b: float, place: tuple[float, float] | None
) -> tuple[float, float]:
    if place is not None:
        return place
    first, second, _ = axes(machine.plane)
    a += block.words.get("xyz"[first], 0.0)
    b += block.words.get("xyz"[second], 0.0)
    return polar_step(block, a, b) if "@" in block.words or "^" in block.words else (a, b)


def _one(
    machine: Machine, block: Block, hole: _Hole, a: float, b: float, clearance: float, clear: float, bottom: float
) -> None:
    motion, kept = block.motion, machine.cycle
    if motion in _NEEDS_Q:
        _peck(machine, block, hole, a, b, clearance, bottom)
    elif motion == 870:
        _back_bore(machine, hole, a, b, clearance, clear, bottom)
        return
    elif motion in _TAPS:
        _tap(machine, block, hole, a, b, clear, bottom)
        return
    else:
        hole.go(FEED, a, b, bottom)
    if motion in _NEEDS_P:
        dwell(machine, kept.get("p", 0.0))
    if motion == 850:
        hole.go(FEED, a, b, clearance)
    if motion == 890:
        hole.go(FEED, a, b, clear)
    elif motion == 880:
        machine.findings.add(
            "manual-retract", "warning", block.line, "G88 stops for a retract by hand, which the path leaves out"
        )
    else:
        hole.go(TRAVERSE, a, b, clear)


def _tap(machine: Machine, block: Block, hole: _Hole, a: float, b: float, clear: float, bottom: float) -> None:
    if machine.plane != 17:
        machine.findings.add(
            "tap-axes",
            "warning",
            block.line,
            f"G{block.motion // 10} outside of G17 taps along the wrong axes, as LinuxCNC does",
        )
    hole.tap(a, b, bottom)
    dwell(machine, machine.cycle.get("p", 0.0))
    hole.tap(a, b, clear)


def _peck(machine: Machine, block: Block, hole: _Hole, a: float, b: float, clearance: float, bottom: float) -> None:
    step = machine.cycle["q"]
    if (clearance - bottom) / step > MAX_PECKS:
        raise block.refuse(f"Q{step:g} would need more than {MAX_PECKS} pecks; give a larger Q.")
    depth = clearance - step
    while depth > bottom:
        hole.go(FEED, a, b, depth)
        if block.motion == 830:
            hole.go(TRAVERSE, a, b, clearance)
        hole.go(TRAVERSE, a, b, depth + PECK_CLEARANCE[machine.unit])
        depth -= step
    hole.go(FEED, a, b, bottom)


def _back_bore(
    machine: Machine, hole: _Hole, a: float, b: float, clearance: float, clear: float, bottom: float
) -> None:
    first, second, third = hole.axes
    aside_a = a + machine.cycle["ijk"[first]]
    aside_b = b + machine.cycle["ijk"[second]]
    middle = machine.cycle["ijk"[third]] + (0.0 if machine.absolute else bottom)
    for kind, to_a, to_b, to_c in (
        (TRAVERSE, aside_a, aside_b, clearance),
        (TRAVERSE, aside_a, aside_b, bottom),
        (TRAVERSE, a, b, bottom),
        (FEED, a, b, middle),
        (FEED, a, b, bottom),
        (TRAVERSE, aside_a, aside_b, bottom),
        (TRAVERSE, aside_a, aside_b, clear),
        (TRAVERSE, a, b, clear),
    ):
        hole.go(kind, to_a, to_b, to_c)
