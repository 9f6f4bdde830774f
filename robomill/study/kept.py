"""The folder of a study: what it is of, finished points in Parquet parts as they come, the whole table at the end.

study.json        the description's digest, and what it was made of, for people
parts/*.parquet   rows in the order in which they came; each file is complete, or is not there
results.parquet   all rows by their number, when none is missing: the same file however often the study was stopped
"""

from __future__ import annotations

import json
import os
import uuid
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from robomill.errors import StudyError
from robomill.extras import needed
from robomill.files import shown_place, write_whole, written
from robomill.io.results import json_text
from robomill.study.described import Study
from robomill.study.point import Row, version
from robomill.study.responses import WORDS

MARK, PARTS, RESULTS = "study.json", "parts", "results.parquet"


@dataclass(frozen=True, eq=False)
class Kept:
    """The folder of one study."""

    folder: Path
    study: Study

    def opened(self) -> dict[int, Row]:
        """What is finished there; a folder that is new, or holds no study, becomes this study's. Raises StudyError."""
        mark = self.folder / MARK
        try:
            found = json.loads(mark.read_text(encoding="utf-8")) if mark.exists() else {}
            digest, name = (str(found["digest"]), str(found["name"])) if mark.exists() else ("", "")
        except (OSError, ValueError, KeyError, TypeError):
            raise StudyError(
                f"{shown_place(mark)}: it does not say which study this folder is of; give another folder.", where="out"
            ) from None
        if digest and digest != self.study.digest():
            raise StudyError(
                f"{shown_place(self.folder)}: this folder holds another study, or {name!r:.60} as it was described "
                "before; give another folder, or take back what was changed.",
                where="out",
            )
        try:
            (self.folder / PARTS).mkdir(parents=True, exist_ok=True)
        except OSError as exc:
            raise StudyError(f"{shown_place(self.folder)}: cannot write there ({exc.strerror}).", where="out") from None
        if not digest:
            self._mark()
        return self._rows()

    def _mark(self) -> None:
        study = self.study
        record = {
            "robomill": version(),
            "digest": study.digest(),
            "name": study.name,
            "design": {"kind": study.kind, "points": len(study.points), "seed": study.seed},
            "parameters": study.keys,
            "responses": list(study.responses),
            "setup": study.setup.digest(),
        }
        write_whole(self.folder / MARK, json_text(record), StudyError)

    def _rows(self) -> dict[int, Row]:
        """Rows of all parts by point; what stops in the middle of being written has left none."""
        with needed_parquet():
            import pyarrow as pa
            import pyarrow.parquet as pq
        found: dict[int, Row] = {}
        for part in sorted((self.folder / PARTS).glob("[!.]*.parquet")):  # others were cut off
            try:
                table = pq.read_table(part).to_pydict()
                rows = zip(
                    table["point"], table["reason"], *(table[name] for name in self.study.responses), strict=True
                )
                found |= {int(point): Row(int(point), tuple(values), reason) for point, reason, *values in rows}
            except (OSError, KeyError, ValueError, pa.ArrowException) as exc:
                raise StudyError(
                    f"{shown_place(part)}: this part cannot be read ({exc!s:.80}); delete it, and its points are "
                    "computed again.",
                    where="out",
                ) from None
        return {point: row for point, row in found.items() if 0 <= point < len(self.study.points)}

    def add(self, rows: Sequence[Row]) -> None:
        """Write rows as one more part. Raises StudyError where there is no room."""
        self._write(self.folder / PARTS / f"{os.getpid()}-{uuid.uuid4().hex}.parquet", rows)

    def finish(self, rows: Iterable[Row]) -> Path:
        """Write the whole table, once every point has its row."""
        place = self.folder / RESULTS
        self._write(place, sorted(rows, key=lambda row: row.point))
        return place

    def _write(self, place: Path, rows: Sequence[Row]) -> None:
        with needed_parquet():
            import pyarrow as pa
            import pyarrow.parquet as pq
        text, number = pa.string(), pa.float64()
        columns: dict[str, Any] = {"point": pa.array([row.point for row in rows], pa.int64())}
        for i, each in enumerate(self.study.parameters):
            values = [self.study.points[row.point][i] for row in rows]
            plain = all(isinstance(value, int | float) and not isinstance(value, bool) for value in each.tried)
            columns[each.key] = pa.array(values, number if plain else None)
        for i, name in enumerate(self.study.responses):
            columns[name] = pa.array([row.values[i] for row in rows], text if name in WORDS else number)
        columns["reason"] = pa.array([row.reason for row in rows], text)
        with written(place, StudyError, resume_words()) as beside:
            pq.write_table(pa.table(columns), beside)


def resume_words() -> str:
    """How what is finished is gone on from."""
    return "what was finished before is kept: the same study with the same folder goes on from there."


def needed_parquet() -> Any:
    """What is raised where Parquet cannot be written."""
    return needed("A study")
