"""Lines of a program, and stretches of plain ones among them that are read and moved along together.

A line is plain if it holds only N, G0 to G3, X Y Z A B C I J K R F S, each once with a plain number, and comments
that say nothing to the machine. ``scan`` reads those and leaves all others to the reader of ``words``. Like the rules
of ``motion`` it is plain Python, compiled where a program is long.
"""

from __future__ import annotations

import functools
import inspect
import math
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from robomill.arrays import IntArray
from robomill.compiled import cache_folder, cached_in
from robomill.toolpath.gcode import motion
from robomill.toolpath.gcode.motion import LETTERS, MOVE, STATE, F, G, S
from robomill.toolpath.gcode.program import Move

MAX_LINE = 100_000
"""Characters of a line that can be read."""
LONG = 20_000
"""Lines of a program that is worth loading the compiled rules for."""
LOADED_LONG = 300
"""Lines of a program that is worth calling them once they are loaded."""
WORTHWHILE = 16
"""Plain lines in a row that are worth handing over to them."""
CHUNK = 1 << 15

_MAX_DIGITS = 15
_TENS = tuple(10.0**n for n in range(_MAX_DIGITS + 1))
_BLANKS = (9, 11, 12, 13, 32)
_COLUMNS = tuple(
    next((i for i, letter in enumerate(LETTERS[:-1]) if code in (ord(letter), ord(letter.upper()))), -1)
    for code in range(256)
)


# --- plain lines: plain Python for lists and bytes, or compiled for arrays
def scan(text, starts, words, plain) -> None:  # type: ignore[no-untyped-def]
    """Read the lines of ``text`` (bytes) that begin at ``starts`` (n + 1) into rows of ``words`` (n, 14)."""
    for i in range(len(starts) - 1):
        plain[i] = _scan_line(text, starts[i], starts[i + 1] - 1, words[i])


def _scan_line(text, at, end, w) -> bool:  # type: ignore[no-untyped-def]
    """The words of a line by the indices of ``motion``; False if it is not plain."""
    if end - at > MAX_LINE:
        return False
    fresh = True
    while at < end:
        code = text[at]
        at += 1
        if code in _BLANKS:
            continue
        if code == 59:  # ; and the rest is a comment
            return True
        if code == 40:  # ( ... ), where a comma may make it a message
            while at < end and text[at] not in (40, 41, 44):
                at += 1
            if at == end or text[at] != 41:
                return False
            at += 1
            continue
        column = _COLUMNS[code]
        if column < 0 and not (fresh and code in (78, 110)):  # N comes first
            return False
        fresh = False
        negative, value = False, 0
        digits, decimals, signs = 0, -1, 0
        while at < end:
            code = text[at]
            if 48 <= code <= 57:
                value = value * 10 + (code - 48)
                digits += 1
                decimals += 1 if decimals >= 0 else 0
            elif code == 46 and decimals < 0:
                decimals = 0
            elif code in (43, 45) and digits == 0 and decimals < 0 and signs == 0:
                negative, signs = code == 45, 1
            elif code not in _BLANKS:
                break
            at += 1
            if digits > _MAX_DIGITS:
                return False
        if digits == 0 or (column < 0 and signs > 0):
            return False
        if column >= 0:
            if not math.isnan(w[column]):
                return False
            number = value / _TENS[max(decimals, 0)]  # an exact integer by an exact power: the nearest double
            w[column] = -number if negative else number
    if w[F] < 0.0 or w[S] < 0.0:
        return False
    if not math.isnan(w[G]):
        w[G] = 10.0 * w[G]
        return w[G] in (0.0, 10.0, 20.0, 30.0)
    return True


@functools.cache
def compiled() -> tuple[Callable[..., Any], Callable[..., Any]]:
    """``scan`` and ``motion.run`` as machine code, from the cache on disk where it has them."""
    import numba
    from numba.extending import register_jitable

    rules = (f for _, f in inspect.getmembers(motion, inspect.isfunction) if f.__module__ == motion.__name__)
    for rule in (_scan_line, *rules):
        register_jitable(rule)
    with cached_in(cache_folder([Path(__file__), Path(motion.__file__)])):
        return numba.njit(cache=True, nogil=True)(scan), numba.njit(cache=True, nogil=True)(motion.run)


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
        return len(self) >= (LOADED_LONG if compiled.cache_info().currsize else LONG)

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
            words, plain = np.full((count, len(LETTERS)), math.nan), np.zeros(count, bool)
            compiled()[0](np.frombuffer(self.data, np.uint8), starts, words, plain)
            self._words = words
        else:
            self._words, plain = [[math.nan] * len(LETTERS) for _ in range(count)], np.zeros(count, bool)
            scan(self.data, starts.tolist(), self._words, plain)
        stops = np.where(plain, count, np.arange(count))
        self._run_end = np.minimum.accumulate(stops[::-1])[::-1].tolist()
        self._first = first


def run_plain(machine: Any, words: Any, line: int) -> int:
    """Make plain lines into moves, ``line`` the number of the first; how many of them are done."""
    if len(words) < WORTHWHILE or not isinstance(words, np.ndarray):
        rows = [Move() for _ in words]
        listed = words.tolist() if isinstance(words, np.ndarray) else words
        done, moves = motion.run(machine, listed, line, rows)
        machine.recorder.extend(rows[:moves])
        return int(done)
    state = np.zeros(1, STATE)[0]
    for name in STATE.names or ():
        state[name] = getattr(machine, name)
    table = np.zeros(len(words), MOVE)
    done, moves = compiled()[1](state, words, line, table)
    for name in STATE.names or ():
        setattr(machine, name, state[name].tolist())
    machine.recorder.extend(table[:moves])
    return int(done)
