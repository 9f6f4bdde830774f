"""The verbs of the command line, with what ``--help`` and the completion of shells tell of them: quick to load."""

import argparse
import textwrap
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from functools import partial
from importlib import import_module
from shutil import get_terminal_size
from typing import Any

from robomill import __version__
from robomill.cli import verb_options as options
from robomill.cli.options import Parser
from robomill.cli.serve import serve_options

EXIT_CODES = (
    "exit codes: 0 done; 1 a red verdict, not judged or not reached; 2 refused, with a sentence on standard error; "
    "70 a mistake of robomill's own; 130 interrupted"
)


@dataclass(frozen=True)
class Kind:
    """What a verb writes, and how its name ends."""

    what: str
    ends: tuple[str, ...] = ()


PROGRAM = Kind("a program")  # whose name ends as a control likes it, but as no other file


@dataclass(frozen=True)
class Verb:
    """A verb: what it does, one line that runs as it stands in any folder, what adds its options, and a ``note``.

    alone   its ``run_NAME`` stands in a module of its name, else in ``verbs``
    writes  what it writes by which option; refused before anything is computed
    makes   it makes the folder that it writes to
    json    it has a record to give on standard output
    """

    name: str
    text: str
    example: str
    options: Callable[[argparse.ArgumentParser], None] | None = None
    note: str = ""
    alone: bool = False
    writes: Mapping[str, Kind] = field(default_factory=dict)
    makes: bool = False
    json: bool = True


VERBS = (
    Verb("robots", "List the robots that come with robomill.", "robomill robots"),
    Verb(
        "pose",
        "Pose, Jacobian and compliance at a configuration.",
        "robomill pose slavkovic_5r --theta-deg 0,0,0,0,0",
        options.pose_options,
    ),
    Verb(
        "ik",
        "Joint coordinates for a pose.",
        'robomill ik slavkovic_5r --pose "0,-1300,0,0,0"',
        options.ik_options,
        note="Exits 1 where the pose is not reached.",
    ),
    Verb(
        "gcode",
        "Read a program, or a table of points: moves, lengths, extents, findings.",
        "robomill gcode heart",
        options.gcode_options,
    ),
    Verb(
        "drawing",
        "Layers and lines of a DXF or SVG drawing, and a program that cuts along them.",
        "robomill drawing bracket --cut slots:inside:3 --feed 600 --diameter 8 --out bracket.nc",
        options.drawing_options,
        note="The tool goes straight down at the plunge feed where a line begins, and round a closed one pass by pass.",
        alone=True,
        writes={"out": PROGRAM},
    ),
    Verb(
        "map",
        "A quantity over a plane or a box, NaN where the robot cannot reach.",
        "robomill map slavkovic_5r --quantity C_yy --z 0 --x -600:600:100 --y -1600:-1000:100 --out map.csv",
        options.map_options,
    ),
    Verb(
        "identify",
        "Joint compliances from load tests, with their intervals.",
        "robomill identify slavkovic_5r nine_points --out identified.toml",
        options.identify_options,
        alone=True,
        writes={"out": Kind("a robot", (".toml",)), "sheet": Kind("a table", (".csv",))},
    ),
    Verb(
        "simulate",
        "Run a set-up: deviation, groove, verdict.",
        "robomill simulate paper_flute --out result",
        options.simulate_options,
        note="Exits 1 where the verdict is red, and where nothing or not all can be judged: never 0 on a "
        "number that is not known.",
        alone=True,
        makes=True,
    ),
    Verb(
        "report",
        "Run a set-up and write what comes out as one HTML page, to print or hand over.",
        "robomill report paper_flute --out report.html",
        options.report_options,
        note="Exits as simulate does. An older report there is replaced, any other file is kept.",
        alone=True,
        writes={"out": Kind("a page", (".html", ".htm"))},
    ),
    Verb(
        "advise",
        "The same part cut otherwise: with another feed, turned round, in passes, once more.",
        "robomill advise paper_flute/setup_process",
        options.setup_option,
        note="Exits 1 where no way keeps the tolerance.",
        alone=True,
    ),
    Verb(
        "place",
        "Where in a box the part should lie so that its cut comes out best.",
        "robomill place paper_flute --x -300:300 --y -1500:-1100 --yaw -90:90",
        options.place_options,
        note="Left out, x and y are today's and 15 % of the arm's length to each side; height and yaw stay. "
        "Exits 1 where the verdict is red at the best place, too.",
        alone=True,
        writes={"out": Kind("a set-up", (".toml",))},
    ),
    Verb(
        "turn",
        "How the spindle should be turned about its axis along a path: six and seven axes.",
        "robomill turn paper_flute --robot fanuc_r2000ic",
        options.turn_options,
        note="Exits 1 where the verdict is red along the best course, too, and 2 where nothing is left to turn.",
        alone=True,
    ),
    Verb(
        "design",
        "The joints to stiffen so that a cut keeps a tolerance, at the least cost.",
        "robomill design paper_flute --tolerance-mm 0.1",
        options.design_options,
        note="Exits 1 where the tolerance cannot be met.",
        alone=True,
    ),
    Verb(
        "compensate",
        "Correct a program for the push on its tool, and say what is left.",
        "robomill compensate paper_flute --out corrected.nc",
        options.compensate_options,
        note="Refused, with the reason, where the prediction itself is not to be trusted.",
        alone=True,
        writes={"out": PROGRAM},
        makes=True,
    ),
    Verb(
        "study",
        "Many runs of a set-up: a grid, a Latin hypercube or Sobol's sequence of its numbers.",
        "robomill study paper_flute/study --out study",
        options.study_options,
        note="Stopped or failed, the same command goes on from what is finished. Exits 1 where no point came out.",
        alone=True,
        makes=True,
    ),
    Verb(
        "grade",
        "Mark the exercises of a class: its files of answers, with the reason of every mark.",
        "robomill grade answers --out marks.csv",
        options.grade_options,
        note="A file that cannot be marked keeps its row and its reason, and the exit code is 1.",
        alone=True,
        writes={"out": Kind("a table", (".csv",))},
        makes=True,
    ),
    Verb(
        "samples",
        "List the samples, or copy them to work on.",
        "robomill samples --copy samples",
        options.samples_options,
    ),
    Verb(
        "reproduce",
        "Every table, figure and claim of the paper: what it gives, and what comes out here.",
        "robomill reproduce",
        note="Exits 1 where a claim of the paper that should hold does not.",
    ),
    Verb(
        "completion",
        "Print what a shell needs to complete verbs, options, samples and robots.",
        "robomill completion bash",
        options.completion_options,
        note="For bash, write it to ~/.local/share/bash-completion/completions/robomill; for zsh, to a file "
        "_robomill in a folder of $fpath; for fish, to ~/.config/fish/completions/robomill.fish.",
        json=False,
    ),
    Verb(
        "serve",
        "Serve the app to others: no error details for visitors, work kept within bounds.",
        "robomill serve --port 8502",
        serve_options,
        alone=True,
        json=False,
    ),
)


def make_parser() -> argparse.ArgumentParser:
    """The verbs and their options."""
    top = Parser(
        prog="robomill", description="Path deviation of a milling robot. Without a verb: the app.", epilog=EXIT_CODES
    )
    top.add_argument("--version", action="version", version=f"robomill {__version__}")
    top.add_argument("--debug", action="store_true", help="show the traceback of a crash (or set ROBOMILL_DEBUG=1)")
    verbs = top.add_subparsers(dest="verb", required=True, metavar="VERB")
    wide = max(11, min(79, get_terminal_size().columns - 2))
    for verb in VERBS:
        sub = verbs.add_parser(
            verb.name,
            help=verb.text,
            description=textwrap.fill(f"{verb.text} {verb.note}", wide),
            epilog=f"example:\n  {verb.example}",
            formatter_class=argparse.RawDescriptionHelpFormatter,
        )
        sub.set_defaults(run=partial(_run, verb), writes=verb.writes, makes=verb.makes)
        if verb.json:
            sub.add_argument("--json", action="store_true", help="one JSON object on stdout")
        else:
            sub.set_defaults(json=False)
        if verb.options is not None:
            verb.options(sub)
    return top


def _run(verb: Verb, arguments: Any) -> int:
    """Load the module that runs the verb, and run it."""
    module = import_module(f"robomill.cli.{verb.name if verb.alone else 'verbs'}")
    run: Callable[[Any], int] = getattr(module, f"run_{verb.name}")
    return run(arguments)
