"""A row of the validation table: two numbers that should be one, and how far apart they are."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from importlib import import_module

from robomill.units import from_si, unit_label

TINY = 1e-12
HEAD = "| what | the other way | by it | by robomill | apart |\n|---|---|---:|---:|---:|"
SUPERSCRIPT = str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹")


class ValidationError(Exception):
    """Two numbers that should agree do not."""


@dataclass(frozen=True)
class Check:
    """One row: what is compared, by which independent way, both numbers in ``unit``, and how far apart they may lie
    as a share of the first (of ``scale`` where that is given, in SI)."""

    what: str
    way: str
    independent: float
    robomill: float
    unit: str
    within: float
    digits: int = 4
    scale: float | None = None

    @property
    def apart(self) -> float:
        return abs(self.robomill - self.independent) / (self.scale or abs(self.independent))

    def row(self) -> str:
        if not self.apart <= self.within:
            raise ValidationError(f"{self.what}: {self.independent!r} by {self.way}, {self.robomill!r} by robomill.")
        label = unit_label(self.unit)
        if self.independent == 0.0:  # the largest difference of many: neither number says anything by itself
            return f"| {self.what} | {self.way} | | | {_size(self.apart)}{'' if self.apart < TINY else ' ' + label} |"
        values = (f"{from_si(value, self.unit):.{self.digits}f}" for value in (self.independent, self.robomill))
        shown = (f"{value} {label}".replace("-", "−") for value in values)
        return f"| {self.what} | {self.way} | {' | '.join(shown)} | {_size(self.apart)} |"


Compute = Callable[[], list[Check]]


def table(checks: Sequence[Compute], needs: Sequence[str] = ()) -> str:
    """The rows of ``checks``; a check whose package in ``needs`` is not installed is left out and named."""
    rows, missing = [], []
    for k, compute in enumerate(checks):
        try:
            if needs:
                import_module(needs[k])
        except ModuleNotFoundError:
            missing.append(needs[k])
            continue
        rows += [check.row() for check in compute()]
    left_out = f"\n\nNot computed in this build, as they are not installed: {', '.join(missing)}." if missing else ""
    return "\n".join([HEAD, *rows]) + left_out


def _size(apart: float) -> str:
    if apart < TINY:
        return "rounding"
    exponent = math.floor(math.log10(apart))
    return f"{apart / 10.0**exponent:.0f}·10{str(exponent).translate(SUPERSCRIPT)}"
