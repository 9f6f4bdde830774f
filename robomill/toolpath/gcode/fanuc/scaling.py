"""Scaled and mirrored coordinates of Fanuc and Haas: G51 P or I J K with G50, G51.1 with G50.1, G101 with G100.

Words are scaled as they are read, about a centre in the coordinate system in force: a place X is C + s (X - C), a step
or the centre and radius of an arc are s times what is written. What a cycle pecks (Q) stays as it is.
"""

import math
from dataclasses import replace

from robomill.toolpath.gcode import codes as modal
from robomill.toolpath.gcode.codes import g_name
from robomill.toolpath.gcode.machine import Machine, Scale
from robomill.toolpath.gcode.rules.cycle_rules import is_cycle
from robomill.toolpath.gcode.rules.motion_rules import CLOCKWISE, COUNTERCLOCKWISE, LINE, RAPID, is_arc
from robomill.toolpath.gcode.words import Block
from robomill.toolpath.plane import axes

_CODES = {510: "G51", 511: "G51.1", 500: "G50", 501: "G50.1", 1010: "G101", 1000: "G100"}
_UNSCALED, _HAAS = 500, 1010
_MIRRORS, _STRAIGHT = (511, _HAAS), (501, 1000)
_THOUSAND = 1000.0


def scales(machine: Machine, block: Block, code: int) -> bool:
    """Follow G51, G51.1, G50 and G50.1, and Haas's G101 and G100; False for other words."""
    if code not in _CODES:
        return False
    if code == _UNSCALED and (machine.scale is None or machine.scale.mirrors):
        return False
    machine.need_compensation_off(block, _CODES[code])
    machine.initial_level = math.nan
    words = block.words
    if machine.before_turn is not None or machine.polar_words:
        raise block.refuse(f"{_CODES[code]} inside of G68 or G16 is not read; end that first (G69, G15).")
    if code == _UNSCALED:
        if words.keys() & set("xyz"):
            raise block.refuse("G50 with axis words sets a coordinate system, which is not read; remove the line.")
        machine.scale = None
        return True
    given = {letter: words.pop(letter) for letter in "xyzijkp" if letter in words}
    if code in _STRAIGHT:
        _end_mirror(machine, given)
        return True
    if not machine.is_absolute(block):
        raise block.refuse(f"{_CODES[code]} is read in G90 alone.")
    if machine.scale is not None and machine.scale.mirrors != (code in _MIRRORS):  # the one would replace the other
        mirrors = machine.scale.mirrors
        inner, end = ("mirrored (G51.1)", "G50.1") if mirrors else ("scaled (G51)", "G50")
        raise block.refuse(f"{_CODES[code]} while coordinates are {inner} is not read; end that first ({end}).")
    if code in _MIRRORS:
        _mirror(machine, block, code, given)
    else:
        _enlarge(machine, block, given)
    return True


def _mirror(machine: Machine, block: Block, code: int, given: dict[str, float]) -> None:
    """G51.1 and G101 mirror the axes that they name; those that others have named stay mirrored where they are."""
    if not given.keys() & set("xyz"):
        raise block.refuse(f"{_CODES[code]} needs the axes that it mirrors, as in {_CODES[code]} X0.")
    if code == _HAAS:
        machine.note("mirror", "info", "G101 is read as Haas's mirror image about part zero")
        given = dict.fromkeys(given, 0.0)  # whatever its words say
    before = machine.scale or Scale()
    centre = tuple(given.get(letter, at) for letter, at in zip("xyz", before.centre))
    factors = tuple(-1.0 if letter in given else old for letter, old in zip("xyz", before.factors))
    machine.scale = Scale(factors, centre, mirrors=True)  # type: ignore[arg-type]


def _end_mirror(machine: Machine, given: dict[str, float]) -> None:
    """G50.1 and G100 end the mirror images of the axes that they name, of all where they name none."""
    before = machine.scale
    if before is None or not before.mirrors:
        return
    left = tuple(1.0 if letter in given or not given else old for letter, old in zip("xyz", before.factors))
    machine.scale = replace(before, factors=left) if -1.0 in left else None  # type: ignore[arg-type]


def _enlarge(machine: Machine, block: Block, given: dict[str, float]) -> None:
    """G51 P, or I, J and K, about X, Y and Z, or where the tool is."""
    factors: tuple[float, ...]
    if "p" in given:
        factors = (_factor(machine, block, given["p"]),) * 3
    elif given.keys() & set("ijk"):
        factors = tuple(_factor(machine, block, given[letter]) if letter in given else 1.0 for letter in "ijk")
    else:
        raise block.refuse("G51 needs P, or I, J and K: how many times larger everything is.")
    centre = tuple(given.get(letter, at) for letter, at in zip("xyz", machine.p))
    machine.scale = Scale(factors, centre)  # type: ignore[arg-type]


def _factor(machine: Machine, block: Block, value: float) -> float:
    """A factor; a large whole number counts in thousandths, as on Fanuc controls."""
    factor = value
    if value == round(value) and abs(value) >= _THOUSAND / 10.0:
        factor = value / _THOUSAND
        machine.note("scale-thousandths", "warning", f"G51: {value:g} is read as thousandths, a scale of {factor:g}")
    if not 1e-6 <= abs(factor) <= 1e3:
        raise block.refuse(f"G51 has a scale of {factor:g}; expected 0.000001 to 1000.")
    return factor


def scale_words(machine: Machine, block: Block) -> None:
    """The words of a line as they are once scaled."""
    scale, words, motion = machine.scale, block.words, block.motion
    if scale is None:
        return
    non_modal = block.g.get(modal.NON_MODAL, -1)
    if non_modal in (280, 300, 530):
        return
    if non_modal not in (-1, 40):
        raise block.refuse(f"{g_name(non_modal)} while coordinates are scaled (G51) is not read; end that first (G50).")
    if not words.keys().isdisjoint("@^"):
        raise block.refuse("G16 while coordinates are scaled or mirrored is not read; end that first (G50, G50.1).")
    cycle = is_cycle(motion)
    if motion not in (-1, 800, RAPID, LINE, CLOCKWISE, COUNTERCLOCKWISE) and not cycle:
        raise block.refuse(f"{g_name(motion)} while coordinates are scaled (G51) is not read; end that first (G50).")
    if cycle and (scale.factors[2] < 0.0 or machine.plane != 17):
        raise block.refuse("a cycle is read in G17, and not mirrored along Z; end G51 first (G50).")
    absolute = machine.is_absolute(block)
    for axis, letter in enumerate("xyz"):
        if letter in words:
            words[letter] = scale.place(axis, words[letter]) if absolute else scale.factors[axis] * words[letter]
    if cycle and "r" in words:
        words["r"] = scale.place(2, words["r"]) if absolute else scale.factors[2] * words["r"]
    if is_arc(motion):
        _scale_arc(machine, block, scale)


def _scale_arc(machine: Machine, block: Block, scale: Scale) -> None:
    words, g = block.words, block.g
    plane = {170: 17, 180: 18, 190: 19}.get(g.get(modal.PLANE, -1), machine.plane)
    first, second, _ = axes(plane)
    a, b = scale.factors[first], scale.factors[second]
    if abs(abs(a) - abs(b)) > 1e-9 * abs(a):
        raise block.refuse("an arc scaled unlike along its two axes is none; let the CAM system write it as lines.")
    for axis, letter in enumerate("ijk"):
        if letter in words:
            absolute = g.get(modal.ARC_DISTANCE, 901 if machine.arc_absolute else 911) == 901
            words[letter] = scale.place(axis, words[letter]) if absolute else scale.factors[axis] * words[letter]
    if "r" in words:
        words["r"] *= abs(a)
    if a * b < 0.0:
        block.motion = CLOCKWISE + COUNTERCLOCKWISE - block.motion
