"""Pecks of Heidenhain's drilling cycles 200, 203 and 205, and the holes of cycles 1 and 2 of its older controls.

Cycles 1 and 2 begin where the tool stands, at their SET UP above the surface, and end there. Pecking comes back at
rapid to an advanced stop before the depth that it had: 0.6 mm in a hole of up to 30 mm, else a fiftieth, at most 7 mm.
(HEIDENHAIN, TNC 426, User's Manual: Pecking, cycle 1; Tapping, cycle 2.)
"""

import math
from collections.abc import Callable
from itertools import pairwise

import numpy as np

from robomill.errors import GCodeError
from robomill.toolpath.gcode.sinumerik.holes import MAX_PECKS, Hole, Peck

OLD = {
    1: {"1": "SET UP", "2": "DEPTH", "3": "PECKG", "4": "DWELL", "5": "F"},
    2: {"1": "SET UP", "2": "DEPTH", "3": "DWELL", "4": "F"},
}
"""Parts of the older cycles, by their number behind the point."""


def pecks_of(
    number: int, q: Callable[[int], float], heights: tuple[float, float, float], line: int
) -> tuple[Peck, ...]:
    """Cycles 200, 203 and 205: out of the hole from each depth, and back at rapid to the set-up clearance above it,
    in 205 to Q258 above the first depth and Q259 above the last. 203 breaks the chip Q213 times in between, 205 at
    every Q257: up by Q256. ``q`` tells a parameter."""
    surface, bottom, clear = heights
    step, less = abs(q(202)), abs(q(212)) if number in (203, 205) else 0.0
    depths: list[float] = []
    at = surface - step
    while step > 0.0 and at > bottom + 1e-9:
        depths.append(at)
        step = max(step - less, abs(q(205)) or less) if less else step
        at -= step
        if len(depths) > MAX_PECKS:
            raise GCodeError.at(line, f"CYCL DEF {number} needs more than {MAX_PECKS} pecks; give a larger Q202.")
    back, breaks = abs(q(256)), q(213) if number == 203 else 0.0
    near = [abs(q(200))] * len(depths)
    if number == 205:
        near = np.linspace(abs(q(258)), abs(q(259)), len(depths)).tolist()
    outs = [breaks < 1.0 or n % (int(breaks) + 1) == int(breaks) for n in range(len(depths))]
    found = [
        Peck(each, min(each + (above if out else back), clear), out) for each, above, out in zip(depths, near, outs)
    ]
    often = abs(q(257)) if number == 205 else 0.0
    if often > 0.0:
        found += _breaks([surface, *depths, bottom], often, back, line)
        found.sort(key=lambda peck: -peck.depth)
    return tuple(found)


def _breaks(ends: list[float], often: float, back: float, line: int) -> list[Peck]:
    """Where cycle 205 breaks the chip: at every Q257 (``often``) of each infeed, between its ``ends``."""
    found: list[Peck] = []
    for start, end in pairwise(ends):
        count = math.ceil((start - end) / often - 1e-9) - 1
        if len(found) + count > MAX_PECKS:
            raise GCodeError.at(line, f"CYCL DEF 205 needs more than {MAX_PECKS} breaks; give a larger Q257.")
        depths = [start - k * often for k in range(1, count + 1)]
        found += [Peck(depth, depth + back, False) for depth in depths]
    return found


def old_hole(number: int, said: dict[str, float], top: float, mm: float, line: int) -> Hole:
    """CYCL DEF 1 and 2 from the height ``top``; ``mm`` is a millimetre in program units."""
    missing = [name for name in OLD[number].values() if name not in said and name != "DWELL"]
    if missing:
        raise GCodeError.at(line, f"CYCL DEF {number} has no {missing[0]}; give it.")
    if said["DEPTH"] >= 0.0 or said["F"] <= 0.0:
        raise GCodeError.at(line, f"CYCL DEF {number} needs its DEPTH below 0 and its F above; mend them.")
    depth, surface = abs(said["DEPTH"]), top - abs(said["SET UP"])
    dwell, feed, bottom = max(said.get("DWELL", 0.0), 0.0), said["F"], surface - depth
    if number == 2:
        return Hole(top, top, bottom, dwell, feed, feed, (), 0.0, taps=True)
    step, stop = abs(said["PECKG"]), min(max(depth / 50.0, 0.6 * mm), 7.0 * mm)
    count = math.ceil(depth / step - 1e-9) - 1 if step > 0.0 else 0
    if count > MAX_PECKS:
        raise GCodeError.at(line, f"CYCL DEF 1 needs more than {MAX_PECKS} pecks; give a larger PECKG.")
    depths = [surface - k * step for k in range(1, count + 1)]
    return Hole(top, top, bottom, dwell, feed, 0.0, tuple(Peck(d, min(d + stop, top), True) for d in depths), 0.0)
