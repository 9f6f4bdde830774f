"""``robomill place``: where in a box the part of a set-up should lie."""

from pathlib import Path
from typing import Any

from robomill.cli import given, options
from robomill.cli.saying import Written, say


def run_place(arguments: Any) -> int:
    """Search; 1 where the cut is red at the best place, too."""
    from robomill.improve.placement import place
    from robomill.io.writers import write_setup
    from robomill.report.placement_record import placement_lines, placement_record
    from robomill.simulation.judging.verdict_words import RED

    found = place(
        given.setup(arguments.setup, arguments.allow_outside),
        x_mm=options.span(arguments.x, "--x"),
        y_mm=options.span(arguments.y, "--y"),
        z_mm=options.span(arguments.z, "--z"),
        yaw_deg=options.span(arguments.yaw, "--yaw"),
        keep_out_mm=[options.box(text, "--keep-out") for text in arguments.keep_out or ()] or None,
        measure=arguments.measure,
        candidates=arguments.candidates,
        **({} if arguments.room is None else {"room": arguments.room}),
    )
    files = Written.before([Path(arguments.out)] if arguments.out else [])
    if arguments.out:
        write_setup(arguments.out, found.moved)
    record = placement_record(found)
    return say(arguments, record, placement_lines(record), int(found.best.level in RED), files)
