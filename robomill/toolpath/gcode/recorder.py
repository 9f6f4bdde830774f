"""Where the interpreter writes its moves: rows that become the arrays of a Program."""

from __future__ import annotations

from typing import Any

import numpy as np

from robomill.errors import GCodeError
from robomill.toolpath.gcode.program import ARC

MAX_MOVES = 6_000_000
_FLUSH = 16_384
COLUMNS: dict[str, tuple[Any, int]] = {
    "line": (np.int32, 1),
    "kind": (np.int8, 1),
    "start": (np.float64, 3),
    "end": (np.float64, 3),
    "rotary0": (np.float64, 3),
    "rotary": (np.float64, 3),
    "plane": (np.int8, 1),
    "centre": (np.float64, 3),
    "turns": (np.int32, 1),
    "clockwise": (np.bool_, 1),
    "v_f": (np.float64, 1),
    "n_s": (np.float64, 1),
    "tool": (np.int32, 1),
}
"""Columns of a move: type and width. Lengths in m in the machine frame, angles in rad."""

Point = tuple[float, float, float]
_ZERO: Point = (0.0, 0.0, 0.0)


class Recorder:
    """Collects moves. ``at`` is the tip in the machine frame (m), ``turned`` the rotary axes (rad)."""

    def __init__(self) -> None:
        self.at: Point = _ZERO
        self.turned: Point = _ZERO
        self.v_f = 0.0
        self.n_s = 0.0
        self.tool = 0
        self.count = 0
        self._rows: list[tuple[Any, ...]] = []
        self._chunks: list[dict[str, np.ndarray]] = []

    def move(self, line: int, kind: int, end: Point, turned: Point, v_f: float) -> None:
        """A straight move (traverse, feed, tap or probe) to ``end``."""
        self._add((line, kind, *self.at, *end, *self.turned, *turned, 0, *_ZERO, 0, False, v_f, self.n_s, self.tool))
        self.at, self.turned = end, turned

    def arc(self, line: int, end: Point, turned: Point, plane: int, centre: Point, turn: int, v_f: float) -> None:
        """An arc to ``end``; ``turn`` counts started turns, negative for clockwise."""
        self._add(
            (
                line,
                ARC,
                *self.at,
                *end,
                *self.turned,
                *turned,
                plane,
                *centre,
                abs(turn),
                turn < 0,
                v_f,
                self.n_s,
                self.tool,
            )
        )
        self.at, self.turned = end, turned

    def _add(self, row: tuple[Any, ...]) -> None:
        self._rows.append(row)
        self.count += 1
        if len(self._rows) >= _FLUSH:
            self._flush()
            if self.count > MAX_MOVES:
                raise GCodeError(
                    f"Line {row[0]}: the program makes more than {MAX_MOVES} moves; split it.", line=int(row[0])
                )

    def extend(self, columns: dict[str, np.ndarray]) -> None:
        """Many moves at once, as arrays by column name (missing ones are 0)."""
        self._flush()
        self._chunks.append(columns)
        self.count += len(columns["line"])
        if self.count > MAX_MOVES:
            raise GCodeError(f"Program: makes more than {MAX_MOVES} moves; split it.")

    def _flush(self) -> None:
        if not self._rows:
            return
        table = np.array(self._rows, dtype=np.float64)
        self._rows = []
        chunk, column = {}, 0
        for name, (dtype, width) in COLUMNS.items():
            part = table[:, column : column + width]
            chunk[name] = np.ascontiguousarray(part if width > 1 else part[:, 0]).astype(dtype)
            column += width
        self._chunks.append(chunk)

    def columns(self) -> dict[str, np.ndarray]:
        """All moves, by column name; columns that are 0 throughout are not stored twice."""
        self._flush()
        chunks, self._chunks = self._chunks, []
        out: dict[str, np.ndarray] = {}
        for name, (dtype, width) in COLUMNS.items():
            shape = (self.count, width) if width > 1 else (self.count,)
            parts = [chunk.get(name) for chunk in chunks]
            if all(part is None or not part.any() for part in parts):
                out[name] = np.broadcast_to(np.zeros(1, dtype), shape)
                continue
            whole, row = np.zeros(shape, dtype), 0
            for chunk, part in zip(chunks, parts):
                n = len(chunk["line"])
                if part is not None:
                    whole[row : row + n] = part
                row += n
                chunk.pop(name, None) if name != "line" else None
            whole.flags.writeable = False
            out[name] = whole
        return out
