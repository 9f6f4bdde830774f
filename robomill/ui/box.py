"""What stands on a number box, and what a number typed into it means: no screen is needed for either."""

import math
from dataclasses import dataclass, replace
from typing import Any

from robomill.errors import ProjectError
from robomill.quantities import Quantity, quantities
from robomill.ui.project import read_field
from robomill.units import UNITS, from_si, parse_number, to_si, unit_label


@dataclass(frozen=True)
class NumberBox:
    """What stands on a number box, in the unit that is shown; an empty one means None where ``optional``.

    ``low`` and ``high`` are refused beyond in a sentence; ``digits`` default to those of the unit.
    """

    label: str
    unit: str = "1"
    step: float | None = None
    digits: int | None = None
    hint: str | None = None
    low: float | None = None
    high: float | None = None
    whole: bool = False
    optional: bool = False
    disabled: bool = False
    hidden: bool = False
    placeholder: str = "not given"

    @property
    def form(self) -> str | None:
        """How its number is written, as ``printf`` says it."""
        return None if self.whole else f"%.{UNITS[self.unit].digits if self.digits is None else self.digits}f"

    @property
    def title(self) -> str:
        """The label with its unit."""
        return f"{self.label}, {unit_label(self.unit)}" if unit_label(self.unit) else self.label

    def shown(self, value: float | None) -> float | None:
        """A value in SI as the box shows it, without the last bits that a conversion leaves behind."""
        if value is None or self.whole:
            return None if value is None else int(value)
        return float(f"{from_si(float(value), self.unit):.12g}")

    def written(self, value: float | None) -> str:
        """A value in SI as a line of text, with the digits of the box or all it has; "" is None."""
        shown = self.shown(value)
        said = "" if shown is None else str(shown) if self.form is None else self.form % shown
        return said if shown is None or float(said) == shown else f"{shown:.12g}"

    def read(self, text: str) -> float | None:
        """What was typed as a line of text, in SI; None where it is empty. Raises ProjectError naming the box."""
        if not text.strip():
            return self.typed(None)
        try:
            shown = parse_number(text)
        except ValueError:
            shown = math.nan
        if not math.isfinite(shown) or (self.whole and shown % 1.0):
            raise ProjectError(f"{self.label}: found {text.strip()!r}, expected a {'whole ' * self.whole}number.")
        return self.typed(shown)

    def typed(self, shown: float | None) -> float | None:
        """What was typed, in SI. Raises ProjectError naming the box where it is empty or beyond its bounds."""
        if shown is None:
            if self.optional:
                return None
            raise ProjectError("The box is empty: type a number.")
        low, high = self.low, self.high
        if (low is not None and shown < low) or (high is not None and shown > high):
            expected = f"{low:g} or more" if high is None else f"{high:g} or less" if low is None else ""
            expected = expected or f"{low:g} to {high:g}"
            named = f"{expected} {unit_label(self.unit)}".strip()
            raise ProjectError(f"{self.label}: found {shown:g}, expected {named}.")
        return int(shown) if self.whole else to_si(float(shown), self.unit)


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
    """The box of a declared number; ``shown`` are fields to be otherwise (in another ``unit`` steps follow).

    A number that nobody declared needs its ``label``.
    """
    if said is None:
        return NumberBox(**shown)
    unit = shown.get("unit", said.unit)
    given: dict[str, Any] = {
        "label": said.label,
        "unit": unit,
        "step": said.step_in(unit),
        "digits": said.digits_in(unit),
        "hint": said.hint,
        "whole": said.kind == "whole",
        "optional": said.optional,
    }
    return NumberBox(**{**given, **shown})
