"""The command line: the same job without a screen, with the same numbers.

Exit codes: 0 success, 1 red verdict, 2 refused input (the sentence is on stderr), 130 interrupted.
"""

import argparse
import os
import sys
from collections.abc import Callable, Sequence
from functools import partial
from typing import Any

from robomill import __version__, compiled
from robomill.cli.options import whole
from robomill.cli.progress_line import ProgressLine
from robomill.cli.serve import run_serve, serve_options, start_app
from robomill.cli.verbs import run_gcode, run_identify, run_ik, run_map, run_pose, run_robots, run_simulate
from robomill.errors import MissingExtraError, RobomillError
from robomill.progress import Progress, watched

# Values of these options may begin with a minus ("-90,0,0"), which argparse would take for an option.
SIGNED = ("--theta-deg", "--pose", "--x", "--y", "--z", "--a-deg", "--b-deg")


def main(argv: Sequence[str] | None = None) -> int:
    """Run one verb; without one, open the app."""
    words = list(sys.argv[1:] if argv is None else argv)
    if not words or (words[0].startswith("--") and words[0] not in ("--help", "--version")):
        try:
            return start_app(words)
        except MissingExtraError as exc:
            print(f"robomill: {exc}", file=sys.stderr)
            return 2
    arguments = parser().parse_args(_joined(words))
    compiled.announce(lambda word: print(f"{word} ...", file=sys.stderr, flush=True))
    line = ProgressLine(sys.stderr)
    try:
        with watched(Progress(say=line.say)):  # unwatched, work would not stop for Ctrl-C before it is done
            code: int = arguments.run(arguments)
    except KeyboardInterrupt:
        return 130
    except RobomillError as exc:
        print(f"robomill: {exc}", file=sys.stderr)
        return 2
    except BrokenPipeError:
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return 0
    finally:
        line.clear()
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
    run.add_argument(
        "--allow-outside", action="store_true", help="let the set-up name files that are not in its own folder or below"
    )

    text = "Serve the app to others: no error details for visitors, work kept within bounds."
    serve = verbs.add_parser("serve", help=text, description=text)
    serve_options(serve)
    serve.set_defaults(run=run_serve, json=False)
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
        default=None,
        help="joints with bending springs (2,3 in models with bending), or auto: none or those that cross-validation "
        "chooses",
    )
    fit.add_argument("--fit-points", default="none", help="points to fit too: none (default), force, gauge or both")
    fit.add_argument("--robust", action="store_true", help="weigh down tests that do not fit")
    fit.add_argument("--weights", default="equal", help="equal (default), or size: every test by its relative error")
    fit.add_argument("--leave-out", default="pose", help="cross-validation by pose (default) or by neighbours")
    fit.add_argument("--exclude", default="", metavar="ROWS", help="rows of the file to leave out, with commas")
    fit.add_argument("--out", metavar="ROBOT.toml", help="write the robot with these compliances there")
    fit.add_argument("--sheet", metavar="SHEET.csv", help="write the tests to do next there, to be filled in")
    fit.add_argument(
        "--next", type=partial(whole, 100), default=3, metavar="TESTS", help="how many tests to do next (default 3)"
    )
