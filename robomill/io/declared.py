"""Values of declared classes as TOML tables: every quantity under its own key, every other field by its type's codec.

``to_table`` writes each quantity (None only where files have a number for it); a field of another type is written
where it differs from its default. A type without a codec is not in the file: ``given`` must bring it.
"""

from collections.abc import Callable, Mapping
from dataclasses import MISSING, dataclass, field, fields
from typing import Any, TypeVar

import numpy as np

from robomill.errors import RobomillError
from robomill.io.beside import ALONE, Beside
from robomill.io.tables import Table, shown
from robomill.provenance import Provenance
from robomill.quantities import Quantity, declared_types, quantities
from robomill.spelled import made

T = TypeVar("T")


@dataclass(frozen=True)
class Around:
    """What a codec may need beside its own keys: the files that may be named, and the fields known so far."""

    beside: Beside = ALONE
    known: Mapping[str, Any] = field(default_factory=dict)


@dataclass(frozen=True)
class Codec:
    """How fields of one type stand in a table: under which keys (``"{name}"`` is the field's), read and written.

    A codec without keys finds its value from what is ``Around``.
    """

    keys: tuple[str, ...]
    read: Callable[[Table, str, Around], Any]
    write: Callable[[str, Any], dict[str, Any]]

    def keys_of(self, name: str) -> tuple[str, ...]:
        return tuple(key.format(name=name) for key in self.keys)


CODECS: dict[Any, Codec] = {
    str: Codec(("{name}",), lambda table, name, _: table.text(name), lambda name, text: {name: text}),
    tuple[str, ...]: Codec(
        ("{name}",), lambda table, name, _: tuple(table.words(name)), lambda name, words: {name: list(words)}
    ),
    tuple[int, ...]: Codec(
        ("{name}",), lambda table, name, _: tuple(table.wholes(name)), lambda name, numbers: {name: list(numbers)}
    ),
    Provenance: Codec(
        ("source",),
        lambda table, name, _: table.provenance("source"),
        lambda name, value: {"source": {"kind": value.kind, "source": value.source}},
    ),
}


def from_table(
    table: Table,
    cls: type[T],
    *,
    given: Mapping[str, Any] | None = None,
    codecs: Mapping[Any, Codec] = CODECS,
    beside: Beside = ALONE,
) -> T:
    """A value of ``cls`` from ``table``; refuses keys that are not its own. ``given`` are fields from elsewhere."""
    known = dict(given or {})
    for name, declared in quantities(cls).items():
        if name not in known:
            known[name] = read_quantity(table, declared)
    absent = {each.name for each in fields(cls) if each.default is not MISSING}  # type: ignore[arg-type]
    for name, kind in declared_types(cls).items():
        codec = codecs.get(kind)
        if name in known or codec is None:
            continue
        keys = codec.keys_of(name)
        if not keys or name not in absent or any(table.has(key) for key in keys):
            known[name] = codec.read(table, name, Around(beside, known))
        table.asked.update(keys)
    table.finish()
    try:
        return made(cls, known)
    except RobomillError as refused:
        raise _placed(refused, table, cls) from None


def _placed(refused: RobomillError, table: Table, cls: type) -> RobomillError:
    """What a value of ``cls`` refuses, with the table and the key of the field it names before it."""
    declared = quantities(cls).get(refused.where or "")
    place = table.where if declared is None else f"{table.where}, {declared.key}"
    return type(refused)(f"{place}: {refused}", where=refused.where)


def to_table(value: Any, codecs: Mapping[Any, Codec] = CODECS) -> dict[str, Any]:
    """The table that ``from_table`` reads back to an equal value."""
    out: dict[str, Any] = {}
    for name, declared in quantities(type(value)).items():
        written = write_quantity(declared, getattr(value, name))
        if written is not None:
            out[declared.key] = written
    defaults = {each.name: each.default for each in fields(value)}
    for name, kind in declared_types(type(value)).items():
        codec = codecs.get(kind)
        found, default = getattr(value, name), defaults[name]
        if codec is not None and not (found is default or (np.ndim(found) == 0 and found == default)):
            out |= codec.write(name, found)
    return out


def kind_from_table(table: Table, kinds: Mapping[str, type[T]]) -> T:
    """A value of the class that ``kind`` names."""
    return from_table(table, kinds[table.choice("kind", tuple(kinds))])


def kind_to_table(value: Any, codecs: Mapping[Any, Codec] = CODECS) -> dict[str, Any]:
    """The table that reads back to an equal value of its kind."""
    return {"kind": value.kind, **to_table(value, codecs)}


def read_quantity(table: Table, declared: Quantity) -> Any:
    """The declared number in SI (array, flag, code), or its default where it may be left out."""
    key = declared.key
    if not declared.needed and not table.has(key):
        table.asked.add(key)
        return declared.default
    value = _READERS[declared.kind](table, declared)
    return None if declared.written_none is not None and value == declared.written_none else value


def write_quantity(declared: Quantity, value: Any) -> Any:
    """The value as TOML holds it, in the unit of its key; None where the key is left out."""
    if value is None:
        return declared.written_none
    if declared.kind == "number":
        return shown(value, declared.unit)
    if declared.kind == "array":
        flat = np.array([shown(number, declared.unit) for number in np.ravel(value)], dtype=object)
        return flat.reshape(np.shape(value)).tolist()
    return value


def _array(table: Table, declared: Quantity) -> Any:
    length, *rest = declared.shape
    if rest:
        return table.rows(declared.key, int(rest[0] or 0), declared.unit)
    return np.array(table.numbers(declared.key, length, declared.unit))


_READERS: dict[str, Callable[[Table, Quantity], Any]] = {
    "number": lambda table, declared: table.number(declared.key, declared.unit),
    "whole": lambda table, declared: table.whole(declared.key),
    "switch": lambda table, declared: table.flag(declared.key, False),
    "array": _array,
    "choice": lambda table, declared: table.choice(declared.key, tuple(declared.options)),
}
