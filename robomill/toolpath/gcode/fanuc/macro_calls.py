"""Macro B's calls with values (G65, G66), and variables that nobody has set.

A variable that nobody has set is empty: a word that takes its value is left out (``X#24``), ``#1 EQ #0`` asks for it,
and in sums it counts as 0. G65 gives a subprogram its own #1 to #33 (Fanuc, Custom Macro B, argument specification).
"""

import math
import re
from typing import Any

from robomill.errors import GCodeError
from robomill.toolpath.gcode.expressions import Reader
from robomill.toolpath.gcode.fanuc.macro import MacroB
from robomill.toolpath.gcode.machine import Machine
from robomill.toolpath.gcode.scan import COMMENT
from robomill.toolpath.gcode.subprograms import LOCALS
from robomill.toolpath.gcode.words import Block

SYSTEM = range(1000, 5070)
EMPTY = (range(1, LOCALS + 1), range(100, 200), range(500, 1000))
"""Variables that a program sets; those of ``SYSTEM`` are the control's own."""
_ARGUMENTS = dict(
    zip("ABCIJKDEFHMQRSTUVWXYZ", (1, 2, 3, 4, 5, 6, 7, 8, 9, 11, 13, 17, 18, 19, 20, 21, 22, 23, 24, 25, 26))
)
_SETS = 10
"""I, J and K can be given so many times."""
_CALL = re.compile(r"g(65|66)(?![\d.])")
_ENDS_MODAL = 670
_WORD = re.compile(r"([A-FH-MP-Z])\s*[-+]?\s*#\s*(\d+)(?![\d\s]*[-+*/])", re.IGNORECASE)
_ASKS = re.compile(r"#(\d+)\s*(EQ|NE)\s*(#0(?!\d)|[-+]?[\d.]+)|#0\s*(EQ|NE)\s*#(\d+)", re.IGNORECASE)
_COPIES = re.compile(r"\s*(?:/\s*)?(?:N\d+\s*)?#\s*(\d+)\s*=\s*#\s*(\d+)\s*")
_ALARM = re.compile(r"#\s*3000\s*=")
_SAYS = re.compile(r"\(([^()]*)\)")


def begin_empty(machine: Machine) -> None:
    """Variables are empty as a Fanuc control begins; those of the control itself are asked for."""
    machine.is_fanuc, machine.variable = True, system_variable
    machine.store.vacate((*EMPTY, SYSTEM))
    machine.store.combine_bits()


def is_empty(machine: Machine, number: int) -> bool:
    """Whether nobody has set the variable; #0 is always empty."""
    return number == 0 or (any(number in each for each in EMPTY) and math.isnan(machine.store.numbered[number]))


class MacroCalls(MacroB):
    """Follows G65, G66 and G67."""

    modal_macro: tuple[int, int, int, dict[int, float]] | None = None

    def filled_in(self, raw: str, line: int) -> str:
        """The line without words whose variable is empty, and with what it asks of empty ones answered."""
        if not self.machine.is_fanuc or "#" not in raw:
            return raw
        machine, code = self.machine, COMMENT.sub("", raw)
        if _ALARM.search(code):
            said = _SAYS.search(raw)
            raise GCodeError.at(line, f"the program stops here with an alarm (#3000){f': {said[1]}' if said else ''}.")
        copy = _COPIES.fullmatch(code)
        if copy is not None and is_empty(machine, int(copy[2][:9])) and any(int(copy[1][:9]) in r for r in EMPTY):
            machine.store.vacate([range(int(copy[1]), int(copy[1]) + 1)])
            return ""

        def answered(found: re.Match[str]) -> str:
            empty = is_empty(machine, int((found[1] or found[5])[:9]))
            if (found[3] or "#0") != "#0" and not empty:
                return found[0]
            same = empty and (found[3] or "#0") == "#0"
            return f"1 {found[2] or found[4]} {1 if same else 0}"

        plain = _ASKS.sub(answered, code)
        plain = _WORD.sub(lambda found: "" if is_empty(machine, int(found[2][:9])) else found[0], plain)
        return raw if plain == code else plain

    def macro_call(self, reader: Reader) -> bool:
        """Follow the line if it is a call with values. Raises GCodeError where it cannot be followed."""
        found = _CALL.match(reader.text, reader.at)
        if found is None or not self.machine.is_fanuc:
            return False
        reader.at = found.end()
        given, number, repeats = self._arguments(reader)
        start = self.o_words(self.main).bare.get(str(number))
        if start is None:
            raise reader.refuse(self._missing(f"G{found[1]}", f"O{number}", reader.line))
        if found[1] == "66":
            self.modal_macro = self.machine.modal = (number, start + 1, repeats, given)
        else:
            self._enter(Block(reader.line), str(number), start + 1, repeats, given)
        return True

    def _arguments(self, reader: Reader) -> tuple[dict[int, float], int, int]:
        """Values by variable, the program that is called and how often."""
        given: dict[int, float] = {}
        said: dict[str, float] = {}
        sets, before, text = 0, "", reader.text
        while reader.at < len(text) and text[reader.at] != ";":
            letter = text[reader.at].upper()
            if letter == "(":
                reader.at = text.index(")", reader.at) + 1
                continue
            if letter not in "PL" and letter not in _ARGUMENTS:
                raise reader.refuse(f"found {letter!r} among the values of a macro; expected letters but G, N, O.")
            reader.at += 1
            value = reader.value()
            if letter in "PL":
                said[letter] = value
            elif letter in "IJK":
                sets += letter <= before
                before = letter
                if sets >= _SETS:
                    raise reader.refuse(f"I, J and K are given more than {_SETS} times.")
                given[_ARGUMENTS[letter] + 3 * sets] = value
            else:
                given[_ARGUMENTS[letter]] = value
        number, repeats = said.get("P", -1.0), said.get("L", 1.0)
        if number != round(number) or number < 0 or repeats != round(repeats) or not 0 <= repeats <= 9999:
            raise reader.refuse("a macro is called by P, the number of a program, and L, up to 9999 repeats.")
        return given, round(number), round(repeats)

    def fanuc_call(self, block: Block) -> bool:
        """G67 ends what G66 began, wherever it stands on its line; the other words of the line are executed."""
        if self.machine.is_fanuc and _ENDS_MODAL in block.unknown_g:
            block.unknown_g.remove(_ENDS_MODAL)
            self.modal_macro = self.machine.modal = None
        return super().fanuc_call(block)

    def call_modal(self, block: Block) -> None:
        """G66 calls its macro behind every line that moves, and not from within it."""
        called: Any = self.modal_macro
        if called is None or block.motion < 0 or any(call.values is not None for call in self.foreign.values()):
            return
        if block.words.keys() & set("xyzabc"):
            number, start, repeats, given = called
            self._enter(block, str(number), start, repeats, given)


def system_variable(machine: Machine, number: int) -> float:
    """What a Fanuc control says of itself. Raises GCodeError (without a line) where that is not known here."""
    if any(number in each for each in EMPTY):
        machine.note("never-set", "warning", f"#{number} is read and nobody has set it: it counts as 0")
        return 0.0
    for first in (5001, 5041):
        if first <= number < first + 6 and machine.compensation is None:
            return machine.p[number - first]
    known = {
        4001: machine.motion / 10.0,
        4002: float(machine.plane),
        4003: 90.0 if machine.absolute else 91.0,
        4006: machine.unit_code / 10.0,
        4109: machine.feed,
        4119: machine.speed,
        4120: float(machine.in_spindle),
    }
    if 5061 <= number < 5070:
        raise GCodeError(f"#{number} is where a probe has met something, which is not known here; write its value.")
    if number not in known:
        raise GCodeError(f"#{number} is the control's own, and is not known here; write its value instead.")
    return known[number]
