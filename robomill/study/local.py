"""Points computed by processes of this machine, each its own interpreter with one thread."""

from __future__ import annotations

import json
import os
import queue
import subprocess
import sys
import threading
from collections.abc import Generator, Sequence
from contextlib import suppress
from dataclasses import asdict
from typing import IO, Any

from robomill import compiled
from robomill.study.point import Row, Task, failed

ONE_THREAD = {f"{name}_NUM_THREADS": "1" for name in ("OMP", "OPENBLAS", "MKL", "NUMBA")}
TRIES = 2  # of a point whose process dies


def processors() -> int:
    """How many processes are worth while."""
    with suppress(AttributeError):
        return max(len(os.sched_getaffinity(0)), 1)
    return os.cpu_count() or 1


def run_locally(
    task: Task, points: Sequence[Sequence[Any]], todo: Sequence[int], processes: int
) -> Generator[list[Row] | None]:
    """Rows as they come; None from time to time, for whoever wants to stop."""
    if not todo:
        return
    compiled.prepare()
    open_: queue.SimpleQueue[int] = queue.SimpleQueue()
    for point in todo:
        open_.put(point)
    rows: queue.SimpleQueue[Row | BaseException] = queue.SimpleQueue()
    hands = [_Hand(task, points, open_, rows) for _ in range(min(processes, len(todo)))]
    try:
        for hand in hands:
            hand.start()
        left = len(todo)
        while left:
            try:
                row = rows.get(timeout=0.1)
            except queue.Empty:
                yield None
                continue
            if isinstance(row, BaseException):
                raise row
            left -= 1
            yield [row]
    finally:
        for hand in hands:
            hand.stop()


class _Hand:
    """One process, and the thread that gives it points and takes rows from it."""

    def __init__(
        self,
        task: Task,
        points: Sequence[Sequence[Any]],
        todo: queue.SimpleQueue[int],
        rows: queue.SimpleQueue[Row | BaseException],
    ) -> None:
        self._task, self._points, self._todo, self._rows = task, points, todo, rows
        self._process: subprocess.Popen[str] | None = None
        self._stopped = False
        self._thread = threading.Thread(target=self._run, daemon=True)

    def start(self) -> None:
        """Begin to work."""
        self._thread.start()

    def _run(self) -> None:
        try:
            while not self._stopped:
                try:
                    point = self._todo.get_nowait()
                except queue.Empty:
                    return
                if (row := self._row(point)) is not None:
                    self._rows.put(row)
        except BaseException as wrong:  # to be raised where it is waited for
            self._rows.put(wrong)
        finally:
            self.stop()

    def _row(self, point: int) -> Row | None:
        """Computed by the process; by a new one, once, where that dies. None where it was stopped."""
        code = None
        for _ in range(TRIES):
            try:
                process = self._started()
                source, answers = _pipes(process)
                source.write(json.dumps([point, self._points[point]]) + "\n")
                source.flush()
                if line := answers.readline():
                    number, values, reason = json.loads(line)
                    return Row(number, tuple(values), reason)
            except (OSError, ValueError):
                pass  # it has ended, or in the middle of an answer: the reason is in its exit code
            if self._stopped:
                return None
            code = self._ended()
        return failed(self._task, point, f"The process that computed it ended ({_words(code)}), twice.")

    def _started(self) -> subprocess.Popen[str]:
        if self._process is None:
            self._process = subprocess.Popen(
                [sys.executable, "-m", "robomill.study.worker"],
                stdin=subprocess.PIPE,
                stdout=subprocess.PIPE,
                text=True,
                encoding="utf-8",
                env={
                    **os.environ,
                    **ONE_THREAD,
                    "PYTHONPATH": os.pathsep.join(path or os.getcwd() for path in sys.path),
                },
                start_new_session=True,  # Ctrl-C is for the one that writes down what is finished
            )
            source, _ = _pipes(self._process)
            source.write(json.dumps(asdict(self._task)) + "\n")
            source.flush()
        return self._process

    def _ended(self) -> int | None:
        process, self._process = self._process, None
        if process is None:
            return None
        with suppress(OSError):
            process.kill()
        for pipe in (process.stdin, process.stdout):
            with suppress(OSError):
                if pipe is not None:
                    pipe.close()
        return process.wait()

    def stop(self) -> None:
        """End the process."""
        self._stopped = True
        self._ended()


def _pipes(process: subprocess.Popen[str]) -> tuple[IO[str], IO[str]]:
    assert process.stdin is not None
    assert process.stdout is not None
    return process.stdin, process.stdout


def _words(code: int | None) -> str:
    if code is None:
        return "it did not start"
    return f"signal {-code}" if code < 0 else f"code {code}"
