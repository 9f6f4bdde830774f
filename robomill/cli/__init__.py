"""The command line: the same job without a screen, with the same numbers.

``main`` runs a verb and returns its exit code: 0 done, 1 a red verdict, not judged or not reached, 2 refused input (the
sentence is on stderr), 130 interrupted. What is the process's (code pages, crashes) is in ``robomill.__main__``.
"""

import os
import sys
from collections.abc import Sequence

from robomill.cli.parser import make_parser
from robomill.console import refuse
from robomill.errors import RobomillError
from robomill.interrupts import heard

# Values of these options may begin with a minus ("-90,0,0"), which argparse would take for an option.
SIGNED = ("--theta-deg", "--pose", "--x", "--y", "--z", "--a-deg", "--b-deg", "--yaw", "--keep-out")

# What is called so in code goes here by an option.
OPTIONS = {"feed_mm_min": "--feed", "unit": "--unit", "tip": "--tip"}


def main(argv: Sequence[str] | None = None) -> int:
    """Run one verb; without one, open the app."""
    words = list(sys.argv[1:] if argv is None else argv)
    if "_ARGCOMPLETE" in os.environ:  # a shell asks, and gets its answer from here
        import argcomplete

        argcomplete.autocomplete(make_parser())
    try:
        if not words or (words[0].startswith("-") and words[0] not in ("-h", "--help", "--version")):
            from robomill.cli.serve import start_app

            if words and "." not in words[0].partition("=")[0]:  # as options of the app's server have one
                raise RobomillError(f"There is no option {words[0]!r:.40}; 'robomill --help' lists the verbs.")
            return start_app(words)
        return _run(words)
    except KeyboardInterrupt:
        return 130
    except RobomillError as exc:
        refuse(exc)
        return 2


def _run(words: Sequence[str]) -> int:
    """The verb, with a line on the terminal of how far it has come."""
    arguments = make_parser().parse_args(_joined(words))
    from robomill import compiled
    from robomill.cli.given import check_kept, check_once
    from robomill.cli.progress_line import ProgressLine
    from robomill.progress import Progress, watched
    from robomill.spelled import units_beside

    check_once(arguments)
    check_kept(arguments)
    line = ProgressLine(sys.stderr)
    compiled.announce(line.announce)
    try:
        with (
            units_beside(OPTIONS),
            watched(Progress(stop=lambda: bool(heard), say=line.say)),
        ):  # unwatched, work would not stop for Ctrl-C before it is done
            code: int = arguments.run(arguments)
    finally:
        compiled.announce(None)
        line.clear()
    return code


def _joined(words: Sequence[str]) -> list[str]:
    out: list[str] = []
    for word in words:
        if out and out[-1] in SIGNED:
            out[-1] += "=" + word
        else:
            out.append(word)
    return out
