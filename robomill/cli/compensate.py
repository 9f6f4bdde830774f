"""``robomill compensate``: the program that sends the tool elsewhere, so that it goes where it was meant to go."""

import shlex
from pathlib import Path
from typing import Any

from robomill.cli import given
from robomill.cli.saying import Written, say
from robomill.errors import ProjectError, RobomillError


def run_compensate(arguments: Any) -> int:
    """Correct the program of a set-up and write it."""
    from robomill.improve.errors import level_of
    from robomill.io.compensated import compensate
    from robomill.io.results import write_files
    from robomill.report.compensation_record import compensation_lines, compensation_record
    from robomill.simulation.judging.verdict_words import RED

    setup = given.setup(arguments.setup, arguments.allow_outside)
    place = Path(arguments.out)
    _check_kept(place, arguments.setup, setup.source)
    found = compensate(setup, arguments.components, bound_um=arguments.bound_um)
    files = Written.before([place])
    write_files(place.parent, {place.name: found.text})
    record = compensation_record(found)
    check = ["robomill", "simulate", arguments.setup, "--program", arguments.out]
    lines = [*compensation_lines(record), f"to check  {shlex.join(check)}"]
    return say(arguments, record, lines, int(level_of(found.led) in RED), files)


def _check_kept(place: Path, setup: str, source: Any) -> None:
    """Refuse to write over the program that is corrected, wherever the set-up has it from."""
    said, place = place, place.resolve()  # of a folder that is made on the way, and left again, nothing is there yet
    if not place.is_file():
        return
    folder = Path(setup) if Path(setup).is_dir() else Path(setup).parent
    beside = folder / source.name
    same = beside.is_file() and place.samefile(beside)
    if same or _text(place) == getattr(source, "text", ""):
        raise ProjectError(f"--out {said}: the program to be corrected stands there and would be lost; give another.")


def _text(place: Path) -> str | None:
    """What stands there as programs are read, whatever its encoding; None of what is no program."""
    from robomill.io.programs import read_program

    try:
        return read_program(place).text
    except RobomillError:
        return None
