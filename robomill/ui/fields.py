"""Fields of nested frozen values by a written path: ``"cutter.diameter"``, ``"force.vector_M[1]"``, ``"T_MW[0,3]"``."""

from __future__ import annotations

import dataclasses
import re
from typing import Any

import numpy as np

_PART = re.compile(r"(?P<name>\w+)(?:\[(?P<index>[\d,\s]+)\])?$")


def read(value: Any, path: str) -> Any:
    """The field at ``path`` of a (nested) dataclass; an index picks one number of an array."""
    for part in path.split("."):
        name, index = _split(part)
        value = getattr(value, name)
        if index is not None:
            value = np.asarray(value)[index].item()
    return value


def write(value: Any, path: str, new: Any) -> Any:
    """A copy of ``value`` with the field at ``path`` replaced; every level is checked again by its own class."""
    first, _, rest = path.partition(".")
    name, index = _split(first)
    if rest:
        new = write(getattr(value, name), rest, new)
    elif index is not None:
        array = np.array(getattr(value, name), dtype=float)
        array[index] = new
        new = array
    if hasattr(value, "replace"):
        return value.replace(**{name: new})
    return dataclasses.replace(value, **{name: new})


def _split(part: str) -> tuple[str, tuple[int, ...] | None]:
    match = _PART.match(part)
    if match is None:
        raise KeyError(f"not a field path: {part!r}")
    index = match["index"]
    return match["name"], None if index is None else tuple(int(i) for i in index.split(","))
