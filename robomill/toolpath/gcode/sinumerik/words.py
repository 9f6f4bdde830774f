"""What everyday programs of Sinumerik controls say beside moves: R parameters, jumps, frames, drilling cycles.

R parameters are kept as ``#1000`` and on. A cycle is drilled where the tool stands, or, with MCALL, behind every line
that moves in X or Y (840D sl, Cycles: RTP retraction plane, RFP reference plane, SDIS safety distance above it, DP the
depth, or DPR how far it is below RFP).
"""

import math
import re
from dataclasses import dataclass, replace
from typing import Any

from robomill.errors import GCodeError
from robomill.lazy import cached_property
from robomill.toolpath.gcode.corners import BEVEL, LEGS, ROUND, Corner
from robomill.toolpath.gcode.expressions import Reader
from robomill.toolpath.gcode.fanuc.macro_calls import MacroCalls
from robomill.toolpath.gcode.offsets import frame_of, see_frame, turn_back
from robomill.toolpath.gcode.program import FEED, TRAVERSE
from robomill.toolpath.gcode.rules.motion_rules import MINUTE, PER_TURN, dwell, feed_speed
from robomill.toolpath.gcode.words import Block, normalise
from robomill.toolpath.plane import turned

FIRST_R = 1000
MOST_R = 1000
MAX_PECKS = 10_000
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
_CORNER = re.compile(r"\b(RNDM?|CHF|CHR|FRCM?)[ \t]*=[ \t]*(\d+(?:\.\d*)?|\.\d+)")
_KINDS = {"RND": ROUND, "CHF": BEVEL, "CHR": LEGS}
_IDENTIFIER = re.compile(r"\b[A-Z_]{1,2}\w+\b")
_TWO = re.compile(r"\b(?:POT[ \t]*\(((?:[^()]|\([^()]*\))*)\)|ATAN2[ \t]*\(((?:[^()]|\([^()]*\))*)\))")
_TRUTH = re.compile(r"\b(?:TRUE|FALSE|TRUNC)\b")
_IN_PLACE = re.compile(r"\b([XYZABCIJK])[ \t]*=[ \t]*(AC|IC|DC|ACP|ACN)[ \t]*\(((?:[^()]|\([^()]*\))*)\)")
_COMPARES = (("==", " EQ "), ("<>", " NE "), (">=", " GE "), ("<=", " LE "), (">", " GT "), ("<", " LT "))


@dataclass(frozen=True)
class Peck:
    """A depth of a drilling cycle before its bottom, a height as all of them. From there the tool goes ``out`` of the
    hole, and back at rapid down to ``on``; or it breaks the chip: up to ``on``, ``at_feed`` or at rapid."""

    depth: float
    on: float
    out: bool
    at_feed: bool = False


@dataclass(frozen=True)
class Hole:
    """A drilling cycle: heights along Z in program units, dwells in s, feeds.

    A ``feed`` of 0 is the one in force, so is an ``out`` of infinity; an ``out`` of 0 is a rapid. A tap goes by its
    ``pitch``, or ``taps`` by a feed, in a chuck that gives. ``first`` is by how much the first depth is gone to slower.
    The tool waits for ``dwell`` at the bottom, for ``between`` at each depth before it and for ``above`` when it has
    come out of the hole in between.
    """

    retract: float
    clear: float
    bottom: float
    dwell: float
    feed: float
    out: float
    pecks: tuple[Peck, ...]
    pitch: float
    taps: bool = False
    first: float = 1.0
    between: float = 0.0
    above: float = 0.0


class SinumerikWords(MacroCalls):
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
        """Drill where a line has moved to in X or Y, while MCALL holds."""
        if self.modal_hole is not None and block.motion in (0, 10) and block.words.keys() & {"x", "y"}:
            self.drill_here(self.modal_hole, block.line)

    # --- values
    def __init__(self, *given: Any) -> None:
        super().__init__(*given)
        self.variables: dict[str, int] = {}
        self.own: set[str] = set()
        self.used = 0
        self.kinds: dict[int, str] = {}
        self.rounds: dict[tuple[int, int], int] = {}

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

        text = _TWO.sub(lambda found: _of_two(found, line), _R.sub(known, text))
        text = _IDENTIFIER.sub(self._known_name, text)
        text = _TRUTH.sub(lambda found: {"TRUE": "1", "FALSE": "0", "TRUNC": "FIX"}[found[0]], text)
        for sign, word in _COMPARES:
            text = text.replace(sign, word)
        return text.replace("(", "[").replace(")", "]")

    def _known_name(self, found: re.Match[str]) -> str:
        return f"#{self.variables[found[0]]}" if found[0] in self.variables else found[0]

    def _computed(self, value: str) -> bool:
        """Whether a value is more than a number."""
        names = _IDENTIFIER.findall(value)
        return "R" in value or any(n in self.variables for n in names) or any(s in value.strip()[1:] for s in "+-*/(")

    def _values(self, code: str, line: int) -> str:
        """Set the R parameters of a line, and write out what its other words are set to."""
        if "=" not in code or '"' in code:
            return code
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
            raise GCodeError.at(line, f"{way} {label} leads nowhere: there is no such label on that side.")
        self.pc = chosen[0]

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
        if not any(shift) and angle == 0.0:
            turn_back(self.machine)
        else:
            see_frame(self.machine, shift, angle)

    # --- holes
    def _hole(self, kind: str, text: str, line: int) -> Hole:
        given = [self.value(each, line) if each.strip() else math.nan for each in text.split(",")]
        given += [math.nan] * (17 - len(given))
        retract, reference, safety, bottom, below = given[:5]
        if math.isnan(retract + reference) or (math.isnan(bottom) and math.isnan(below)):
            raise GCodeError.at(line, f"CYCLE{kind} needs RTP, RFP and DP or DPR, as in CYCLE{kind}(50,0,2,-10).")
        if kind in "8182" and not math.isnan(given[6]) and given[6] != 0.0:
            raise GCodeError.at(
                line, f"CYCLE{kind} counts its depth by the diameter (_GMODE), which is not read; give DP."
            )
        bottom = reference - abs(below) if math.isnan(bottom) else bottom
        clear = reference + (0.0 if math.isnan(safety) else abs(safety))
        if bottom >= clear or retract < clear:
            raise GCodeError.at(line, f"CYCLE{kind}: expected RTP above RFP + SDIS, and the depth below; mend them.")
        wait = given[8] if kind == "83" else given[5] if kind not in ("81", "87") else math.nan
        pitch = abs(given[8]) if kind == "84" else 0.0
        if kind == "84" and not pitch > 0.0:
            raise GCodeError.at(line, "CYCLE84 needs PIT, its pitch, which MPIT does not say here; give it.")
        feeds = [0.0 if math.isnan(v) else abs(v) for v in (given[6], given[7])] if kind == "85" else [0.0, 0.0]
        feeds[1] = math.inf if kind == "89" else feeds[1]
        seconds = 0.0 if math.isnan(wait) else max(wait, 0.0)
        hole = Hole(retract, clear, bottom, seconds, feeds[0], feeds[1], (), pitch)
        return self._pecked(hole, given, reference, line) if kind == "83" else hole

    def _pecked(self, hole: Hole, given: list[float], reference: float, line: int) -> Hole:
        """CYCLE83: VARI 1 goes out of the hole and back at rapid to DIS1 above the depth (0: 0.6 mm, or a 50th of holes
        deeper than 30 mm, 7 mm at most); VARI 0 goes up by VRT (0: 1 mm) at feed."""
        said = [0.0 if math.isnan(each) else each for each in given]
        mm = 1e-3 / self.machine.factor
        goes_out, depth = said[11] == 1.0, reference - hole.bottom
        usual = min(max(0.6 * mm, depth / 50.0 if depth > 30.0 * mm else 0.0), 7.0 * mm) if goes_out else mm
        up = abs(said[16 if goes_out else 14]) or usual
        depths = self._depths(given, reference, hole.bottom, line)
        pecks = tuple(Peck(each, min(each + up, hole.clear), goes_out, not goes_out) for each in depths)
        slower, last = said[10] if 0.0 < said[10] < 1.0 else 1.0, said[15]
        dwell = last if last > 0.0 else hole.dwell
        return replace(hole, dwell=dwell, pecks=pecks, first=slower, between=hole.dwell, above=max(said[9], 0.0))

    def _depths(self, given: list[float], reference: float, bottom: float, line: int) -> list[float]:
        """Depths of CYCLE83 before the last: FDEP or FDPR first; then each stroke is less by DAM, and DAM at least, or
        by a factor where DAM is negative, and MDEP at least."""
        first = reference - abs(given[6]) if math.isnan(given[5]) else given[5]
        step = reference - first
        if math.isnan(first) or step <= 0.0:
            raise GCodeError.at(line, "CYCLE83 needs FDEP or FDPR, its first depth.")
        less, least = (0.0 if math.isnan(each) else each for each in (given[7], given[13]))
        if less < -1.0:
            raise GCodeError.at(line, f"CYCLE83 has DAM {less:g}; a factor is -1 to 0, an amount above 0.")
        depths: list[float] = []
        while first > bottom:
            depths.append(first)
            step = max(step - less, less) if less > 0.0 else max(-less * step, least) if less < 0.0 else step
            rest = first - bottom
            first -= 0.5 * rest if step == less < rest <= 2.0 * less else step  # the last two are alike
            if len(depths) > MAX_PECKS:
                raise GCodeError.at(line, f"CYCLE83 would need more than {MAX_PECKS} pecks; give a larger FDPR.")
        return depths

    def drill_here(self, hole: Hole, line: int) -> None:
        """Drill where the tool stands."""
        machine = self.machine
        block = Block(line)
        machine.need_compensation_off(block, "A drilling cycle")
        if machine.plane != 17:
            raise block.refuse("a drilling cycle is read in the plane G17 alone.")
        if machine.feed == 0.0 and hole.feed == 0.0 and hole.pitch == 0.0:
            raise block.refuse("a drilling cycle needs a feed rate; give an F word above 0 first.")
        down = hole.feed * machine.factor / MINUTE if hole.feed else None
        out = hole.out * machine.factor / MINUTE if 0.0 < hole.out < math.inf else None
        if hole.pitch:
            if machine.speed == 0.0:
                raise block.refuse("CYCLE84 needs a spindle speed; give an S word first.")
            down = out = hole.pitch * machine.factor * machine.speed / MINUTE
        before, machine.motion = machine.motion, 840 if hole.pitch or hole.taps else machine.motion
        self._to(TRAVERSE, line, hole.clear)
        begin = down if hole.first == 1.0 else hole.first * (feed_speed(machine) if down is None else down)
        for n, peck in enumerate(hole.pecks):
            self._to(FEED, line, peck.depth, down if n else begin)
            self._wait(hole.between)
            if peck.out:
                self._to(FEED if hole.out else TRAVERSE, line, hole.clear, out)
                self._wait(hole.above)
            if peck.on < hole.clear if peck.out else peck.on > peck.depth:
                self._to(*(FEED, line, peck.on, down) if peck.at_feed else (TRAVERSE, line, peck.on))
        self._to(FEED, line, hole.bottom, down if hole.pecks else begin)
        self._wait(hole.dwell)
        if hole.out or hole.pitch:
            self._to(FEED, line, hole.clear, out)
        self._to(TRAVERSE, line, hole.retract)
        machine.motion = before

    def _wait(self, seconds: float) -> None:
        if seconds:
            dwell(self.machine, seconds)

    def _to(self, kind: int, line: int, height: float, v_f: float | None = None) -> None:
        machine = self.machine
        end = [*machine.p[:2], height, *machine.p[3:]]
        machine.place({"z": height})
        machine.go(kind, line, end, v_f)
        machine.p = end


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
            if depth == 0 and last not in "+-*/=" and code[ahead : ahead + 1] not in ("+", "-", "*", "/"):
                return at
        else:
            depth += (sign == "(") - (sign == ")")
            last = sign
        at = ahead
    return at
