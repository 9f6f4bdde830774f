"""What everyday programs of Sinumerik controls say beside moves: R parameters, jumps, frames, drilling cycles.

R parameters are kept as ``#1000`` and on. A cycle is drilled where the tool stands, or, with MCALL, behind every line
that moves in X or Y (840D sl, Cycles: RTP retraction plane, RFP reference plane, SDIS safety distance above it, DP the
depth, or DPR how far it is below RFP).
"""

import math
import re
from typing import Any

from robomill.errors import GCodeError
from robomill.lazy import cached_property
from robomill.toolpath.gcode.corners import BEVEL, LEGS, ROUND, Corner
from robomill.toolpath.gcode.expressions import Reader
from robomill.toolpath.gcode.frames import frame_of, see_frame, turn_back
from robomill.toolpath.gcode.rules.motion_rules import PER_TURN
from robomill.toolpath.gcode.sinumerik.holes import Hole, Holes, drilling_cycle, of_percentages
from robomill.toolpath.gcode.standing import note_moved
from robomill.toolpath.gcode.words import Block, normalise
from robomill.toolpath.plane import turned

FIRST_R = 1000
MOST_R = 1000
_N = re.compile(r"^[ \t/]*(?:N\d+[ \t]*)?")
_R = re.compile(r"\bR(\d+)\b")
_SET_R = re.compile(r"\bR(\d+)\s*=\s*")
_WORD = re.compile(r"\b([XYZABCIJKFS]|[ABC]3|RND|RNDM|CHF|CHR|FRC|FRCM|CR|TURN)\s*=\s*(?!(?:AC|IC|DC|ACP|ACN)\s*\()")
_LABEL = re.compile(r"([A-Z_]{2}\w*)[ \t]*:(?!=)")
_LABELS = re.compile(rb"^[/ \t]*(?:N\d+[ \t]*)?([A-Za-z_]{2}\w*)[ \t]*:(?!=)", re.MULTILINE)
_JUMP = re.compile(r"(?:IF\b(.*?)[ \t]*)?\b(GOTO[FBC]?)[ \t]+(\w+)[ \t]*")
_FRAME = re.compile(r"(A?TRANS|A?ROT)\b(.*)")
_ALONE = re.compile(r"\bA?(?:TRANS|ROT)\b")
_FRAME_WORD = re.compile(r"\b(X|Y|Z|RPL)[ \t]*(?:=|(?=[-+.\d]))")
_CYCLE = re.compile(r"(MCALL\b[ \t]*)?(?:CYCLE(8[1-9])[ \t]*\(([^()]*)\))?[ \t]*")
_CORNER = re.compile(r"\b(RNDM?|CHF|CHR|FRCM?)[ \t]*=[ \t]*(-?(?:\d+(?:\.\d*)?|\.\d+))")
_KINDS = {"RND": ROUND, "CHF": BEVEL, "CHR": LEGS}
_IDENTIFIER = re.compile(r"\b[A-Z_]{1,2}\w+\b")
_TWO = re.compile(r"\b(?:POT[ \t]*\(((?:[^()]|\([^()]*\))*)\)|ATAN2[ \t]*\(((?:[^()]|\([^()]*\))*)\))")
_GOES_ON = re.compile(r"[-+*/]|(?:DIV|MOD)\b")
_WENT_ON = re.compile(r"\b(?:DIV|MOD)$")
_DIV = re.compile(r"(#?\w+(?:\.\d*)?|[^\s(+\-*/]*\))[ \t]*\bDIV\b[ \t]*(#?\w+(?:\.\d*)?|[(+\-])")
_NOT = re.compile(r"\bNOT\b[ \t]*(\((?:[^()]|\([^()]*\))*\)|[#\w.]+)")
_R_COMPUTED = re.compile(r"\bR\[([^\[\]]+)\]")
_TRUTH = re.compile(r"\b(?:TRUE|FALSE|TRUNC)\b")
_IN_PLACE = re.compile(r"\b([XYZABCIJK])[ \t]*=[ \t]*(AC|IC|DC|ACP|ACN)[ \t]*\(((?:[^()]|\([^()]*\))*)\)")
_COMPARES = (("==", " EQ "), ("<>", " NE "), (">=", " GE "), ("<=", " LE "), (">", " GT "), ("<", " LT "))


class SinumerikWords(Holes):
    """Reads what stands beside moves; what is left of a line goes on to the reader of words."""

    modal_hole: Hole | None = None
    corner_feed = 0.0

    def sinumerik_line(self, code: str, line: int) -> str | None:
        """What is left of ``code`` (capitals, no comment); None where it is done."""
        plain = _N.sub("", code).strip()
        label = _LABEL.match(plain)
        if label is not None:
            plain = plain[label.end() :].strip()
            code = plain
        jump = _JUMP.fullmatch(plain)
        if jump is not None:
            self._jump(jump, line)
            return None
        frame = _FRAME.fullmatch(plain)
        if frame is not None:
            self._frame(frame[1], frame[2], line)
            return None
        cycle = _CYCLE.fullmatch(plain) if plain[:5] in ("MCALL", "CYCLE") else None
        if cycle is not None and (cycle[1] or cycle[2]):
            hole = None if cycle[2] is None else self._hole(cycle[2], cycle[3], line)
            if cycle[1]:
                self.modal_hole = self.machine.modal = hole
            elif hole is not None:
                self.drill_here(hole, line)
            return None
        alone = _ALONE.search(code)
        if alone is not None:
            raise GCodeError.at(line, f"{alone[0]} stands on a line of its own, and not as it is here.")
        code = self._values(code, line)
        said = {corner[1]: float(corner[2]) for corner in _CORNER.finditer(code)}
        if said:
            name, least = min(said.items(), key=lambda each: each[1])
            if least < 0.0:
                raise GCodeError.at(line, f"{name}={least:g} is below 0; expected the size of a corner, or its feed.")
            code = _CORNER.sub("", code)
            self._corner(said)
        return code if code.strip() else None

    def _corner(self, said: dict[str, float]) -> None:
        """What a line says of corners; FRC is the feed of the one at its end, FRCM that of all that follow, until 0."""
        machine = self.machine
        if "RNDM" in said:
            machine.set_rounding(said["RNDM"])
        self.corner_feed = said.get("FRCM", self.corner_feed)
        feed = said.get("FRC", self.corner_feed) * (machine.speed if machine.feed_mode == PER_TURN else 1.0)
        for name, kind in _KINDS.items():
            if name in said:
                machine.corner = Corner(kind, said[name], feed)

    def drill_modal(self, block: Block) -> None:
        """Drill where a line has moved to, be it along Z alone, while MCALL holds."""
        moves = block.motion in (0, 10, 20, 30) and block.words.keys() & set("xyzabcij")
        if self.modal_hole is not None and moves:
            self.drill_here(self.modal_hole, block.line)

    def _hole(self, kind: str, text: str, line: int) -> Hole:
        given = [self.value(each, line) if each.strip() else math.nan for each in text.split(",")]
        if kind == "83" and (factors := of_percentages(given)) is not None:
            text = "CYCLE83: DAM above the first stroke and FRF above 1 are read as percentages, as Operate writes them"
            self.machine.findings.add("cycle-percent", "warning", line, text)
            given = factors
        return drilling_cycle(kind, given, self.machine.factor, line)

    # --- values
    def __init__(self, *given: Any) -> None:
        super().__init__(*given)
        self.variables: dict[str, int] = {}
        self.own: set[str] = set()
        self.used = 0
        self.kinds: dict[int, str] = {}
        self.rounds: dict[tuple[int, int], int] = {}
        self.repeated: list[tuple[int, int, int, int]] = []

    def slot(self, name: str, line: int) -> int:
        """The number of the parameter that keeps an R parameter or a variable, which is then set."""
        if name in self.variables:
            return self.variables[name]
        if not re.fullmatch(r"R\d+", name) or int(name[1:10]) >= MOST_R:
            raise GCodeError.at(line, f"{name} is no variable; define it (DEF REAL {name}) or take R1.")
        self.machine.r_set.add(int(name[1:10]))
        return FIRST_R + int(name[1:10])

    def keep(self, at: int, value: float) -> None:
        """Set a parameter or variable: an INT keeps the next whole number, a BOOL 0 or 1."""
        kind = self.kinds.get(at)
        whole = float(math.floor(value + 0.5)) if kind == "INT" else float(value != 0.0) if kind == "BOOL" else value
        self.machine.store.set(at, whole)

    def value(self, text: str, line: int) -> float:
        """The value of an expression."""
        reader = Reader(normalise(f"[{self._expression(text, line)}]", line), line, self.machine.store)
        value = reader.value()
        if reader.at < len(reader.text):
            raise reader.refuse(f"found {reader.rest()!r} behind a value; expected an expression such as R1+5.")
        return value

    def _expression(self, text: str, line: int) -> str:
        """A Sinumerik expression in the words of ``value_rules``."""

        def known(found: re.Match[str]) -> str:
            number = int(found[1][:9])
            if number not in self.machine.r_set:
                raise GCodeError.at(line, f"R{number} is read before the program sets it; set it at the start.")
            return f"#{FIRST_R + number}"

        text = _R_COMPUTED.sub(lambda found: self._numbered(found[1], line), text)
        text = _TWO.sub(lambda found: _of_two(found, line), _R.sub(known, text))
        text = _DIV.sub(lambda found: self._of_whole(found, line), text)
        text = _NOT.sub(lambda found: f"({found[1]}==0)", _IDENTIFIER.sub(self._known_name, text))
        text = _TRUTH.sub(lambda found: {"TRUE": "1", "FALSE": "0", "TRUNC": "FIX"}[found[0]], text)
        for sign, word in _COMPARES:
            text = text.replace(sign, word)
        return text.replace("(", "[").replace(")", "]")

    def _numbered(self, text: str, line: int) -> str:
        """R[ ] by its computed number."""
        number = self.value(text, line)
        if not 0.0 <= number < MOST_R or number != round(number):
            raise GCodeError.at(line, f"R[{number:g}] does not exist; R parameters run from 0 to {MOST_R - 1}.")
        return f"R{number:.0f}"

    def _of_whole(self, found: re.Match[str], line: int) -> str:
        """DIV of whole numbers: how often the one goes into the other."""
        if re.search(r"(?:[*/]|\bMOD|\bDIV)[ \t]*$", found.string[: found.start()]):
            raise GCodeError.at(line, "DIV behind another product is read in brackets of its own alone; write them.")
        for each in found.groups():
            if not each.isdigit() and self.kinds.get(self.variables.get(each, -1)) != "INT":
                found_there = f"R{int(each[1:]) - FIRST_R}" if re.fullmatch(r"#1\d{3}", each) else each[:20]
                text = f"DIV is read between whole numbers and INT variables, found {found_there}; write TRUNC(a/b)."
                raise GCodeError.at(line, text)
        return f"TRUNC(({found[1]})/({found[2]}))"

    def _known_name(self, found: re.Match[str]) -> str:
        return f"#{self.variables[found[0]]}" if found[0] in self.variables else found[0]

    def _computed(self, value: str) -> bool:
        """Whether a value is more than a number."""
        names = _IDENTIFIER.findall(value)
        if "R" in value or any(n in self.variables or n in ("DIV", "MOD") for n in names):
            return True
        return any(s in value.strip()[1:] for s in "+-*/(")

    def _values(self, code: str, line: int) -> str:
        """Set the R parameters of a line, and write out what its other words are set to."""
        if "=" not in code or '"' in code:
            return code
        code = _R_COMPUTED.sub(lambda found: self._numbered(found[1], line), code)
        if _SET_R.match(_N.sub("", code).lstrip()):
            rest = _N.sub("", code).strip()
            while found := _SET_R.match(rest):
                after = _SET_R.search(rest, found.end())
                value = rest[found.end() : after.start() if after else len(rest)].strip()
                number = int(found[1][:9])
                if number >= MOST_R:
                    raise GCodeError.at(line, f"R{number} does not exist; R parameters run from 0 to {MOST_R - 1}.")
                self.machine.store.set(FIRST_R + number, self.value(value, line))
                self.machine.r_set.add(number)
                rest = rest[after.start() :] if after else ""
            return rest
        code = _IN_PLACE.sub(lambda found: self._in_place(found, line), code)
        out, at = [], 0
        for found in _WORD.finditer(code):
            if found.start() < at:
                continue
            end = value_end(code, found.end())
            value = code[found.end() : end]
            if self._computed(value):
                out += [code[at : found.end()], f"{self.value(value, line):.12f} "]
                at = end
        return "".join([*out, code[at:]])

    def _in_place(self, found: re.Match[str], line: int) -> str:
        """X=AC( ) and its kin with their value; DC, ACP and ACN turn an axis the short way, up or down."""
        letter, way, value = found[1], found[2], self.value(found[3], line)
        if way in ("DC", "ACP", "ACN"):
            if letter not in "ABC":
                raise GCodeError.at(line, f"{letter}={way}( ) is for axes that turn; write {letter}=AC( ).")
            at = self.machine.p["XYZABC".index(letter)]
            up = (value - at) % 360.0
            value = at + {"DC": up if up <= 180.0 else up - 360.0, "ACP": up, "ACN": up - 360.0 if up else 0.0}[way]
            way = "AC"
        return f"{letter}={way}({value:.12f})"

    # --- jumps
    def _jump(self, found: re.Match[str], line: int) -> None:
        if found[1] is None or self.value(found[1], line) != 0.0:
            self._jump_to(found[2], found[3], line)

    def _jump_to(self, way: str, label: str, line: int) -> None:
        """GOTOF looks ahead, GOTOB back, GOTO ahead and then back."""
        places = self.labels.get(label, [])
        if not places and re.fullmatch(r"N\d+", label):
            places = self._line_numbers.get(int(label[1:10]), [])
        ahead, behind = [p for p in places if p >= self.pc], [p for p in places if p < self.pc]
        chosen = {"GOTOF": ahead[:1], "GOTOB": behind[-1:]}.get(way, ahead[:1] or behind[-1:])
        if not chosen:
            if way == "GOTOC":
                return
            raise GCodeError.at(line, f"{way} {label} leads nowhere: there is no such label on that side.")
        self.pc, here = chosen[0], self.machine.store.level
        while self.repeated and self.repeated[-1][3] == here:
            start, end, index, level = self.repeated[-1]
            if start <= self.pc <= end:
                break
            self.repeated.pop()  # who jumps out of what REPEAT repeats has done with it
            self.rounds.pop((level, index), None)

    @cached_property
    def labels(self) -> dict[str, list[int]]:
        found: dict[str, list[int]] = {}
        for each in _LABELS.finditer(self.main.lines.data):
            at = self.main.lines.index_at(each.start())
            found.setdefault(each[1].decode("ascii", "replace").upper(), []).append(at)
        return found

    # --- frames
    def _frame(self, name: str, text: str, line: int) -> None:
        """TRANS and ROT begin anew, ATRANS and AROT add; without words they end what was."""
        if self.machine.tilted is not None and text.strip():
            raise GCodeError.at(line, f"{name} in a swivelled plane is not read; end that before: CYCLE800().")
        words = list(_FRAME_WORD.finditer(text))
        ends = [word.start() for word in words[1:]] + [len(text)]
        said = {word[1]: self.value(text[word.end() : end].strip(), line) for word, end in zip(words, ends)}
        rest = text[: words[0].start()].strip() if words else text.strip()
        turning = name.endswith("ROT")
        if rest or (turning and (said.keys() & {"X", "Y"} or len(said) > 1)) or (not turning and "RPL" in said):
            found = (rest or text).strip()[:20]
            raise GCodeError.at(line, f"{name} {found} is not read; expected shifts along X, Y, Z or a turn about Z.")
        self.machine.need_compensation_off(Block(line), name)
        if self.machine.plane != 17 and turning:
            raise GCodeError.at(line, f"{name} is read in the plane G17 alone.")
        shift, angle = frame_of(self.machine) if name[0] == "A" else ([0.0] * 3, 0.0)
        if turning:
            angle += sum(said.values())
        else:
            x, y, z = (said.get(letter, 0.0) for letter in "XYZ")
            shift = [*turned(x, y, math.radians(angle), *shift[:2]), shift[2] + z]
        before = self.machine.said_point()
        if not any(shift) and angle == 0.0:
            turn_back(self.machine)
        else:
            see_frame(self.machine, shift, angle)
        note_moved(self.machine, before)


def _of_two(found: re.Match[str], line: int) -> str:
    """POT, the square, and ATAN2 of two values, in the words of ``value_rules``."""
    if found[1] is not None:
        return f"(({found[1]})**2)"
    values = parts(found[2])
    if len(values) != 2:
        raise GCodeError.at(line, "ATAN2 needs two values, as in ATAN2(R1,R2).")
    return f"(ATAN({values[0]})/({values[1]}))"


def parts(text: str) -> list[str]:
    """What stands between commas, but for those in brackets and quotes."""
    out, depth, quoted = [""], 0, False
    for sign in text:
        quoted ^= sign == '"'
        depth += 0 if quoted else (sign in "([") - (sign in ")]")
        if sign == "," and depth == 0 and not quoted:
            out.append("")
        else:
            out[-1] += sign
    return out


def value_end(code: str, at: int) -> int:
    """Where an expression ends that begins at ``at``: at a blank outside of brackets that no operator stands beside, or
    at a sign of another value."""
    depth, last = 0, "="
    while at < len(code) and code[at] != "=":
        sign, ahead = code[at], at + 1
        if sign in " \t":
            while code[ahead : ahead + 1] in (" ", "\t"):
                ahead += 1
            goes_on = last in "+-*/=" or _GOES_ON.match(code, ahead) or _WENT_ON.search(code[:at])
            if depth == 0 and not goes_on:
                return at
        else:
            depth += (sign == "(") - (sign == ")")
            last = sign
        at = ahead
    return at
