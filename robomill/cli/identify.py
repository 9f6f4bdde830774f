"""``robomill identify``: joint compliances from load tests, the robot that has them, and the tests to do next."""

from pathlib import Path
from typing import Any

from robomill.cli import given, options
from robomill.cli.saying import Written, say
from robomill.errors import ProjectError
from robomill.files import write_whole


def run_identify(arguments: Any) -> int:
    """Fit, write what is asked for, and say it."""
    from robomill.identification.fit.estimate import identify
    from robomill.identification.plan import next_best
    from robomill.identification.record import identification_record
    from robomill.io.declared import kind_to_table
    from robomill.io.measured.load_test_sheets import measuring_sheet
    from robomill.io.robot.writer import robot_to_toml
    from robomill.report.plain import identification_lines
    from robomill.simulation.origin.assumptions import assumed_of_robot, assumed_of_tests

    robot = given.robot(arguments.robot, arguments.tip)
    tests, called = given.load_tests(arguments.tests, robot)
    result = identify(robot, tests, *_asked(arguments))
    record, findings = identification_record(robot, tests, result)
    record = {"robot": robot.name, **record}
    record["findings"] = [finding.record() for finding in findings]
    record["springs"] = [kind_to_table(spring) for spring in result.springs(robot)]
    found = [*assumed_of_robot(robot, compliances=False), *assumed_of_tests(tests)]
    record["assumed"] = [each.record() for each in found]
    lines = identification_lines(record)
    places = [Path(place) for place in (arguments.out, arguments.sheet) if place]
    files = Written.before(places)
    if arguments.out:
        write_whole(arguments.out, robot_to_toml(result.adopted(robot, called, robot, ())[0]), ProjectError)
        lines += _springs(record["springs"])
    if arguments.sheet:
        plan = next_best(robot, tests, result, count=arguments.next)
        record["next"] = plan.rows()
        write_whole(arguments.sheet, measuring_sheet(plan, called), ProjectError)
    return say(arguments, record, lines, files=files)


def _asked(arguments: Any) -> tuple[str, Any]:
    """The model and how the tests are treated."""
    from robomill.identification.fit.models import Model
    from robomill.identification.fit.treatment import AUTO, BENDING_JOINTS, Treatment

    bending: Any = BENDING_JOINTS if arguments.bending is None else arguments.bending
    model = Model(arguments.model)
    if arguments.bending not in (None, AUTO):
        bending = options.wholes(arguments.bending, "--bending")
        model = model.bending_at(bending, turned=False) if model.has("joint") else model
    excluded = options.wholes(arguments.exclude, "--exclude") if arguments.exclude else ()
    points, robust, weights = arguments.fit_points, arguments.robust, arguments.weights
    return model.name, Treatment(bending, points, robust, excluded, weights, arguments.leave_out)


def _springs(springs: list[dict[str, Any]]) -> list[str]:
    """Springs that were found and that a robot's file cannot hold."""
    import tomli_w

    if not springs:
        return []
    return [
        "a robot's file holds its joints only; for the set-up, beside them:",
        tomli_w.dumps({"springs": springs}).rstrip(),
    ]
