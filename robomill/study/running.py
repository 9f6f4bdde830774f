"""A study run to its end, or as far as it comes: what is finished is kept, and gone on from."""

from __future__ import annotations

import os
import time
from collections.abc import Generator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from robomill.arguments import asked, made_by
from robomill.arrays import digest
from robomill.errors import StudyError
from robomill.extras import missing
from robomill.frames import Columns
from robomill.lazy import cached_property
from robomill.progress import checkpoint
from robomill.study.cluster import run_on_cluster
from robomill.study.described import Study, load_study
from robomill.study.kept import Kept
from robomill.study.local import processors, run_locally
from robomill.study.point import Row, Task
from robomill.units import format_count, format_duration, format_number
from robomill.values import Tabled

EACH_S, MANY = 1.0, 2000  # rows are written at least so often, and as many at once


@made_by('rm.run_study(study, "out")')
@dataclass(frozen=True, eq=False, repr=False)
class StudyResult(Tabled):
    """What came of a study.

    study    as described             folder   where its rows are kept
    rows     one a point, in their order
    resumed  how many were there from an earlier run
    seconds  that this run took

    Examples
    --------
    >>> import tempfile
    >>> import robomill as rm
    >>> study = {"setup": "paper_flute", "parameters": {"cutter.diameter_mm": {"values": [6, 8]}}}
    >>> found = rm.run_study(study, tempfile.mkdtemp())
    >>> found
    <StudyResult paper_flute: 2 of 2 points done>
    >>> found.to_dataframe()["verdict"].tolist()
    ['ok', 'ok']
    """

    study: Study
    folder: Path
    rows: tuple[Row, ...]
    resumed: int
    seconds: float

    @property
    def done(self) -> int:
        """Points that have their numbers."""
        return sum(not row.reason for row in self.rows)

    @property
    def failed(self) -> int:
        """Points that have none, each with its reason."""
        return len(self.rows) - self.done

    def columns(self) -> Columns:
        """One row a point: its number, the parameters in the units of their keys, the responses, and why there are
        none."""
        found: Columns = {"point": np.array([row.point for row in self.rows], dtype=np.int64)}
        for i, key in enumerate(self.study.keys):
            found[key] = np.array([self.study.points[row.point][i] for row in self.rows])
        for i, name in enumerate(self.study.responses):
            found[name] = np.array([row.values[i] for row in self.rows])
        return found | {"reason": np.array([row.reason for row in self.rows])}

    @cached_property
    def _digest(self) -> str:
        return digest((self.study.digest(), [repr(row) for row in self.rows]))

    def _said(self) -> str:
        lost = f", {self.failed} failed" if self.failed else ""
        return f"{self.study.name}: {self.done} of {format_count(len(self.rows), 'point')} done{lost}"


@asked
def run_study(
    study: Study | str | Path | Mapping[str, Any],
    out: str | Path,
    *,
    scheduler: str | None = None,
    processes: int | None = None,
) -> StudyResult:
    """Every point of a study, on this machine's processors or on a Dask cluster.

    Parameters
    ----------
    study : Study, str, Path or mapping
        A study, its TOML file, or what stands in it.
    out : str or Path
        The folder that its rows are kept in as they come. Where it holds some of this study already, only the others
        are computed.
    scheduler : str, optional
        Address of a Dask scheduler, as ``tcp://host:8786``; left out: processes of this machine.
    processes : int, optional
        How many of those; left out: one a processor.

    Returns
    -------
    StudyResult
        All rows; ``done``, ``failed``, ``resumed`` and ``seconds``.

    Raises
    ------
    StudyError
        For a study that cannot be run, a folder that holds another one, a scheduler that is not there or has gone, and
        a disk that is full: what was finished before is kept.

    Notes
    -----
    A point that is refused fails with its reason, and the others go on. Rows are the same to the last digit wherever
    they are computed and however often the study is stopped: ``results.parquet`` in ``out`` is the same file.

    Examples
    --------
    >>> import tempfile
    >>> import robomill as rm
    >>> tolerances = {"tolerance_mm": {"low": 0.1, "high": 0.4, "steps": 4}}
    >>> found = rm.run_study({"setup": "paper_flute", "parameters": tolerances}, tempfile.mkdtemp(), processes=1)
    >>> found.to_dataframe()["share"].round(2).tolist()
    [2.3, 1.15, 0.77, 0.57]
    """
    absent = missing("A study", "study", "pyarrow")
    if absent is not None:
        raise absent
    if scheduler is not None and (absent := missing("A study on a Dask cluster", "study", "distributed")) is not None:
        raise absent
    _check(out, processes, scheduler)
    asked_for = study if isinstance(study, Study) else load_study(study)
    began, kept = time.monotonic(), Kept(Path(out), asked_for)
    rows = kept.opened()
    resumed = len(rows)
    todo = [point for point in range(len(asked_for.points)) if point not in rows]
    task = Task(asked_for.data, tuple(asked_for.keys), asked_for.responses)
    if scheduler is not None and todo:
        coming = run_on_cluster(task, asked_for.points, todo, scheduler)
    else:
        coming = run_locally(task, asked_for.points, todo, processes or processors())
    _Writing(kept, rows, len(asked_for.points)).take(coming)
    ordered = tuple(rows[point] for point in sorted(rows))
    kept.finish(ordered)
    return StudyResult(asked_for, kept.folder, ordered, resumed, time.monotonic() - began)


def _check(out: Any, processes: Any, scheduler: Any) -> None:
    if not isinstance(out, str | os.PathLike) or not str(out).strip():
        raise StudyError(f"Study: out is {out!r:.40}; expected the name of a folder.", where="out")
    if processes is not None and not (isinstance(processes, int) and not isinstance(processes, bool) and processes > 0):
        raise StudyError(
            f"Study: processes is {processes!r:.40}; expected a whole number from 1 on.", where="processes"
        )
    if scheduler is not None and not (isinstance(scheduler, str) and "://" in scheduler):
        raise StudyError(
            f"Study: the scheduler is {scheduler!r:.60}; expected its address, as tcp://host:8786.", where="scheduler"
        )


@dataclass(frozen=True, eq=False)
class _Writing:
    """Rows that come in and are written down."""

    kept: Kept
    rows: dict[int, Row]
    count: int

    def take(self, coming: Generator[list[Row] | None]) -> None:
        """All that come, written at least every second, and whatever happens at the end."""
        began, first, fresh, told = time.monotonic(), len(self.rows), list[Row](), time.monotonic()
        try:
            for some in coming:
                fresh += some or ()
                self.rows.update({row.point: row for row in some or ()})
                now = time.monotonic()
                if fresh and (len(fresh) >= MANY or now - told > EACH_S):
                    writing, fresh, told = fresh, [], now
                    self.kept.add(writing)
                checkpoint(len(self.rows) / self.count, "Points", self._pace(len(self.rows) - first, now - began))
        finally:
            try:
                if fresh:
                    self.kept.add(fresh)
            finally:
                coming.close()

    def _pace(self, done: int, seconds: float) -> str:
        """How fast it goes, and how long it takes yet."""
        if not done:
            return ""
        left = (self.count - len(self.rows)) * seconds / done
        return f"{format_number(done / seconds, 1)} a second, {format_duration(left, 0)} left"
