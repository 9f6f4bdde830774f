"""The rules of O words: where a program goes on; ``motion_rules`` says what rules are.

``flow`` is the ``Flow`` of the file that is being executed. An O word is named by its place among those of its file.
Where one cannot be followed it has changed nothing; ``owords.SENTENCES`` says what each problem means.
"""

# mypy: disable-error-code="no-untyped-def, no-untyped-call"

import math

from robomill.toolpath.gcode.parameters import ARGUMENTS, LEVELS, VALUE, VALUE_RETURNED
from robomill.toolpath.gcode.rules.line_rules import apply_settings, read_line
from robomill.toolpath.gcode.rules.mode_rules import plain_line
from robomill.toolpath.gcode.rules.value_rules import value

KEYWORDS = (
    *("sub", "endsub", "call", "do", "while", "repeat", "if", "elseif", "else", "endif"),
    *("break", "continue", "endwhile", "endrepeat", "return"),
)
"""In the order in which they are tried; what follows a keyword is its argument."""
(SUB, ENDSUB, CALL, DO, WHILE, REPEAT, IF, ELSEIF, ELSE, ENDIF) = range(10)
(BREAK, CONTINUE, ENDWHILE, ENDREPEAT, RETURN) = range(10, len(KEYWORDS))
BARE = -1
"""An O word without a keyword."""
MOST = {CALL: 10**9, IF: 1, ELSEIF: 1, WHILE: 1, REPEAT: 1, RETURN: 1, ENDSUB: 1, SUB: 0, DO: 0, ENDIF: 0}
"""So many values an argument has at most; what stands behind others is not read."""

(NO_CONDITION, MORE_BEHIND, NO_END, OUTSIDE, TOO_MANY_ARGUMENTS, TOO_MANY_LEVELS) = range(41, 47)
ELSEWHERE, SPECIAL = 47, 48
"""No refusals: a subroutine of another file is called, a call is left that only the interpreter can leave."""

MOST_REPEATS = 2.0**31


def run(m, s, text, flow, stretch, rows):
    """(how many lines were executed, which comes next) of a ``stretch``, plain lines and O words: from which line on,
    and how many at most.

    Up to the first line that is neither, that is refused or that means more than these rules. That one has changed
    nothing that doing it again would not; the interpreter reads it and says what is wrong. Moves are made into
    ``rows``, of which ``m.moves`` are written.
    """
    at, count = stretch
    words, place = flow.words, first_word(flow.words, at)
    ahead = words[place].line if place < len(words) else -1
    for done in range(count):
        if at == ahead:
            problem, behind, where = (ELSEWHERE, 0, 0) if words[place].handed else step(m, s, flow, place)
            if problem != 0:
                return done, at
            at, place = words[where].line + behind, where + behind
            ahead = words[place].line if place < len(words) else -1
            continue
        if m.moves == len(rows) or at == len(text.starts) - 1:
            return done, at
        settings = read_line(s, text.codes, text.starts[at], text.starts[at + 1] - 1)
        if settings > 0:
            apply_settings(s, settings)
        elif settings < 0 or not plain_line(m, s.words, s.end, rows, at + 1):
            return done, at
        at += 1
    return count, at


def first_word(words, line: int) -> int:
    """The place of the first O word at or behind a line."""
    low, high = 0, len(words)
    while low < high:
        middle = (low + high) // 2
        if words[middle].line < line:
            low = middle + 1
        else:
            high = middle
    return low


def step(m, s, flow, place: int):
    """(0, 1, where): follow an O word; it goes on behind the O word ``where``, or at it (0, 0, where).

    Otherwise (problem, 0, where in ``flow.arguments``); ``ELSEWHERE`` leaves arguments in ``s.settings``, and how many
    they are in ``s.figures``.
    """
    word, level, text = flow.words[place], s.level[0], flow.arguments
    keyword, at, count, x = word.keyword, word.begin, 0, 0.0
    if level == 0 and keyword in (RETURN, ENDSUB):
        return OUTSIDE, 0, at
    counter = level * (len(flow.counters) // LEVELS) + word.counter
    if not (keyword == ELSEIF and not m.seeking) and not (keyword == REPEAT and flow.counters[counter] >= 0):
        if keyword in (IF, ELSEIF, WHILE, REPEAT) and (at >= word.past or text[at] != 91):
            return NO_CONDITION, 0, at
        while at < word.past and ((text[at] == 91 and count < word.most) or (text[at] == 40 and word.most > 1)):
            if text[at] == 91:
                problem, x, at = value(s, text, at, word.past)
                if problem != 0:
                    return problem, 0, at
                s.settings[min(count, ARGUMENTS)] = x
                count += 1
            else:  # a comment
                while text[at] != 41:
                    at += 1
                at += 1
        if word.most >= 0 and at < word.past and text[at] != 40 and text[at] != 59:
            return MORE_BEHIND, 0, at
    if keyword == CALL:
        s.figures[0] = count
        problem = TOO_MANY_ARGUMENTS if count > ARGUMENTS else (ELSEWHERE if word.start < 0 else 0)
        if problem == 0:
            problem = enter(s, flow, word.start, place, count)
        return (0, 1, word.start) if problem == 0 else (problem, 0, at)
    if keyword in (RETURN, ENDSUB):
        if flow.special[level] != 0:
            return SPECIAL, 0, at
        s.named[VALUE], s.named[VALUE_RETURNED] = x, count
        return 0, 1, leave(s, flow)
    if keyword == REPEAT:
        return _repeat(m, flow, counter, place, x)
    return _go_on(m, flow, place, x)


# --- branches and loops
def _go_on(m, flow, place: int, x: float):
    """Where to, with a condition of ``x``, and without a subroutine."""
    word = flow.words[place]
    keyword = word.keyword
    if keyword in (ENDWHILE, ENDREPEAT):
        return 0, 0, word.start
    if keyword == SUB:
        return _behind_end(word)
    if keyword in (IF, ELSEIF, ELSE):
        return _branch(m, word, place, x)
    if keyword == WHILE:
        return _while(m, flow, place, x)
    if keyword in (BREAK, CONTINUE):
        return _out(m, flow, place)
    return 0, 1, place


def _behind_end(word):
    """Go on behind the end of what a word belongs to."""
    return (NO_END, 0, word.begin) if word.end < 0 else (0, 1, word.end)


def _branch(m, word, place: int, x: float):
    """If, elseif, else: a condition that fails seeks the next branch, any branch that is not sought ends the last."""
    if word.keyword != IF and not m.seeking:
        return _behind_end(word)
    if word.keyword != ELSE and x == 0.0:
        m.seeking = word.next != word.end
        return (0, 0, word.next) if m.seeking else _behind_end(word)
    m.seeking = False
    return 0, 1, place


def _while(m, flow, place: int, x: float):
    """While, at the start of a loop or behind ``do``.

    LinuxCNC keeps one flag each for break and continue, and they outlive their loops: that is followed and counted.
    """
    word = flow.words[place]
    if flow.words[word.start].keyword == DO:
        loops = x != 0.0 and not m.broke
        if x != 0.0 and m.broke:
            flow.left_over[place] += 1
        m.broke = False
        return 0, 1, (word.start if loops else place)
    if x != 0.0:
        return 0, 1, place
    if word.end >= 0:
        m.continued = False
        m.broke = m.broke or word.has_break
    return _behind_end(word)


def _repeat(m, flow, counter: int, place: int, x: float):
    """Repeat: every level of calls counts for itself, from its first round on; -1 is before that."""
    word, left = flow.words[place], flow.counters[counter]
    if left < 0:
        left = round(min(max(x, 0.0), MOST_REPEATS))
    if left > 0:
        flow.counters[counter] = left - 1
        return 0, 1, place
    if word.end < 0:
        return _behind_end(word)
    flow.counters[counter] = -1
    if m.continued:
        flow.left_over[place] += 1
        m.continued = False
        return 0, 0, place
    return _behind_end(word)


def _out(m, flow, place: int):
    """Break and continue."""
    word = flow.words[place]
    if word.end < 0:
        return _behind_end(word)
    in_while = flow.words[word.start].keyword == WHILE
    if word.keyword == CONTINUE:
        m.continued = not in_while
        return 0, 0, word.end
    m.broke = m.broke or in_while
    if in_while and m.continued:
        flow.left_over[place] += 1
        m.continued = False
        return 0, 0, word.start
    return _behind_end(word)


# --- subroutines
def enter(s, flow, sub: int, back: int, count: int) -> int:
    """A subroutine begins, with so many arguments, which goes back behind ``back``; -1: a subprogram, without any.

    A problem, or 0.
    """
    if s.level[0] + 1 >= LEVELS:
        return TOO_MANY_LEVELS
    enter_names(s)
    level, repeats = s.level[0], len(flow.counters) // LEVELS
    flow.subs[level], flow.back[level] = sub, back
    first, past = 0, repeats
    if sub >= 0:
        first, end = flow.words[sub].counter, flow.words[sub].end
        past = flow.words[end].counter if end >= 0 else repeats
        for i in range(ARGUMENTS):
            flow.aside[level * ARGUMENTS + i] = s.numbered[1 + i]
            s.numbered[1 + i] = s.settings[i] if i < count else 0.0
        s.named[level * s.room + s.provided] = count
    for i in range(first, past):
        flow.counters[level * repeats + i] = -1
    return 0


def enter_names(s) -> None:
    """The next level of names: none is set. The first ones are the machine's, and those of all levels."""
    s.level[0] += 1
    for column in range(s.provided, len(s.ends) - 1):
        s.named[s.level[0] * s.room + column] = math.nan


def leave(s, flow) -> int:
    """A subroutine ends: the O word that it goes back behind."""
    level = s.level[0]
    if flow.subs[level] >= 0:
        for i in range(ARGUMENTS):
            s.numbered[1 + i] = flow.aside[level * ARGUMENTS + i]
    s.level[0] = level - 1
    return flow.back[level]
