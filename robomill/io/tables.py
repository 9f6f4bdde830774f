"""TOML tables read with care: every key asked for by name and unit, every unknown key refused."""

from __future__ import annotations

import json
import math
import re
import tomllib
from collections.abc import Mapping, Sequence
from decimal import Decimal
from typing import Any

import numpy as np

from robomill.arrays import FloatArray
from robomill.errors import ProjectError, RobomillError
from robomill.provenance import KINDS, Provenance
from robomill.units import decimal_from_si, decimal_to_si, from_si, to_si

MISSING: Any = object()  # a key without a default has to be there
# Of a path of Windows in double quotes, whose \U begins a character.
PATHS = "A path is written with / or in single quotes, as 'C:\\Users\\...'."
DEEPEST = 12  # tables and lists within one another; what is written here has six
LARGEST = 2**63  # TOML's own bound of whole numbers
FLOATS = 17  # digits that any float is told by
_DOTTED = re.compile(r"""(?<![\w-])(?>(?:[\w-]++|"[^"\n]*+"|'[^'\n]*+')[ \t]*+\.[ \t]*+){64}""")


def parse_toml(text: str, where: str, error: type[RobomillError] = ProjectError, exact: bool = False) -> dict[str, Any]:
    """The document, or a refusal naming the line that is not TOML, or the key that is too deep or too large.

    ``exact``: a number with more digits than a float holds keeps them, as a Decimal, until a Table has it in SI.
    """
    try:
        if _DOTTED.search(text):  # reading one takes as long as the square of its parts
            raise ValueError
        data = tomllib.loads(text, parse_float=_number if exact else float)
    except tomllib.TOMLDecodeError as exc:
        path = f" {PATHS}" if "hex value" in str(exc) or "\\" in str(exc) else ""
        raise error(f"{where}: this is not a readable TOML file: {exc}.{path}", where=where) from None
    except (RecursionError, ValueError):
        raise error(
            f"{where}: this is not a readable TOML file: a number is too long, or lists stand too deep in one another.",
            where=where,
        ) from None
    _check_values(data, where, error)
    return data


def _number(text: str) -> float | Decimal:
    digits = "".join(filter(str.isdigit, text.lower().partition("e")[0])).lstrip("0")
    return Decimal(text) if len(digits) > FLOATS else float(text)


def _check_values(data: dict[str, Any], where: str, error: type[RobomillError]) -> None:
    """Refuse what no key can hold, before anything is made of it."""
    level: list[tuple[str, Any]] = list(data.items())
    for _ in range(DEEPEST):
        for key, value in level:
            if type(value) is int and not -LARGEST <= value < LARGEST:
                raise error(f"{where}, {key:.60}: a whole number is too large; expected fewer digits.", where=where)
        lists = ((key, item) for key, value in level if isinstance(value, list) for item in value)
        tables = (pair for _, value in level if isinstance(value, dict) for pair in value.items())
        level = [*lists, *tables]
        if not level:
            return
    raise error(f"{where}, {level[0][0]:.60}: tables and lists stand more than {DEEPEST} deep.", where=where)


def exactly(value: float, unit: str) -> float | None:
    """The value in ``unit`` with as few digits as read back to the very same SI number; None where no number does."""
    full = float(from_si(float(value), unit))
    for digits in range(1, 18):
        short = float(f"{full:.{digits}g}")
        if to_si(short, unit) == value:
            return short
    return None


def shown(value: float, unit: str) -> float | Decimal:
    """The value in ``unit`` with as few digits as read back to the very same SI number."""
    found = exactly(value, unit)
    if found is None and math.isfinite(value):
        return decimal_from_si(float(value), unit)
    return float(value) if found is None else found


def toml_value(value: Any) -> str:
    """A text, a number or a list of numbers as TOML on one line."""
    if isinstance(value, Decimal):
        return str(value)
    if isinstance(value, list):
        return f"[{', '.join(map(toml_value, value))}]"
    # JSON writes these as TOML does, but for one character that TOML wants escaped.
    return json.dumps(value, ensure_ascii=False).replace("\x7f", "\\u007F")


class Table:
    """One table of a file. ``where`` is how a refusal names it: "setup.toml, [force]"."""

    def __init__(self, data: Any, where: str, error: type[RobomillError] = ProjectError) -> None:
        if not isinstance(data, Mapping):
            raise error(f"{where}: expected a table of keys, found {data!r:.40}.", where=where)
        self.data = dict(data)
        self.where = where
        self.error = error
        self.asked: set[str] = set()

    def refuse(self, key: str, message: str) -> RobomillError:
        return self.error(f"{self.where}, {key}: {message}", where=f"{self.where}, {key}")

    def _get(self, key: str, default: Any) -> Any:
        self.asked.add(key)
        if key in self.data:
            return self.data[key]
        if default is MISSING:
            raise self.refuse(key, "missing; add it.")
        return default

    def has(self, key: str) -> bool:
        return key in self.data

    def text(self, key: str, default: Any = MISSING) -> str:
        value = self._get(key, default)
        if value is not default and not isinstance(value, str):
            raise self.refuse(key, f"expected text in quotes, found {value!r:.40}.")
        return value  # type: ignore[no-any-return]

    def words(self, key: str) -> list[str]:
        """A list of texts; empty where it is absent."""
        value = self._get(key, [])
        if not isinstance(value, list) or not all(isinstance(item, str) for item in value):
            raise self.refuse(key, f"expected a list of texts, found {value!r:.40}.")
        return value

    def choice(self, key: str, allowed: Sequence[str], default: Any = MISSING) -> str:
        """One of the codes ``allowed``."""
        code = self.text(key, default)
        if code not in allowed:
            raise self.refuse(key, f"expected one of {', '.join(allowed)}, found {code!r:.40}.")
        return code

    def flag(self, key: str, default: bool) -> bool:
        value = self._get(key, default)
        if not isinstance(value, bool):
            raise self.refuse(key, f"expected true or false, found {value!r:.40}.")
        return value

    def flags(self, key: str) -> list[bool]:
        """A list of true and false."""
        value = self._get(key, MISSING)
        if not isinstance(value, list) or not all(isinstance(item, bool) for item in value):
            raise self.refuse(key, f"expected a list of true and false, found {value!r:.40}.")
        return value

    def whole(self, key: str, default: Any = MISSING) -> int:
        value = self._get(key, default)
        if isinstance(value, bool) or not isinstance(value, int) or not -LARGEST <= value < LARGEST:
            raise self.refuse(key, f"expected a whole number, found {value!r:.40}.")
        return value

    def wholes(self, key: str, default: Any = MISSING) -> Any:
        """A list of whole numbers (``default`` as it is)."""
        value = self._get(key, default)
        if value is not default and not (isinstance(value, list) and all(type(item) is int for item in value)):
            raise self.refuse(key, f"expected a list of whole numbers, found {value!r:.40}.")
        return value

    def number(self, key: str, unit: str, default: Any = MISSING) -> Any:
        """The value in SI (``default`` is returned as it is)."""
        value = self._get(key, default)
        return value if value is default else self.si(key, value, unit)

    def numbers(self, key: str, count: int | None, unit: str, default: Any = MISSING, expected: str = "") -> Any:
        """``count`` (None: any) values in SI as a list (``default`` as it is); a refusal says ``expected``."""
        value = self._get(key, default)
        if value is default:
            return value
        if not isinstance(value, list) or len(value) != (len(value) if count is None else count):
            found = f"{len(value)}: {value!r:.60}" if isinstance(value, list) else f"{value!r:.60}"
            many = "" if count is None else f"{count} "
            raise self.refuse(key, f"expected {expected or f'a list of {many}numbers'}, found {found}.")
        return [self.si(key, item, unit) for item in value]

    def rows(self, key: str, count: int, unit: str, many: int | None = None) -> FloatArray:
        """A list of ``many`` (None: any) lists of ``count`` numbers, in SI, as (r, count)."""
        value = self._get(key, MISSING)
        if not isinstance(value, list) or not value:
            raise self.refuse(key, f"expected a list of rows of {count} numbers, found {value!r:.60}.")
        for i, row in enumerate(value):
            if not isinstance(row, list) or len(row) != count:
                raise self.refuse(key, f"row {i + 1}: expected {count} numbers, found {row!r:.60}.")
        if many is not None and len(value) != many:
            raise self.refuse(key, f"expected {many} rows of {count} numbers, found {len(value)} rows.")
        return np.array([[self.si(key, item, unit) for item in row] for row in value])

    def measure(self, stem: str, suffixes: Mapping[str, str], default: Any = MISSING) -> Any:
        """A number in SI written as ``stem_<suffix>``; ``suffixes`` maps what may stand in the key to its unit."""
        key = self._spelled(stem, suffixes, default)
        return default if key is None else self.number(key, suffixes[key.removeprefix(f"{stem}_")])

    def measures(self, stem: str, suffixes: Mapping[str, str], count: int, default: Any, expected: str) -> Any:
        """``count`` numbers in SI written as ``stem_<suffix>``, as ``numbers`` gives them."""
        key = self._spelled(stem, suffixes, default)
        if key is None:
            return default
        return self.numbers(key, count, suffixes[key.removeprefix(f"{stem}_")], expected=expected)

    def _spelled(self, stem: str, suffixes: Mapping[str, str], default: Any) -> str | None:
        """The one key of ``stem`` that is there; None where there is none and need not be."""
        keys = [f"{stem}_{suffix}" for suffix in suffixes]
        self.asked.update(keys)
        found = [key for key in keys if key in self.data]
        if len(found) > 1:
            raise self.refuse(stem, f"it is given twice, as {' and '.join(found)}; keep one.")
        if not found and default is MISSING:
            near = [f", not {key}" for key in self.data if key.startswith(f"{stem}_")]
            raise self.error(f"{self.where}: {stem} is missing; give {' or '.join(keys)}{''.join(near[:1])}.")
        return found[0] if found else None

    def table(self, key: str, default: Any = MISSING) -> Table:
        name = self.where.removesuffix("]") + f".{key}]" if self.where.endswith("]") else f"{self.where}, [{key}]"
        return Table(self._get(key, default), name, self.error)

    def tables(self, key: str) -> list[Table]:
        """The entries of an array of tables, [[key]]; none where it is absent."""
        entries = self._get(key, [])
        if not isinstance(entries, list):
            raise self.refuse(key, f"expected entries written as [[{key}]], found {entries!r:.40}.")
        return [Table(entry, f"{self.where}, {key} {i}", self.error) for i, entry in enumerate(entries, start=1)]

    def provenance(self, key: str) -> Provenance:
        """An entry ``{ kind = "paper", source = "..." }``."""
        entry = self.table(key)
        kind = entry.choice("kind", KINDS)
        source, carried_from = entry.text("source"), entry.text("carried_from", "")
        entry.finish()
        return Provenance(kind, source, carried_from)  # type: ignore[arg-type]

    def si(self, key: str, value: Any, unit: str) -> float:
        """A ``value`` that stands under ``key``, in SI."""
        label = "" if unit == "1" else f" in {unit}"
        if isinstance(value, bool) or not isinstance(value, int | float | Decimal):
            raise self.refuse(key, f"expected a number{label}, found {value!r:.40}.")
        plain = float(value) if isinstance(value, Decimal) else value
        if not abs(plain) < math.inf or (isinstance(plain, int) and abs(plain) > LARGEST):
            raise self.refuse(key, f"expected a finite number{label}, found {value!r:.40}.")
        try:
            converted = decimal_to_si(value, unit) if isinstance(value, Decimal) else float(to_si(float(value), unit))
        except ArithmeticError:
            converted = math.inf
        if not math.isfinite(converted):
            raise self.refuse(key, f"expected a number{label} of ordinary size, found {value}.")
        return converted

    def finish(self) -> None:
        """Refuse keys nobody asked for: a misspelt key must not be silently ignored."""
        unknown = sorted(set(self.data) - self.asked)
        if unknown:
            known = ", ".join(sorted(self.asked))
            raise self.refuse(unknown[0], f"this key is not known here; known are: {known}.")
