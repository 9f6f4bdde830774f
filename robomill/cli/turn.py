"""``robomill turn``: how the spindle should be turned about its axis, on arms of six and seven axes."""

from typing import Any

from robomill.cli import given
from robomill.cli.saying import say


def run_turn(arguments: Any) -> int:
    """Search; 1 where the cut is red along the best course, too."""
    from robomill.improve.turning import turn
    from robomill.report.turning_record import turning_lines, turning_record
    from robomill.simulation.judging.verdict_words import RED

    given.check_tip(arguments)
    setup = given.setup(arguments.setup, arguments.allow_outside)
    if arguments.robot:
        setup = setup.replace(robot=given.another_robot(arguments, setup))
    found = turn(setup, measure=arguments.measure, rate_deg_mm=arguments.rate)
    record = turning_record(found)
    return say(arguments, record, turning_lines(record), int(found.course.level in RED))
