"""The options of each verb, as ``--help`` tells them: quick to load. Defaults and choices that a library declares are
stated again here, for that library would have to be loaded; a test holds each against its declaration."""

import argparse
from functools import partial
from typing import Any

from robomill.cli import completers
from robomill.cli.completers import offered
from robomill.cli.options import number, whole

SHELLS = ("bash", "zsh", "fish", "powershell")


def _named(sub: argparse.ArgumentParser, name: str, text: str, kind: str, **more: Any) -> None:
    """An argument that takes a file, a sample's name, or - for standard input."""
    offered(sub.add_argument(name, help=text, **more), completers.samples, kind)


def _worded(sub: argparse.ArgumentParser, name: str, where: str, *more: str, **given: Any) -> None:
    """An option that takes one of the words ``where`` ("module.NAME") and ``more``; what reads it refuses others."""
    module, _, words = where.rpartition(".")
    offered(sub.add_argument(name, **given), completers.words, module, words, more)


def _compliance_set(sub: argparse.ArgumentParser, text: str = "one of the robot's compliance sets") -> None:
    offered(sub.add_argument("--compliance-set", help=text), completers.compliance_sets)


def robot_option(sub: argparse.ArgumentParser) -> None:
    _named(sub, "robot", "name of a robot, a .toml or .urdf file, or - for standard input", "robot")
    _tip(sub)


def _another_robot(sub: argparse.ArgumentParser) -> None:
    _named(sub, "--robot", "another robot than the set-up's: a name or a file", "robot")
    _tip(sub)


def _tip(sub: argparse.ArgumentParser) -> None:
    sub.add_argument("--tip", metavar="LINK", help="of a URDF: the link at which the arm ends (its only end)")


def pose_options(pose: argparse.ArgumentParser) -> None:
    robot_option(pose)
    pose.add_argument("--theta-deg", required=True, help="joint coordinates, comma separated (mm for sliding joints)")
    _compliance_set(pose)


def gcode_options(gcode: argparse.ArgumentParser) -> None:
    _named(gcode, "file", "a program, points (.csv, .parquet), a sample's name, or - for standard input", "program")
    _points_options(gcode)
    gcode.add_argument("--tools", help="tool table: LinuxCNC's .tbl, CSV tool,diameter_mm,length_mm,..., TOML")
    gcode.add_argument("--tools-unit", default="mm", choices=("mm", "in"), help="unit of a .tbl, which does not say it")
    gcode.add_argument("--moves", metavar="OUT.jsonl", help="write the canonical moves, one a line")
    told = "auto, linuxcnc, fanuc, grbl, sinumerik or heidenhain"
    _worded(gcode, "--dialect", "toolpath.gcode.dialects.NAMES", "auto", default="auto", help=told)


def _points_options(sub: argparse.ArgumentParser) -> None:
    sub.add_argument(
        "--unit", default="", choices=("mm", "in", "cm", "m"), help="unit of points whose header is silent"
    )
    sub.add_argument("--feed", type=number, metavar="MM_MIN", help="feed of points that have none, mm/min")


def drawing_options(sub: argparse.ArgumentParser) -> None:
    _named(sub, "file", "a drawing (.dxf or .svg), a sample's name, or - for standard input", "drawing")
    units = ("mm", "in", "cm", "m", "px", "pt")
    sub.add_argument("--unit", default="", choices=units, help="unit of the drawing where it does not say it")
    sub.add_argument(
        "--origin", default="drawing", choices=("drawing", "corner", "centre"), help="where the part zero is"
    )
    sub.add_argument(
        "--cut",
        action="append",
        metavar="LAYER:SIDE:DEPTH",
        help="cut the lines of a layer: on, left, right, inside or outside, depth in mm; one --cut a layer",
    )
    for name, metavar, text in (
        ("depth", "MM", "depth of layers that say none, mm"),
        ("step-down", "MM", "deepest pass, mm (one pass)"),
        ("feed", "MM_MIN", "feed along the lines, mm/min"),
        ("diameter", "MM", "of the cutter, mm: for cuts beside their line"),
        ("plunge", "MM_MIN", "feed of the plunges, mm/min (300)"),
        ("clearance", "MM", "height of rapids, mm (5)"),
        ("spindle", "1_MIN", "spindle speed, 1/min"),
    ):
        sub.add_argument(f"--{name}", type=number, metavar=metavar, help=text)
    sub.add_argument("--out", metavar="PROGRAM.nc", help="write the path there as G-code; an older file is replaced")


def map_options(grid: argparse.ArgumentParser) -> None:
    robot_option(grid)
    wanted = grid.add_argument(
        "--quantity", action="append", required=True, help="C_yy, det_J, ...; several with commas"
    )
    offered(wanted, completers.quantities)
    for axis in "xyz":
        grid.add_argument(f"--{axis}", required=True, metavar="LOW:HIGH:STEP", help="mm, or one number")
    grid.add_argument("--a-deg", type=number, default=0.0, help="tool tilt A")
    grid.add_argument("--b-deg", type=number, default=0.0, help="tool tilt B")
    _compliance_set(grid)
    grid.add_argument("--out", help="write the map there: .csv, .parquet or .vti; an older file is replaced")


def identify_options(fit: argparse.ArgumentParser) -> None:
    robot_option(fit)
    _named(fit, "tests", "load tests (.csv), a sample's name, or - for standard input", "load tests")
    models = "joints, joints+bending, joints+tool, joints+bending+tool or constant"
    _worded(fit, "--model", "identification.fit.models.MODELS", default="joints", help=models)
    fit.add_argument(
        "--bending",
        "--bending-joints",
        default=None,
        help="joints with bending springs (2,3 in models with bending), or auto: none or those that cross-validation "
        "chooses",
    )
    points = "points to fit too: none (default), force, gauge or both"
    _worded(fit, "--fit-points", "identification.pull.points.FREED", default="none", help=points)
    fit.add_argument("--robust", action="store_true", help="weigh down tests that do not fit")
    weights = "equal (default), or size: every test by its relative error"
    _worded(fit, "--weights", "identification.fit.treatment.WEIGHTS", default="equal", help=weights)
    folds = "cross-validation by pose (default) or by neighbours"
    _worded(fit, "--leave-out", "identification.fit.folds.LEAVE_OUT", default="pose", help=folds)
    fit.add_argument("--exclude", default="", metavar="ROWS", help="rows of the file to leave out, with commas")
    fit.add_argument(
        "--out", metavar="ROBOT.toml", help="write the robot with these compliances there; an older file is replaced"
    )
    fit.add_argument("--sheet", metavar="SHEET.csv", help="write the tests to do next there, to be filled in")
    fit.add_argument(
        "--next", type=partial(whole, 100), default=3, metavar="TESTS", help="how many tests to do next (default 3)"
    )


def setup_option(sub: argparse.ArgumentParser) -> None:
    _named(sub, "setup", "a set-up (.toml), its folder, a sample's name, or - for standard input", "set-up")
    _outside(sub, "the set-up")


def _outside(sub: argparse.ArgumentParser, what: str) -> None:
    sub.add_argument("--allow-outside", action="store_true", help=f"let {what} name files outside its own folder")


def design_options(sub: argparse.ArgumentParser) -> None:
    setup_option(sub)
    sub.add_argument(
        "--tolerance-mm", "--tol", type=number, metavar="MM", help="of walls and floors, mm (the set-up's)"
    )
    sub.add_argument(
        "--measure",
        default="verdict",
        choices=("verdict", "wall", "floor", "tip"),
        help="what has to keep it: what the verdict judges (default), one of its parts, or the tip's deviation",
    )
    sub.add_argument("--most", type=number, metavar="TIMES", help="how many times as stiff a joint may be made (10)")
    sub.add_argument("--box", metavar="X,Y,Z:X,Y,Z", help="a box of the workspace in the place of the cut, mm")
    sub.add_argument("--force", metavar="FX,FY,FZ", help="what pushes the tip at every point of the box, N")
    sub.add_argument("--every", type=number, metavar="MM", help="how far apart its points are, mm (100)")


def _asked_for(sub: argparse.ArgumentParser) -> None:
    sub.add_argument(
        "--measure",
        default="verdict",
        choices=("verdict", "wall", "floor", "tip", "feed"),
        help="what is made small: what the verdict judges (default), one of its parts, or the tip's deviation",
    )


def turn_options(sub: argparse.ArgumentParser) -> None:
    setup_option(sub)
    _another_robot(sub)
    _asked_for(sub)
    sub.add_argument("--rate", type=number, metavar="DEG_MM", help="how fast the spin may change, degrees a mm (1)")


def place_options(sub: argparse.ArgumentParser) -> None:
    setup_option(sub)
    for axis in "xyz":
        sub.add_argument(f"--{axis}", metavar="LOW:HIGH", help=f"{axis} of part zero in the robot's base, mm")
    sub.add_argument("--yaw", metavar="LOW:HIGH", help="turn of the part about Z, degrees (as it is)")
    sub.add_argument(
        "--keep-out",
        action="append",
        metavar="X,Y,Z:X,Y,Z",
        help="a box, mm, in the robot's base that the stock keeps out of; one --keep-out a box",
    )
    _asked_for(sub)
    sub.add_argument(
        "--room", type=number, metavar="SHARE", help="of its half range a joint keeps to its limits (0.05)"
    )
    sub.add_argument(
        "--candidates", type=partial(whole, 100_000), default=1000, metavar="PLACES", help="places of the map (1000)"
    )
    sub.add_argument("--out", metavar="SETUP.toml", help="write the set-up moved there; an older file is replaced")


def _cut_options(run: argparse.ArgumentParser) -> None:
    setup_option(run)
    _named(run, "--program", "another program than the set-up's, or points (.csv, .parquet)", "program")
    _points_options(run)
    told = "of a corrected program: the one it was made of, from whose path the deviation is told"
    _named(run, "--wanted", told, "program")
    _another_robot(run)
    run.add_argument(
        "--tol", "--tolerance-mm", type=number, metavar="MM", help="another tolerance of walls and floors, mm"
    )
    _compliance_set(run, "another of the robot's compliance sets")


def simulate_options(run: argparse.ArgumentParser) -> None:
    _cut_options(run)
    run.add_argument(
        "--out",
        metavar="DIR",
        help="write the result there: JSON, CSV tables, pictures, an STL below 10 MB, and a copy of the set-up that "
        "runs again from there; what an earlier run wrote is replaced, other files stay",
    )
    run.add_argument("--full-stl", action="store_true", help="with --out: an STL of every cell, however large")


def report_options(run: argparse.ArgumentParser) -> None:
    _cut_options(run)
    run.add_argument(
        "--out", required=True, metavar="FILE.html", help="write the page there; an older report is replaced"
    )
    run.add_argument("--remedies", action="store_true", help="compute remedies, too, and what each leaves (slower)")


def study_options(run: argparse.ArgumentParser) -> None:
    _named(run, "study", "a study (.toml), a sample's name, or - for standard input", "study")
    _outside(run, "the study")
    run.add_argument(
        "--out", required=True, metavar="DIR", help="keep its points there; where some are there already, go on"
    )
    run.add_argument(
        "--scheduler", metavar="tcp://HOST:PORT", help="of a Dask cluster; left out: processes of this machine"
    )
    run.add_argument("--processes", type=partial(whole, 1000), metavar="N", help="how many of those (one a processor)")


def compensate_options(run: argparse.ArgumentParser) -> None:
    setup_option(run)
    run.add_argument(
        "--out", required=True, metavar="FILE.nc", help="write the corrected program there; an older file is replaced"
    )
    run.add_argument(
        "--components",
        default="normal,axial",
        help="what is taken back: normal (across the path), axial, feed; with commas (default normal,axial)",
    )
    run.add_argument(
        "--bound-um",
        type=number,
        default=2.0,
        metavar="UM",
        help="how near the program keeps to the corrected path, um (default 2)",
    )


def grade_options(sub: argparse.ArgumentParser) -> None:
    _named(sub, "folder", "a folder with files of answers (.toml), in it or below, or a sample's name", "answers")
    sub.add_argument(
        "--out", required=True, metavar="MARKS.csv", help="write the table of marks there; an older file is replaced"
    )
    told = "the robot that the class was given (any that comes with robomill)"
    offered(sub.add_argument("--robot", metavar="NAME", help=told), completers.names, "robot")


def ik_options(sub: argparse.ArgumentParser) -> None:
    robot_option(sub)
    sub.add_argument("--pose", required=True, help='"X,Y,Z,A,B" in mm and degrees')


def samples_options(sub: argparse.ArgumentParser) -> None:
    _named(sub, "names", "samples to list or copy (all)", "any", nargs="*")
    sub.add_argument("--copy", metavar="DIR", help="copy them there; what is there and differs is never replaced")


def completion_options(sub: argparse.ArgumentParser) -> None:
    sub.add_argument("shell", choices=SHELLS)
