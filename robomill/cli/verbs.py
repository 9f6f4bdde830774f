"""What each verb does: read, compute, print the record; everything is imported by the verb that needs it."""

import sys
from pathlib import Path
from typing import Any

from robomill.cli import given, options
from robomill.cli.saying import Written, say
from robomill.console import put
from robomill.errors import RobomillError


def run_robots(arguments: Any) -> int:
    from robomill.io.robot.robots import load_robot, robot_names
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
    return say(arguments, record, pose_lines(record), 0 if record["reached"] else 1)


def run_ik(arguments: Any) -> int:
    import numpy as np

    from robomill.arrays import check_place
    from robomill.kinematics.asked import in_the_foot
    from robomill.kinematics.inverse import inverse_kinematics
    from robomill.kinematics.transforms import pose_from_world
    from robomill.report.plain import ik_lines
    from robomill.report.records import ik_record
    from robomill.units import to_si

    robot = given.robot(arguments.robot, arguments.tip)
    values = np.array(options.numbers(arguments.pose, "--pose", 5, "X,Y,Z,A,B in mm and degrees"))
    x_M = np.append(to_si(values[:3], "mm"), to_si(values[3:], "deg"))
    check_place(x_M[:3], "--pose", RobomillError)
    if in_the_foot(robot, x_M[:3]):
        raise RobomillError("--pose: this lies in the middle of the robot's foot; X, Y, Z are in mm.")
    record = ik_record(robot, inverse_kinematics(robot, pose_from_world(x_M)))
    return say(arguments, record, ik_lines(record), 0 if record["reached"] else 1)


def run_gcode(arguments: Any) -> int:
    from robomill.errors import ToolpathError
    from robomill.report.plain import gcode_lines
    from robomill.report.records import path_record
    from robomill.simulation.origin.assumptions import assumed_of_program, assumed_of_tools
    from robomill.toolpath.apt import read_apt
    from robomill.toolpath.gcode import gcode_report, interpret, write_moves_jsonl
    from robomill.toolpath.gcode.report import write_path_jsonl

    data = given.come_in(arguments.file)
    table = given.points(arguments.file, arguments.unit, arguments.feed, data)
    if not table:
        given.check_points_options(given.CALLED if data else arguments.file, arguments.unit, arguments.feed)
    source = b"" if table else data or given.program(arguments.file)
    files = Written.before([Path(arguments.moves)] if arguments.moves else [])
    if arguments.moves and table:
        raise ToolpathError("--moves: these are the moves of a program; a table of points has none to write.")
    if table:
        record, assumed, files = path_record(table.path), assumed_of_program(table.path.findings), []
    elif given.is_apt(source):
        path = read_apt(source)
        record, assumed = path_record(path), assumed_of_program(path.findings)
        if arguments.moves:
            write_path_jsonl(path, arguments.moves)
    else:
        tools = given.tools(arguments.tools, arguments.tools_unit) if arguments.tools else None
        program = interpret(source, dialect=arguments.dialect, tools=tools)
        record, assumed = gcode_report(program), assumed_of_program(program.findings)
        if tools is not None:
            record["findings"] += [finding.record() for finding in tools.findings]
            assumed += assumed_of_tools(tools, tools)
        if arguments.moves:
            write_moves_jsonl(program, arguments.moves)
    record["assumed"] = [each.record() for each in assumed]
    return say(arguments, record, gcode_lines(record), files=files)


def run_map(arguments: Any) -> int:
    from robomill.io.maps import map_place, write_map
    from robomill.report.plain import map_lines
    from robomill.report.records import map_record
    from robomill.units import to_si
    from robomill.workspace.fields import compliance_map
    from robomill.workspace.grid import Grid

    if arguments.out:
        map_place(arguments.out)
    robot = _robot(arguments)
    grid = Grid(**{f"{axis}_mm": options.axis(getattr(arguments, axis), f"--{axis}") for axis in "xyz"})
    A, B = to_si(arguments.a_deg, "deg"), to_si(arguments.b_deg, "deg")
    everything = compliance_map(robot, grid, A, B)
    names = dict.fromkeys(filter(None, (name.strip() for name in ",".join(arguments.quantity).split(","))))
    if not names:
        raise RobomillError("--quantity: no quantity is named; give C_yy, det_J or another (docs: file formats, map).")
    fields = [everything.field(name) for name in names]
    files = Written.before([Path(arguments.out)] if arguments.out else [])
    if arguments.out:
        write_map(arguments.out, fields)
    record = map_record(fields)
    return say(arguments, record, map_lines(record), 0 if record["reached"]["count"] else 1, files)


def run_samples(arguments: Any) -> int:
    from robomill.errors import ProjectError
    from robomill.io.samples import copy_samples, samples
    from robomill.report.plain import sample_lines

    chosen = [each for each in samples() if not arguments.names or each.name in arguments.names]
    unknown = [name for name in arguments.names if name not in {each.name for each in chosen}]
    if unknown:
        raise ProjectError(f"{unknown[0]!r:.80}: there is no such sample; 'robomill samples' lists them.")
    rows = [{"kind": each.kind, "name": each.name, "title": each.title, "path": str(each.path)} for each in chosen]
    record: dict[str, Any] = {"samples": rows}
    lines = sample_lines(record)
    if arguments.copy is not None:
        copies = copy_samples(arguments.copy, arguments.names)
        record["copied"] = [str(copy) for copy in copies]
        lines.append(f"copied    {len(copies)} files to {Path(arguments.copy)}")
    return say(arguments, record, lines)


def run_reproduce(arguments: Any) -> int:
    from robomill.learn.evidence import evidence
    from robomill.report.plain import reproduction_lines
    from robomill.report.reproduction import reproduction
    from robomill.report.reproduction_row import reproduction_record

    held = evidence()
    record = reproduction_record(reproduction(held), held.robot)
    return say(arguments, record, reproduction_lines(record), 0 if record["holds"] else 1)


def run_completion(arguments: Any) -> int:
    import argcomplete

    put(argcomplete.shellcode(["robomill"], shell=arguments.shell), sys.stdout)
    return 0


def _robot(arguments: Any) -> Any:
    """The robot asked for, with the compliance set asked for."""
    robot = given.robot(arguments.robot, arguments.tip)
    return robot.with_compliance_set(arguments.compliance_set) if arguments.compliance_set else robot
