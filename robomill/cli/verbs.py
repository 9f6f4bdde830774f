"""What each verb does: read, compute, print the record; everything is imported by the verb that needs it."""

from collections.abc import Sequence
from pathlib import Path
from typing import Any

from robomill.cli import options


def say(arguments: Any, record: dict[str, Any], lines: Sequence[str], code: int = 0) -> int:
    """Print the record as JSON, or its lines for a person; returns the exit code."""
    from robomill.io.results import json_text
    from robomill.report.records import jsonable

    print(json_text(jsonable(record)).rstrip("\n") if arguments.json else "\n".join(lines))
    return code


def run_robots(arguments: Any) -> int:
    from robomill.io.robots import load_robot, robot_names
    from robomill.report.plain import robot_lines
    from robomill.report.records import robots_record

    record = robots_record([load_robot(name) for name in robot_names()])
    return say(arguments, record, robot_lines(record))


def run_pose(arguments: Any) -> int:
    from robomill.compliance.at_pose import at_pose
    from robomill.report.plain import pose_lines
    from robomill.report.records import pose_record

    robot = _robot(arguments)
    record = pose_record(at_pose(robot, options.theta(robot, arguments.theta_deg)))
    return say(arguments, record, pose_lines(record))


def run_ik(arguments: Any) -> int:
    import numpy as np

    from robomill.arrays import check_place
    from robomill.errors import RobomillError
    from robomill.io.robots import load_robot
    from robomill.kinematics.inverse import inverse_kinematics
    from robomill.kinematics.transforms import pose_from_world
    from robomill.report.plain import ik_lines
    from robomill.report.records import ik_record
    from robomill.units import to_si

    robot = load_robot(arguments.robot)
    values = np.array(options.numbers(arguments.pose, "--pose", 5, "X,Y,Z,A,B in mm and degrees"))
    x_M = np.append(to_si(values[:3], "mm"), to_si(values[3:], "deg"))
    check_place(x_M[:3], "--pose", RobomillError)
    record = ik_record(robot, inverse_kinematics(robot, pose_from_world(x_M)))
    return say(arguments, record, ik_lines(record))


def run_gcode(arguments: Any) -> int:
    from robomill.io.tool_tables import read_tool_table
    from robomill.report.plain import gcode_lines
    from robomill.report.records import path_record
    from robomill.toolpath.apt import read_apt
    from robomill.toolpath.gcode import gcode_report, interpret, write_moves_jsonl

    source = options.program(arguments.file)
    if options.reads_as_apt(source):
        record = path_record(read_apt(source))
    else:
        tools = read_tool_table(arguments.tools, unit=arguments.tools_unit) if arguments.tools else None
        program = interpret(source, dialect=arguments.dialect, tools=tools)
        record = gcode_report(program)
        record["findings"] += [finding.record() for finding in tools.findings] if tools is not None else []
        if arguments.moves:
            write_moves_jsonl(program, arguments.moves)
    return say(arguments, record, gcode_lines(record))


def run_map(arguments: Any) -> int:
    from robomill.io.maps import write_map
    from robomill.report.plain import map_lines
    from robomill.report.records import map_record
    from robomill.units import to_si
    from robomill.workspace.fields import compliance_map
    from robomill.workspace.grid import Grid

    robot = _robot(arguments)
    grid = Grid(*(options.axis(getattr(arguments, axis), f"--{axis}") for axis in "xyz"))
    A, B = to_si(arguments.a_deg, "deg"), to_si(arguments.b_deg, "deg")
    everything = compliance_map(robot, grid, A, B)
    fields = [everything.field(name) for name in ",".join(arguments.quantity).split(",")]
    if arguments.out:
        write_map(arguments.out, fields)
    record = map_record(fields)
    return say(arguments, record, map_lines(record))


def run_identify(arguments: Any) -> int:
    import tomli_w

    from robomill.identification.estimate import identify
    from robomill.identification.models import Model
    from robomill.identification.plan import next_best
    from robomill.identification.record import identification_record
    from robomill.identification.treatment import AUTO, BENDING_JOINTS, Treatment
    from robomill.io.declared import kind_to_table
    from robomill.io.load_test_sheets import measuring_sheet
    from robomill.io.load_tests import read_load_tests
    from robomill.io.results import write_file
    from robomill.io.robots import load_robot, robot_to_toml
    from robomill.report.plain import identification_lines

    robot = load_robot(arguments.robot)
    tests = read_load_tests(Path(arguments.tests), robot)
    bending: Any = BENDING_JOINTS if arguments.bending is None else arguments.bending
    model = Model(arguments.model)
    if arguments.bending not in (None, AUTO):
        bending = options.wholes(arguments.bending, "--bending")
        model = model.bending_at(bending, turned=False) if model.has("joint") else model
    treatment = Treatment(
        bending,
        arguments.fit_points,
        arguments.robust,
        options.wholes(arguments.exclude, "--exclude") if arguments.exclude else (),
        arguments.weights,
        arguments.leave_out,
    )
    result = identify(robot, tests, model.name, treatment)
    record, findings = identification_record(robot, tests, result)
    record["findings"] = [finding.record() for finding in findings]
    record["springs"] = [kind_to_table(spring) for spring in result.springs(robot)]
    lines = identification_lines(record)
    if arguments.out:
        write_file(arguments.out, robot_to_toml(result.adopted(robot, Path(arguments.tests).name, robot, ())[0]))
        if record["springs"]:
            lines += [
                "a robot's file holds its joints only; for the set-up, beside them:",
                tomli_w.dumps({"springs": record["springs"]}).rstrip(),
            ]
    if arguments.sheet:
        plan = next_best(robot, tests, result, count=arguments.next)
        record["next"] = plan.rows()
        write_file(arguments.sheet, measuring_sheet(plan, Path(arguments.tests).name))
    return say(arguments, record, lines)


def run_simulate(arguments: Any) -> int:
    from robomill.io.programs import read_program
    from robomill.io.projects import load_setup
    from robomill.io.results import json_text, write_files
    from robomill.report.plain import simulation_lines
    from robomill.report.records import jsonable
    from robomill.report.simulation_record import simulation_record
    from robomill.report.tables import csv_text
    from robomill.simulation.run import simulate
    from robomill.units import to_si

    setup = load_setup(arguments.setup, arguments.allow_outside)
    if arguments.program:
        setup = setup.replace(source=read_program(arguments.program))
    if arguments.tol is not None:
        setup = setup.replace(tolerance=to_si(arguments.tol, "mm"), floor_tolerance=None)
    setup = setup.replace(robot=_with_set(setup.robot, arguments))
    result = simulate(setup)
    record = simulation_record(result)
    if arguments.out:
        from robomill.io.meshes import mesh_bytes

        files: dict[str, str | bytes] = {
            "result.json": json_text(jsonable(record)),
            "deviation.csv": csv_text(result.columns()),
            "sections.csv": csv_text(result.sections.columns()),
            "machined.stl": mesh_bytes(result.machined, "stl"),
        }
        write_files(Path(arguments.out), files)
    return say(arguments, record, simulation_lines(record), 1 if result.verdict.red else 0)


def _robot(arguments: Any) -> Any:
    """The robot asked for, with the compliance set asked for."""
    from robomill.io.robots import load_robot

    return _with_set(load_robot(arguments.robot), arguments)


def _with_set(robot: Any, arguments: Any) -> Any:
    return robot.with_compliance_set(arguments.compliance_set) if arguments.compliance_set else robot
