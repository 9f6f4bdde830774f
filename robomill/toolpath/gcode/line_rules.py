"""The rules of plain lines: which ones are plain, and what their words and numbers are.

A line is plain if it holds only N, G0 to G3, X Y Z A B C I J K R F S, each once with a plain number, and comments
that say nothing to the machine. All others are left to the reader of ``words``. Like the rules of ``motion_rules``
this is plain Python that numba can compile: for bytes and lists, or for arrays.
"""

# mypy: disable-error-code="no-untyped-def, no-untyped-call"

from __future__ import annotations

import math

from robomill.toolpath.gcode.motion_rules import LETTERS, F, G, S

MAX_LINE = 100_000
"""Characters of a line that can be read."""

_MAX_DIGITS = 15
_TENS = tuple(10.0**n for n in range(_MAX_DIGITS + 1))
_BLANKS = (9, 11, 12, 13, 32)
_COLUMNS = tuple(
    next((i for i, letter in enumerate(LETTERS[:-1]) if code in (ord(letter), ord(letter.upper()))), -1)
    for code in range(256)
)


def scan(text, starts, words, plain) -> None:
    """Read the lines of ``text`` (bytes) that begin at ``starts`` (n + 1) into rows of ``words`` (n, 14)."""
    for i in range(len(starts) - 1):
        plain[i] = scan_line(text, starts[i], starts[i + 1] - 1, words[i])


def scan_line(text, at, end, w) -> bool:
    """The words of a line by the indices of ``motion_rules``; False if it is not plain."""
    if end - at > MAX_LINE:
        return False
    fresh = True
    while at < end:
        code = text[at]
        at += 1
        if code in _BLANKS:
            continue
        if code == 59:  # ; and the rest is a comment
            break
        if code == 40:  # ( ... ), where a comma may make it a message
            while at < end and text[at] not in (40, 41, 44):
                at += 1
            if at == end or text[at] != 41:
                return False
            at += 1
            fresh = False
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
