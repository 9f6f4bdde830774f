"""Numbers as people type them: the one reader of every box, cell and pasted row, and the one writer of what it read.

Decimal comma or point, exponents (``7,14E-7``, ``7.14·10^-7``), thousands with blanks or apostrophes, true minus signs,
fractions (``1/16``, ``1 1/2``), and a unit behind the number. What can be read in two ways is not read at all: one
comma before exactly three digits is a decimal mark to some and parts thousands to others.
"""

import math
import re
import unicodedata
from collections.abc import Callable
from dataclasses import dataclass

from robomill.errors import NumberError
from robomill.unit_words import alike, meaning, measure, raised
from robomill.units import rounded, unit_label
from robomill.wording import DASHES, listed

SI_BELOW, NOTHING = 1e-3, 1e-12
SHOWN, GIVEN = 6, 10  # significant digits of what was computed, and of what somebody gave
_SAME = str.maketrans(
    dict.fromkeys(DASHES, "-")
    | dict.fromkeys("’ʼ′", "'")
    | dict.fromkeys("\u200b\u200e\u200f\u2060\ufeff")  # of no width
    | {"⁄": "/", "\t": " "}
)
_FRACTION = re.compile(r"([+-]?) ?(?:(\d{1,9}) )?([1-9]\d{0,8}) ?/ ?([1-9]\d{0,8})(?![\d.,'/])")
_NUMBER = re.compile(
    r"(?P<sign>[+-]?) ?"
    r"(?:10(?:\^|\*\*)(?P<power>[+-]?\d+)|(?P<body>\d+(?:[ ']\d{3}(?![\d/]))*[\d.,]*|[.,]\d+)"
    r"(?:e(?P<e>[+-]?\d+)| ?[·⋅×*x] ?10(?:\^|\*\*)(?P<ten>[+-]?\d+))?)(?![\d.,'])",
    re.IGNORECASE,
)
_PLAIN = re.compile(r"[+-]?(\d+(?:\.\d*)?|\.\d+)(e[+-]?\d+)?", re.IGNORECASE)
_GROUPED = re.compile(r"\d{1,3}(?P<mark>[ '])\d{3}((?P=mark)\d{3})*([.,]\d*)?")
_PARTED = re.compile(r"[1-9]\d{0,2}(?P<mark>[.,])\d{3}((?P=mark)\d{3})*(?P<rest>(?!(?P=mark))[.,]\d*)?")
_EITHER = re.compile(r"[+-]?[1-9]\d{0,2},\d{3}")
_HALF = re.compile(r"(?<=\d)(?=[¼½¾⅐-⅞])")


@dataclass(frozen=True)
class TypedNumber:
    """A number in the unit of its field; ``plain``: written as a program would; ``converted``: not the one typed."""

    value: float
    plain: bool = True
    converted: bool = False


def read_number(text: str, unit: str = "1") -> TypedNumber:
    """What ``text`` means in a field of ``unit``, a key of ``UNITS``.

    In a unit with a power of ten ("1e-7 rad/(N m)") a small number with an exponent is meant without that power:
    7.14e-7 is what the field calls 7.14. Raises NumberError with what was found and what to type.
    """
    given, line = text.strip(), _on_one_line(text)
    fraction = _FRACTION.match(line)
    found = fraction or _NUMBER.match(line)
    behind = line[found.end() :].strip() if found else ""
    if found is None or (behind and not re.search(r'[^\W\d_]|[%°"]', behind)):
        raise NumberError(f"found {given!r:.40}, expected {_expected(unit)}.")
    number = _fraction(fraction, given, unit) if fraction else _number(found, line, unit)
    if not math.isfinite(number):
        raise NumberError(f"found {given!r:.40}, expected {_expected(unit)} that is finite.")
    if behind:
        value = _from(number, behind, given, unit)
    elif unit.startswith("1e-") and not fraction and found.group("e", "ten", "power") != (None,) * 3:
        value = rounded(number / measure(unit).factor, 15) if abs(number) < SI_BELOW else number
    else:
        value = number
    return TypedNumber(value, _PLAIN.fullmatch(given) is not None, value != number or fraction is not None)


def plain_number(text: str, kind: Callable[[str], float] = float) -> float:
    """What ``kind`` makes of a text that a program or a file gives. Raises ValueError for what is no number, ``1_0``
    with it: ten to Python, and a slip to everybody else."""
    if "_" in text:
        raise ValueError(text)
    return kind(text)


def either_way(number: str, text: str) -> str:
    """How a ``number`` with one comma is read in two ways, told of the whole ``text``; "" where it is not."""
    if not _EITHER.fullmatch(number):
        return ""
    return f"{text.replace(',', '.')} to some and {text.replace(',', '')} to others"


def write_number(value: float, decimals: int | None = None) -> str:
    """A number to be typed over: with so many ``decimals`` or, where that is not all of it, with all that it was given.

    What a conversion computed has no end of digits: it keeps to the decimals where they say it, else to six digits.
    """
    shown = 0.0 if abs(value) < NOTHING else float(f"{value:.{GIVEN}g}")
    given = shown in (0.0, value) or abs(shown - value) <= 1e-12 * abs(value)
    if decimals is not None and abs(shown) < 10.0**GIVEN:
        fixed = f"{shown:.{decimals}f}"
        if float(fixed) == shown or (not given and abs(shown) >= 10.0 ** (2 - decimals)):
            return fixed
    return f"{shown if given else float(f'{value:.{SHOWN}g}'):.{GIVEN}g}"


def _on_one_line(text: str) -> str:
    """The text with one kind of blank, minus, apostrophe and digit, and with its superscripts on the line."""
    line = unicodedata.normalize("NFKC", _HALF.sub(" ", raised(text))).translate(_SAME)
    return " ".join(line.replace("''", '"').split())


def _expected(unit: str) -> str:
    return f"a number in {unit_label(unit)}" if unit_label(unit) else "a number"


def _fraction(found: re.Match[str], given: str, unit: str) -> float:
    sign, whole, over, under = found.groups()
    if whole and int(over) >= int(under):
        raise NumberError(f"found {given!r:.40}, expected {_expected(unit)}, or a fraction such as 1/16 or 1 1/2.")
    return float(f"{sign}1") * (int(whole or 0) + int(over) / int(under))


def _number(found: re.Match[str], line: str, unit: str) -> float:
    exponent = found["e"] or found["ten"] or found["power"] or "0"
    return float(f"{found['sign']}{_digits(found['body'] or '1', line, unit)}e{exponent}")


def _digits(body: str, line: str, unit: str) -> str:
    """The digits with a decimal point and nothing else between them. Raises NumberError."""
    marks = [mark for mark in body if mark in ".,"]
    if " " in body or "'" in body:
        if not _GROUPED.fullmatch(body):
            raise NumberError(f"found {line!r:.40}, expected {_expected(unit)}, its thousands in groups of three.")
        return body.replace(" ", "").replace("'", "").replace(",", ".")
    if ways := either_way(body, line):
        raise NumberError(f"found {line!r:.40}, which is {ways}: type it in one of these two ways.")
    if len(marks) < 2:
        return body.replace(",", ".")
    parted = _PARTED.fullmatch(body)
    if not parted:
        raise NumberError(f"found {line!r:.40}, expected {_expected(unit)} with one decimal mark.")
    return body.replace(parted["mark"], "").replace(",", ".")


def _from(number: float, behind: str, given: str, unit: str) -> float:
    """The number in ``unit`` that was given in the unit ``behind`` it."""
    own, other = measure(unit), meaning(behind)
    if other is None or other.dimensions != own.dimensions:
        known = [*([unit_label(unit)] if unit_label(unit) else []), *alike(unit)]
        wanted = listed(known, "or") or "no unit"
        raise NumberError(f"found {given!r:.40}, expected a number in {wanted}; {behind!r:.20} is no such unit.")
    return number if other.same(own) else rounded(number * other.factor / own.factor, 15)
