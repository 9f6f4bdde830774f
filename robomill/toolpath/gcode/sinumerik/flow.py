"""Branches, loops and variables of Sinumerik programs: IF, WHILE, FOR, REPEAT, LOOP, DEF, and modal subprograms.

Variables that DEF makes are kept as ``#2000`` and on, behind the R parameters. (840D sl, Programming Manual, Job
Planning: flexible NC programming.)
"""

import re

from robomill.errors import GCodeError
from robomill.lazy import cached_property
from robomill.toolpath.gcode.sinumerik.angles import SinumerikAngles
from robomill.toolpath.gcode.sinumerik.words import parts, value_end
from robomill.toolpath.gcode.words import Block

FIRST_VARIABLE, MOST_VARIABLES = 2000, 1000
_START = re.compile(r"^[ \t/]*(?:N\d+[ \t]*)?(?:[A-Z_]{2}\w*[ \t]*:(?!=)[ \t]*)?")
_WORD = re.compile(
    r"(IF|WHILE|FOR|UNTIL)\b(.*)|(ELSE|ENDIF|ENDWHILE|ENDFOR|LOOP|ENDLOOP)[ \t]*|"
    r"(REPEATB?)(?:[ \t]+(?!P[ \t]*=)(\w+))?(?:[ \t]+(?!P[ \t]*=)(?!P\d+[ \t]*$)(\w+))?"
    r"(?:[ \t]+P[ \t]*=?[ \t]*(\d{1,6}))?[ \t]*"
)
_LIKELY = re.compile(rb"\b(?:IF|ELSE|WHILE|FOR|UNTIL|ENDIF|ENDWHILE|ENDFOR|LOOP|ENDLOOP|REPEAT)\b", re.IGNORECASE)
_CLOSES = {"ENDIF": "IF", "ENDWHILE": "WHILE", "ENDFOR": "FOR", "UNTIL": "REPEAT", "ENDLOOP": "LOOP"}
_COUNTS = re.compile(r"[ \t]*(R\d+|[A-Z_]\w*)[ \t]*=(.+?)\bTO\b(.+)")
_DEF = re.compile(r"DEF[ \t]+(REAL|INT|BOOL)[ \t]+(.+)")
_NAME = re.compile(r"([A-Z_]{1,2}\w+)[ \t]*(?:=[ \t]*(.+))?")
_SETS = re.compile(r"[ \t]*([A-Z_]\w+)[ \t]*=(?!=)")
_MODAL = re.compile(r"MCALL[ \t]+(L\d{1,7}|[A-Z_]{2}\w*)[ \t]*(?:\([ \t]*\))?")


class SinumerikFlow(SinumerikAngles):
    """Follows the structure of a program; ``SinumerikAngles`` reads what else its lines say."""

    modal_sub: tuple[str, int, int] | None = None

    def sinumerik_flow(self, code: str, line: int) -> bool:
        """Follow ``code`` (capitals, no comment) if it branches, loops or defines; False for other lines."""
        plain = _START.sub("", code, count=1).strip()
        found = _WORD.fullmatch(plain) if plain[:1] in "IWFUELR" else None
        if found is not None and "GOTO" not in plain and "#" not in plain:
            self._branch(found, line - 1)
            return True
        if plain[:4] == "DEF ":
            self._define(plain, line)
            return True
        if plain[:6] == "MCALL " and self._modal_call(plain, line):
            return True
        if plain == "MCALL":
            self.modal_sub = None
        found = _SETS.match(plain) if "=" in plain else None
        if found is not None and found[1] in self.variables:
            self._set_variables(plain, line)
            return True
        return plain[:1] in "AMSHCPL" and self.sinumerik_shape(plain, line)

    def _set_variables(self, plain: str, line: int) -> None:
        """One or several on a line."""
        at = 0
        while plain[at:].strip():
            found = _SETS.match(plain, at)
            if found is None or found[1] not in self.variables:
                raise GCodeError.at(line, f"found {plain[at:].strip()[:20]!r} where a variable is set; expected ABC=1.")
            at = value_end(plain, found.end())
            self.keep(self.variables[found[1]], self.value(plain[found.end() : at], line))

    def _branch(self, found: re.Match[str], index: int) -> None:
        word, line = found[1] or found[3] or found[4], index + 1
        if found[4] and (found[5] is not None or word == "REPEATB"):
            self._repeat(word, found[5] or "", found[6], int(found[7] or 1), index)
            return
        start, other, end = self._structure.get(index, (-1, -1, -1))
        if start < 0:
            raise GCodeError.at(line, f"{word} has no partner here; IF, WHILE, FOR, REPEAT and LOOP need their ends.")
        if word == "IF":
            if self.value(found[2], line) == 0.0:
                self.pc = (other if other >= 0 else end) + 1
        elif word == "ELSE":
            self.pc = end + 1
        elif word == "WHILE":
            if self.value(found[2], line) == 0.0:
                self.pc = end + 1
        elif word in ("ENDWHILE", "ENDLOOP"):
            self.pc = start
        elif word == "UNTIL":
            if self.value(found[2], line) == 0.0:
                self.pc = start + 1
        elif word in ("FOR", "ENDFOR"):
            self._count_on(start, end, word == "FOR", line)

    def _count_on(self, start: int, end: int, first: bool, line: int) -> None:
        """FOR begins to count, or ENDFOR counts on."""
        text = _START.sub("", self.main.lines[start].partition(";")[0].upper(), count=1).strip()
        found = _COUNTS.fullmatch(text.removeprefix("FOR"))
        if found is None:
            raise GCodeError.at(start + 1, "FOR is not read as it stands; expected FOR R1=1 TO 5.")
        at = self.slot(found[1], line)
        value = self.value(found[2], line) if first else self.machine.store.get(at) + 1.0
        self.keep(at, value)
        self.pc = start + 1 if value <= self.value(found[3], line) else end + 1

    def _repeat(self, word: str, label: str, last: str | None, times: int, index: int) -> None:
        """P=n times: REPEATB the line of a label, REPEAT those from a label to another, to ENDLABEL, or to here."""
        start = self._labelled(label, -1, index)
        end = start if word == "REPEATB" else self._labelled(last, start, index) if last else None
        if word == "REPEAT" and last is None:
            ends = [place for place in self.labels.get("ENDLABEL", []) if place > start]
            end = ends[0] if ends and (ends[0] < index or start > index) else None
        if end is None and start > index:
            raise GCodeError.at(index + 1, f"REPEAT {label} leads nowhere: there is no such label before it.")
        if end is not None and start <= index <= end:
            raise GCodeError.at(index + 1, f"{word} {label} stands in what it repeats; move it behind that.")
        key = (self.machine.store.level, index)
        left = self.rounds.get(key, times)
        if left > 0:
            self.rounds[key], self.pc = left - 1, start
            if end is not None:
                self.repeated.append((start, end, index, self.machine.store.level))
        else:
            self.rounds.pop(key, None)

    def _labelled(self, label: str, start: int, index: int) -> int:
        """The line of a label from ``start`` on: the last one before line ``index``, else the first behind it."""
        places = [place for place in self.labels.get(label, []) if place >= start]
        behind = [place for place in places if place < index]
        if not places:
            raise GCodeError.at(index + 1, f"REPEAT {label} leads nowhere: there is no such label.")
        return behind[0 if start >= 0 else -1] if behind else places[0]

    def leave_if_due(self) -> None:
        """Go back to REPEAT behind the last line of what it repeats."""
        super().leave_if_due()
        if self.repeated:
            _, end, index, level = self.repeated[-1]
            if self.pc == end + 1 and self.machine.store.level == level:
                self.repeated.pop()
                self.pc = index

    @cached_property
    def _structure(self) -> dict[int, tuple[int, int, int]]:
        """For each line that opens, divides or closes: the lines (indices) of its start, ELSE (-1: none) and end."""
        found: dict[int, tuple[int, int, int]] = {}
        stack: list[tuple[str, int, int]] = []
        lines = self.main.lines
        for index in sorted({lines.index_at(each.start()) for each in _LIKELY.finditer(lines.data)}):
            plain = _START.sub("", lines[index].partition(";")[0].upper(), count=1).strip()
            each = _WORD.fullmatch(plain)
            if each is None or "GOTO" in plain or (each[4] and each[5]):
                continue
            word = each[1] or each[3] or each[4]
            if word in ("IF", "WHILE", "FOR", "LOOP", "REPEAT"):
                stack.append((word, index, -1))
            elif word == "ELSE":
                if stack and stack[-1][0] == "IF":
                    stack[-1] = ("IF", stack[-1][1], index)
            elif stack and stack[-1][0] == _CLOSES[word]:
                _, start, other = stack.pop()
                for place in {start, index, *([other] if other >= 0 else [])}:
                    found[place] = start, other, index
        return found

    # --- variables
    def _define(self, plain: str, line: int) -> None:
        found = _DEF.fullmatch(plain)
        if found is None:
            raise GCodeError.at(line, f"{plain[:20]} is not read; expected DEF REAL, DEF INT or DEF BOOL and names.")
        for part in parts(found[2]):
            each = _NAME.fullmatch(part.strip())
            if each is None:
                raise GCodeError.at(line, f"found {part.strip()[:20]!r} where DEF has a name; fields are not read.")
            value = self.value(each[2], line) if each[2] else 0.0
            self.keep(self.define(found[1], each[1], line), value)

    def define(self, kind: str, name: str, line: int) -> int:
        """The place of a variable of this program or subprogram, new where it has none of that name."""
        if name not in self.own:
            if self.used >= MOST_VARIABLES:
                raise GCodeError.at(line, f"more than {MOST_VARIABLES} variables are defined.")
            self.variables[name] = FIRST_VARIABLE + self.used
            self.used += 1
            self.own.add(name)
        self.kinds[self.variables[name]] = kind
        return self.variables[name]

    # --- modal subprograms
    def _modal_call(self, plain: str, line: int) -> bool:
        found = _MODAL.fullmatch(plain)
        start = self.names.get(found[1]) if found is not None else None
        if found is None or start is None:
            return False
        self.modal_sub = found[1], start, self.machine.store.level
        self.machine.modal = self.modal_sub
        return True

    def call_modal(self, block: Block) -> None:
        """A subprogram that MCALL holds is called behind every line that moves, and not from within it."""
        super().call_modal(block)
        if self.modal_sub is None or block.motion < 0 or not block.words.keys() & set("xyzabc"):
            return
        name, start, level = self.modal_sub
        if self.machine.store.level == level:
            self.enter_modal(block, name, start)

    def enter_modal(self, block: Block, name: str, start: int) -> None:
        """Call the subprogram that MCALL holds."""
        self._enter(block, name, start, 1)
