"""O words: which lines open, close and branch, found once, as ``flow_rules`` takes them; subroutines by name."""

import re
from array import array
from dataclasses import dataclass
from operator import attrgetter
from typing import Any

import numpy as np

from robomill.errors import GCodeError
from robomill.lazy import cached_property
from robomill.toolpath.gcode.lines import Lines
from robomill.toolpath.gcode.parameters import ARGUMENTS, LEVELS
from robomill.toolpath.gcode.rules import flow_rules as rules
from robomill.toolpath.gcode.rules.flow_rules import KEYWORDS
from robomill.toolpath.gcode.rules.line_rules import MAX_LINE
from robomill.toolpath.gcode.rules.records import OWORD, Flow
from robomill.toolpath.gcode.words import normalise

_MAYBE = re.compile(rb"^(?:[/\dNn.\x00-\x09\x0b-\x20\x80-\xff]*[oO]|:\d)", re.MULTILINE)
_COLON = re.compile(r":(\d{1,8})(?=$|[(;])")

_LINE = re.compile(r"/?\d*(?:n[\d.]+)?o(<[^>]*>|\d+)(.*)", re.DOTALL)
_CLOSES = {
    rules.ENDWHILE: rules.WHILE,
    rules.ENDREPEAT: rules.REPEAT,
    rules.ENDIF: rules.IF,
    rules.ENDSUB: rules.SUB,
}
_OPENS = (rules.DO, rules.WHILE, rules.REPEAT, rules.IF)


@dataclass(slots=True)
class OWord:
    """An O word: its label, the text of its argument, and what is wrong with it if it is executed.

    line        int   index of its line
    keyword     int   place in ``KEYWORDS``, ``BARE`` for none
    begin, past int   its argument among those of the file
    start, end  int   O words that open and close what it belongs to (of a call: its subroutine); -1 if there is none
    next        int   the next branch of its ``if``, or its end
    counter     int   ``repeat`` words before it
    most        int   values that its argument has at most; -1 where it is not read
    has_break   bool  it opens a loop with a ``break``
    handed      bool  the interpreter reads its line first
    """

    line: int
    keyword: int
    label: str
    argument: str
    begin: int = 0
    past: int = 0
    start: int = -1
    end: int = -1
    next: int = -1
    counter: int = 0
    most: int = -1
    has_break: bool = False
    handed: bool = False
    problem: str = ""

    @property
    def name(self) -> str:
        """Label and keyword, as it is written."""
        return f"O{self.label} {KEYWORDS[self.keyword]}" if self.keyword >= 0 else f"O{self.label}"


_row_of = attrgetter(*(OWORD.names or ()))


class Calls:
    """The subroutines that are being executed, by level; explained in ``Flow``."""

    def __init__(self) -> None:
        self.special, self.back, self.subs = (array("q", [value]) * LEVELS for value in (0, -1, -1))
        self.aside = array("d", [0.0]) * (LEVELS * ARGUMENTS)


class Structure:
    """The O words of a file and their places by line, its subroutines by label, and the lines of bare ones by label."""

    def __init__(self, calls: Calls) -> None:
        self.words: list[OWord] = []
        self.places: dict[int, int] = {}
        self.subs: dict[str, int] = {}
        self.bare: dict[str, int] = {}
        self.calls = calls

    @cached_property
    def plain(self) -> Flow:
        """For rules in plain Python."""
        words, calls = self.words, self.calls
        codes: Any = "".join(word.argument for word in words).encode("ascii", "replace")
        repeats = sum(word.keyword == rules.REPEAT for word in words)
        memory: Any = (array("q", [-1]) * (LEVELS * repeats), array("q", [0]) * len(words))
        others: Any = (calls.special, calls.back, calls.subs, calls.aside)
        return Flow(words, codes, *memory, *others)

    @cached_property
    def views(self) -> Flow:
        """The same memory, as arrays for compiled code."""
        words = np.array([_row_of(word) for word in self.words], OWORD)
        words.flags.writeable = False
        memory: Any = self.plain[2:]
        views: Any = (np.frombuffer(values, values.typecode) for values in memory)
        return Flow(words, np.frombuffer(self.plain.arguments, np.uint8), *views)


def split(text: str) -> tuple[str, int, str] | None:
    """Label, keyword and argument of a normalised line that starts with an O word; None if it has none.

    Some controls write ``:1234`` for O1234.
    """
    found = _LINE.match(_COLON.sub(r"o\1", text, count=1))
    if found is None:
        return None
    label = found[1][1:-1] if found[1][0] == "<" else str(int(found[1][:18]))
    rest = found[2]
    for code, keyword in enumerate(KEYWORDS):
        if rest.startswith(keyword):
            return label, code, rest[len(keyword) :]
    return label, rules.BARE, rest


def scan(lines: Lines, calls: Calls) -> Structure:
    """The structure of a file. Mismatches become problems of their line, raised only if it is executed.

    What stands behind the % that ends the program belongs to none.
    """
    structure = Structure(calls)
    scanner = _Scanner(structure)
    words, past = structure.words, 0
    for found in _MAYBE.finditer(lines.data):
        index = lines.index_at(found.start())
        if lines.closing is not None and index > lines.closing:
            break
        raw = lines[index]
        try:
            text = normalise(raw, index + 1)
        except GCodeError:
            continue
        parts = split(text)
        if parts is None:
            continue
        label, keyword, argument = parts
        word = OWord(index, keyword, label, argument, past, past + len(argument))
        word.counter, word.most = scanner.repeats, rules.MOST.get(keyword, -1)
        structure.places[index] = len(words)
        words.append(word)
        past = word.past
        scanner.put(word, len(words) - 1)
        word.handed = bool(word.problem) or keyword == rules.BARE or text[0] == "/" or len(raw) > MAX_LINE
    for word in words:
        if word.keyword == rules.CALL:
            word.start = structure.subs.get(word.label, -1)
    return structure


class _Scanner:
    """Finds out what every O word belongs to: lists of the places of what is open, the first one opens it."""

    def __init__(self, structure: Structure) -> None:
        self.structure, self.words = structure, structure.words
        self.sub: list[int] = []
        self.open: dict[tuple[str, str], list[list[int]]] = {}
        self.seen: dict[tuple[str, str], int] = {}
        self.repeats = 0

    def put(self, word: OWord, place: int) -> None:
        """The next word."""
        keyword = word.keyword
        if keyword == rules.BARE:
            if not word.argument or word.argument[0] in "(;":
                self.structure.bare.setdefault(word.label, word.line)
            else:
                word.problem = f"found {word.argument[:20]!r} after {word.name}; expected sub, call, if and so on."
        elif keyword == rules.SUB:
            self._open_sub(word, place)
        elif keyword == rules.ENDSUB:
            if self.sub and self.words[self.sub[0]].label == word.label:
                self._close(self.sub, place)
                self.sub = []
            else:
                word.problem = f"{word.name} closes nothing; there is no open O{word.label} sub."
        else:
            scope = self.words[self.sub[0]].label if self.sub else ""
            self._put_inside(word, place, (scope, word.label))
        self.repeats += keyword == rules.REPEAT

    def _open_sub(self, word: OWord, place: int) -> None:
        subs, label = self.structure.subs, word.label
        if self.sub:
            outer = self.words[self.sub[0]].label
            word.problem = f"O{label} sub stands inside O{outer} sub; close that one with endsub first."
        elif label in subs:
            first = self.words[subs[label]].line + 1
            word.problem = f"O{label} sub is defined twice; the first is on line {first}."
        else:
            subs[label] = place
        self.sub = [place]
        word.start = place

    def _put_inside(self, word: OWord, place: int, where: tuple[str, str]) -> None:
        """A word of a branch or loop; ``where``: the subroutine around it, and its label."""
        stack = self.open.setdefault(where, [])
        keyword, kind = word.keyword, self.words[stack[-1][0]].keyword if stack else rules.BARE
        if keyword == rules.WHILE and kind == rules.DO:
            self._close(stack.pop(), place)
        elif keyword in _OPENS:
            first = self.seen.setdefault(where, word.line)
            if first != word.line:
                word.problem = f"{word.name}: the label is used on line {first + 1} already; choose another."
            stack.append([place])
            word.start = place
        elif keyword in _CLOSES:
            if kind == _CLOSES[keyword]:
                self._close(stack.pop(), place)
            else:
                what = KEYWORDS[_CLOSES[keyword]]
                word.problem = f"{word.name} closes nothing; there is no open O{word.label} {what}."
        elif keyword in (rules.ELSE, rules.ELSEIF):
            if kind == rules.IF:
                self._join(stack[-1], place)
            else:
                word.problem = f"{word.name} belongs to no O{word.label} if."
        elif keyword in (rules.BREAK, rules.CONTINUE):
            if kind in (rules.BARE, rules.IF):
                word.problem = f"{word.name} is in no O{word.label} loop."
            else:
                self._join(stack[-1], place)
                self.words[stack[-1][0]].has_break |= keyword == rules.BREAK
                if kind == rules.REPEAT:
                    word.problem = f"{word.name} is in a repeat loop; it works in while and do loops only."

    def _join(self, places: list[int], place: int) -> None:
        self.words[place].start = places[0]
        places.append(place)

    def _close(self, places: list[int], end: int) -> None:
        self._join(places, end)
        for place, after in zip(places, [*places[1:], end]):
            self.words[place].next, self.words[place].end = after, end
