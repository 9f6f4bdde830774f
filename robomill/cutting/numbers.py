"""The numbers that a force is computed from, one by one: what is not known exactly, and the same with one changed."""

from dataclasses import dataclass, replace
from typing import Any, TypeVar

import numpy as np

from robomill.quantities import Quantity, quantities

T = TypeVar("T")


@dataclass(frozen=True)
class Number:
    """A number by its ``key``, with ``label`` and ``unit``; ``value`` in SI."""

    key: str
    label: str
    unit: str
    value: float


def numbers_of(holder: Any) -> list[Number]:
    """The declared numbers of ``holder``, arrays by their entries; what is not given or 0 is left out."""
    declared = [each for each in quantities(type(holder)).values() if each.kind in ("number", "array")]
    given = [(each, getattr(holder, each.name)) for each in declared]
    return [one for each, value in given if value is not None for one in _entries(each, value) if one.value]


def with_number(holder: T, key: str, by: float) -> T:
    """``holder`` with the number called ``key`` changed ``by`` so much; itself where it has none."""
    declared, (name, _, entry) = quantities(type(holder)), key.rpartition("_")
    if key in declared:
        return replace(holder, **{key: getattr(holder, key) + by})  # type: ignore[type-var]
    if name in declared:
        values = np.array(getattr(holder, name))
        values[int(entry)] += by
        return replace(holder, **{name: values})  # type: ignore[type-var]
    return holder


def _entries(declared: Quantity, value: Any) -> list[Number]:
    """A field, or each entry of an array."""
    if declared.kind == "number":
        label = declared.label if declared.unit != "N" else f"Force, {declared.label.lower()}"
        return [Number(declared.name, label, declared.unit, float(value))]
    names = list(declared.axes) or [str(i) for i in range(len(value))]
    return [
        Number(f"{declared.name}_{i}", f"{declared.label}_{n}", declared.unit, float(v))
        for i, (n, v) in enumerate(zip(names, value))
    ]
