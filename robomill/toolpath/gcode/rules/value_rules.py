"""The rules of values: numbers, parameters, expressions and functions in the characters of a line.

The grammar is RS274/NGC's: ``[`` ... ``]`` with ``**`` before ``* / MOD`` before ``+ -`` before comparisons before
``AND OR XOR``, all from left to right; functions of a bracket, ``ATAN[y]/[x]``; angles in degrees. Blanks and case do
not count.

Like the rules of ``motion_rules`` this is plain Python that numba can compile. ``s`` is the ``Store`` of parameters,
``text`` the codes of characters, read from ``at`` up to ``end``. A function that can refuse returns a problem first (0
for none); ``expressions.SENTENCES`` says what each means, with the numbers that are left in ``s.figures``. Reading
changes no parameter, so a line that is refused can be read again.
"""

# mypy: disable-error-code="no-untyped-def, no-untyped-call"
# One function serves bytes, lists and arrays: no annotation would say more than the names.

import math

from robomill.toolpath.gcode.rules import operator_rules as op

BLANKS = (9, 11, 12, 13, 26, 32)
MAX_DEPTH = 60

KEYWORDS = 16
_EXACT = 15
_TENS = tuple(10.0**n for n in range(23))
"""A whole number of ``_EXACT`` digits over one of these is the nearest double: neither is rounded."""


# What waits on the stack of marks for a value: operators as above, signs, a #, and what opened a bracket.
_KEEP, _NEGATE, _NUMBERED, _BRACKET, _SECOND, _FUNCTION = 20, 21, 22, 30, 31, 40
STACK = 8 * (MAX_DEPTH + 2)
"""Values and marks that can wait: every level holds at most five operators and what opened it."""


def packed(word: str) -> int:
    """A keyword as the number that ``keyword`` makes of its letters."""
    code = 0
    for letter in word:
        code = 32 * code + ord(letter) - 96
    return code


def packed_all(words: tuple[str, ...]) -> tuple[int, ...]:
    """Keywords for ``keyword``, -1 for signs; as many for all, so that it is compiled once."""
    return tuple(packed(word) if word.isalpha() else -1 for word in (*words, *("]" * (KEYWORDS - len(words)))))


_OPERATOR_WORDS, _FUNCTION_WORDS = packed_all(op.OPERATORS), packed_all(op.FUNCTIONS)


# --- characters
def past_blanks(text, at, end):
    """Where the next character stands that is no blank."""
    while at < end and text[at] in BLANKS:
        at += 1
    return at


def lower(code):
    """The code of a character in lower case."""
    return code + 32 if 65 <= code <= 90 else code


def is_digit(code) -> bool:
    """True for 0 to 9."""
    return 48 <= code <= 57


def keyword(text, at, end, words):
    """(place among ``words``, where it ends) of the keyword at ``at``; -1 if there is none."""
    code = 0
    for _ in range(6):
        at = past_blanks(text, at, end)
        if at >= end or not 97 <= lower(text[at]) <= 122:
            break
        code = 32 * code + lower(text[at]) - 96
        at += 1
        for i in range(len(words)):
            if words[i] == code:
                return i, at
    return -1, at


def codes(text: str) -> bytes | list[int]:
    """The characters as the rules take them, one a place; those that are not ASCII lie above all bytes."""
    return text.encode() if text.isascii() else [ord(c) if c.isascii() else 256 + ord(c) for c in text]


# --- numbers
def nearest(text, first, end) -> float:
    """A number of many digits; compiled code finds it too large, and leaves its line to Python."""
    return float("".join(chr(text[i]) for i in range(first, end) if text[i] not in BLANKS))


def number(text, at, end):
    """(problem, value, where it ends) of digits with one point among them or none."""
    first, value, digits, significant, decimals = at, 0, 0, 0, -1
    while at < end:
        code = text[at]
        if 48 <= code <= 57:
            digits += 1
            significant += 1 if significant > 0 or code != 48 else 0
            decimals += 1 if decimals >= 0 else 0
            if significant <= _EXACT:
                value = value * 10 + (code - 48)
        elif code == 46:
            if decimals >= 0:
                return op.NOT_A_NUMBER, 0.0, first
            decimals = 0
        elif code not in BLANKS:
            break
        at += 1
    if digits == 0:
        return op.NOT_A_NUMBER, 0.0, first
    if at < end and text[at] == 44 and at + 1 < end and is_digit(text[at + 1]):
        return op.DECIMAL_COMMA, 0.0, first
    if significant > _EXACT or decimals >= len(_TENS):
        return 0, nearest(text, first, at), at
    return 0, value / _TENS[max(decimals, 0)], at


# --- parameters
def numbered(s, index: float):
    """(problem, value) of ``#index``."""
    s.figures[0] = index
    near = op.whole(index)
    if math.isnan(near):
        return op.NOT_WHOLE, 0.0
    s.figures[0] = near
    if not 1.0 <= near < len(s.numbered):
        return op.NO_PARAMETER, 0.0
    value = s.numbered[int(near)]
    return (op.ASK_NUMBER if math.isnan(value) else 0), value


def name_end(text, at, end):
    """Where the > of a name stands that is open at ``at``; -1 if it is not closed."""
    while at < end and text[at] not in (40, 59, 62):
        at += 1
    return at if at < end and text[at] == 62 else -1


def first_slot(text, at, end, slots: int) -> int:
    """Where the search for a name begins among so many slots."""
    place = 0
    for i in range(at, end):
        if text[i] not in BLANKS:
            place = (33 * place + lower(text[i])) & 0xFFFFFFF
    return place % slots


def column_of(s, text, at, end) -> int:
    """The column of the name between ``at`` and ``end``; -1 if no such name is known."""
    place = first_slot(text, at, end, len(s.slots))
    while s.slots[place] > 0:
        if _is_name(s, s.slots[place] - 1, text, at, end):
            return s.slots[place] - 1
        place = (place + 1) % len(s.slots)
    return -1


def _is_name(s, column, text, at, end) -> bool:
    known = s.ends[column]
    for i in range(at, end):
        if text[i] not in BLANKS:
            if known >= s.ends[column + 1] or s.letters[known] != lower(text[i]):
                return False
            known += 1
    return known == s.ends[column + 1]


def place_of(s, text, at, end, column) -> int:
    """Where the value of a name stands in ``s.named``: names with _ in front are shared by all calls."""
    return (0 if text[past_blanks(text, at, end)] == 95 else s.level[0]) * s.room + column


def _named(s, text, at, end):
    """(problem, value, where it ends) of the ``<name>`` at ``at``."""
    close = name_end(text, at, end)
    if close < 0:
        return op.NAME_NOT_CLOSED, 0.0, at
    column = column_of(s, text, at + 1, close)
    value = math.nan if column < 0 else s.named[place_of(s, text, at + 1, close, column)]
    if math.isnan(value):
        return (op.ASK_NAME if 0 <= column < s.provided else op.NOT_DEFINED), 0.0, at
    return 0, value, close + 1


# --- a value
def _operator(text, at, end):
    """(operator, where it ends); -1 if there is none."""
    at = past_blanks(text, at, end)
    code = text[at] if at < end else 0
    if code == 42:
        after = past_blanks(text, at + 1, end)
        if after < end and text[after] == 42:
            return op.POWER, after + 1
        return op.TIMES, at + 1
    if code == 93:
        return op.CLOSE, at + 1
    if code == 43:
        return op.PLUS, at + 1
    if code == 45:
        return op.MINUS, at + 1
    if code == 47:
        return op.OVER, at + 1
    found, after = keyword(text, at, end, _OPERATOR_WORDS)
    return found, after if found >= 0 else at


def _signs_end(text, at, end):
    """Where the signs end that stand at ``at``, and how many they are."""
    count = 0
    at = past_blanks(text, at, end)
    while at < end and text[at] in (43, 45):
        at, count = past_blanks(text, at + 1, end), count + 1
    return at, count


def _opens(s, text, at, end):
    """(problem, mark, where it ends) of what stands before a value and waits for it; 0 for nothing."""
    code = text[at]
    if code == 91:
        return 0, _BRACKET, at + 1
    if code == 35:
        after = past_blanks(text, at + 1, end)
        return 0, (0 if after < end and text[after] == 60 else _NUMBERED), after
    if code in (43, 45):
        return 0, _NEGATE if code == 45 else _KEEP, at + 1
    function, after = keyword(text, at, end, _FUNCTION_WORDS)
    if function < 0:
        return op.NO_FUNCTION, 0, at
    after = past_blanks(text, after, end)
    if after >= end or text[after] != 91:
        s.figures[1], s.figures[2] = function, -1.0
        return op.NO_ARGUMENT, 0, after
    if function != op.EXISTS:
        return 0, _FUNCTION + function, after + 1
    after = past_blanks(text, after + 1, end)
    if after >= end or text[after] != 35:
        return op.EXISTS_OF_WHAT, 0, after
    return 0, _FUNCTION + op.EXISTS, after + 1


def _operand(s, text, at, end, marks):
    """(problem, value, where it ends, marks) of what stands where a value should; NaN for one that is yet to come."""
    at = past_blanks(text, at, end)
    if at >= end:
        return op.NOTHING, 0.0, at, marks
    after, signs = _signs_end(text, at, end)
    if after < end and (is_digit(text[after]) or text[after] == 46):
        problem, x, after = number(text, after, end)
        if problem != 0 or signs > 1:
            return (problem if problem == op.DECIMAL_COMMA else op.NOT_A_NUMBER), 0.0, at, marks
        return 0, (-x if text[at] == 45 else x), after, marks
    asked = marks > 0 and s.marks[marks - 1] == _FUNCTION + op.EXISTS
    if text[at] == 60 and asked:
        problem, _, after = _named(s, text, at, end)
        if problem == op.NAME_NOT_CLOSED:
            return problem, 0.0, at, marks
        return 0, (0.0 if problem == op.NOT_DEFINED else 1.0), name_end(text, at, end) + 1, marks
    problem, mark, after = _opens(s, text, at, end)
    if problem == 0 and mark == 0:
        problem, x, after = _named(s, text, after, end)
        return problem, x, after, marks
    s.marks[marks] = mark
    return problem, math.nan, after, marks + 1


def _signed(s, x: float, marks: int):
    """(problem, value, marks) after the signs and # that wait for the value ``x``."""
    while marks > 0 and _KEEP <= s.marks[marks - 1] <= _NUMBERED:
        if not math.isfinite(x):
            return op.TOO_LARGE, x, marks
        marks -= 1
        if s.marks[marks] == _NEGATE:
            x = -x
        elif s.marks[marks] == _NUMBERED:
            problem, x = numbered(s, x)
            if problem != 0:
                return problem, x, marks
    return (0 if math.isfinite(x) else op.TOO_LARGE), x, marks


def value(s, text, at, end):
    """(problem, value, where it ends) of a number, ``[expression]``, ``#parameter`` or function; signs may precede."""
    marks, waiting, depth = 0, 0, 0  # marks and values on the stacks, and levels that are open
    while True:
        before = marks
        problem, x, at, marks = _operand(s, text, at, end, marks)
        depth += marks - before
        if problem == 0 and depth > MAX_DEPTH:
            problem = op.TOO_DEEP
        if problem != 0:
            return problem, x, at
        while not math.isnan(x):
            before = marks
            problem, x, marks = _signed(s, x, marks)
            depth -= before - marks
            if problem != 0 or marks == 0:
                return problem, x, at
            operator, at = _operator(text, at, end)
            if operator < 0:
                return (op.NO_OPERATOR if at < end else op.NOT_CLOSED), x, at
            while s.marks[marks - 1] < len(op.OPERATORS) and op.BINDS[s.marks[marks - 1]] >= op.BINDS[operator]:
                marks, waiting = marks - 1, waiting - 1
                problem, x = op.combined(s, s.marks[marks], s.values[waiting], x)
                if problem != 0:
                    return problem, x, at
            opened = s.marks[marks - 1]
            if operator == op.CLOSE and opened != _FUNCTION + op.ATAN:
                marks, depth = marks - 1, depth - 1
                if opened == _SECOND:
                    waiting -= 1
                    x = math.atan2(s.values[waiting], x) / op.DEGREE
                elif opened >= _FUNCTION:
                    problem, x = op.applied(s, opened - _FUNCTION, x)
                    if problem != 0:
                        return problem, x, at
                continue
            if operator == op.CLOSE:
                problem, at = _second_argument(text, at, end)
                s.marks[marks - 1] = _SECOND
            else:
                problem = op.EXISTS_NOT_CLOSED if opened == _FUNCTION + op.EXISTS else 0
                s.marks[marks] = operator
                marks += 1
            if problem != 0:
                return problem, x, at
            s.values[waiting] = x
            waiting, x = waiting + 1, math.nan


def _second_argument(text, at, end):
    """(problem, where it begins) of the second argument of op.ATAN."""
    at = past_blanks(text, at, end)
    after = past_blanks(text, at + 1, end)
    if at >= end or text[at] != 47 or after >= end or text[after] != 91:
        return op.ONE_ARGUMENT, at
    return 0, after + 1
