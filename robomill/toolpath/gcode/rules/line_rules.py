"""The rules of plain lines: which ones are plain, and what their words are.

A line is plain if it holds only words that ``mode_rules.plain_line`` knows, each once, and comments that say nothing
to the machine; or if it only sets parameters. All others are left to the reader of ``words``. Like the other rules this
is plain Python that numba can compile.
"""

# mypy: disable-error-code="no-untyped-def, no-untyped-call"

import math

import numpy as np

from robomill.toolpath.gcode import codes
from robomill.toolpath.gcode.codes import G_GROUP, LETTERS, M_GROUP, WIDTH, F, L, S
from robomill.toolpath.gcode.parameters import MAX_SETTINGS
from robomill.toolpath.gcode.rules.operator_rules import whole
from robomill.toolpath.gcode.rules.value_rules import (
    BLANKS,
    column_of,
    is_digit,
    keyword,
    lower,
    name_end,
    packed_all,
    past_blanks,
    place_of,
    value,
)

MAX_LINE = 100_000
"""Characters of a line that can be read."""
NOT_PLAIN = -1
ORIGINS_FROM, ORIGINS_TO = 5201, 5341
"""Parameters that hold where G54 and on lie."""

PLAIN_G = (
    *(0, 10, 20, 30, 730, 740, *range(800, 900, 10)),
    *(170, 180, 190, 200, 210, 400, 610, 611, 640, 900, 901, 910, 911, 930, 940, 950, 970, 980, 990),
    *(code for code, group in codes.G_GROUPS.items() if group == codes.COORDINATES),
)
PLAIN_M = (0, 1, 60, 3, 4, 5, 7, 8, 9, 48, 49)
_G_GROUPS = np.array([codes.G_GROUPS[code] if code in PLAIN_G else -1 for code in range(1000)])
_M_GROUPS = np.array([codes.M_GROUPS[code] if code in PLAIN_M else -1 for code in range(100)])
_COLUMNS = np.array([LETTERS.find(chr(code)) for code in range(128)])
_SAYING = packed_all(("msg", "debug", "print", "log", "abort"))
"""Comments that begin with one of these and a comma are said, or end the program."""


def read_line(s, text, at, end) -> int:
    """0 and the words of a line in ``s.words``, or how many parameters it sets; ``NOT_PLAIN`` if it is no such line."""
    if end - at > MAX_LINE:
        return NOT_PLAIN
    for column in range(WIDTH):
        s.words[column] = math.nan
    fresh, given, settings = True, False, 0
    while True:
        at = past_blanks(text, at, end)
        if at >= end or text[at] == 59:  # ; and the rest is a comment
            return NOT_PLAIN if settings > 0 and given else settings
        code, at = lower(text[at]), at + 1
        if code == 40:
            at = comment_end(text, at, end)
            if at < 0:
                return NOT_PLAIN
        elif code == 110 and fresh:  # N comes first
            at = past_blanks(text, at, end)
            if at >= end or not is_digit(text[at]):
                return NOT_PLAIN
            while at < end and (is_digit(text[at]) or text[at] == 46 or text[at] in BLANKS):
                at += 1
        elif code == 35:
            at = _setting(s, text, at, end, settings)
            if at < 0:
                return NOT_PLAIN
            settings += 1
        elif code > 127 or (_COLUMNS[code] < 0 and code not in (103, 109)):
            return NOT_PLAIN
        else:
            given = True
            problem, number, at = value(s, text, at, end)
            column, number = _column(code, number)
            if problem != 0 or column < 0 or not math.isnan(s.words[column]):
                return NOT_PLAIN
            s.words[column] = number
        fresh = False


def _column(code, number: float):
    """Where a word stands among the words of a line, and its value or code; -1 if the line is not plain with it."""
    if code == 103:
        near = round(10.0 * number) if -1.0 < number < 100.0 else -1
        group = _G_GROUPS[near] if near >= 0 and abs(10.0 * number - near) <= 0.01 else -1
        return (G_GROUP + group if group >= 0 else -1), float(near)
    if code == 109:
        near = int(whole(number)) if 0.0 <= whole(number) < 100.0 else -1
        group = _M_GROUPS[near] if near >= 0 else -1
        return (M_GROUP + group if group >= 0 else -1), float(near)
    column = _COLUMNS[code]
    if number < 0.0 and column in (F, S, L):
        return -1, number
    if column == L:
        number = whole(number)
    return (-1 if math.isnan(number) else column), number


def comment_end(text, at, end):
    """Where a comment ends that has opened before ``at``; -1 if it does not, or says something."""
    first, comma = at, False
    while at < end and text[at] not in (40, 41):
        comma = comma or text[at] == 44
        at += 1
    if at >= end or text[at] == 40:
        return -1
    if comma:
        said, after = keyword(text, first, at, _SAYING)
        if said >= 0 and text[past_blanks(text, after, end)] == 44:
            return -1
    return at + 1


def _setting(s, text, at, end, count: int):
    """Where a setting ends that has begun with a # before ``at``, kept in ``s``; -1 if it is left to the reader."""
    at = past_blanks(text, at, end)
    if at >= end or count >= MAX_SETTINGS:
        return -1
    if text[at] == 60:
        close = name_end(text, at, end)
        column = -1 if close < 0 else column_of(s, text, at + 1, close)
        if column < s.provided:  # or unknown
            return -1
        key = -1 - place_of(s, text, at + 1, close, column)
        at = close + 1
    else:
        problem, index, at = value(s, text, at, end)
        near = whole(index)
        if problem != 0 or not 1.0 <= near < len(s.numbered) or math.isnan(s.numbered[int(near)]):
            return -1
        key = int(near)
        if ORIGINS_FROM <= key < ORIGINS_TO:  # a Fanuc's coordinate system moves with them
            return -1
    at = past_blanks(text, at, end)
    if at >= end or text[at] != 61:
        return -1
    problem, number, at = value(s, text, at + 1, end)
    if problem != 0:
        return -1
    s.keys[count], s.settings[count] = key, number
    return at


def apply_settings(s, count: int) -> None:
    """Set the parameters that a line sets, all with values from before the line."""
    for i in range(count):
        if s.keys[i] < 0:
            s.named[-1 - s.keys[i]] = s.settings[i]
        else:
            s.numbered[s.keys[i]] = s.settings[i]
