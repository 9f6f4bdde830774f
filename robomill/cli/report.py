"""``robomill report``: one run as an HTML page to hand over."""

from collections.abc import Callable
from pathlib import Path
from typing import Any

from robomill.cli.saying import Written, say
from robomill.cli.simulate import asked_setup
from robomill.errors import ProjectError, RobomillError
from robomill.files import write_whole


def run_report(arguments: Any) -> int:
    """Run and write the page; 1 where the verdict is red or nothing can be judged."""
    from robomill.report.html import check_replaceable, page
    from robomill.report.plain import simulation_lines
    from robomill.report.simulation_record import simulation_record
    from robomill.simulation.run import simulate

    place = Path(arguments.out)
    check_replaceable(place)
    result = simulate(asked_setup(arguments))
    record = simulation_record(result)
    rows = _remedies(result) if arguments.remedies else []
    files = Written.before([place])
    write_whole(place, page(result, record, rows), ProjectError)
    lines = simulation_lines(record)[:2] + [f"remedy    {row.title}, {row.what}: {row.leaves}" for row in rows]
    record["remedies"] = [vars(row) for row in rows]
    return say(arguments, record, lines, 1 if result.verdict.red else 0, files)


def _remedies(result: Any) -> list[Any]:
    """All that may mend a cut, and of what does not apply why."""
    from functools import cache

    from robomill.improve.advice import advise
    from robomill.improve.placement import place
    from robomill.improve.remedies import REMEDIES, moved_and_corrected, stiffened
    from robomill.improve.turning import turn
    from robomill.io.compensated import compensate
    from robomill.report.remedies_told import refused, told
    from robomill.simulation.run import simulate

    placed = cache(place)
    finds: dict[str, Callable[[Any], Any]] = {
        "program": compensate,
        "stiffen": lambda setup: stiffened(setup, simulate),
        "place": placed,
        "both": lambda setup: moved_and_corrected(placed(setup), compensate),
        "turn": turn,
        "cut": advise,
    }
    rows = []
    for remedy in REMEDIES:
        try:
            rows += told(finds[remedy.code](result.setup))
        except RobomillError as exc:
            rows.append(refused(remedy, exc))
    return rows
