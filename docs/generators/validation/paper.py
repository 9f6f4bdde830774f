"""The paper, statement by statement."""

from __future__ import annotations

from generators.validation.check import ValidationError
from robomill.learn.evidence import evidence
from robomill.report.reproduction import reproduction
from robomill.report.reproduction_row import WORDS, Row, summary

PAPER_ARM = "slavkovic_5r"


def rows() -> str:
    found = reproduction(evidence())
    lost = [row.statement.where for row in found if not row.holds]
    if lost:
        raise ValidationError(f"Statements of the paper that do not hold: {lost}.")
    head = "| where | the paper | robomill | that is | why |\n|---|---|---|---|---|"
    return "\n".join([summary(found), "", head, *map(_paper_row, found)])


def _paper_row(row: Row) -> str:
    cells = (row.statement.where, row.statement.gives, row.found, WORDS[row.statement.status], row.reason)
    return "| " + " | ".join(cell.replace("|", "\\|").replace("$", "\\$") for cell in cells) + " |"
