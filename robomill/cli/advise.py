"""``robomill advise``: the same part cut otherwise, each way by a run."""

from typing import Any

from robomill.cli import given
from robomill.cli.saying import say


def run_advise(arguments: Any) -> int:
    """Run every way; 1 where none keeps the tolerance."""
    from robomill.improve.advice import advise
    from robomill.report.advice_record import advice_lines, advice_record

    found = advise(given.setup(arguments.setup, arguments.allow_outside))
    record = advice_record(found)
    return say(arguments, record, advice_lines(record), 0 if any(way.keeps for way in found.ways) else 1)
