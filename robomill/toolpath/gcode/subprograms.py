"""Subprograms called by number, line or name: M97, M98, M198 with M99; L100, names and CALL with M17 and RET."""

import math
import re
from dataclasses import replace
from itertools import pairwise

from robomill.errors import GCodeError
from robomill.lazy import cached_property
from robomill.toolpath.gcode import codes as modal
from robomill.toolpath.gcode.expressions import Reader
from robomill.toolpath.gcode.owords import SENTENCES, Call, OWords
from robomill.toolpath.gcode.rules import flow_rules as rules
from robomill.toolpath.gcode.rules.cycle_rules import is_cycle
from robomill.toolpath.gcode.scan import CALLS, COMMENT, letters_of_call
from robomill.toolpath.gcode.words import Block

_LINE_NUMBER = re.compile(rb"^[/ \t]*N[ \t]*0*(\d{1,9})(?![\d.])", re.MULTILINE | re.IGNORECASE)
_HEADER = re.compile(
    rb"^[ \t]*(?:%_N_(\w+?)_(?:SPF|MPF)\b|(?:N\d+[ \t]*)?PROC[ \t]+(\w+))", re.MULTILINE | re.IGNORECASE
)
_NUMBERED = re.compile(r"L(\d{1,7})(?:[ \t]+P[ \t]*=?[ \t]*(\d{1,4}))?[ \t]*")
_NAMED = re.compile(
    r"(?:CALL[ \t]*\"(\w+)\"|([A-Z_]{2}\w*)(?:[ \t]*\([^()]*\))?)(?:[ \t]+P[ \t]*=?[ \t]*(\d{1,4}))?[ \t]*"
)
_LEAVES = re.compile(r"\b(?:M17|M0?2|M30|RET)\b(?:[ \t]*\([^()]*\))?")
_N = re.compile(r"^[ \t/]*(?:N\d+[ \t]*)?")
_OVER = re.compile(r"M[ \t]*99(?![\d.])(?![ \t]*P)|^[ \t]*[O:]\d", re.IGNORECASE)
_PROGRAM = re.compile(r"^[ \t]*[O:][ \t]*0*(\d{1,9})[ \t;\r]*(?:\([^\n]*)?$", re.MULTILINE | re.IGNORECASE)
_ENDS = re.compile(r"M[ \t]*0*(2|30|99)(?!\d)", re.IGNORECASE)
LOCALS = 33
"""Variables #1 to #33 of Macro B belong to the macro that is being run."""


class Subprograms(OWords):
    """Follows calls of subprograms in the same file; ``OWords`` follows those of O words."""

    calls_lines = leaves = False

    def fanuc_call(self, block: Block) -> bool:
        """M97, M98 and M198 call a subprogram, M99 returns from it (in the main program: ends it)."""
        code = next((c for c in (*block.unknown_m, *block.m.values()) if c in (*CALLS, 99)), None)
        if code is None:
            return False
        if (rest := _beside(block, code)) is not None:
            if self.machine.modal is not None and all(call.values is None for call in self.foreign.values()):
                text = (
                    f"M{code} beside other words, and a macro or cycle that every move calls; put it on its own line."
                )
                raise block.refuse(text)
            self.execute(rest)
        if code == 99:
            self._return(block)
            return True
        if "p" not in block.words and "h" in block.words and code == 98:  # Mitsubishi: a line of this program
            code, block.words["p"] = 97, block.words.pop("h")
        if "p" not in block.words:
            raise block.refuse(f"M{code} needs P, the {'line' if code == 97 else 'number of the program'} to call.")
        bare = self.o_words(self.main).bare
        number, repeats = self.dialect.subprogram(block, code, bare)
        if code == 97:
            self.calls_lines = True
            start = self.line_numbered(number)
            if start is None:
                raise block.refuse(f"M97 calls line N{number}, but no line has that number; add it, or mend P.")
        else:
            at = bare.get(str(number))
            if at is None:
                raise block.refuse(self._missing(f"M{code}", f"O{number}", block.line))
            start, repeats = self._begun(block, at + 1, repeats)
        self._enter(block, str(number), start, repeats)
        return True

    def execute(self, block: Block) -> None:
        """Check and execute a block."""
        raise NotImplementedError

    def o_word(self, reader: Reader, index: int) -> None:
        """Follow the O word of a line; on a Fanuc the number of another program ends the one before it."""
        place = self.o_words(self.file).places.get(index)
        word = None if place is None else self.o_words(self.file).words[place]
        if not self.machine.is_fanuc or word is None or word.keyword != rules.BARE or word.problem:
            super().o_word(reader, index)
            return
        if self.machine.store.level > 0:
            raise reader.refuse(f"O{self.called_now()} goes on into {word.name}; close it with M99 before that line.")
        if len(self.machine.recorder):
            text = f"the program ends without M30 before {word.name}, where it is taken to end"
            self.machine.findings.add("no-end", "warning", index + 1, text)
            self.finish(index + 1)
            self.ended = True

    def begin_at_main(self) -> None:
        """Go to the first program that ends for good, where it calls the one that the file begins with: as a control
        writes all of its programs out, subprograms may stand above what calls them."""
        lines = self.main.lines
        data = lines.data if lines.closing is None else lines.data[: lines.starts[lines.closing]]
        if b"M99" not in data and b"m99" not in data:
            return
        text = data.decode("utf-8", "replace")
        heads = list(_PROGRAM.finditer(text))
        if len(heads) < 2:
            return
        bounds = [head.start() for head in heads] + [len(text)]
        parts = [COMMENT.sub("", text[a:b]) for a, b in pairwise(bounds)]
        first = heads[0][1]
        main = next((k for k, part in enumerate(parts) if {"2", "30"} & {*_ENDS.findall(part)}), 0)
        called = rf"(?:M[ \t]*98|G[ \t]*6[56])(?!\d)[^\n]*P[ \t]*\d*{first}(?!\d)"
        if main == 0 or not re.search(called, parts[main], re.IGNORECASE):
            return
        self.pc = text.count("\n", 0, heads[main].start())
        said = f"the program begins at O{heads[main][1]}: O{first} above it is a subprogram that it calls"
        self.machine.findings.add("begins-at-main", "info", self.pc + 1, said)

    def _begun(self, block: Block, start: int, repeats: int) -> tuple[int, int]:
        """Where M98 with Q (Mitsubishi: also H) begins, and how often it is run.

        Q is a line of the subprogram (Fanuc, Mitsubishi); where no line there has that number, and nobody has stated
        such a control, it is how often it is run (Mach3).
        """
        letter = next((each for each in "qh" if each in block.words), "")
        if not letter:
            return start, repeats
        number, end = block.words[letter], self._end_of(start)
        within = (at for at in self._line_numbers.get(round(number), []) if start <= at < end)
        at = next(within, None) if number == round(number) else None
        said = f"{letter.upper()}{number:g} of M98"
        if at is not None:
            self.machine.note("call-begins", "warning", f"{said} is read as the line N{number:g} at which to begin")
            return at, repeats
        stated = not self.dialect.guessed or letter == "h" or "l" in block.words
        if stated or not 1 <= number <= 9999 or number != round(number):
            raise block.refuse(f"{said} names a line of what it calls, and none there has that number; mend it.")
        self.machine.note(
            "call-counts", "warning", f"{said} is read as a count, as Mach3 does: no line there is N{number:g}"
        )
        return start, round(number)

    def _end_of(self, start: int) -> int:
        """The index of the line at which what begins at ``start`` ends: its M99, or the next O number."""
        lines = self.main.lines
        ends = (at for at in range(start, len(lines)) if _OVER.search(COMMENT.sub("", lines[at])))
        return next(ends, len(lines))

    def _missing(self, call: str, name: str, line: int) -> str:
        """Why a subprogram cannot be called: it is not there, or stands where no control looks."""
        end = self.main.lines.closing
        behind = re.compile(rf"^[ \t]*(?:O|:)[ \t]*0*{name[1:]}[ \t]*(?:\(.*)?$", re.IGNORECASE)
        if end is not None and any(behind.match(text) for text in self.main.lines[end:]):
            return (
                f"{call} calls {name}, which stands behind the % that ends the program, where a control reads no "
                "further; move it before that %."
            )
        if re.fullmatch(r"O98\d\d", name) and call == "G65":
            return f"{call} calls {name}, a macro that measures with a probe and cuts nothing; take its lines out."
        return f"{call} calls {name}, but there is no {name} in the program; paste it in behind the end (M30)."

    def line_numbered(self, number: int) -> int | None:
        """The index of line N``number``: the next one behind this line, else the first."""
        places = self._line_numbers.get(number, [])
        return next((place for place in places if place >= self.pc), places[0] if places else None)

    @cached_property
    def _line_numbers(self) -> dict[int, list[int]]:
        found: dict[int, list[int]] = {}
        lines = self.main.lines
        for each in _LINE_NUMBER.finditer(lines.data):
            found.setdefault(int(each[1]), []).append(lines.index_at(each.start()))
        return found

    def _enter(
        self, block: Block, label: str, start: int, repeats: int, values: dict[int, float] | None = None
    ) -> None:
        """Call what begins at ``start``; ``values`` are its own variables, None if it shares those of its caller."""
        if repeats < 1:
            return
        if rules.enter(self.machine.store.arrays, self.o_words(self.main).plain, -1, -1, 0):
            raise block.refuse(SENTENCES[rules.TOO_MANY_LEVELS])
        call = Call(label, self.file, self.pc, repeats, start, values)
        if values is not None:
            call.kept = self.machine.store.values(1, LOCALS)
            self._give(values)
        self._go_to(call, self.main, start)

    def _give(self, values: dict[int, float]) -> None:
        self.machine.store.put(1, [values.get(number, math.nan) for number in range(1, LOCALS + 1)])

    def _return(self, block: Block) -> None:
        target = None
        if "p" in block.words:
            target = self.line_numbered(round(block.words["p"]))
            if target is None:
                raise block.refuse(f"M99 goes back to line N{block.words['p']:g}, but no line has that number.")
        if self.machine.store.level > 0:
            self._repeat_or_leave()
        elif target is None:
            self.machine.note("m99-ends", "info", "M99 in the main program is taken as its end")
            self.finish(block.line)
            self.ended = True
        if target is not None:
            self.pc = target

    def _repeat_or_leave(self) -> None:
        level = self.machine.store.level
        call = self.foreign.get(level)
        if call is not None and call.repeats > 1:
            call.repeats -= 1
            self.pc = call.start
            if call.values is not None:
                self._give(call.values)
        else:
            if call is not None and call.values is not None:
                self.machine.store.put(1, call.kept)
            self._go_back(level, rules.leave(self.machine.store.arrays, self.o_words(self.file).plain))

    # --- Sinumerik: by name
    def leave_if_due(self) -> None:
        """Leave a subprogram whose last line says more than its end."""
        if self.leaves:
            self.leaves = False
            self._repeat_or_leave()

    def sinumerik_call(self, code: str, line: int) -> str | None:
        """Follow a call, or the end of a subprogram; what else the line says, None where it is done.

        ``code`` is the line in capitals without its comment.
        """
        plain = _N.sub("", code).strip()
        if plain[:1] in "%P" and _HEADER.match(plain.encode()):
            if plain[0] == "%" and self.pc > 1 and self.machine.store.level == 0 and len(self.machine.recorder):
                return "M2"  # the next program of an archive
            if plain[0] == "%" and self.machine.store.level > 0:
                self._repeat_or_leave()
            return None
        if self.machine.store.level > 0 and _LEAVES.search(plain):
            rest = _LEAVES.sub("", plain).strip()
            if rest:
                self.leaves = True
                return rest
            self._repeat_or_leave()
            return None
        found = _NUMBERED.fullmatch(plain)
        name = f"L{found[1]}" if found else ""
        if found is None:
            found = _NAMED.fullmatch(plain)
            name = (found[1] or found[2]) if found else ""
            if found is None or (found[1] is None and name not in self.names):
                return code
        start = self.names.get(name)
        repeats = int(found[found.re.groups] or 1)
        if start is None:
            text = f"{name} calls a subprogram that is not in this file; paste it in behind the end, below a line "
            raise GCodeError.at(line, f"{text}%_N_{name}_SPF, or let the CAM system write its moves out.")
        if "(" in plain and re.search(r"\([^()]*\w[^()]*\)", plain):
            raise GCodeError.at(
                line, f"{name} is called with values, but no line PROC {name}(REAL A, ...) says what they are; add it."
            )
        self._enter(Block(line), name, start, repeats)
        return None

    @cached_property
    def names(self) -> dict[str, int]:
        """Where the subprograms begin that a Sinumerik calls by name."""
        lines = self.main.lines
        found = ((each[1] or each[2], lines.index_at(each.start())) for each in _HEADER.finditer(lines.data))
        return {name.decode("ascii", "replace").upper(): at + 1 for name, at in found}


def _beside(block: Block, code: int) -> Block | None:
    """What a line says beside its call, or beside M99; None where that is all.

    It is executed first: ``X1000. M98 P1200`` calls behind the move (Fanuc, Operator's Manual: subprogram).
    """
    called = {letter.lower() for letter in letters_of_call(modal.LENGTH in block.g)}
    if is_cycle(block.g.get(modal.MOTION, -1)) and not block.words.keys().isdisjoint("lq"):
        raise block.refuse(f"M{code} and a cycle on one line both want L or Q; put them on two lines.")
    words = {letter: value for letter, value in block.words.items() if letter not in called}
    m = {group: each for group, each in block.m.items() if each != code}
    unknown = [each for each in block.unknown_m if each != code]
    if not (words or m or unknown or block.g or block.unknown_g or block.settings):
        return None
    left = replace(block, words=words, m=m, unknown_m=unknown)
    block.words = {letter: value for letter, value in block.words.items() if letter in called}
    return left
