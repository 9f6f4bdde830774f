"""A study that was run, as a JSON-ready record and as lines for a person."""

from collections import Counter
from typing import Any

import numpy as np

from robomill.frames import Columns
from robomill.simulation.origin.assumptions import assumed_of_setup
from robomill.study.responses import WORDS
from robomill.study.running import StudyResult
from robomill.units import format_count, format_si
from robomill.version import __version__

MOST_REASONS = 5  # that are told, the most frequent first


def study_record(found: StudyResult) -> dict[str, Any]:
    """How many points there are, what they span, and why some failed."""
    study, columns = found.study, found.columns()
    reasons = Counter(row.reason for row in found.rows if row.reason)
    return {
        "robomill": __version__,
        "name": study.name,
        "design": study.kind,
        "points": len(found.rows),
        "done": found.done,
        "failed": found.failed,
        "resumed": found.resumed,
        "seconds": found.seconds,
        "parameters": study.keys,
        "responses": {name: _spanned(columns, name) for name in study.responses},
        "reasons": [{"count": count, "reason": reason} for reason, count in reasons.most_common(MOST_REASONS)],
        "assumed": [each.record() for each in assumed_of_setup(study.setup)],
        "digest": found.digest(),
    }


def _spanned(columns: Columns, name: str) -> dict[str, Any]:
    """Least, median and largest of the points that have the number; of a word how often it came out."""
    done = columns["reason"] == ""
    values = columns[name][done]
    if name in WORDS:
        return dict(Counter(values.tolist()))
    known = values[np.isfinite(values)]
    if not len(known):
        return {"least": None, "median": None, "largest": None}
    return {"least": float(known.min()), "median": float(np.median(known)), "largest": float(known.max())}


def study_lines(record: dict[str, Any]) -> list[str]:
    """The counts first, then what each response spans, and why points failed."""
    head = f"{record['name']}: {record['done']} of {format_count(record['points'], 'point')} done"
    lines = [head + (f", {record['failed']} failed" if record["failed"] else "")]
    took = format_si(record["seconds"], "s")
    lines.append(f"took      {took}" + (f"; {record['resumed']} were there before" if record["resumed"] else ""))
    for name, said in record["responses"].items():
        if name in WORDS:
            lines.append(f"{name:18s}" + ", ".join(f"{word} {count}" for word, count in said.items()))
        elif said["least"] is not None:
            spanned = ", ".join(f"{said[key]:.4g} {key}" for key in ("least", "median", "largest"))
            lines.append(f"{name:18s}{spanned}")
    return lines + [f"failed    {format_count(each['count'], 'time')}: {each['reason']}" for each in record["reasons"]]
