"""The marks of a class as a JSON-ready record, and as lines for a person."""

from typing import Any

from robomill import __version__
from robomill.learn.grading import Marks, Row
from robomill.learn.marking import MOST
from robomill.learn.personal import TASKS
from robomill.units import format_count


def marks_record(found: Marks) -> dict[str, Any]:
    """Every file with its marks and their reasons."""
    totals = [row.total for row in found.rows if row.total is not None]
    return {
        "robomill": __version__,
        "of": MOST * len(TASKS),
        "marked": len(totals),
        "unmarked": found.unmarked,
        "mean": sum(totals) / len(totals) if totals else None,
        "rows": [_row(row) for row in found.rows],
    }


def _row(row: Row) -> dict[str, Any]:
    whose = row.answers
    return {
        "file": row.file,
        "student": whose.student if whose else None,
        "name": whose.name if whose else None,
        "robot": whose.robot if whose else None,
        "total": row.total,
        "exercises": [
            {"id": name, "kind": each.kind, "marks": each.marks, "why": each.sentence}
            for name, each in row.judged.items()
        ],
        "remarks": list(row.remarks),
    }


def marks_lines(record: dict[str, Any]) -> list[str]:
    """A line a file, and what deserves a look beneath it."""
    lines = []
    for row in record["rows"]:
        total = "not marked" if row["total"] is None else f"{row['total']:g} of {record['of']:g}"
        lines.append(f"{row['student'] or '-':<12} {total:<11} {row['name'] or ''} ({row['file']})")
        lines += [f"    {remark}" for remark in row["remarks"]]
    mean = "" if record["mean"] is None else f", {record['mean']:.1f} of {record['of']:g} on the mean"
    lines.append(f"marked    {format_count(record['marked'], 'file')}{mean}; not marked: {record['unmarked']}")
    return lines
