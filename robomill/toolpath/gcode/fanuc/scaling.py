"""Scaled and mirrored coordinates of Fanuc and Haas: G51 P or I J K with G50, G51.1 with G50.1, G101 with G100.

Words are scaled as they are read, about a centre in the coordinate system in force: a place X is C + s (X - C), a step
or the centre and radius of an arc are s times what is written. What a cycle pecks (Q) stays as it is.
"""

import math

from robomill.toolpath.gcode import codes as modal
from robomill.toolpath.gcode.codes import g_name
from robomill.toolpath.gcode.machine import Machine, Scale
from robomill.toolpath.gcode.rules.cycle_rules import is_cycle
from robomill.toolpath.gcode.rules.motion_rules import CLOCKWISE, COUNTERCLOCKWISE, LINE, RAPID, is_arc
from robomill.toolpath.gcode.words import Block
from robomill.toolpath.plane import axes

_CODES = {510: "G51", 511: "G51.1", 500: "G50", 501: "G50.1", 1010: "G101", 1000: "G100"}
_THOUSAND = 1000.0


def scales(machine: Machine, block: Block, code: int) -> bool:
    """Follow G51, G51.1, G50 and G50.1, and Haas's G101 and G100; False for other words."""
    if code not in _CODES:
        return False
    if code == 500 and machine.scale is None:
        return False
    machine.need_compensation_off(block, _CODES[code])
    machine.initial_level = math.nan
    words = block.words
    if machine.before_turn is not None or machine.polar_words:
        raise block.refuse(f"{_CODES[code]} inside of G68 or G16 is not read; give it before them.")
    if code in (500, 501, 1000):
        if words.keys() & set("xyz") and code == 500:
            raise block.refuse("G50 with axis words sets a coordinate system, which is not read; remove the line.")
        for letter in "xyz":
            words.pop(letter, None)
        machine.scale = None
        return True
    given = {letter: words.pop(letter) for letter in "xyzijkp" if letter in words}
    if not _is_absolute(machine, block):
        raise block.refuse(f"{_CODES[code]} is read in G90 alone.")
    centre = tuple(given.get(letter, at) for letter, at in zip("xyz", machine.p))
    if code in (511, 1010):
        if not given.keys() & set("xyz"):
            raise block.refuse(f"{_CODES[code]} needs the axes that it mirrors, as in {_CODES[code]} X0.")
        if code == 1010:  # about part zero, whatever its words say
            machine.note("mirror", "info", "G101 is read as Haas's mirror image about part zero")
            centre = tuple(0.0 if letter in given else at for letter, at in zip("xyz", centre))
        before = machine.scale.factors if machine.scale is not None else (1.0, 1.0, 1.0)
        factors = tuple(-1.0 if letter in given else old for letter, old in zip("xyz", before))
    elif "p" in given:
        factors = (_factor(machine, block, given["p"]),) * 3
    elif given.keys() & set("ijk"):
        factors = tuple(_factor(machine, block, given[letter]) if letter in given else 1.0 for letter in "ijk")
    else:
        raise block.refuse("G51 needs P, or I, J and K: how many times larger everything is.")
    machine.scale = Scale(factors, centre)  # type: ignore[arg-type]
    return True


def _is_absolute(machine: Machine, block: Block) -> bool:
    """Whether the words of a line are places, not steps."""
    return bool(block.g.get(modal.DISTANCE, 900 if machine.absolute else 910) == 900)


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
    cycle = is_cycle(motion)
    if motion not in (-1, 800, RAPID, LINE, CLOCKWISE, COUNTERCLOCKWISE) and not cycle:
        raise block.refuse(f"{g_name(motion)} while coordinates are scaled (G51) is not read; end that first (G50).")
    if cycle and (scale.factors[2] < 0.0 or machine.plane != 17):
        raise block.refuse("a cycle is read in G17, and not mirrored along Z; end G51 first (G50).")
    absolute = _is_absolute(machine, block)
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
