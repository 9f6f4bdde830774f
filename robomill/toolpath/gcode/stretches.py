"""The lines of a program, and stretches of plain ones among them that are read and moved along together."""

from __future__ import annotations

import math
import sys
from collections.abc import Sequence
from typing import Any

import numpy as np

from robomill.arrays import IntArray
from robomill.toolpath.gcode import line_rules, motion_rules
from robomill.toolpath.gcode.motion_rules import LETTERS
from robomill.toolpath.gcode.program import Move
from robomill.toolpath.gcode.records import MOVE, STATE

LONG = 20_000
"""Lines of a program that is worth loading the compiled rules for."""
LOADED_LONG = 300
"""Lines of a program that is worth calling them once they are loaded."""
WORTHWHILE = 16
"""Plain lines in a row that are worth handing over to them."""
CHUNK = 1 << 15
_KERNELS = "robomill.toolpath.gcode.kernels"


class Lines(Sequence[str]):
    """The lines of a program (bytes with "\\n" between them); each is made a string when it is asked for."""

    def __init__(self, data: bytes) -> None:
        self.data = data
        ends = np.flatnonzero(np.frombuffer(data, np.uint8) == 10)
        self.starts: IntArray = np.concatenate([[0], ends + 1, [len(data) + 1]])
        self._first = -1
        self._words: Any = []
        self._run_end: Any = []

    def __len__(self) -> int:
        return len(self.starts) - 1

    def __getitem__(self, index: Any) -> Any:
        if isinstance(index, slice):
            return [self[i] for i in range(*index.indices(len(self)))]
        index = range(len(self))[index]
        return self.data[int(self.starts[index]) : int(self.starts[index + 1]) - 1].decode("utf-8", "replace")

    def is_long(self) -> bool:
        """True if the compiled rules are worth loading, or are loaded already and worth calling."""
        return len(self) >= (LOADED_LONG if _KERNELS in sys.modules else LONG)

    def plain(self, index: int) -> Any:
        """(n, 14) words of the plain lines from ``index`` on, as far as they are known; empty if it is not plain."""
        first = index - index % CHUNK
        if first != self._first:
            self._scan(first)
        at = index - first
        return self._words[at : self._run_end[at]]

    def _scan(self, first: int) -> None:
        starts = self.starts[first : first + CHUNK + 1]
        count = len(starts) - 1
        if self.is_long():
            from robomill.toolpath.gcode import kernels

            words, plain = np.full((count, len(LETTERS)), math.nan), np.zeros(count, bool)
            kernels.scan(np.frombuffer(self.data, np.uint8), starts, words, plain)
            self._words = words
        else:
            self._words, plain = [[math.nan] * len(LETTERS) for _ in range(count)], np.zeros(count, bool)
            line_rules.scan(self.data, starts.tolist(), self._words, plain)
        stops = np.where(plain, count, np.arange(count))
        self._run_end = np.minimum.accumulate(stops[::-1])[::-1].tolist()
        self._first = first


def run_plain(machine: Any, words: Any, line: int) -> int:
    """Make plain lines into moves, ``line`` the number of the first; how many of them are done."""
    if len(words) < WORTHWHILE or not isinstance(words, np.ndarray):
        rows = [Move() for _ in words]
        listed = words.tolist() if isinstance(words, np.ndarray) else words
        done, moves = motion_rules.run(machine, listed, line, rows)
        machine.recorder.extend(rows[:moves])
        return int(done)
    from robomill.toolpath.gcode import kernels

    state = np.zeros(1, STATE)
    for name in STATE.names or ():
        state[name] = getattr(machine, name)
    table = np.zeros(len(words), MOVE)
    done, moves = kernels.run(state, words, line, table)
    for name in STATE.names or ():
        setattr(machine, name, state[0][name].tolist())
    machine.recorder.extend(table[:moves])
    return int(done)
