"""TOML tables read with care: every key asked for by name and unit, every unknown key refused."""

from __future__ import annotations

import math
import tomllib
from collections.abc import Mapping
from typing import Any

import numpy as np

from robomill.arrays import FloatArray
from robomill.errors import ProjectError, RobomillError
from robomill.provenance import KINDS, Provenance
from robomill.units import from_si, to_si

_MISSING: Any = object()


def parse_toml(text: str, where: str) -> dict[str, Any]:
    """The document, or a ProjectError naming the line that is not TOML."""
    try:
        return tomllib.loads(text)
    except tomllib.TOMLDecodeError as exc:
        raise ProjectError(f"{where}: this is not a readable TOML file: {exc}.", where=where) from None


def shown(value: float, unit: str) -> float:
    """The value in ``unit`` with as few digits as read back to the very same SI number."""
    exact = float(from_si(float(value), unit))
    for digits in range(1, 18):
        short = float(f"{exact:.{digits}g}")
        if to_si(short, unit) == value:
            return short
    for near in (exact, np.nextafter(exact, -np.inf), np.nextafter(exact, np.inf)):
        if to_si(float(near), unit) == value:
            return float(near)
    return exact


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
        if default is _MISSING:
            raise self.refuse(key, "missing; add it.")
        return default

    def has(self, key: str) -> bool:
        return key in self.data

    def text(self, key: str, default: Any = _MISSING) -> str:
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

    def flag(self, key: str, default: bool) -> bool:
        value = self._get(key, default)
        if not isinstance(value, bool):
            raise self.refuse(key, f"expected true or false, found {value!r:.40}.")
        return value

    def whole(self, key: str, default: Any = _MISSING) -> int:
        value = self._get(key, default)
        if isinstance(value, bool) or not isinstance(value, int):
            raise self.refuse(key, f"expected a whole number, found {value!r:.40}.")
        return value

    def number(self, key: str, unit: str, default: Any = _MISSING) -> Any:
        """The value in SI (``default`` is returned as it is)."""
        value = self._get(key, default)
        return value if value is default else self._si(key, value, unit)

    def numbers(self, key: str, count: int, unit: str, default: Any = _MISSING) -> Any:
        """``count`` values in SI as a list (``default`` is returned as it is)."""
        value = self._get(key, default)
        if value is default:
            return value
        if not isinstance(value, list) or len(value) != count:
            raise self.refuse(key, f"expected a list of {count} numbers, found {value!r:.60}.")
        return [self._si(key, item, unit) for item in value]

    def rows(self, key: str, count: int, unit: str) -> FloatArray:
        """A list of lists of ``count`` numbers, in SI, as (r, count)."""
        value = self._get(key, _MISSING)
        if not isinstance(value, list) or not value:
            raise self.refuse(key, f"expected a list of rows of {count} numbers, found {value!r:.60}.")
        for i, row in enumerate(value):
            if not isinstance(row, list) or len(row) != count:
                raise self.refuse(key, f"row {i + 1}: expected {count} numbers, found {row!r:.60}.")
        return np.array([[self._si(key, item, unit) for item in row] for row in value])

    def table(self, key: str, default: Any = _MISSING) -> Table:
        name = self.where.removesuffix("]") + f".{key}]" if self.where.endswith("]") else f"{self.where}, [{key}]"
        return Table(self._get(key, default), name, self.error)

    def tables(self, key: str) -> list[Table]:
        """The entries of an array of tables, [[key]]; none where it is absent."""
        entries = self._get(key, [])
        if not isinstance(entries, list):
            raise self.refuse(key, f"expected entries written as [[{key}]], found {entries!r:.40}.")
        return [Table(entry, f"{self.where}, [[{key}]] {i}", self.error) for i, entry in enumerate(entries, start=1)]

    def provenance(self, key: str) -> Provenance:
        """An entry ``{ kind = "paper", source = "..." }``."""
        entry = self.table(key)
        kind = entry.text("kind")
        if kind not in KINDS:
            raise entry.refuse("kind", f"expected one of {', '.join(KINDS)}, found {kind!r:.40}.")
        source = entry.text("source")
        entry.finish()
        return Provenance(kind, source)  # type: ignore[arg-type]

    def _si(self, key: str, value: Any, unit: str) -> float:
        if isinstance(value, bool) or not isinstance(value, int | float):
            raise self.refuse(key, f"expected a number in {unit}, found {value!r:.40}.")
        if not math.isfinite(value):
            raise self.refuse(key, f"expected a finite number in {unit}, found {value}.")
        return float(to_si(float(value), unit))

    def finish(self) -> None:
        """Refuse keys nobody asked for: a misspelt key must not be silently ignored."""
        unknown = sorted(set(self.data) - self.asked)
        if unknown:
            known = ", ".join(sorted(self.asked))
            raise self.refuse(unknown[0], f"this key is not known here; known are: {known}.")
