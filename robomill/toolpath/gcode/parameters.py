"""Numbered and named parameters, with the ones the machine itself provides."""

import math
from array import array
from collections.abc import Callable, Iterable, Sequence
from typing import Any, NamedTuple

import numpy as np

from robomill.compiled import Out1, OutInt1
from robomill.errors import GCodeError
from robomill.toolpath.gcode.codes import WIDTH
from robomill.toolpath.gcode.rules import value_rules as rules
from robomill.toolpath.gcode.rules.value_rules import STACK

COUNT = 5602
"""Numbered parameters run from 1 to COUNT - 1."""

ARGUMENTS = 30
"""#1 to #30 are the arguments of a subroutine; a call saves and restores them."""

MAX_NAMED = 10_000
MAX_SETTINGS = 50
"""Parameters that a line can set."""
READ_ONLY = frozenset(range(5400, 5414)) | frozenset(range(5420, 5429))


RETURNED = ("_value", "_value_returned")
VALUE, VALUE_RETURNED = range(len(RETURNED))
"""What a subroutine returns; these names come first, and their values are among the others."""

LEVELS = 10
"""Levels of subroutines, the main program included; each has names of its own."""


class Store(NamedTuple):
    """What the rules of ``value_rules`` read: lists in plain Python, arrays that share their memory in compiled code.

    A value is NaN where none is set, or where the machine has to be asked for it.
    """

    numbered: Out1
    """(COUNT,) values of ``#1`` and so on."""
    named: Out1
    """(LEVELS * room,) values of names, a row a level."""
    slots: OutInt1
    """Names by their hash: 1 + the column of a name, or 0."""
    letters: OutInt1
    """The codes of the letters of all names,"""
    ends: OutInt1
    """and where each begins and ends among them."""
    values: Out1
    """Values that wait for an operator,"""
    marks: OutInt1
    """and the operators."""
    figures: Out1
    """(3,) the numbers of the last refusal."""
    keys: OutInt1
    """What a line sets: 0 or more for ``#5``, -1 - place in ``named`` for a name,"""
    settings: Out1
    """and to which values."""
    words: Out1
    """The words of a line,"""
    end: Out1
    """(6,) and where it leads."""
    level: OutInt1
    """(1,) how many subroutines are being executed."""
    room: int
    """Columns of ``named``."""
    provided: int
    """So many columns are names that the machine provides; the next one is ``n_args``."""
    towards_zero: int
    """1 where FIX and MOD cut towards 0, as Fanuc, Sinumerik and Heidenhain do; LinuxCNC's cut downwards."""
    by_bits: int
    """1 where AND, OR and XOR combine whole numbers bit by bit, as Fanuc's do: 6 AND 1 is 0."""


class Parameters:
    """The parameters. ``provide`` answers for read-only values (``#5420``, ``#<_x>``, called ``names``)."""

    def __init__(self, provide: Callable[[str | int], float] | None = None, names: Sequence[str] = ()) -> None:
        self.numbered = array("d", [0.0]) * COUNT
        self.numbered[5220] = 1.0
        self._provide = provide
        self._columns: dict[str, int] = {}
        self._asked: list[tuple[array[float], int]] = []
        self._named, self._slots = array("d"), array("q", [0])
        self._letters, self._ends = array("q"), array("q", [0])
        marks, figures, keys = array("q", [0]) * STACK, array("d", [0.0]) * 3, array("q", [0]) * MAX_SETTINGS
        values, settings = array("d", [0.0]) * STACK, array("d", [0.0]) * MAX_SETTINGS
        self._scratch = (values, marks, figures, keys, settings, array("d", [0.0]) * WIDTH, array("d", [0.0]) * 6)
        self._room, self._provided, self._level = 0, 0, array("q", [0])
        self._towards_zero = self._by_bits = 0
        self._views: Store | None = None
        names = (*RETURNED, *names)
        self._make_room(max(64, 2 * len(names)))
        for name in (*names, "n_args"):
            self._add(name)
        self._named[VALUE] = self._named[VALUE_RETURNED] = 0.0
        if provide is not None:
            for index in READ_ONLY:
                self.numbered[index] = math.nan
        self._provided = len(names)
        self.arrays = self._store()

    def cut_towards_zero(self) -> None:
        """FIX and MOD cut towards 0 from here on."""
        self._towards_zero = 1
        self.arrays = self._store()

    def combine_bits(self) -> None:
        """AND, OR and XOR go bit by bit from here on."""
        self._by_bits = 1
        self.arrays = self._store()

    # --- memory
    def _store(self) -> Store:
        names: Any = (self._named, self._slots, self._letters, self._ends)
        fields: Any = (
            self.numbered,
            *names,
            *self._scratch,
            self._level,
            self._room,
            self._provided,
            self._towards_zero,
            self._by_bits,
        )
        self._views = None
        return Store(*fields)

    def views(self) -> Store:
        """The same memory, as arrays for compiled code; what holds them has to let go before a name is added."""
        if self._views is None:
            fields: Any = self.arrays
            views: Any = (np.frombuffer(values, values.typecode) for values in fields[:-4])
            self._views = Store(*views, *fields[-4:])
        return self._views

    def _make_room(self, room: int) -> None:
        """Columns for ``room`` names, and half as many slots again and more."""
        named = array("d", [math.nan]) * (LEVELS * room)
        for level in range(LEVELS):
            known = self._named[level * self._room : (level + 1) * self._room]
            named[level * room : level * room + self._room] = known
        self._named, self._room, self._slots = named, room, array("q", [0]) * (2 * room)
        for column in range(len(self._columns)):
            self._put_slot(column)

    def _put_slot(self, column: int) -> None:
        first, end = self._ends[column], self._ends[column + 1]
        place = rules.first_slot(self._letters, first, end, len(self._slots))
        while self._slots[place]:
            place = (place + 1) % len(self._slots)
        self._slots[place] = column + 1

    def _add(self, name: str) -> None:
        self._views = None
        if len(self._columns) == self._room:
            self._make_room(2 * self._room)
        self._letters.extend(rules.codes(name))
        self._ends.append(len(self._letters))
        self._columns[name] = len(self._columns)
        self._put_slot(len(self._columns) - 1)
        self.arrays = self._store()

    # --- subroutines
    @property
    def level(self) -> int:
        """How many subroutines are being executed."""
        return self._level[0]

    # --- values
    def values(self, first: int, count: int) -> list[float]:
        """Of ``#first`` and those after it."""
        return self.numbered[first : first + count].tolist()

    def put(self, first: int, values: Sequence[float]) -> None:
        """Set ``#first`` and those after it."""
        self.numbered[first : first + len(values)] = array("d", values)

    def get(self, index: int) -> float:
        """Value of ``#index``."""
        value = self.numbered[index]
        return value if not math.isnan(value) or self._provide is None else self._provide(index)

    def get_named(self, name: str) -> float | None:
        """Value of ``#<name>``, None if it is not defined."""
        column = self._columns.get(name, -1)
        value = math.nan if column < 0 else self._named[self._place(name)]
        if not math.isnan(value):
            return value
        return self._provide(name) if 0 <= column < self._provided and self._provide is not None else None

    def _place(self, name: str) -> int:
        return (0 if name.startswith("_") else self._level[0]) * self._room + self._columns[name]

    def set(self, key: int | str, value: float) -> None:
        """Set ``#key`` or ``#<key>``. Raises GCodeError (without a line) if it cannot be set."""
        if isinstance(key, str):
            if key not in self._columns:
                if len(self._columns) > MAX_NAMED + self._provided:
                    raise GCodeError(f"more than {MAX_NAMED} named parameters; use fewer.")
                self._add(key)
            if self._columns[key] < self._provided:
                raise GCodeError(f"#<{key}> is provided by the machine and cannot be set.")
            self._named[self._place(key)] = value
        elif key in READ_ONLY:
            raise GCodeError(f"#{key} is provided by the machine and cannot be set.")
        elif not 1 <= key < COUNT:
            beyond = "those of a control beyond, such as tool offsets, cannot be set here: remove the line"
            raise GCodeError(f"#{key} does not exist; parameters run from 1 to {COUNT - 1}, and {beyond}.")
        else:
            self.numbered[key] = value

    def vacate(self, ranges: Iterable[range]) -> None:
        """Nobody has set the numbered parameters of ``ranges``: what reads one asks the machine for it."""
        for each in ranges:
            self.numbered[each.start : each.stop] = array("d", [math.nan]) * len(each)

    # --- what the machine provides
    def ask(self, name: str | None) -> None:
        """Let the machine say the value of a name, or of the number in ``figures``, until ``forget``.

        Raises GCodeError (without a line) where it cannot be said.
        """
        assert self._provide is not None
        if name is None:
            values, place = self.numbered, int(self.arrays.figures[0])
            values[place] = self._provide(place)
        else:
            values, place = self._named, self._place(name)
            values[place] = self._provide(name)
        self._asked.append((values, place))

    def forget(self) -> None:
        """Values that the machine said may change from now on."""
        for values, place in self._asked:
            values[place] = math.nan
        self._asked.clear()

    def expand(self, comment: str) -> str:
        """``comment`` with each ``#1`` or ``#<name>`` replaced by its value, as messages show it."""
        out, at = [], 0
        while at < len(comment):
            if comment[at] != "#":
                out.append(comment[at])
                at += 1
                continue
            at += 1
            value: float | None = None
            end = at
            if comment[at : at + 1] == "<" and ">" in comment[at:]:
                end = comment.index(">", at) + 1
                value = self.get_named("".join(comment[at + 1 : end - 1].split()).lower())
            else:
                while end < len(comment) and comment[end].isdigit():
                    end += 1
                if end > at and int(comment[at:end][:9]) < COUNT and int(comment[at:end][:9]) > 0:
                    value = self.get(int(comment[at:end]))
            if end == at:
                out.append("#")
                continue
            out.append("######" if value is None else f"{0.0 if abs(value) < 1e-6 else value:f}")
            at = end
        return "".join(out)
