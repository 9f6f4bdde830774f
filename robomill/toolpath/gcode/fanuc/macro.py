"""Macro B as Fanuc and Haas run it: IF [...] GOTO, IF [...] THEN, GOTO, WHILE [...] DO ... END; ``#1=#2+1``.

Values are those of ``value_rules``; a variable that was never set is 0, and ``#0`` (vacant) is refused.
"""

import re

from robomill.lazy import cached_property
from robomill.toolpath.gcode.expressions import Reader
from robomill.toolpath.gcode.offsets import place_by_numbers
from robomill.toolpath.gcode.scan import COMMENT
from robomill.toolpath.gcode.subprograms import Subprograms
from robomill.toolpath.gcode.words import apply_settings, read_words

_BEGINS = re.compile(r"if\[|while\[|goto|end\d|do\d")
_LOOP = re.compile(
    rb"^[/ \t]*(?:N[ \t]*\d+)?[ \t]*(?:(WH(?:ILE)?[^\n(A-Za-z]*\[[^\n(]*DO|DO)|EN(?:D)?)[ \t]*(\d)(?!\d)",
    re.MULTILINE | re.IGNORECASE,
)
_SUM = re.compile(
    r"^([ \t]*/?[ \t]*(?:N\d+)?[ \t]*#\s*(?:\d+|\[[^\]=]*\])\s*=)([^=;(]*?)\s*(\(.*|;.*)?$", re.IGNORECASE
)
_TURN = re.compile(r"(?:do|end)\d")
_OPERATOR = re.compile(r"[\]\d.]\s*(?:[-+*/]|MOD|AND|OR|XOR)", re.IGNORECASE)


_SHORT = {
    **{"WH": "WHILE", "GO": "GOTO", "EN": "END", "TH": "THEN", "XO": "XOR"},
    **{"SI": "SIN", "CO": "COS", "TA": "TAN", "AS": "ASIN", "AC": "ACOS", "AT": "ATAN", "SQ": "SQRT", "AB": "ABS"},
    **{"RO": "ROUND", "FI": "FIX", "FU": "FUP", "EX": "EXP"},
}
_SHORTENED = re.compile(rf"(?<![A-Z])({'|'.join(_SHORT)})(?=\s*[\[#\d])", re.IGNORECASE)


def in_full(raw: str) -> str:
    """``WH[...]DO1`` as ``WHILE[...]DO1``: two letters stand for a word, as a Fanuc writes its tapes."""
    if not _SHORTENED.search(COMMENT.sub("", raw)):
        return raw
    return _SHORTENED.sub(lambda found: _SHORT[found[1].upper()], COMMENT.sub("", raw))


def with_brackets(raw: str) -> str:
    """``#1=#2+1``, which Macro B reads to its end, as ``#1=[#2+1]``; other lines as they are."""
    found = _SUM.match(raw) if "#" in raw and "=" in raw else None
    if found is None or not _OPERATOR.search(found[2]):
        return raw
    return f"{found[1]}[{found[2]}]{found[3] or ''}"


class MacroB(Subprograms):
    """Follows the branches and loops of Macro B."""

    def macro_word(self, reader: Reader, index: int) -> bool:
        """Follow the line if it is one of Macro B's. Raises GCodeError where it leads nowhere."""
        text = reader.text
        if not _BEGINS.match(text, reader.at):
            return False
        if text.startswith("goto", reader.at):
            reader.at += 4
            self._go_to_line(reader)
        elif text.startswith("if", reader.at):
            reader.at += 2
            holds = reader.value() != 0.0
            if text.startswith("goto", reader.at):
                reader.at += 4
                if holds:
                    self._go_to_line(reader)
            elif text.startswith("then", reader.at):
                reader.at += 4
                if holds:
                    self._then(reader)
            else:
                raise reader.refuse(f"found {reader.rest()!r} after the condition of IF; expected GOTO or THEN.")
        else:
            self._loop(reader, index)
        return True

    def _go_to_line(self, reader: Reader) -> None:
        number = reader.integer("The line that GOTO goes to")
        self._alone(reader)
        target = self.line_numbered(number)
        if target is None:
            raise reader.refuse(f"GOTO {number} leads nowhere: no line has the number N{number}.")
        self.pc = target

    def _then(self, reader: Reader) -> None:
        rest = with_brackets(reader.text[reader.at :])
        block = read_words(Reader(rest, reader.line, reader.store))
        more = block.words or block.g or block.m or block.unknown_g or block.unknown_m
        if more or not block.settings:
            raise reader.refuse("THEN sets variables, as in THEN #1=2; put moves on a line of their own behind a GOTO.")
        apply_settings(block, reader.store)
        place_by_numbers(self.machine, block)

    def _loop(self, reader: Reader, index: int) -> None:
        partner = self._loops.get(index)
        if partner is None:
            raise reader.refuse("WHILE ... DO and END do not match here; each DO1 needs its END1, and they nest.")
        over = False
        if reader.text.startswith("end", reader.at):
            self.pc = partner
        elif reader.text.startswith("while", reader.at):
            reader.at += 5
            over = reader.value() == 0.0
        turn = _TURN.match(reader.text, reader.at)
        reader.at = reader.at if turn is None else turn.end()
        self._alone(reader)
        if over:
            self.pc = partner + 1

    def _alone(self, reader: Reader) -> None:
        """Raise GCodeError where words stand behind GOTO, DO or END on their line: nothing would execute them."""
        rest = reader.text[reader.at :].strip()
        if rest and rest[0] not in "(;":
            raise reader.refuse(f"found {reader.rest()!r} behind GOTO, DO or END; put it on a line of its own.")

    @cached_property
    def _loops(self) -> dict[int, int]:
        """Lines of DO and END, each with the other's."""
        found: dict[int, int] = {}
        stack: list[tuple[bytes, int]] = []
        lines = self.main.lines
        for each in _LOOP.finditer(lines.data):
            at = lines.index_at(each.start())
            if each[1]:
                stack.append((each[2], at))
            elif stack and stack[-1][0] == each[2]:
                start = stack.pop()[1]
                found[start], found[at] = at, start
        return found
