"""Force models to and from the [force] table of a set-up."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np

from robomill.cutting.force import ConstantForce, ForceModel, PathForce
from robomill.cutting.tool import Cutter
from robomill.io.tables import Table

KINDS = ("constant", "path", "mechanistic", "kienzle", "measured")


def force_from_table(table: Table, cutter: Cutter, folder: Path | None = None) -> ForceModel:
    """The model that [force] names by ``kind``; files are looked for in ``folder``."""
    kind = table.text("kind")
    reader = _READERS.get(kind)
    if reader is None:
        raise table.refuse("kind", f"expected one of {', '.join(_READERS)}, found {kind!r:.40}.")
    model = reader(table, cutter, folder)
    table.finish()
    return model


def _constant(table: Table, cutter: Cutter, folder: Path | None) -> ForceModel:
    return ConstantForce(np.array(table.numbers("vector_N", 3, "N")))


def _path(table: Table, cutter: Cutter, folder: Path | None) -> ForceModel:
    return PathForce(
        feed=table.number("feed_N", "N", 0.0),
        feed_normal=table.number("feed_normal_N", "N", 0.0),
        axial=table.number("axial_N", "N", 0.0),
    )


_READERS: dict[str, Callable[[Table, Cutter, Path | None], ForceModel]] = {"constant": _constant, "path": _path}


def force_to_table(force: ForceModel) -> dict[str, Any]:
    """The model as a table that ``force_from_table`` reads back to an equal one."""
    if isinstance(force, ConstantForce):
        return {"kind": "constant", "vector_N": force.vector_M.tolist()}
    if isinstance(force, PathForce):
        return {"kind": "path", "feed_N": force.feed, "feed_normal_N": force.feed_normal, "axial_N": force.axial}
    raise TypeError(f"no table for a force of type {type(force).__name__}")
