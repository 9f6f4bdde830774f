"""One row of the reproduction table, and the table as columns and as a sentence."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

Status = Literal["reproduced", "assumed", "gap", "not computed"]
WORDS: dict[Status, str] = {
    "reproduced": "reproduced",
    "assumed": "reproduced with the assumed lengths",
    "gap": "gap",
    "not computed": "nothing to compute",
}


@dataclass(frozen=True)
class Row:
    """One table, figure or claim: what the paper gives, what robomill finds now, how they stand, and why.

    ``holds`` is the check behind the status; a test asserts it for every row.
    """

    item: str
    paper: str
    found: str
    status: Status
    reason: str
    holds: bool


def columns(rows: Sequence[Row]) -> dict[str, list[str]]:
    """The rows as a table."""
    return {
        "of the paper": [r.item for r in rows],
        "paper": [r.paper for r in rows],
        "robomill": [r.found for r in rows],
        "status": [WORDS[r.status] for r in rows],
        "reason": [r.reason for r in rows],
    }


def summary(rows: Sequence[Row]) -> str:
    """How many of which status, in one sentence."""
    count = {status: sum(r.status == status for r in rows) for status in WORDS}
    return (
        f"{len(rows)} tables, figures and claims: {count['reproduced']} reproduced, {count['assumed']} reproduced "
        f"with the "
        f"assumed lengths, {count['gap']} with a gap that is named, {count['not computed']} with nothing to compute."
    )
