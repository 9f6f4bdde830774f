"""The command line: the same job without a screen, with the same numbers.

Exit codes: 0 success, 1 red verdict, 2 refused input (the sentence is on stderr).
"""

from __future__ import annotations

import argparse
import os
import subprocess
import sys
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

from robomill import __version__, compiled
from robomill.errors import RobomillError

# Values of these options may begin with a minus ("-90,0,0"), which argparse would take for an option.
SIGNED = ("--theta-deg", "--pose", "--x", "--y", "--z", "--a-deg", "--b-deg")


def main(argv: Sequence[str] | None = None) -> int:
    """Run one verb; without one, open the app."""
    words = list(sys.argv[1:] if argv is None else argv)
    if not words or (words[0].startswith("--") and words[0] not in ("--help", "--version")):
        return start_app(words)
    arguments = parser().parse_args(_joined(words))
    compiled.announce(lambda word: print(f"{word} ...", file=sys.stderr, flush=True))
    try:
        code: int = arguments.run(arguments)
    except RobomillError as exc:
        print(f"robomill: {exc}", file=sys.stderr)
        return 2
    except BrokenPipeError:
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return 0
    return code


def _joined(words: list[str]) -> list[str]:
    out: list[str] = []
    for word in words:
        if out and out[-1] in SIGNED:
            out[-1] += "=" + word
        else:
            out.append(word)
    return out


def parser() -> argparse.ArgumentParser:
    """The verbs and their options."""
    top = argparse.ArgumentParser(
        prog="robomill", description="Path deviation of a milling robot. Without a verb: the app."
    )
    top.add_argument("--version", action="version", version=f"robomill {__version__}")
    verbs = top.add_subparsers(dest="verb", required=True)

    def verb(name: str, run: Callable[[Any], int], text: str) -> argparse.ArgumentParser:
        sub = verbs.add_parser(name, help=text, description=text)
        sub.add_argument("--json", action="store_true", help="one JSON object on stdout")
        sub.set_defaults(run=run)
        return sub

    verb("robots", run_robots, "List the robots that come with robomill.")

    pose = verb("pose", run_pose, "Pose, Jacobian and compliance at a configuration.")
    pose.add_argument("robot", help="name of a robot or a .toml file")
    pose.add_argument("--theta-deg", required=True, help="joint coordinates, comma separated (mm for sliding joints)")
    pose.add_argument("--compliance-set", help="one of the robot's compliance sets")

    ik = verb("ik", run_ik, "Joint coordinates for a pose.")
    ik.add_argument("robot", help="name of a robot or a .toml file")
    ik.add_argument("--pose", required=True, help='"X,Y,Z,A,B" in mm and degrees')

    gcode = verb("gcode", run_gcode, "Read a program: moves, lengths, extents, findings.")
    gcode.add_argument("file", help="a program, or - for what comes in")
    gcode.add_argument("--tools", help="tool table: LinuxCNC's .tbl, CSV tool,diameter_mm,length_mm,..., TOML")
    gcode.add_argument("--tools-unit", default="mm", choices=("mm", "in"), help="unit of a .tbl, which does not say it")
    gcode.add_argument("--moves", metavar="OUT.jsonl", help="write the canonical moves, one a line")
    gcode.add_argument("--dialect", default="auto", help="auto, linuxcnc, fanuc, grbl or sinumerik")

    grid = verb("map", run_map, "A quantity over a plane or a box, NaN where the robot cannot reach.")
    grid.add_argument("robot", help="name of a robot or a .toml file")
    grid.add_argument("--quantity", action="append", required=True, help="C_yy, det_J, ...; several with commas")
    for axis in "xyz":
        grid.add_argument(f"--{axis}", required=True, metavar="LOW:HIGH:STEP", help="mm, or one number")
    grid.add_argument("--a-deg", type=float, default=0.0, help="tool tilt A")
    grid.add_argument("--b-deg", type=float, default=0.0, help="tool tilt B")
    grid.add_argument("--compliance-set", help="one of the robot's compliance sets")
    grid.add_argument("--out", help="write the map there: .csv, .parquet or .vti")

    fit = verb("identify", run_identify, "Joint compliances from load tests, with their intervals.")
    _identify_options(fit)

    run = verb("simulate", run_simulate, "Run a set-up: deviation, groove, verdict.")
    run.add_argument("setup", help="a set-up (.toml) or a sample's folder")
    run.add_argument("--program", help="another program than the set-up's")
    run.add_argument("--tol", type=float, metavar="MM", help="another tolerance of walls and floors, mm")
    run.add_argument("--compliance-set", help="another of the robot's compliance sets")
    run.add_argument("--out", metavar="DIR", help="write the result there: CSV tables, JSON, STL")
    return top


def _identify_options(fit: argparse.ArgumentParser) -> None:
    fit.add_argument("robot", help="name of a robot or a .toml file")
    fit.add_argument("tests", help="load tests (.csv)")
    fit.add_argument(
        "--model", default="joints", help="joints, joints+bending, joints+tool, joints+bending+tool or constant"
    )
    fit.add_argument(
        "--bending",
        "--bending-joints",
        default="2,3",
        help="joints with bending springs (default 2,3), or auto: none or those that cross-validation chooses",
    )
    fit.add_argument("--fit-points", default="none", help="points to fit too: none (default), force, gauge or both")
    fit.add_argument("--robust", action="store_true", help="weigh down tests that do not fit")
    fit.add_argument("--weights", default="equal", help="equal (default), or size: every test by its relative error")
    fit.add_argument("--leave-out", default="pose", help="cross-validation by pose (default) or by neighbours")
    fit.add_argument("--exclude", default="", metavar="ROWS", help="rows of the file to leave out, with commas")
    fit.add_argument("--out", metavar="ROBOT.toml", help="write the robot with these compliances there")
    fit.add_argument("--sheet", metavar="SHEET.csv", help="write the tests to do next there, to be filled in")
    fit.add_argument("--next", type=int, default=3, metavar="TESTS", help="how many tests to do next (default 3)")


def say(arguments: Any, record: dict[str, Any], lines: Sequence[str], code: int = 0) -> int:
    """Print the record as JSON, or its lines for a person; returns the exit code."""
    from robomill.io.results import json_text
    from robomill.report.records import jsonable

    print(json_text(jsonable(record)).rstrip("\n") if arguments.json else "\n".join(lines))
    return code


def start_app(words: Sequence[str] = ()) -> int:
    """Serve the app on this machine only and open it; further words go to Streamlit."""
    from robomill.io.samples import app_dir

    folder = app_dir()
    command = [sys.executable, "-m", "streamlit", "run", str(folder / "app.py")]
    if not any(word.startswith("--server.address") for word in words):
        command += ["--server.address=127.0.0.1"]
    try:
        return subprocess.call([*command, "--browser.gatherUsageStats=false", *words])
    except KeyboardInterrupt:
        return 130


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
    record = pose_record(at_pose(robot, _theta(robot, arguments.theta_deg)))
    return say(arguments, record, pose_lines(record))


def run_ik(arguments: Any) -> int:
    import numpy as np

    from robomill.io.robots import load_robot
    from robomill.kinematics.inverse import inverse_kinematics
    from robomill.kinematics.transforms import pose_from_world
    from robomill.report.plain import ik_lines
    from robomill.report.records import ik_record
    from robomill.units import to_si

    robot = load_robot(arguments.robot)
    values = np.array(_numbers(arguments.pose, "--pose", 5, "X,Y,Z,A,B in mm and degrees"))
    x_M = np.append(to_si(values[:3], "mm"), to_si(values[3:], "deg"))
    record = ik_record(robot, inverse_kinematics(robot, pose_from_world(x_M)))
    return say(arguments, record, ik_lines(record))


def run_gcode(arguments: Any) -> int:
    from robomill.io.tool_tables import read_tool_table
    from robomill.report.plain import gcode_lines
    from robomill.report.records import path_record
    from robomill.toolpath.apt import read_apt
    from robomill.toolpath.gcode import gcode_report, interpret, write_moves_jsonl

    source = _program(arguments.file)
    if _reads_as_apt(source):
        record = path_record(read_apt(source))
    else:
        tools = read_tool_table(arguments.tools, unit=arguments.tools_unit) if arguments.tools else None
        program = interpret(source, dialect=arguments.dialect, tools=tools)
        record = gcode_report(program)
        record["findings"] += [finding.record() for finding in tools.findings] if tools is not None else []
        if arguments.moves:
            write_moves_jsonl(program, arguments.moves)
    return say(arguments, record, gcode_lines(record))


def _program(name: str) -> Path | bytes:
    """The file of a program; where that is a stream, which can be read once, what comes out of it (``-``: stdin)."""
    from robomill.toolpath.text import MAX_BYTES

    file = Path("/dev/stdin" if name == "-" else name)
    try:
        if file.is_file() or file.is_dir() or not file.exists():
            return file
        with file.open("rb") as stream:
            return stream.read(MAX_BYTES + 1)
    except OSError:
        return file  # the interpreter says what is wrong with it


def _reads_as_apt(source: Path | bytes) -> bool:
    from robomill.toolpath.apt import is_apt

    if isinstance(source, bytes):
        return is_apt(source)
    try:
        with source.open("rb") as stream:
            return is_apt(stream.read(200_000))
    except OSError:
        return False  # the interpreter says what is wrong with the file


def run_map(arguments: Any) -> int:
    from robomill.io.maps import write_map
    from robomill.report.plain import map_lines
    from robomill.report.records import map_record
    from robomill.units import to_si
    from robomill.workspace.fields import compliance_field
    from robomill.workspace.grid import Grid

    robot = _robot(arguments)
    grid = Grid(*(_axis(getattr(arguments, axis), f"--{axis}") for axis in "xyz"))
    A, B = to_si(arguments.a_deg, "deg"), to_si(arguments.b_deg, "deg")
    everything = compliance_field(robot, grid, A, B)
    fields = [everything.field(name) for name in ",".join(arguments.quantity).split(",")]
    if arguments.out:
        write_map(arguments.out, fields)
    record = map_record(fields)
    return say(arguments, record, map_lines(record))


def _axis(text: str, option: str) -> Any:
    """Points of one axis in m from "low:high:step" or one number, in mm."""
    from robomill.units import to_si
    from robomill.workspace.grid import axis_points

    words = text.split(":")
    low, *rest = _numbers(",".join(words), option, 3 if len(words) != 1 else 1, "low:high:step or one number, in mm")
    return to_si(axis_points(low, rest[0], rest[1], option), "mm") if rest else to_si(low, "mm")


def run_identify(arguments: Any) -> int:
    from robomill.identification.estimate import identify
    from robomill.identification.plan import next_best
    from robomill.identification.record import identification_record
    from robomill.identification.treatment import Treatment
    from robomill.io.load_test_sheets import measuring_sheet
    from robomill.io.load_tests import read_load_tests
    from robomill.io.robots import load_robot, robot_to_toml
    from robomill.report.plain import identification_lines

    robot = load_robot(arguments.robot)
    tests = read_load_tests(Path(arguments.tests), robot)
    joints = arguments.bending if arguments.bending == "auto" else _wholes(arguments.bending, "--bending")
    treatment = Treatment(
        joints,
        arguments.fit_points,
        arguments.robust,
        _wholes(arguments.exclude, "--exclude") if arguments.exclude else (),
        arguments.weights,
        arguments.leave_out,
    )
    result = identify(robot, tests, arguments.model, treatment)
    record, findings = identification_record(robot, tests, result)
    record["findings"] = [finding.record() for finding in findings]
    if arguments.out:
        Path(arguments.out).write_text(robot_to_toml(result.applied_to(robot)), encoding="utf-8")
    if arguments.sheet:
        plan = next_best(robot, tests, result, count=arguments.next)
        record["next"] = plan.rows()
        Path(arguments.sheet).write_text(measuring_sheet(plan, Path(arguments.tests).name), encoding="utf-8")
    return say(arguments, record, identification_lines(record))


def run_simulate(arguments: Any) -> int:
    from robomill.io.programs import read_program
    from robomill.io.projects import load_setup
    from robomill.io.results import json_text, write_files
    from robomill.report.plain import simulation_lines
    from robomill.report.records import jsonable, simulation_record
    from robomill.report.tables import csv_text, deviation_columns, section_columns
    from robomill.simulation.run import simulate
    from robomill.units import to_si

    setup = load_setup(arguments.setup)
    if arguments.program:
        setup = setup.replace(source=read_program(arguments.program))
    if arguments.tol is not None:
        setup = setup.replace(tolerance=to_si(arguments.tol, "mm"), floor_tolerance=None, feed_tolerance=None)
    setup = setup.replace(robot=_with_set(setup.robot, arguments))
    result = simulate(setup)
    record = simulation_record(result)
    if arguments.out:
        from robomill.io.meshes import mesh_bytes

        files: dict[str, str | bytes] = {
            "result.json": json_text(jsonable(record)),
            "deviation.csv": csv_text(deviation_columns(result)),
            "sections.csv": csv_text(section_columns(result)),
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


def _theta(robot: Any, text: str) -> Any:
    import numpy as np

    from robomill.units import to_si

    what = f"the {robot.n} joint coordinates of {robot.name}"
    values = np.array(_numbers(text, "--theta-deg", robot.n, what))
    return np.array([to_si(value, unit) for value, unit in zip(values, robot.joint_units, strict=True)])


def _wholes(text: str, option: str) -> tuple[int, ...]:
    return tuple(int(v) for v in _numbers(text, option, None, "whole numbers"))


def _numbers(text: str, option: str, count: int | None, what: str) -> list[float]:
    import math

    try:
        values = [float(word) for word in text.split(",")]
    except ValueError:
        values = []
    if len(values) != (count or max(len(values), 1)) or not all(map(math.isfinite, values)):
        raise RobomillError(
            f"{option}: expected {count or 'one or more'} numbers separated by commas ({what}), found {text!r}."
        )
    return values
