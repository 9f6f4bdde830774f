"""The same study on Dask: the same rows to the last digit, also where workers are killed; schedulers that go away."""

import os
import re
import signal
import subprocess
import sys
import time
from collections.abc import Iterator
from pathlib import Path

import pytest

import robomill as rm
from robomill.errors import StudyError
from robomill.progress import Progress, watched
from robomill.study import cluster
from robomill.study.kept import Kept

pytest.importorskip("distributed")
pytest.importorskip("pyarrow")

COARSE = rm.load_setup("paper_flute").replace(step=20e-3, cell=8e-4)
ENV = {**os.environ, "PYTHONPATH": os.pathsep.join(sys.path), "OPENBLAS_NUM_THREADS": "1"}


def drawn(count: int) -> rm.Study:
    force = {"force.feed_normal_N": {"low": 50.0, "high": 150.0}}
    design = {"kind": "sobol", "points": count, "seed": 5}
    return rm.load_study({"setup": COARSE, "design": design, "parameters": force})


class Dask:
    """A scheduler and its workers, each a process of its own."""

    def __init__(self) -> None:
        self.workers: list[subprocess.Popen] = []
        words = ["scheduler", "--host", "127.0.0.1", "--port", "0", "--no-dashboard"]
        self.scheduler = self._started(*words)
        assert self.scheduler.stderr is not None
        for line in self.scheduler.stderr:
            if found := re.search(rb"tcp://127\.0\.0\.1:\d+", line):
                self.address = found[0].decode()
                return
        raise AssertionError("no scheduler")

    def _started(self, *words: str) -> subprocess.Popen:
        program = f"import sys; from distributed.cli.dask_{words[0]} import main; sys.exit(main())"
        return subprocess.Popen([sys.executable, "-c", program, *words[1:]], stderr=subprocess.PIPE, env=ENV)

    def work(self, count: int, *more: str) -> None:
        for _ in range(count):
            words = [
                self.address,
                "--nthreads",
                "1",
                *(more or ("--no-nanny",)),
                "--no-dashboard",
                "--host",
                "127.0.0.1",
            ]
            self.workers.append(self._started("worker", *words))

    def end(self) -> None:
        for process in (*self.workers, self.scheduler):
            process.kill()
            process.wait()


@pytest.fixture
def dask() -> Iterator[Dask]:
    one = Dask()
    yield one
    one.end()


@pytest.mark.parametrize("end", [signal.SIGKILL, signal.SIGTERM])
def test_a_worker_that_ends_loses_nothing_and_rows_are_those_of_this_machine(
    dask: Dask, tmp_path: Path, end: signal.Signals
) -> None:
    study, killed = drawn(120), []
    dask.work(2, *(["--nanny"] if end == signal.SIGTERM else []))

    def say(now: Progress) -> None:
        if now.share > 0.2 and not killed:
            killed.append(now.share)
            dask.workers[0].send_signal(end)

    with watched(Progress(say=say)):
        there = rm.run_study(study, tmp_path / "there", scheduler=dask.address)
    assert killed
    here = rm.run_study(study, tmp_path / "here")
    assert (there.done, there.failed) == (120, 0)
    assert there == here
    both = [(tmp_path / name / "results.parquet").read_bytes() for name in ("there", "here")]
    assert both[0] == both[1]


def test_a_scheduler_that_dies_is_one_sentence_on_the_command_line(dask: Dask, tmp_path: Path) -> None:
    """Dask's client, which seeks it for a while and is then closed, logs how it came out of that with a traceback."""
    dask.work(1)
    lines = [
        'format = "robomill-study"\nversion = 1\nsetup = "paper_flute"',
        '[design]\nkind = "sobol"\npoints = 400',
        '[parameters."force.feed_normal_N"]\nlow = 50.0\nhigh = 150.0',
    ]
    (tmp_path / "study.toml").write_text("\n".join(lines))
    words = ["study", str(tmp_path / "study.toml"), "--out", str(tmp_path / "out"), "--scheduler", dask.address]
    run = subprocess.Popen([sys.executable, "-m", "robomill", *words], stderr=subprocess.PIPE, env=ENV)
    parts, began = tmp_path / "out" / "parts", time.monotonic()
    while not (parts.is_dir() and any(parts.iterdir())) and time.monotonic() - began < 60.0:
        time.sleep(0.05)
    dask.scheduler.send_signal(signal.SIGKILL)
    _, said = run.communicate(timeout=120)
    assert run.returncode == 2
    assert re.fullmatch(rb"robomill: The Dask scheduler at [^\n]* is gone[^\n]*goes on from there\.\n", said), said


def test_a_scheduler_that_dies_loses_nothing_and_the_study_goes_on_here(dask: Dask, tmp_path: Path) -> None:
    study, killed = drawn(150), []
    dask.work(1)

    def say(now: Progress) -> None:
        if now.share > 0.1 and not killed:
            killed.append(now.share)
            dask.scheduler.send_signal(signal.SIGKILL)

    with pytest.raises(StudyError, match="is gone.*goes on from there") as said, watched(Progress(say=say)):
        rm.run_study(study, tmp_path / "lost", scheduler=dask.address)
    assert said.value.where == "scheduler"
    there = len(Kept(tmp_path / "lost", study).opened())
    assert 15 <= there < 150
    found = rm.run_study(study, tmp_path / "lost")
    assert (found.resumed, found.done) == (there, 150)


def test_no_scheduler_and_no_workers_are_told_with_what_to_do(
    dask: Dask, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(cluster, "FIRST_S", 1.0)
    began = time.monotonic()
    with pytest.raises(StudyError, match="No Dask scheduler answers at tcp://127.0.0.1:1 .*'dask scheduler'"):
        rm.run_study(drawn(2), tmp_path, scheduler="tcp://127.0.0.1:1")
    with pytest.raises(StudyError, match=f"at {dask.address} has no workers; start some with 'dask worker"):
        rm.run_study(drawn(2), tmp_path, scheduler=dask.address)
    assert time.monotonic() - began < 30.0


def test_workers_of_another_version_are_refused(dask: Dask, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    dask.work(1)
    before = rm.__version__
    monkeypatch.setattr(rm, "__version__", "9.9")
    with pytest.raises(StudyError, match=f"run robomill {before}, and this is 9.9; install the same"):
        rm.run_study(drawn(2), tmp_path, scheduler=dask.address)
