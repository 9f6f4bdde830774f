"""What stands on a number box, and what a number typed into it means: no screen is needed for either."""

import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any

from robomill.errors import NumberError, ProjectError
from robomill.quantities import Quantity, quantities
from robomill.typed_numbers import read_number, write_number
from robomill.ui.project import read_field
from robomill.units import UNITS, from_si, to_si, unit_label

ENDLESS = "∞"


@dataclass(frozen=True)
class NumberBox:
    """What stands on a number box or a cell, in the unit that is shown; an empty one means None where ``optional``.

    ``low`` and ``high`` are refused beyond in a sentence; ``digits`` default to those of the unit. ``said`` and
    ``meant`` lead from SI to the unit and back, where that is more than its factor; ∞ is then a number.
    """

    label: str
    unit: str = "1"
    digits: int | None = None
    hint: str | None = None
    low: float | None = None
    high: float | None = None
    whole: bool = False
    optional: bool = False
    disabled: bool = False
    hidden: bool = False
    placeholder: str = "not given"
    said: Callable[[float, str], float] = from_si
    meant: Callable[[float, str], float] = to_si

    @property
    def title(self) -> str:
        """The label with its unit."""
        return f"{self.label}, {unit_label(self.unit)}" if unit_label(self.unit) else self.label

    def written(self, value: float | None, cell: bool = False, decimals: int | None = None) -> str:
        """A value in SI as a line of text: with the digits of the box, or in a ``cell`` with those it has, or with so
        many ``decimals``.

        "" is None.
        """
        if value is None:
            return ""
        if self.whole:
            return str(int(value))
        shown = float(self.said(float(value), self.unit))
        return write_number(shown, decimals if cell else self.decimals) if math.isfinite(shown) else ENDLESS

    @property
    def decimals(self) -> int:
        """Those that a number of the box is shown with."""
        return UNITS[self.unit].digits if self.digits is None else self.digits

    def named(self, value: float | None, cell: bool = False) -> str:
        """A value in SI with its unit, as a sentence says it."""
        return "empty" if value is None else f"{self.written(value, cell)} {unit_label(self.unit)}".strip()

    def read(self, text: str) -> float | None:
        """What was typed, in SI; None where it is empty. Raises ProjectError naming the box."""
        if not text.strip():
            return self.typed(None)
        if self.said is not from_si and text.strip() == ENDLESS:
            return self.meant(math.inf, self.unit)
        try:
            shown = read_number(text, self.unit).value
        except NumberError as exc:
            raise ProjectError(f"{self.label}: {exc}") from None
        if self.whole and shown % 1.0:
            raise ProjectError(f"{self.label}: found {text.strip()!r:.40}, expected a whole number.")
        return self.typed(shown)

    def understood(self, text: str, cell: bool = False) -> str:
        """What a number that ``read`` takes means, where that is not its own digits, or a ``cell`` is typed otherwise.

        "" of any other.
        """
        if not text.strip() or text.strip() == ENDLESS:
            return ""
        found = read_number(text, self.unit)
        odd = found.converted or (cell and not found.plain)
        return f"{text.strip()} is {write_number(found.value)} {unit_label(self.unit)}".strip() if odd else ""

    def typed(self, shown: float | None) -> float | None:
        """What was typed, in SI. Raises ProjectError naming the box where it is empty or beyond its bounds."""
        if shown is None:
            if self.optional:
                return None
            raise ProjectError(f"{self.label}: the box is empty; type a number.")
        low, high = self.low, self.high
        if (low is not None and shown < low) or (high is not None and shown > high):
            expected = f"{low:g} or more" if high is None else f"{high:g} or less" if low is None else ""
            expected = expected or f"{low:g} to {high:g}"
            named = f"{expected} {unit_label(self.unit)}".strip()
            raise ProjectError(f"{self.label}: found {shown:g}, expected {named}.")
        found = int(shown) if self.whole else self.meant(float(shown), self.unit)
        if not math.isfinite(found):
            raise ProjectError(f"{self.label}: found {shown:g}, expected more than 0 {unit_label(self.unit)}.")
        return found


def declaration(owner: Any, path: str) -> Quantity | None:
    """What the class of the field at ``path`` of ``owner`` says of it; None where it says nothing.

    An index names one entry of an array: a number, labelled with its axis.
    """
    above, _, last = path.rpartition(".")
    holder = read_field(owner, above) if above else owner
    name, _, index = last.partition("[")
    said = quantities(type(holder)).get(name)
    return said if said is None or not index else entry(said, int(index.rstrip("]")))


def entry(said: Quantity, i: int) -> Quantity:
    """Entry ``i`` of a declared array, as a number of its own that cannot be left out."""
    return replace(said, kind="number", label=f"{said.label} {said.axes[i]}", shape=(), axes=(), optional=False)


def declared(owner: Any, path: str, **shown: Any) -> NumberBox:
    """The box of the number at ``path`` of ``owner`` as its class declares it; ``shown`` as for ``box_of``."""
    return box_of(declaration(owner, path), **shown)


def box_of(said: Quantity | None, **shown: Any) -> NumberBox:
    """The box of a declared number; ``shown`` are fields to be otherwise (in another ``unit`` digits follow).

    A number that nobody declared needs its ``label``.
    """
    if said is None:
        return NumberBox(**shown)
    unit = shown.get("unit", said.unit)
    given: dict[str, Any] = {
        "label": said.label,
        "unit": unit,
        "digits": said.digits_in(unit),
        "hint": said.hint,
        "whole": said.kind == "whole",
        "optional": said.optional,
    }
    return NumberBox(**{**given, **shown})
