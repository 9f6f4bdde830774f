"""Numbers given in code: a name alone is SI, a name that ends in its unit is in that unit.

    Cutter("flat", diameter=0.008)        Cutter("flat", diameter_mm=8.0)

The second name is the number's key in files, so that whoever knows one knows the other. A plain number that is too
large to be SI is refused with how it is written, and so is one under the other name that is certainly SI: nobody mills
with a cutter of 0.008 mm. Whoever does mean it has the first name. Arguments are told in ``arguments``.
"""

import inspect
import math
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from contextvars import ContextVar
from dataclasses import fields
from functools import wraps
from types import MappingProxyType
from typing import Any, Self, TypeVar

import numpy as np

from robomill.arguments import asked as telling, named, refuse_unknown
from robomill.arrays import NO_NUMBERS, brief, is_unreal, no_number
from robomill.errors import ArgumentError, RobomillError
from robomill.kinds import kinds_told
from robomill.quantities import Quantity, quantities
from robomill.units import SI_NAMES, format_plain, from_si, to_si, unit_label

T = TypeVar("T")
C = TypeVar("C", bound=type)
_BESIDE: ContextVar[Mapping[str, str] | None] = ContextVar("units_beside", default=None)


def in_units(
    error: type[RobomillError],
    who: str,
    asked: tuple[str, ...] = (),
    more: tuple[str, ...] = (),
    new: Callable[[Mapping[str, Any]], dict[str, Any]] | None = None,
) -> Callable[[C], C]:
    """A dataclass that takes its declared numbers under their other name, too; ``error`` and ``who`` as in ``settle``.

    Of a new one ``unstated`` are those of ``asked`` that nobody has given. ``new`` makes fields of what a person gives,
    of which ``more`` are the names that are no fields.
    """

    def of(cls: C) -> C:
        make: Callable[..., None] = cls.__init__  # type: ignore[misc]
        own = inspect.signature(make).parameters
        others = [
            inspect.Parameter(key, inspect.Parameter.KEYWORD_ONLY, default=None) for key in (*spelled(cls), *more)
        ]

        signature = inspect.Signature([*own.values(), *others])

        @wraps(make)
        def init(self: Any, *args: Any, **given: Any) -> None:
            found = in_si(cls, named(signature, who, (self, *args), given))
            found = found if new is None else new(found)
            for name, each in own.items():
                if each.default is each.empty and name not in ("self", *found):
                    declared = quantities(cls).get(name)
                    other = "" if declared is None or declared.key == name else f" or {name_in_code(declared)}"
                    raise ArgumentError(f"{who}: {name} is missing{other and f'; give {name}{other}'}.", where=name)
            make(self, **found)
            if asked:
                object.__setattr__(self, "unstated", tuple(name for name in asked if name not in found))

        init.__signature__ = signature  # type: ignore[attr-defined]
        cls.__init__ = telling(init)  # type: ignore[misc]
        cls.door = error, who  # type: ignore[attr-defined]
        return cls

    return of


def made(cls: type[T], known: Mapping[str, Any]) -> T:
    """A value of a class of numbers that are known to be SI (read from a file in their units), whatever their size."""
    one = cls.__new__(cls)
    inspect.unwrap(cls.__init__)(one, **known)
    return one


def spelled(cls: type) -> dict[str, Quantity]:
    """The numbers of a class by their other name, which ends in the unit; those that have none are not in it."""
    return {name_in_code(each): each for each in quantities(cls).values() if each.key != each.name and each.unit != "1"}


def name_in_code(declared: Quantity) -> str:
    """Its key in files as a name: ``diameter_mm``, ``C_x_1e_7_rad_per_Nm``."""
    return declared.key.replace("-", "_")


def in_si(cls: type, given: Mapping[str, Any]) -> dict[str, Any]:
    """``given`` with every number under its own name and in SI. Raises the error of the class for one that is there
    twice, or that was hardly meant in SI."""
    other, own, found = spelled(cls), quantities(cls), {}
    error, who = getattr(cls, "door", (RobomillError, cls.__name__))
    for key, value in given.items():
        if key not in other:
            if key in own:
                refuse_slip(own[key], value, error, who)
            found[key] = value
            continue
        name = other[key].name
        if name in given:
            raise error(f"{who}: {name} and {key} are the same number; give one of them.", where=name)
        found[name] = converted(value, other[key].unit, error, f"{who}, {key}")
        refuse_tiny(other[key], found[name], error, who)
    return found


def one_of(
    declared: Quantity, plain: Any, in_unit: Any, error: type[RobomillError], who: str, default: Any = None
) -> Any:
    """A number in SI that was given plainly or ``in_unit``. Raises ``error`` where both are given, or neither and there
    is no ``default``."""
    if plain is None and in_unit is None and default is None:
        give = to_give(declared.key, "it is missing" if beside() else f"give {declared.name} or {declared.key}")
        raise error(f"{declared.said_of(who)}: {give}.", where=declared.name)
    if plain is not None and in_unit is not None:
        raise error(f"{who}: {declared.name} and {declared.key} are the same; give one of them.", where=declared.name)
    if in_unit is not None:
        found = converted(in_unit, declared.unit, error, f"{who}, {declared.key}")
        refuse_tiny(declared, found, error, who)
        return found
    if plain is not None:
        refuse_slip(declared, plain, error, who)
    return default if plain is None else plain


def converted(value: Any, unit: str, error: type[RobomillError], name: str) -> Any:
    """A number, numbers in lists or an array, or None, in SI."""
    if value is None:
        return None
    if isinstance(value, Mapping):
        return {key: converted(one, unit, error, name) for key, one in value.items()}
    if isinstance(value, list | tuple) and any(one is None for one in value):
        return tuple(converted(one, unit, error, name) for one in value)
    try:
        if is_unreal(value):
            raise TypeError
        numbers = np.asarray(value, dtype=np.float64)
    except NO_NUMBERS:
        found = no_number(value) or brief(value)
        raise error(f"{name}: expected a number, found {found}.", where=name) from None
    return to_si(float(numbers), unit) if numbers.ndim == 0 else to_si(numbers, unit)


def refuse_slip(declared: Quantity, value: Any, error: type[RobomillError], who: str) -> None:
    """Raises ``error`` where a number that should be SI is so large that it was meant in its unit of the edge."""
    if declared.slip is None:
        return
    try:
        found = np.asarray(value, dtype=np.float64)
    except NO_NUMBERS:
        return  # what is no number is refused where it is settled
    size = np.where(np.isfinite(found), np.abs(found), 0.0)
    if size.max(initial=0.0) > declared.slip:
        worst = float(found.ravel()[np.argmax(size)])
        if _BESIDE.get() is not None:
            highest = declared.most if declared.below is None else declared.below
            bounded = highest is not None and highest <= declared.slip
            least = declared.expected if bounded else f"at most {declared.short(declared.slip)}"
            words = f"found {declared.short(worst)}; expected {least}."
        else:
            words = slip_words(declared, worst, found.ndim == 0)
        raise error(f"{declared.said_of(who)}: {words}", where=declared.name)


@contextmanager
def units_beside(names: Mapping[str, str] = MappingProxyType({})) -> Iterator[None]:
    """What is given meanwhile comes from boxes or options that say their units: a refusal says nothing of names in
    code. ``names`` are those of options, by the names in code."""
    before = _BESIDE.set(names)
    try:
        yield
    finally:
        _BESIDE.reset(before)


def beside() -> bool:
    """Whether numbers come in with their units beside them, so that names in code and SI would only puzzle."""
    return _BESIDE.get() is not None


def to_give(name: str, plain: str) -> str:
    """What to do for a number that is called ``name`` in code: to give its option where there is one, else ``plain``"""
    option = (_BESIDE.get() or {}).get(name)
    return plain if option is None else f"give {option}"


def slip_words(declared: Quantity, worst: float, alone: bool = True) -> str:
    """What to say of a plain number that is too large: what it says, and how what was meant is written."""
    si, unit = SI_NAMES[declared.unit], declared.unit
    meant, plain, most = format_plain(worst, 6), f"{to_si(worst, unit):.5g}", format_plain(declared.slip or 0.0, 3)
    other = name_in_code(declared)
    give = f"{declared.name}={plain} or {other}={meant}"
    if not other.isidentifier():
        give = f"{declared.name}={plain}"
    elif not alone:
        give = f"{declared.name} in {si}, or {other}"
    label = unit_label(unit)
    found = f"{meant}{label}" if label == "°" else f"{meant} {label}"
    return f"found {meant} {si}, expected at most {most}: a name alone is in {si}. If {found} is meant, give {give}."


def refuse_tiny(declared: Quantity, value: Any, error: type[RobomillError], who: str) -> None:
    """Raises ``error`` where a ``value`` (SI) that was given in its unit of the edge was certainly meant in SI: too
    small to be anything, or an angle that is a part of pi to four digits and more."""
    if value is None:
        return
    sizes = np.abs(np.array(list(value.values()) if isinstance(value, Mapping) else value, dtype=np.float64))
    largest = float(sizes.max(initial=0.0))
    if not math.isfinite(largest):
        return  # what is no number is refused where it is settled
    tiny = 0.0 < largest < (declared.tiny or 0.0) and (sizes.size > 1 or not declared.extent)
    degrees = float(from_si(largest, "deg"))
    radians = in_radians(degrees) or (declared.quarters and in_quarters(degrees))
    if not (tiny or (declared.unit == "deg" and radians)):
        return
    if beside():
        least = f"at least {declared.short(declared.tiny)}" if tiny else f"an angle in degrees; {_in_degrees(largest)}"
        raise error(f"{declared.said_of(who)}: found {declared.short(largest)}; expected {least}.", where=declared.name)
    unit, si = unit_label(declared.unit), SI_NAMES[declared.unit]
    sign = "-" if sizes.ndim == 0 and value < 0.0 else ""
    found, meant = f"{sign}{float(from_si(largest, declared.unit)):.6g}", f"{sign}{largest:.6g}"
    least = f", expected at least {from_si(declared.tiny or 0.0, declared.unit):.3g}" if tiny else ""
    space = "" if unit == "°" else " "
    other, right = name_in_code(declared), f"{float(from_si(float(found), declared.unit)):.5g}"
    give = (declared.name, other) if sizes.ndim else (f"{declared.name}={found}", f"{other}={right}")
    really = f"{declared.name}{'' if sizes.ndim else '=' + meant}"
    raise error(
        f"{declared.said_of(who)}: found {found}{space}{unit}{least}: {other} is in {unit or si}. If {found} {si} is "
        f"meant, give {give[0]} or {give[1]}; if {found}{space}{unit} is, give {really} in {si}.",
        where=declared.name,
    )


def in_radians(angle: float) -> bool:
    """Whether a number of degrees is one of radians: a multiple of 15 degrees to four digits and more (1.5708)."""
    parts = angle / to_si(15.0, "deg")
    return 0.5 < parts < 24.5 and abs(angle - round(parts) * to_si(15.0, "deg")) < 5.1e-5 and angle != round(angle, 3)


def in_quarters(angle: float) -> bool:
    """Whether a number of degrees is one of radians, to two digits: a quarter turn or several (1.57, 3.14, 6.28)."""
    parts = round(angle / to_si(90.0, "deg"))
    return parts > 0 and abs(angle - round(parts * to_si(90.0, "deg"), 2)) < 1e-9


def _in_degrees(largest: float) -> str:
    """What an angle (rad) whose degrees are a number of radians would be, for people."""
    number = float(from_si(largest, "deg"))
    return f"{number:.6g} rad are {float(from_si(number, 'deg')):.5g}°"


def state(value: Any) -> dict[str, Any]:
    """The fields of a dataclass by their names."""
    return {each.name: getattr(value, each.name) for each in fields(value)}


class Replaceable:
    """A frozen dataclass of which changed copies are made; each is checked as a new one."""

    def replace(self, **changes: Any) -> Self:
        """A checked copy with fields changed: ``tolerance=2e-4``, or ``tolerance_mm=0.2``."""
        cls, who = type(self), f"{type(self).__name__}.replace"
        refuse_unknown(changes, inspect.signature(cls).parameters, who)
        with kinds_told(cls.__init__, who, changes):
            return made(cls, state(self) | self._taken(in_si(cls, changes)))

    def _taken(self, changes: dict[str, Any]) -> dict[str, Any]:
        """Changes by the names of the fields."""
        return changes
