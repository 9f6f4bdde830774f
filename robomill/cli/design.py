"""``robomill design``: which joints to stiffen so that a set-up's cut keeps a tolerance, at the least cost."""

from typing import Any

from robomill.cli import given
from robomill.cli.saying import say


def run_design(arguments: Any) -> int:
    """Solve; 1 where the tolerance cannot be met."""
    from robomill.improve.design import STIFFEST, design
    from robomill.report.design_record import design_lines, design_record

    most = STIFFEST if arguments.most is None else arguments.most
    found = design(
        given.setup(arguments.setup, arguments.allow_outside),
        tolerance_mm=arguments.tolerance_mm,
        measure=arguments.measure,
        bounds=(1.0, most),
    )
    record = design_record(found)
    return say(arguments, record, design_lines(record), 0 if found.feasible else 1)
