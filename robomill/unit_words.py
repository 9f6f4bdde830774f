"""Units as people write them behind a number: ``mm``, ``"``, ``rad/(N m)``, ``µm/N``, ``min⁻¹``, ``N·mm``, ``MPa``.

A unit is a product of the simple ones of ``units.UNITS``, whose factors are used; what is not made of them has no
meaning here. Two units measure the same where their dimensions agree; a turn and a plain number have none.
"""

import math
import re
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cache

from robomill.units import UNITS, unit_label
from robomill.wording import DASHES, MICRO, RAISED

# What each simple unit measures, as (dimension, power).
SIMPLE: dict[str, tuple[str, int]] = {
    **dict.fromkeys(("m", "cm", "mm", "um", "in", "thou", "ft", "uin"), ("length", 1)),
    **dict.fromkeys(("rad", "deg", "mrad", "urad"), ("angle", 1)),
    **dict.fromkeys(("s", "min"), ("time", 1)),
    **dict.fromkeys(("N", "kN"), ("force", 1)),
    "Hz": ("time", -1),
    "kg": ("mass", 1),
    "tooth": ("tooth", 1),
    **dict.fromkeys(("%", "rev", "U"), ("", 0)),
}
# Other ways to write them.
SPELLED = {
    "rpm": "1/min",
    "ipm": "in/min",
    '"': "in",
    "inch": "in",
    "inches": "in",
    "mil": "thou",
    "mils": "thou",
    "foot": "ft",
    "feet": "ft",
    "micron": "um",
    "microns": "um",
    "°": "deg",
    "degree": "deg",
    "degrees": "deg",
    "sec": "s",
    "Nm": "N m",
    "kNm": "kN m",
    "Nmm": "N mm",
    "Pa": "N/m2",
    "MPa": "N/mm2",
    "GPa": "kN/mm2",
}
_PART = re.compile(
    r"(?P<mark>[/()])|(?P<number>1(?:e[+-]?\d+)?)(?![\d.,])|(?P<name>[^\W\d_]+|[%°\"])(?:\^?(?P<power>[+-]?\d))?"
)
_SUPERSCRIPT = re.compile(f"[{''.join(RAISED)}]+")
_ON_THE_LINE = str.maketrans(RAISED)
_SAME = str.maketrans(MICRO | {"″": '"', "”": '"'} | dict.fromkeys(DASHES, "-") | dict.fromkeys("·⋅*×.", " "))


@dataclass(frozen=True)
class Meaning:
    """``value_in_SI = value * factor``, of what has these ``(dimension, power)``."""

    factor: float
    dimensions: frozenset[tuple[str, int]]

    def same(self, other: "Meaning") -> bool:
        """Whether both are one unit, however it is written."""
        return self.dimensions == other.dimensions and math.isclose(self.factor, other.factor, rel_tol=1e-12)


def raised(text: str) -> str:
    """A text with its superscripts on the line: ``mm²`` is ``mm^2``, ``10⁻⁷`` is ``10^-7``."""
    return _SUPERSCRIPT.sub(lambda found: "^" + found[0].translate(_ON_THE_LINE), text)


@cache
def meaning(text: str) -> Meaning | None:
    """What a unit means, as people write it or as a key of ``UNITS``; None where it is none that is known."""
    parts = list(_parts(raised(text).translate(_SAME).replace("''", '"').strip()))
    if None in parts or not parts:
        return None
    factor, powers, depth, over = 1.0, dict[str, int](), [1], 1
    for part in parts:
        assert part is not None
        if part["mark"] == "(":
            depth, over = [*depth, depth[-1] * over], 1
        elif part["mark"] == ")":
            if len(depth) == 1 or over == -1:
                return None
            depth, over = depth[:-1], 1
        elif part["mark"] == "/":
            if over == -1:
                return None
            over = -1
        else:
            one = Meaning(float(part["number"]), frozenset()) if part["number"] else _simple(part["name"])
            if one is None:
                return None
            power = depth[-1] * over * int(part["power"] or 1)
            factor *= one.factor**power
            for name, each in one.dimensions:
                powers[name] = powers.get(name, 0) + each * power
            over = 1
    if len(depth) > 1 or over == -1:
        return None
    return Meaning(factor, frozenset((name, power) for name, power in powers.items() if power))


def measure(unit: str) -> Meaning:
    """What a key of ``UNITS`` means."""
    found = meaning(unit)
    assert found is not None, unit
    return found


def alike(unit: str) -> list[str]:
    """How the other units that measure the same as ``unit``, a key of ``UNITS``, are written."""
    others = [other for other in UNITS if other != unit and measure(other).dimensions == measure(unit).dimensions]
    return [unit_label(other) for other in others if unit_label(other)]


def _simple(name: str) -> Meaning | None:
    """A word without a power, by its exact letters or else in capitals that mean no other (MM, KN, Deg)."""
    known = name if name in SIMPLE or name in SPELLED else _folded().get(name.lower(), "")
    if known in SPELLED:
        return meaning(SPELLED[known])
    if known not in SIMPLE:
        return None
    dimension, power = SIMPLE[known]
    factor = UNITS[known].factor if known in UNITS else 1.0  # teeth and turns are counted
    return Meaning(factor, frozenset([(dimension, power)] if dimension else []))


@cache
def _folded() -> dict[str, str]:
    """Simple units, and other words that are none of them in small letters, by their small letters."""
    words = {name.lower(): name for name in SPELLED if len(name) > 2 and name not in ("kNm", "Nmm", "MPa", "GPa")}
    return words | {name.lower(): name for name in SIMPLE}


def _parts(text: str) -> Iterator[re.Match[str] | None]:
    """The parts of a unit; None where one is not understood."""
    at = 0
    while at < len(text):
        found = None if text[at] == " " else _PART.match(text, at)
        if found is None and text[at] != " ":
            yield None
            return
        if found is not None:
            yield found
        at = found.end() if found is not None else at + 1
