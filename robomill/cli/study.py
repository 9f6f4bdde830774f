"""``robomill study``: many runs of a set-up, here or on a Dask cluster, kept as they come."""

import sys
from pathlib import Path
from typing import Any

from robomill.cli import given
from robomill.cli.saying import Written, say


def run_study(arguments: Any) -> int:
    """Run what is not finished yet; 1 where no point came out."""
    from robomill.extras import missing
    from robomill.study.kept import RESULTS, resume_words
    from robomill.study.record import study_lines, study_record
    from robomill.study.running import run_study as run

    absent = missing("A study", "study", "pyarrow")
    if absent is not None:
        raise absent
    study = given.study(arguments.study, arguments.allow_outside)
    place = Path(arguments.out) / RESULTS
    files = Written.before([place])
    try:
        found = run(study, arguments.out, scheduler=arguments.scheduler, processes=arguments.processes)
    except KeyboardInterrupt:
        print(f"\nrobomill: stopped; {resume_words()}", file=sys.stderr)
        raise
    record = study_record(found)
    return say(arguments, record, study_lines(record), 0 if found.done else 1, files=files)
