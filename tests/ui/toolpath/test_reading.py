"""Reading beside the page: progress, cancel, refusals."""

from __future__ import annotations

from robomill.errors import GCodeError
from robomill.toolpath.source import GCodeSource
from robomill.ui.work.job import Job


def program(lines: int) -> str:
    body = "\n".join(f"G1 X{i % 100} Y{i % 7}" for i in range(lines))
    return f"G21 G90\nS1000 M3\nG0 Z5\nG1 Z-1 F600\n{body}\nG0 Z5\nM2\n"


def finished(job: Job) -> Job:
    job.start()
    assert job.done.wait(60)
    return job


def test_a_program_is_read_and_kept_for_the_page() -> None:
    source = GCodeSource(program(30_000), "long.nc")
    job = finished(Job(source.read, source))
    assert job.error is None
    assert job.bug is None
    assert job.progress.share > 0.9
    assert source.read() is GCodeSource(program(30_000), "long.nc").read(), "what was read is not read again"


def test_a_refusal_is_handed_over_with_its_line() -> None:
    source = GCodeSource(program(2_000).replace("M2", "G2 X55.5"))
    job = finished(Job(source.read, source))
    assert isinstance(job.error, GCodeError)
    assert job.error.line == 2006


def test_a_reading_that_is_given_up_stops() -> None:
    source = GCodeSource(program(60_000).replace("G21", "G21 "), "stopped.nc")
    job = Job(source.read, source)
    job.stop.set()
    finished(job)
    assert job.made is None
    assert job.progress.share < 1.0
    assert (job.error, job.bug) == (None, None), "what a person stops is no refusal"
