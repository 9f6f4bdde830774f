"""Many plain lines at once: words with numbers, read from bytes with array operations.

A line is plain if it holds only N, G0 to G3, X Y Z A B C I J K R F S with plain numbers, each once, and comments
that say nothing to the machine. Everything else is left to the interpreter, line by line.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from robomill.arrays import BoolArray, FloatArray, IntArray

LETTERS = "GXYZABCIJKRFS"
_BLANK, _DIGIT, _POINT, _SIGN, _END, _LETTER, _OTHER = range(7)
_MAX_DIGITS = 15
_TENS = 10.0 ** np.arange(_MAX_DIGITS + 1)
_SPEAKING = b"mMdDpPlLaA"
"""A comment that starts with one of these may be a message (MSG, DEBUG, PRINT, LOG, ABORT)."""


def _classes() -> NDArray[np.uint8]:
    table = np.full(256, _OTHER, np.uint8)
    table[[9, 11, 12, 13, 32]] = _BLANK
    table[48:58] = _DIGIT
    table[ord(".")] = _POINT
    table[[ord("+"), ord("-")]] = _SIGN
    table[10] = _END
    for letter in LETTERS + "N":
        table[[ord(letter), ord(letter.lower())]] = _LETTER
    return table


_CLASS = _classes()
_COLUMN = np.full(256, -1, np.int8)
for _index, _letter in enumerate(LETTERS):
    _COLUMN[[ord(_letter), ord(_letter.lower())]] = _index
_N_CODES = (ord("N"), ord("n"))


@dataclass(frozen=True)
class Lines:
    """Columns of consecutive lines: ``plain`` (n,) and for each letter its value (n,), NaN where it is not given."""

    plain: BoolArray
    values: dict[str, FloatArray]
    run_end: IntArray

    def __len__(self) -> int:
        return len(self.plain)


def read_lines(data: bytes) -> Lines:
    """The words of complete lines (``data`` ends with a newline)."""
    raw = np.frombuffer(data, np.uint8)
    count = int((raw == 10).sum())
    bad = np.zeros(count, bool)
    if b"(" in data or b";" in data:
        raw = _without_comments(raw, bad)
    kind = _CLASS[raw]
    keep = kind != _BLANK
    raw, kind = raw[keep], kind[keep]
    ends = np.flatnonzero(kind == _END)
    bounds = np.flatnonzero((kind == _END) | (kind == _LETTER))
    is_word = kind[bounds] == _LETTER
    at, stop = bounds[is_word], bounds[np.flatnonzero(is_word) + 1]
    line = (np.cumsum(~is_word) - 0)[is_word]
    _mark(bad, ends, np.flatnonzero(kind == _OTHER))
    starts = np.concatenate([[0], ends[:-1] + 1])
    bad |= (kind[starts] != _LETTER) & (kind[starts] != _END)
    value, wrong = _numbers(raw, kind, at, stop)
    bad[line[wrong]] = True
    letter = raw[at]
    is_n = (letter == _N_CODES[0]) | (letter == _N_CODES[1])
    bad[line[is_n & (at != starts[line])]] = True
    bad[line[is_n & (kind[np.minimum(at + 1, len(kind) - 1)] == _SIGN)]] = True
    values = {}
    column = _COLUMN[letter]
    for index, name in enumerate(LETTERS):
        chosen = np.flatnonzero(column == index)
        where = line[chosen]
        bad[where[1:][where[1:] == where[:-1]]] = True
        values[name] = np.full(count, np.nan)
        values[name][where] = value[chosen]
    motion = values["G"]
    bad |= ~(np.isnan(motion) | (motion == 0) | (motion == 1) | (motion == 2) | (motion == 3))
    bad |= (values["F"] < 0) | (values["S"] < 0)
    stops = np.where(bad, np.arange(count), count)
    run_end = np.minimum.accumulate(stops[::-1])[::-1]
    return Lines(~bad, values, run_end)


def _mark(bad: BoolArray, ends: IntArray, positions: IntArray) -> None:
    if len(positions):
        bad[np.searchsorted(ends, positions)] = True


def _numbers(
    raw: NDArray[np.uint8], kind: NDArray[np.uint8], at: IntArray, stop: IntArray
) -> tuple[FloatArray, BoolArray]:
    """Values of the words at ``at`` (their letters) up to ``stop``, and which are no plain numbers.

    The digits make an exact integer and the point an exact power of ten, so that the quotient is the nearest
    double, as ``float`` gives it.
    """
    wrong = np.zeros(len(at), bool)
    if len(at) == 0:
        return np.zeros(0), wrong
    signed = kind[np.minimum(at + 1, len(kind) - 1)] == _SIGN
    first = at + 1 + signed
    signs = np.flatnonzero(kind == _SIGN)
    misplaced = signs[kind[signs - 1] != _LETTER] if len(signs) else signs
    wrong[_inside(at, stop, misplaced)[0]] = True
    owner, points = _inside(at, stop, np.flatnonzero(kind == _POINT))
    wrong[owner[1:][owner[1:] == owner[:-1]]] = True
    decimals = np.zeros(len(at), np.int64)
    decimals[owner] = stop[owner] - points - 1
    digits = stop - first
    digits[owner] -= 1
    wrong |= (digits < 1) | (digits > _MAX_DIGITS)
    mantissa = np.zeros(len(at), np.int64)
    length = np.where(wrong, 0, stop - first)
    for step in range(int(length.max(initial=0))):
        active = np.flatnonzero(length > step) if step else np.flatnonzero(length)
        where = first[active] + step
        is_digit = kind[where] == _DIGIT
        chosen = active[is_digit]
        mantissa[chosen] = mantissa[chosen] * 10 + (raw[where[is_digit]] - 48)
    value = mantissa / _TENS[np.clip(decimals, 0, _MAX_DIGITS)]
    negative = signed & (raw[np.minimum(at + 1, len(raw) - 1)] == ord("-"))
    return np.where(negative, -value, value), wrong


def _inside(at: IntArray, stop: IntArray, positions: IntArray) -> tuple[IntArray, IntArray]:
    """The words that hold ``positions``, and those positions; what is in no word is left out."""
    owner = np.searchsorted(at, positions) - 1
    held = (owner >= 0) & (positions < stop[owner])
    return owner[held], positions[held]


def _without_comments(raw: NDArray[np.uint8], bad: BoolArray) -> NDArray[np.uint8]:
    """``raw`` with simple comments blanked; lines with other ones are marked in ``bad``."""
    ends = np.flatnonzero(raw == 10)
    change = np.zeros(len(raw) + 1, np.int8)
    semicolons = np.flatnonzero(raw == ord(";"))
    lines_s, first = np.unique(np.searchsorted(ends, semicolons), return_index=True)
    change[semicolons[first]] += 1
    change[ends[lines_s]] -= 1
    opened, closed = np.flatnonzero(raw == ord("(")), np.flatnonzero(raw == ord(")"))
    line_o, line_c = np.searchsorted(ends, opened), np.searchsorted(ends, closed)
    opens, closes = np.bincount(line_o, minlength=len(ends)), np.bincount(line_c, minlength=len(ends))
    bad |= (opens != closes) | (opens > 1)
    bad[lines_s[opens[lines_s] + closes[lines_s] > 0]] = True
    good_o, good_c = opened[~bad[line_o]], closed[~bad[line_c]]
    crossed = good_o > good_c
    bad[np.searchsorted(ends, good_o[crossed])] = True
    following = raw[np.minimum(good_o + 1, len(raw) - 1)]
    speaks = np.isin(following, np.frombuffer(_SPEAKING + b" \t", np.uint8))
    bad[np.searchsorted(ends, good_o[speaks])] = True
    change[good_o[~crossed]] += 1
    change[good_c[~crossed] + 1] -= 1
    hidden = np.cumsum(change[:-1], dtype=np.int8) > 0
    return np.where(hidden & (raw != 10), np.uint8(32), raw)
