"""The only door between SI, used inside, and the units of the shop floor, used at the edge.

Every factor lives in ``UNITS``. A value is converted with ``to_si`` and ``from_si`` and shown with ``format_si``
or one of its kin below: decimals, minus signs, thousands and the taking off of units are their business alone.
"""

import math
import re
from collections.abc import Iterable
from dataclasses import dataclass
from decimal import Decimal
from typing import SupportsFloat, TypeVar

import numpy as np
from numpy.typing import NDArray

from robomill.wording import MINUS as MINUS

Number = TypeVar("Number", float, NDArray[np.float64])

NOT_REACHED = "not reached"
LONGEST_S = 1e8  # what takes longer is no time that a machine has
GAP = "\u202f"  # between thousands: a comma there is a decimal mark to many


@dataclass(frozen=True)
class Unit:
    """A unit of the edge: ``value_in_SI = value * factor``; ``digits`` are the decimals shown.

    ``more`` decimals than the metric unit in whose place it stands (``INCHES``) say the same number.
    """

    label: str
    factor: float
    digits: int
    more: int = 0


UNITS: dict[str, Unit] = {
    "1": Unit("", 1.0, 3),
    "%": Unit("%", 1e-2, 1),
    "m": Unit("m", 1.0, 4),
    "cm": Unit("cm", 1e-2, 2),
    "mm": Unit("mm", 1e-3, 3),
    "um": Unit("µm", 1e-6, 1),
    "in": Unit("in", 25.4e-3, 4, 2),
    "thou": Unit("thou", 25.4e-6, 2, 1),
    "uin": Unit("µin", 25.4e-9, 1),
    "ft": Unit("ft", 0.3048, 3),
    "rad": Unit("rad", 1.0, 5),
    "deg": Unit("°", math.pi / 180.0, 2),
    "mrad": Unit("mrad", 1e-3, 3),
    "urad": Unit("µrad", 1e-6, 1),
    "deg/s": Unit("°/s", math.pi / 180.0, 0),
    "deg/mm": Unit("°/mm", math.pi / 180.0 / 1e-3, 1),
    "mm/s": Unit("mm/s", 1e-3, 1),
    "mm/min": Unit("mm/min", 1e-3 / 60.0, 0),
    "in/min": Unit("in/min", 25.4e-3 / 60.0, 2),
    "in/s": Unit("in/s", 25.4e-3, 2, 1),
    "deg/in": Unit("°/in", math.pi / 180.0 / 25.4e-3, 0),
    "mm/tooth": Unit("mm/tooth", 1e-3, 4),
    "in/tooth": Unit("in/tooth", 25.4e-3, 5, 2),
    "1/min": Unit("min⁻¹", 1.0 / 60.0, 0),
    "s": Unit("s", 1.0, 1),
    "Hz": Unit("Hz", 1.0, 1),
    "min": Unit("min", 60.0, 2),
    "N": Unit("N", 1.0, 1),
    "kN": Unit("kN", 1e3, 3),
    "N m": Unit("N m", 1.0, 2),
    "kN m": Unit("kN m", 1e3, 3),
    "kg": Unit("kg", 1.0, 2),
    "N/mm": Unit("N/mm", 1e3, 2),
    "N/mm2": Unit("N/mm²", 1e6, 1),
    "N/in": Unit("N/in", 1.0 / 25.4e-3, 1),
    "MPa": Unit("MPa", 1e6, 1),
    "um/N": Unit("µm/N", 1e-6, 3),
    "uin/N": Unit("µin/N", 25.4e-9, 2, -1),
    "in/N": Unit("in/N", 25.4e-3, 8, 2),
    "N/thou": Unit("N/thou", 1.0 / 25.4e-6, 2),
    "mm/N": Unit("mm/N", 1e-3, 6),
    "m/N": Unit("m/N", 1.0, 9),
    "N/um": Unit("N/µm", 1e6, 3),
    "1e-7 rad/(N m)": Unit("×10⁻⁷ rad/(N m)", 1e-7, 2),
    "kN m/rad": Unit("kN m/rad", 1e3, 1),
    "1e-9 m/N": Unit("×10⁻⁹ m/N", 1e-9, 2),
    "urad/N": Unit("µrad/N", 1e-6, 3),
    "urad/(N m)": Unit("µrad/(N m)", 1e-6, 3),
    "m2": Unit("m²", 1.0, 3),
    "m3": Unit("m³", 1.0, 3),
    "mm3": Unit("mm³", 1e-9, 1),
    "cm3/min": Unit("cm³/min", 1e-6 / 60.0, 1),
    "in3/min": Unit("in³/min", 25.4e-3**3 / 60.0, 2),
    "mm2": Unit("mm²", 1e-6, 2),
    "ft2": Unit("ft²", 0.3048**2, 3),
    "ft3": Unit("ft³", 0.3048**3, 2),
    "in3": Unit("in³", 25.4e-3**3, 5, 4),
    "in2": Unit("in²", 25.4e-3**2, 5, 3),
}

SI_NAMES = {
    "1e-7 rad/(N m)": "rad/(N m)",
    "1e-9 m/N": "m/N",
    "mm": "m",
    "deg": "rad",
    "mm/min": "m/s",
    "mm/s": "m/s",
    "1/min": "1/s",
    "1": "",
    "%": "1",
    "um/N": "m/N",
    "cm3/min": "m3/s",
}
"""The SI unit in which a plain number is given that people know in another."""

# What stands in the place of a unit where lengths are read in inches. MPa is N/mm² by another name.
INCHES = {
    "mm": "in",
    "cm": "in",
    "um": "thou",
    "m": "ft",
    "mm2": "in2",
    "mm3": "in3",
    "m2": "ft2",
    "m3": "ft3",
    "mm/min": "in/min",
    "mm/s": "in/s",
    "mm/tooth": "in/tooth",
    "cm3/min": "in3/min",
    "deg/mm": "deg/in",
    "um/N": "uin/N",
    "mm/N": "in/N",
    "N/mm": "N/in",
    "N/um": "N/thou",
    "N/mm2": "MPa",
}


def in_lengths(unit: str, length: str) -> str:
    """The key of ``UNITS`` in which a quantity of ``unit`` is shown where lengths are in ``length``, mm or in:
    ``in_lengths("um/N", "in") == "uin/N"``. What holds no length stays as it is."""
    return INCHES.get(unit, unit) if length == "in" else unit


def to_si(value: Number, unit: str) -> Number:
    """Value given in ``unit`` (a key of ``UNITS``), in SI."""
    return value * UNITS[unit].factor  # type: ignore[return-value]


def from_si(value: Number, unit: str) -> Number:
    """SI value in ``unit`` (a key of ``UNITS``)."""
    return value / UNITS[unit].factor  # type: ignore[return-value]


def decimal_to_si(value: Decimal, unit: str) -> float:
    """``to_si`` of a number with more digits than a float holds, rounded once."""
    return float(value * Decimal(UNITS[unit].factor))


def decimal_from_si(value: float, unit: str, digits: int = 21) -> Decimal:
    """The number whose ``decimal_to_si`` is the very same SI value: some have no float that is."""
    return Decimal(f"{Decimal(value) / Decimal(UNITS[unit].factor):.{digits}g}")


def si_unit(unit: str) -> str:
    """The unit in which a quantity of ``unit`` is inside: ``si_unit("um/N") == "m/N"``."""
    return unit if UNITS[unit].factor == 1.0 else SI_NAMES[unit]


def unit_label(unit: str) -> str:
    """The unit as people read it, e.g. ``"um/N"`` -> ``"µm/N"``."""
    return UNITS[unit].label


def rounded(value: SupportsFloat, digits: int = 12) -> float:
    """``value`` to so many significant digits; 12 take away what a conversion left in the last bits."""
    return float(f"{float(value):.{digits}g}")


def format_number(value: SupportsFloat, digits: int, sign: bool = False, missing: str = NOT_REACHED) -> str:
    """A bare number with so many decimals: a true minus, no negative zero, ``missing`` for NaN."""
    number = float(value)
    if not math.isfinite(number):
        return missing if math.isnan(number) else ("∞" if number > 0 else f"{MINUS}∞")
    text = f"{number:+.{digits}f}" if sign else f"{number:.{digits}f}"
    return _typeset(text.lstrip("+-") if float(text) == 0.0 else text)


def format_significant(value: SupportsFloat, digits: int = 6, sign: bool = False) -> str:
    """A bare number by its leading digits, without trailing zeros: ``format_significant(-0.12345, 3) == "−0.123"``."""
    number = float(value)
    if not math.isfinite(number):
        return format_number(number, 0)
    return _typeset(f"{number:+.{digits}g}" if sign and number != 0.0 else f"{number:.{digits}g}")


def format_plain(value: float, digits: int) -> str:
    """As files hold a number: so many decimals without trailing zeros, and no negative zero."""
    text = f"{value:.{digits}f}"
    text = text.rstrip("0").rstrip(".") if digits else text
    return "0" if text == "-0" else text


def format_percent(share: SupportsFloat, digits: int = 0, sign: bool = False) -> str:
    """A share of 1 in per cent: ``format_percent(0.42) == "42 %"``."""
    return format_si(share, "%", digits, sign)


def format_share(share: SupportsFloat) -> str:
    """A share of what is allowed, in per cent: with the digits that tell on which side of all of it it lies."""
    return format_beside(share, 1.0, "%", 0)


def format_beside(value: SupportsFloat, limit: float, unit: str, digits: int | None = None, sign: bool = False) -> str:
    """An SI value beside its ``limit``: with more decimals than ``digits`` (those of the unit where None; up to three
    more) where these would show its size as the limit's or on the other side of it."""
    digits = decimals(unit, digits)
    size, allowed = abs(from_si(float(value), unit)), from_si(limit, unit)

    def tells(n: int) -> bool:
        shown = round(size, n) - rounded(allowed)
        return shown * (size - allowed) > 0.0 or math.isclose(size, allowed)

    more = range(digits, digits + 4)
    return format_si(value, unit, next((n for n in more if tells(n)), more[-1]), sign)


def format_limit(limit: float, unit: str) -> str:
    """What is allowed, with two decimals or as many as it has (up to four)."""
    number = from_si(limit, unit)
    return format_si(limit, unit, next((n for n in (2, 3) if abs(round(number, n) - number) < 1e-9), 4))


def format_count(count: int, noun: str = "") -> str:
    """``1 cut``, ``12 400 cuts``; the number alone without a noun."""
    number = _typeset(str(count))
    return f"{number} {noun}{'' if count == 1 else 's'}" if noun else number


def format_short_count(count: int) -> str:
    """A large count as people say it: 812k, 1.2M."""
    if count < 10_000:
        return format_count(count)
    return f"{count / 1e3:.0f}k" if count < 999_500 else f"{count / 1e6:.1f}M"


def format_bytes(count: int) -> str:
    """The size of a file: ``format_bytes(7_905_084) == "7.9 MB"``."""
    for label, size in (("GB", 1e9), ("MB", 1e6), ("kB", 1e3)):
        if count >= size:
            return f"{count / size:.1f} {label}"
    return format_count(count, "byte")


def format_duration(seconds: SupportsFloat, digits: int = 1, sign: bool = False) -> str:
    """A time as people say it: ``12.0 s``, ``4.2 min``, ``3 h 20 min``; the first two with so many digits."""
    size = abs(float(seconds))
    if size < 120.0 or math.isnan(size):
        return format_si(seconds, "s", digits, sign)
    if not size < LONGEST_S:
        return "more than three years"
    minutes = from_si(float(seconds), "min")
    if size < 7200.0:
        return format_value(minutes, "min", digits if size < 600.0 else 0, sign)
    hours, rest = divmod(round(abs(minutes)), 60)
    return f"{format_number(math.copysign(hours, minutes), 0, sign)} h {rest:02d} min"


def format_times(times: SupportsFloat, digits: int = 2) -> str:
    """How many times larger something is drawn, by its leading digits: ``× 1200``."""
    return f"× {_typeset(f'{rounded(times, digits):.12g}')}"


def decimals(unit: str, digits: int | None) -> int:
    """Decimals shown in ``unit``: ``digits``, or the unit's own. Of a length they are those in mm; inches show as much.

    Two more then, but no more than an inch has: 0.23 mm are 0.0091 in. Likewise what stands in the place of µm or N/mm.
    """
    own, more = UNITS[unit].digits, UNITS[unit].more
    if digits is None:
        return own
    return max(digits, min(digits + more, own)) if more >= 0 else max(digits + more, 0)


def format_value(
    value: SupportsFloat,
    unit: str,
    digits: int | None = None,
    sign: bool = False,
    with_unit: bool = True,
    missing: str = NOT_REACHED,
) -> str:
    """A value already in ``unit`` as text; NaN reads ``missing``, and no unit follows what is not finite."""
    text = format_number(value, decimals(unit, digits), sign, missing)
    return _with_label(text, unit) if with_unit and math.isfinite(float(value)) else text


def format_si(
    value: SupportsFloat,
    unit: str,
    digits: int | None = None,
    sign: bool = False,
    with_unit: bool = True,
    missing: str = NOT_REACHED,
) -> str:
    """An SI value shown in ``unit``: ``format_si(2.3e-4, "mm") == "0.230 mm"``."""
    return format_value(from_si(float(value), unit), unit, digits, sign, with_unit, missing)


def format_short(value: SupportsFloat, unit: str, digits: int = 6) -> str:
    """An SI value with the digits that say it, so many at most: ``format_short(8e-3, "mm") == "8 mm"``."""
    return _with_label(format_significant(from_si(float(value), unit), digits), unit)


def format_many(
    values: Iterable[SupportsFloat],
    unit: str,
    digits: int | None = None,
    between: str = ", ",
    sign: bool = False,
    with_unit: bool = True,
) -> str:
    """SI values with the unit once, at the end: points, sizes (`` × ``), ranges (`` to ``), bands (`` ± ``)."""
    *first, last = values
    texts = [format_si(value, unit, digits, sign, with_unit=False) for value in first]
    return between.join([*texts, format_si(last, unit, digits, sign, with_unit)])


def split_unit(text: str) -> tuple[str, str]:
    """``"0.230 mm"`` as number and unit, for screens that set the unit small; ``(text, "")`` where none follows."""
    number, _, unit = text.rpartition(" ")
    if number[-1:].isdigit() and len(unit) < 7 and not any(c.isdecimal() for c in unit):
        return number, unit
    return text, ""


def _with_label(text: str, unit: str) -> str:
    label = UNITS[unit].label
    return f"{text}{label}" if label == "°" else f"{text} {label}".rstrip()


def _typeset(text: str) -> str:
    """A number's characters with a true minus, and its thousands parted from five digits on."""
    whole = re.match(r"[+-]?(\d{5,})(?!\d*e)", text)
    parted = text.replace(whole[1], f"{int(whole[1]):,}".replace(",", GAP), 1) if whole else text
    return parted.replace("-", MINUS)
