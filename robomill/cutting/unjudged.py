"""Steps whose force has no model: they are said, counted, and never green."""

from __future__ import annotations

from dataclasses import dataclass

from robomill.arrays import BoolArray


@dataclass(frozen=True, eq=False)
class Unjudged:
    """Steps ``where`` (m,) that are not judged, for one reason: its ``code``, and ``why`` in words for people."""

    code: str
    where: BoolArray
    why: str
