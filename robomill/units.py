"""The only door between SI, used inside, and the units of the shop floor, used at the edge.

Every factor lives in ``UNITS``. A value is converted with ``to_si`` and ``from_si`` and shown with
``format_si``, which is the one formatter for tiles, tables, hover texts, CSV files and reports.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

Number = TypeVar("Number", float, NDArray[np.float64])


@dataclass(frozen=True)
class Unit:
    """A unit of the edge: ``value_in_SI = value * factor``; ``digits`` are the decimals shown."""

    label: str
    factor: float
    digits: int


UNITS: dict[str, Unit] = {
    "1": Unit("", 1.0, 3),
    "%": Unit("%", 1e-2, 1),
    "m": Unit("m", 1.0, 4),
    "mm": Unit("mm", 1e-3, 3),
    "um": Unit("µm", 1e-6, 1),
    "in": Unit("in", 25.4e-3, 4),
    "rad": Unit("rad", 1.0, 5),
    "deg": Unit("°", math.pi / 180.0, 2),
    "mrad": Unit("mrad", 1e-3, 3),
    "urad": Unit("µrad", 1e-6, 1),
    "mm/s": Unit("mm/s", 1e-3, 1),
    "mm/min": Unit("mm/min", 1e-3 / 60.0, 0),
    "in/min": Unit("in/min", 25.4e-3 / 60.0, 2),
    "mm/tooth": Unit("mm/tooth", 1e-3, 4),
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
    "um/N": Unit("µm/N", 1e-6, 3),
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
    "mm2": Unit("mm²", 1e-6, 2),
}


def to_si(value: Number, unit: str) -> Number:
    """Value given in ``unit`` (a key of ``UNITS``), in SI."""
    return value * UNITS[unit].factor  # type: ignore[return-value]


def from_si(value: Number, unit: str) -> Number:
    """SI value in ``unit`` (a key of ``UNITS``)."""
    return value / UNITS[unit].factor  # type: ignore[return-value]


def unit_label(unit: str) -> str:
    """The unit as people read it, e.g. ``"um/N"`` -> ``"µm/N"``."""
    return UNITS[unit].label


def format_value(value: float, unit: str, digits: int | None = None, sign: bool = False) -> str:
    """A value already in ``unit`` as text with its unit; NaN reads "not reached"."""
    if not math.isfinite(value):
        return "not reached" if math.isnan(value) else ("∞" if value > 0 else "−∞")
    decimals = UNITS[unit].digits if digits is None else digits
    text = f"{value:+.{decimals}f}" if sign else f"{value:.{decimals}f}"
    if float(text) == 0.0:
        text = text.lstrip("+-")
    return _with_label(text, unit)


def format_si(value: float, unit: str, digits: int | None = None, sign: bool = False) -> str:
    """An SI value shown in ``unit``: ``format_si(2.3e-4, "mm") == "0.230 mm"``."""
    return format_value(from_si(float(value), unit), unit, digits, sign)


def format_short(value: float, unit: str) -> str:
    """An SI value with the digits that say it, six at most: ``format_short(8e-3, "mm") == "8 mm"``."""
    return _with_label(f"{from_si(float(value), unit):.6g}", unit)


def _with_label(text: str, unit: str) -> str:
    label = UNITS[unit].label
    blank = "" if label == "°" else " "
    return f"{text.replace('-', '−')}{blank}{label}".rstrip()
