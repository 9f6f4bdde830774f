"""A process that computes points: a task comes in by standard input, then points, and rows go out by standard output.

Lines of JSON, whose numbers are exact to the last digit. It imports nothing of the program that started it, so that a
script or a notebook needs no guard around what it does.
"""

import json
import os
import sys
from typing import IO

from robomill.study.point import Task, computed


def serve(source: IO[str], answers: IO[str]) -> None:
    """Compute until nothing more comes."""
    task = Task(**json.loads(source.readline()))
    for line in source:
        point, values = json.loads(line)
        row = computed(task, point, values)
        answers.write(json.dumps([row.point, row.values, row.reason]) + "\n")
        answers.flush()


if __name__ == "__main__":
    out = os.fdopen(os.dup(sys.stdout.fileno()), "w", encoding="utf-8")
    os.dup2(sys.stderr.fileno(), sys.stdout.fileno())  # what a library prints is no answer
    try:
        serve(sys.stdin, out)
    except (KeyboardInterrupt, BrokenPipeError):
        sys.exit(130)
