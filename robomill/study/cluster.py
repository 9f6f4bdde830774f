"""Points computed by the workers of a Dask scheduler: the same function with the same numbers, on other machines."""

from __future__ import annotations

import logging
import queue
import time
from collections.abc import Generator, Iterator, Sequence
from contextlib import contextmanager, suppress
from typing import Any

from robomill.errors import StudyError
from robomill.extras import needed
from robomill.study.kept import resume_words
from robomill.study.point import Row, Task, computed, failed, version

FIRST_S = 10.0  # that a scheduler has to answer, and to show a worker
PATIENCE_S = 30.0  # without any worker
AHEAD = 3  # pieces of work a thread, so that nobody waits
PIECE_S, LARGEST = 0.5, 256  # what a piece should take, and points that it has at most
LOOK_S = 2.0  # between looks at who is there
LOGGERS = ("distributed", "distributed.client")


def run_on_cluster(
    task: Task, points: Sequence[Sequence[Any]], todo: Sequence[int], address: str
) -> Generator[list[Row] | None]:
    """Rows as they come; None from time to time. Raises StudyError where the scheduler or all workers are gone."""
    with needed("A study on a Dask cluster"):
        import distributed
    with _quiet():
        try:
            client = distributed.Client(address, timeout=FIRST_S, set_as_default=False, heartbeat_interval="1s")
        except (OSError, ValueError, TimeoutError, ImportError) as exc:
            raise StudyError(
                f"No Dask scheduler answers at {address} ({str(exc) or type(exc).__name__:.80}); start one with 'dask "
                f"scheduler', or leave --scheduler out to compute here. {resume_words().capitalize()}",
                where="scheduler",
            ) from None
        try:
            yield from _Cluster(client, address, task, points).rows(list(todo))
        finally:
            with suppress(Exception):  # it may be gone: nothing of this study is there to be lost
                client.close(timeout=2)


@contextmanager
def _quiet() -> Iterator[None]:
    """What Dask logs of comings and goings is told here in sentences. Its client has a logger with a level of its own,
    which the one above it does not change."""
    loggers = [logging.getLogger(name) for name in LOGGERS]
    before = [logger.level for logger in loggers]
    for logger in loggers:
        logger.setLevel(logging.CRITICAL + 1)
    try:
        yield
    finally:
        for logger, level in zip(loggers, before, strict=True):
            logger.setLevel(level)


def same(task: Task) -> Task:
    """The task as a thing of the cluster's own, which is made anew where a worker that holds it ends."""
    return task


def computed_piece(task: Task, piece: list[tuple[int, Sequence[Any]]]) -> tuple[list[Row], float]:
    """Rows of some points, and the seconds that they took."""
    began = time.perf_counter()
    rows = [computed(task, point, values) for point, values in piece]
    return rows, time.perf_counter() - began


class _Cluster:
    """Work that goes out in pieces, and comes back."""

    def __init__(self, client: Any, address: str, task: Task, points: Sequence[Sequence[Any]]) -> None:
        self._client, self._address, self._task, self._points = client, address, task, points
        self._back: queue.SimpleQueue[Any] = queue.SimpleQueue()
        self._out: dict[Any, list[int]] = {}
        self._size = 1

    def rows(self, todo: list[int]) -> Generator[list[Row] | None]:
        threads = self._workers()
        shared = self._client.submit(same, self._task, pure=False)
        todo.reverse()
        alone: list[int] = []  # whose worker ended: each by itself, to know which of them ends it
        looked = missing = time.monotonic()
        while todo or alone or self._out:
            while (todo or alone) and len(self._out) < AHEAD * threads:
                piece = [alone.pop()] if alone else [todo.pop() for _ in range(min(self._size, len(todo)))]
                self._send(shared, piece)
            future = self._next()
            if future is None:
                yield None
                if time.monotonic() - looked > LOOK_S:
                    looked = time.monotonic()
                    there = self._threads()
                    missing, threads = (looked, there) if there else (missing, threads)
                    if looked - missing > PATIENCE_S:
                        raise self._lost("has no workers any more")
                continue
            piece = self._out.pop(future.key)
            missing = time.monotonic()
            rows = self._answer(future, piece)
            if rows is None:
                alone += piece
                if future.status not in ("finished", "error"):  # the task itself may have gone with its worker
                    shared = self._client.submit(same, self._task, pure=False)
            else:
                yield rows

    def _next(self) -> Any:
        """Work that came back; None where none has for a while."""
        try:
            return self._back.get(timeout=0.2)
        except queue.Empty:
            return None

    def _send(self, shared: Any, piece: list[int]) -> None:
        try:
            work = [(point, self._points[point]) for point in piece]
            future = self._client.submit(computed_piece, shared, work, pure=False)
        except Exception as exc:  # of a client whose scheduler has gone: several kinds
            raise self._lost(f"is gone ({type(exc).__name__})") from None
        self._out[future.key] = piece
        future.add_done_callback(self._back.put)

    def _answer(self, future: Any, piece: list[int]) -> list[Row] | None:
        """Rows of a piece; None where its worker ended or was taken down, and its points are to be tried one by one."""
        if future.status == "finished":
            try:
                rows, seconds = future.result(timeout=FIRST_S)
            except Exception:  # it finished, and its worker ended before anybody had asked for it
                self._threads()
                return None
            self._size = max(1, min(LARGEST, int(PIECE_S * len(piece) / max(seconds, 1e-3))))
            return list(rows)
        if future.status != "error":  # lost or cancelled with a worker that left
            self._threads()
            return None
        wrong = future.exception(timeout=FIRST_S)
        if type(wrong).__name__ == "KilledWorker":  # Dask's own, which has no other mark
            if len(piece) > 1:
                return None
            return [failed(self._task, piece[0], "The workers that computed it ended, one after the other.")]
        raise StudyError(
            f"A worker of {self._address} cannot compute a point ({type(wrong).__name__}: {wrong!s:.120}); "
            f"{resume_words()}",
            where="scheduler",
        )

    def _workers(self) -> int:
        """How many threads there are. Raises StudyError where there is none, or one of another robomill."""
        began = time.monotonic()
        while not (threads := self._threads()):
            if time.monotonic() - began > FIRST_S:
                raise StudyError(
                    f"The Dask scheduler at {self._address} has no workers; start some with 'dask worker "
                    f"{self._address}'. {resume_words().capitalize()}",
                    where="scheduler",
                )
            time.sleep(0.1)
        try:
            found = set(self._client.run(version).values())
        except Exception as exc:  # whatever a worker raises that has no robomill
            raise StudyError(
                f"The workers of {self._address} cannot run robomill ({type(exc).__name__}: {exc!s:.80}); install "
                f"robomill {version()} where they run.",
                where="scheduler",
            ) from None
        if found != {ours := version()}:
            others = ", ".join(sorted(found - {ours}))
            raise StudyError(
                f"The workers of {self._address} run robomill {others}, and this is {ours}; install the same.",
                where="scheduler",
            )
        return threads

    def _threads(self) -> int:
        """Of all workers. Raises StudyError where the scheduler does not answer."""
        if self._client.status != "running":
            raise self._lost("is gone")
        try:
            return sum(self._client.nthreads().values())
        except Exception as exc:  # of a client whose scheduler has gone: several kinds
            raise self._lost(f"is gone ({type(exc).__name__})") from None

    def _lost(self, what: str) -> StudyError:
        return StudyError(
            f"The Dask scheduler at {self._address} {what}; {resume_words()}",
            where="scheduler",
        )
