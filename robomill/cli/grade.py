"""``robomill grade``: the answers of a class, marked, with the reason of every mark."""

from pathlib import Path
from typing import Any

from robomill.cli.saying import Written, say


def run_grade(arguments: Any) -> int:
    """Mark and write the table; 1 where a file could not be marked."""
    from robomill.io.results import write_files
    from robomill.io.samples import find_sample
    from robomill.learn.grading import grade
    from robomill.learn.record import marks_lines, marks_record

    place = Path(arguments.out)
    folder = find_sample("answers", arguments.folder) or arguments.folder
    found = grade(folder, arguments.robot, but=place)
    files = Written.before([place])
    write_files(place.parent, {place.name: found.csv()})
    record = marks_record(found)
    return say(arguments, record, marks_lines(record), 1 if found.unmarked else 0, files)
