"""A number is declared once, with the field that holds it: label, unit, bounds, default and name in files.

    @dataclass(frozen=True)
    class Groove:
        width: float = quantity("Width", "mm", above=0.0)
        walls: int = whole("Walls", least=1, default=2)

        def __post_init__(self) -> None:
            settle(self, CuttingError, "Groove")

The class checks itself with ``settle``; files, boxes on the page and reports ask ``quantities(Groove)``. Bounds and
defaults are SI, digits are meant in the unit of the edge. Fields of another kind (a material, a record) are
not declared here: whoever reads, writes or draws them goes by their type (``declared_types``).
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import MISSING, dataclass, field, fields, replace
from functools import cache
from typing import Any, Literal, get_type_hints

import numpy as np

from robomill.arrays import NO_NUMBERS, as_floats, brief, frozen, is_unreal
from robomill.errors import RobomillError
from robomill.units import UNITS, format_short, format_significant, from_si, unit_label
from robomill.wording import listed

QuantityKind = Literal["number", "array", "whole", "switch", "choice"]
_KEY = "quantity"
GREATEST, SMALLEST = 1e12, 1e-12
"""In its own unit, a number beyond the first is a slip of the pen, and so is one below the second that has to be more
than zero: what would be computed from it overflows or never ends."""


@dataclass(frozen=True, eq=False)
class Quantity:
    """What is to know of one field.

    label     what people call it; ``unit`` a key of ``units.UNITS``, in which it is typed, shown and written to files
    above, least, below, most   bounds in SI: more than, at least, less than, at most (None: free)
    digits    the decimals shown, in ``unit``
    optional  None is a value ("not given"); ``written_none`` is the number that files write for it (None: no key)
    shape, axes   of an array (None: any length) and the names of its entries in boxes
    options   of a choice: code -> title
    boxed     whether the page offers a box for it
    sliding   the unit of what belongs to a joint that slides, where it is another than that of one that turns
    slip      in SI: a plain number beyond it was meant in ``unit`` (mm given as m), see ``spelled``
    tiny      in SI: a number below it (not 0) that was given in ``unit`` was meant in SI (m given as mm); of an
              ``extent`` only of several numbers (one coordinate alone may be as small)
    quarters  of an angle whose ends are mostly quarter turns: 1.57 degrees were meant in rad
    name, key   of the field, and in files (with the unit in it)
    default     where nothing is given, unless it is ``needed``
    """

    label: str
    unit: str = "1"
    kind: QuantityKind = "number"
    above: float | None = None
    least: float | None = None
    below: float | None = None
    most: float | None = None
    digits: int | None = None
    hint: str | None = None
    optional: bool = False
    written_none: float | None = None
    shape: tuple[int | None, ...] = ()
    axes: Sequence[str] = ()
    options: Mapping[str, str] = field(default_factory=dict)
    boxed: bool = True
    sliding: str | None = None
    slip: float | None = None
    tiny: float | None = None
    extent: bool = False
    quarters: bool = False
    name: str = ""
    key: str = ""
    default: Any = None
    needed: bool = True

    def of_joint(self, slides: bool) -> Quantity:
        """Of a joint that turns or slides, in its unit."""
        return replace(self, unit=self.sliding) if slides and self.sliding else self

    def digits_in(self, unit: str) -> int:
        """Decimals that show in ``unit`` what ``digits`` show in the unit of the edge."""
        digits = UNITS[self.unit].digits if self.digits is None else self.digits
        return max(0, digits + math.ceil(math.log10(UNITS[unit].factor / UNITS[self.unit].factor) - 1e-9))

    @property
    def expected(self) -> str:
        """What it should be, in words: ``"more than 0 mm"``, ``"0 to less than 85°"``, ``"right or left"``."""
        if self.kind == "choice":
            return listed(self.options, "or")
        if self.kind == "switch":
            return "true or false"
        words = self._between or ("a whole number" if self.kind == "whole" else "a finite number")
        return f"{words}, or left out" if self.optional else words

    @property
    def _between(self) -> str:
        """Its bounds in words; "" where it is free."""
        low, high = (None if bound is None else self.short(bound) for bound in (self._lowest, self._highest))
        if low is None and high is None:
            return ""
        if high is None:
            return f"more than {low}" if self.above is not None else f"{low} or more"
        if low is None:
            return f"less than {high}" if self.below is not None else f"at most {high}"
        start = f"more than {low}" if self.above is not None else low
        return f"{start} to {f'less than {high}' if self.below is not None else high}"

    def settled(self, value: Any, error: type[RobomillError] = RobomillError, who: str = "") -> Any:
        """``value`` as the field keeps it: float, int, bool, code or frozen array; ``error`` where it cannot be."""
        if value is None:
            if self.optional:
                return None
            raise self._refusal("nothing", error, who)
        found = _CONVERTERS[self.kind](self, value, error, who)
        if self.kind in ("number", "array", "whole") and not np.all(self.allows(found)):
            worst = self._offending(found)
            shown = self.short(worst) if math.isfinite(worst) else str(worst)
            raise self._refusal(shown, error, who, self._slips(worst))
        return found

    @property
    def _lowest(self) -> float | None:
        return self.above if self.above is not None else self.least

    @property
    def _highest(self) -> float | None:
        return self.below if self.below is not None else self.most

    def allows(self, value: Any) -> Any:
        """Where ``value`` lies within the bounds; NaN and what is beyond ``GREATEST`` never do."""
        one = UNITS[self.unit].factor
        good = np.abs(value) <= GREATEST * one
        if self.above is not None:
            good &= value >= SMALLEST * one if self.above == 0.0 else value > self.above
        if self.least is not None:
            good &= value >= self.least
        if self.below is not None:
            good &= value < self.below
        if self.most is not None:
            good &= value <= self.most
        return good

    def _offending(self, value: Any) -> float:
        """The first number out of bounds."""
        return float(np.ravel(value)[np.flatnonzero(~np.ravel(self.allows(value)))[0]])

    def _slips(self, worst: float) -> str:
        """What is expected besides, of a number that only ``GREATEST`` or ``SMALLEST`` refuses."""
        size = abs(worst) / UNITS[self.unit].factor
        if GREATEST < size < math.inf:
            return f", and no larger than {format_short(GREATEST * UNITS[self.unit].factor, self.unit)}"
        if self.above == 0.0 and worst > 0.0 and size < SMALLEST:
            return f", and no smaller than {format_short(SMALLEST * UNITS[self.unit].factor, self.unit)}"
        return ""

    def short(self, value: Any) -> str:
        """A value of the field (SI) in words: ``"8 mm"``, the title of a choice, ``"on"`` or ``"off"``."""
        if self.kind == "choice":
            return self.options[value]
        if self.kind == "switch":
            return "on" if value else "off"
        return format_short(value, self.unit)

    def _refusal(self, found: str, error: type[RobomillError], who: str, besides: str = "") -> RobomillError:
        return error(f"{self.said_of(who)}: found {found}; expected {self.expected}{besides}.", where=self.name)

    def said_of(self, who: str) -> str:
        """The head of a refusal: ``"Cutter, Diameter"``, or ``"Diameter"`` of nobody."""
        return f"{who}, {self.label}" if who else self.label


def quantity(label: str, unit: str = "1", *, default: Any = MISSING, **said: Any) -> Any:
    """A number (an array, where ``shape`` is given) as a dataclass field; ``said`` are further fields of ``Quantity``.

    An ``optional`` one is None unless it is given, where no other default is stated. ``compare=False`` keeps it out
    of comparisons and of the digest, as in ``dataclasses.field``.
    """
    if said.get("optional") and default is MISSING:
        default = None
    compare = said.pop("compare", True)
    return _declared(Quantity(label, unit, "array" if said.get("shape") else "number", **said), default, compare)


def again(declared: Quantity, *, default: Any = MISSING, **said: Any) -> Any:
    """One number of a quantity that is declared elsewhere, as a dataclass field; ``said`` is what is its own."""
    return _declared(replace(declared, **{"kind": "number", **said}), default)


def whole(label: str, *, default: Any = MISSING, **said: Any) -> Any:
    """A whole number as a dataclass field."""
    return _declared(Quantity(label, kind="whole", **{"digits": 0, **said}), default)


def switch(label: str, *, default: Any = MISSING, **said: Any) -> Any:
    """True or False as a dataclass field."""
    return _declared(Quantity(label, kind="switch", **said), default)


def choice(label: str, options: Mapping[str, str], *, default: Any = MISSING, **said: Any) -> Any:
    """One of a few codes as a dataclass field; ``options`` maps each to its title."""
    return _declared(Quantity(label, kind="choice", options=dict(options), **said), default)


def quantities(cls: type) -> Mapping[str, Quantity]:
    """The declared fields of a dataclass in their order, by field name."""
    return _quantities(cls)


@cache
def _quantities(cls: type) -> Mapping[str, Quantity]:
    found = {}
    for each in fields(cls):
        declared = each.metadata.get(_KEY)
        if declared is not None:
            key = declared.key or each.name + file_suffix(declared.unit)
            needed = each.default is MISSING
            found[each.name] = replace(
                declared, name=each.name, key=key, default=None if needed else each.default, needed=needed
            )
    return found


def declared_types(cls: type) -> Mapping[str, Any]:
    """The types of the fields that are not quantities, by field name: a material, a record, a provenance."""
    return _types(cls)


@cache
def _types(cls: type) -> Mapping[str, Any]:
    hints = get_type_hints(cls)
    return {each.name: hints[each.name] for each in fields(cls) if _KEY not in each.metadata}


def settle(value: Any, error: type[RobomillError], who: str = "") -> None:
    """Check and convert every declared field of a frozen dataclass; for its ``__post_init__``.

    Raises ``error`` with one sentence: ``who``, the label, what was found, what was expected; ``where`` is the field.
    """
    for name, declared in quantities(type(value)).items():
        object.__setattr__(value, name, declared.settled(getattr(value, name), error, who))


def described(value: Any) -> str:
    """The declared numbers of a value in words, e.g. ``"Feed 0 N, Axial −23 N"``; what is absent is left out."""
    said = []
    for name, declared in quantities(type(value)).items():
        found = getattr(value, name)
        if declared.kind == "array":
            numbers = ", ".join(format_significant(from_si(float(v), declared.unit)) for v in np.ravel(found))
            said.append(f"{declared.label} ({numbers}) {unit_label(declared.unit)}".rstrip())
        elif found is not None:
            said.append(f"{declared.label} {declared.short(found)}")
    return ", ".join(said)


def told(value: Any) -> list[tuple[str, str]]:
    """The declared numbers of a value by their labels, in words; what is absent is left out."""
    found = ((declared, getattr(value, name)) for name, declared in quantities(type(value)).items())
    return [(declared.label, declared.short(each)) for declared, each in found if each is not None]


def file_suffix(unit: str) -> str:
    """How a unit ends a key in files: ``"_mm"``, ``"_N_mm2"``, nothing for a plain number."""
    return "" if unit == "1" else "_" + unit.replace("/", "_").replace(" ", "_")


def _declared(declared: Quantity, default: Any, compare: bool = True) -> Any:
    return field(default=default, compare=compare, metadata={_KEY: declared})


def _number(declared: Quantity, value: Any, error: type[RobomillError], who: str) -> float:
    try:
        if is_unreal(value):
            raise TypeError
        return float(value)
    except NO_NUMBERS as exc:
        raise declared._refusal(brief(value, 40), error, who) from exc


def _array(declared: Quantity, value: Any, error: type[RobomillError], who: str) -> Any:
    label = unit_label(declared.unit)
    name = f"{declared.said_of(who)} ({label})" if label else declared.said_of(who)
    array = as_floats(value, name, declared.shape, error=error)
    if array.ndim != len(declared.shape):
        want = ", ".join("any" if length is None else str(length) for length in declared.shape)
        raise error(f"{name}: expected shape ({want}), found {array.shape}.", where=declared.name)
    return frozen(array)


def _whole(declared: Quantity, value: Any, error: type[RobomillError], who: str) -> int:
    try:
        number = float(value)
        if number.is_integer() and not isinstance(value, str | bool):
            return int(number)
    except NO_NUMBERS:
        pass
    bounds = f", {declared.expected}" if declared._between else ""
    raise error(
        f"{declared.said_of(who)}: found {brief(value, 40)}; expected a whole number{bounds}.",
        where=declared.name,
    )


def _switch(declared: Quantity, value: Any, error: type[RobomillError], who: str) -> bool:
    if isinstance(value, bool | np.bool_):
        return bool(value)
    raise declared._refusal(brief(value, 40), error, who)


def _choice(declared: Quantity, value: Any, error: type[RobomillError], who: str) -> str:
    if isinstance(value, str) and value in declared.options:
        return value
    raise declared._refusal(brief(value, 40), error, who)


_CONVERTERS = {"number": _number, "array": _array, "whole": _whole, "switch": _switch, "choice": _choice}
