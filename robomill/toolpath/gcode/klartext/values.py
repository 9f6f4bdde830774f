"""Q parameters, jumps, datum shifts and drilling cycles of Heidenhain's dialogue."""

import math
import re

from robomill.errors import GCodeError
from robomill.toolpath.gcode.expressions import Reader
from robomill.toolpath.gcode.klartext.pecks import pecks_of
from robomill.toolpath.gcode.machine import Scale
from robomill.toolpath.gcode.offsets import frame_of, see_frame, turn_back
from robomill.toolpath.gcode.program import TRAVERSE
from robomill.toolpath.gcode.sinumerik.holes import Hole
from robomill.toolpath.gcode.sinumerik.procs import SinumerikProcs
from robomill.toolpath.gcode.words import Block, normalise

NUMBER = r"[-+]? ?(?:\d+(?:\.\d*)?|\.\d+|Q[LR]?\d+)"
FIRST_Q = {"Q": 1000, "QL": 3000, "QR": 4000}
MOST_Q = {"Q": 1999, "QL": 499, "QR": 499}
_FEEDS = ("Q206", "Q207", "Q208")
"""Feeds of cycles, which AUTO makes that of TOOL CALL."""
RAPID_OUT = 99_999.0
"""Q208 from which on a tool leaves its hole at rapid; what MAX and FMAX stand for."""
_Q = re.compile(r"(Q[LR]?)(\d+)")
_SET = re.compile(r"(?:FN ?(\d+) ?: ?)?(Q[LR]?\d+) ?= ?(.+)")
_JUMP = re.compile(
    r"FN ?(9|10|11|12) ?: ?IF ?(.+?) ?(?<![A-Z])(EQU|NEQU|NEQ(?!\d)|NE|GT|LT)(?![A-PR-Z]) ?(.+?) ?"
    r"GOTO ?LBL ?(\"[^\"]+\"|\d+)"
)
_COMPARES = {"9": ("EQU",), "10": ("NE", "NEQ", "NEQU"), "11": ("GT",), "12": ("LT",)}
_SIGNS = {0: "", 1: "+", 2: "-", 3: "*", 4: "/"}
_TWO = {
    0: r"(.+)",
    1: r"(.+?) ?\+ ?(.+)",
    2: r"(.+?) ?- ?(.+)",
    3: r"(.+?) ?\* ?(.+)",
    4: r"(.+?) ?(?:DIV|/) ?(.+)",
    8: r"(.+?) ?LEN ?(.+)",
    13: r"(.+?) ?ANG ?(.+)",
}
_ONE = {5: "SQRT", 6: "SIN", 7: "COS"}
_FUNCTION = re.compile(
    r"\b(SQRT|SQ|SIN|COS|TAN|ASIN|ACOS|ATAN|ABS|INT|FRAC|SGN|NEG|LN|LOG|EXP) ?([-+]?(?:#\d+|[\d.]+)|(?=\[))"
)
_WRITTEN_OUT = {
    "SQ": "[{0}**2]",
    "ATAN": "ATAN{0}/[1]",
    "FRAC": "[{0}-FIX{0}]",
    "SGN": "[[{0} GT 0]-[{0} LT 0]]",
    "NEG": "[0-{0}]",
    "LOG": "[LN{0}/LN[10]]",
}
"""Functions that LinuxCNC has by another name; {0} is their argument in its brackets."""
_OWN = re.compile(rf"\b({'|'.join(_WRITTEN_OUT)})\[")
_CYCLE = re.compile(r"CYCL DEF ?(\d+)(?: ?\.(\d+))?(.*)")
_AXIS = re.compile(rf"(I?)([XYZ]) ?({NUMBER})")
_DRILLS = {
    200: "drilling",
    201: "reaming",
    203: "drilling",
    205: "drilling",
    206: "tapping",
    207: "tapping",
    209: "tapping",
    240: "centring",
}
_PATTERNS = (220, 221)


class KlartextValues(SinumerikProcs):
    """Reads what computes, shifts and drills; moves are those of ``klartext``."""

    drill: int = 0
    says_out = False
    due = per_turn = False
    raised = 0.0
    pole: tuple[int, float, float] | None = None
    preset: float | None = None
    tool_feed: float | None = None
    """Program units a minute, as the last TOOL CALL says."""

    # --- values
    def number(self, text: str, line: int) -> float:
        """The value of a number, a Q parameter or an expression."""

        def known(found: re.Match[str]) -> str:
            at = self._place(found[1], int(found[2][:6]), line)
            if at not in self.machine.r_set:
                raise GCodeError.at(line, f"{found[0]} is read before the program sets it; set it at the start.")
            return f"#{at}"

        plain = _Q.sub(known, text.replace("PI", f"{math.pi:.15f}"))
        plain = plain.replace("(", "[").replace(")", "]").replace("^", "**").replace("%", " MOD ")
        plain = _FUNCTION.sub(
            lambda found: ("FIX" if found[1] == "INT" else found[1]) + (f"[{found[2]}]" if found[2] else ""), plain
        )
        plain = _written_out(re.sub(r"(?<=[-+*/]) ?\+ ?", " ", re.sub(r"^ ?\+ ?", "", plain)))
        reader = Reader(normalise(f"[{plain}]", line), line, self.machine.store)
        value = reader.value()
        if reader.at < len(reader.text):
            raise reader.refuse(f"found {reader.rest()!r} behind a value; expected an expression such as Q1 + 5.")
        return value

    def _place(self, kind: str, number: int, line: int) -> int:
        if number > MOST_Q[kind]:
            raise GCodeError.at(line, f"{kind}{number} does not exist; {kind} parameters run up to {MOST_Q[kind]}.")
        return FIRST_Q[kind] + number

    def set_q(self, name: str, value: float, line: int) -> None:
        """Set a Q parameter."""
        found = _Q.fullmatch(name)
        assert found is not None
        at = self._place(found[1], int(found[2][:6]), line)
        self.machine.store.set(at, value)
        self.machine.r_set.add(at)

    def q(self, number: int, default: float = 0.0) -> float:
        """The value of a Q parameter; ``default`` where nobody has set it."""
        at = FIRST_Q["Q"] + number
        return self.machine.store.get(at) if at in self.machine.r_set else default

    def label(self, name: str, line: int) -> int:
        """The index of the line behind a label."""
        raise NotImplementedError

    def values_line(self, code: str, line: int) -> bool:
        """Set Q parameters, or jump; False for other lines."""
        jump = _JUMP.fullmatch(code)
        if jump is not None:
            if jump[3] not in (said := _COMPARES[jump[1]]):
                raise GCodeError.at(
                    line, f"FN {jump[1]} compares by {said[0]}, found {jump[3]}; mend the one or other."
                )
            a, b = self.number(jump[2], line), self.number(jump[4], line)
            same = abs(a - b) <= 1e-9
            if {"9": same, "10": not same, "11": a > b and not same, "12": a < b and not same}[jump[1]]:
                self.pc = self.label(jump[5], line)
            return True
        found = _SET.fullmatch(code)
        if found is None:
            return False
        if found[1] is None:
            self.set_q(found[2], self.number(found[3], line), line)
            return True
        kind = int(found[1])
        if kind in _ONE:
            self.set_q(found[2], self.number(self._of_one(kind, found[3], line), line), line)
            return True
        terms = re.fullmatch(_TWO[kind], found[3]) if kind in _TWO else None
        if terms is None:
            raise GCodeError.at(line, f"FN {kind} is not read; expected FN 0 to 13.")
        if kind in (8, 13):
            a, b = (self.number(each, line) for each in terms.groups())
            self.set_q(found[2], math.hypot(a, b) if kind == 8 else math.degrees(math.atan2(a, b)) % 360.0, line)
            return True
        text = _SIGNS[kind].join(f"({each})" for each in terms.groups())
        self.set_q(found[2], self.number(text, line), line)
        return True

    def _of_one(self, kind: int, said: str, line: int) -> str:
        """The expression of FN 5 to 7, which write their function out themselves, as in SQRT +16."""
        name = _ONE[kind]
        value = said.removeprefix(name).strip()
        if re.match("[A-Z]{2}", value) and not _Q.match(value):
            raise GCodeError.at(line, f"FN {kind} is {name}, found {said[:20]}; expected {name} and a value.")
        return f"{name}({value})"

    # --- cycles
    def cycle_words(self, code: str, line: int) -> str | None:
        """CYCL DEF, CYCL CALL and TRANS DATUM."""
        if code.startswith("CYCL CALL"):
            return self.cycle_call(code, line)
        if code.startswith("TRANS DATUM"):
            reset = "RESET" in code
            self._shift({} if reset else self._axes_of(code, line), line, every=reset)
            return None
        found = _CYCLE.match(code)
        if found is None:
            raise GCodeError.at(line, f"{code[:30]} is not read; expected CYCL DEF and its number.")
        number, part, rest = int(found[1][:4]), found[2], found[3]
        if number in _DRILLS or number in _PATTERNS:
            if number in _DRILLS:
                self.drill, self.says_out = number, "Q208" in rest
            for name, value in re.findall(r"(Q\d+) ?= ?(\S+)", rest):
                if name == "Q208" and value in ("MAX", "FMAX"):
                    self.set_q(name, RAPID_OUT, line)
                    continue
                if value in ("AUTO", "FAUTO") and name in _FEEDS:
                    self.set_q(name, self.rate("AUTO", line) * self.tenth, line)
                    continue
                if not re.fullmatch(NUMBER, value):
                    raise GCodeError.at(line, f"CYCL DEF {number} has {name}={value}, which is not read.")
                self.set_q(name, self.number(value, line), line)
            if number in _PATTERNS:
                self.pattern(number, line)
            return None
        return self._other_cycle(number, part, rest.strip(), line)

    def _other_cycle(self, number: int, part: str | None, rest: str, line: int) -> str | None:
        if number == 7 and part != "0":
            if "#" in rest:
                raise GCodeError.at(line, "CYCL DEF 7 takes its shift from a table, which is not read; write X, Y, Z.")
            self._shift(self._axes_of(rest, line), line)
        elif number == 10 and part != "0":
            found = re.fullmatch(rf"(I?)ROT ?({NUMBER})", rest)
            if found is None:
                raise GCodeError.at(line, f"CYCL DEF 10.{part} {rest[:20]} is not read; expected ROT and an angle.")
            self._turn(self.number(found[2], line), bool(found[1]), line)
        elif number == 9 and part != "0":
            found = re.search(rf"({NUMBER}) ?$", rest)
            return f"G4 P{max(self.number(found[1], line), 0.0):.6f}" if found else None
        elif number == 247:
            self._choose_preset(float(next(iter(re.findall(r"Q339 ?= ?\+?(\d+)", rest)), "0")), line)
        elif number == 8 and part != "0":
            self._mirror(rest, line)
        elif number == 11 and part != "0":
            if any(float(v) != 1.0 for v in re.findall(r"[-+]?(?:\d+\.?\d*|\.\d+)", rest)):
                raise GCodeError.at(line, f"CYCL DEF 11.{part} {rest[:20]} scales: not read.")
        elif number not in (7, 8, 9, 10, 11, 13, 19, 32, 247, *_TUNING):
            raise GCodeError.at(line, f"CYCL DEF {number} {rest[:20]} is a cycle that is not read; {_LET}.")
        return None

    def _choose_preset(self, preset: float, line: int) -> None:
        """CYCL DEF 247, which also ends a datum shift, a rotation and a mirror image."""
        if self.preset is not None and self.preset != preset:
            raise GCodeError.at(line, "CYCL DEF 247 chooses a second preset; split the program there.")
        self.preset = preset
        if self.machine.scale is not None:
            self._mirror("", line)
        if frame_of(self.machine) != ([0.0] * 3, 0.0):
            self._see([0.0] * 3, 0.0, line)

    def _axes_of(self, text: str, line: int) -> dict[str, tuple[bool, float]]:
        return {letter.lower(): (bool(step), self.number(value, line)) for step, letter, value in _AXIS.findall(text)}

    def _shift(self, said: dict[str, tuple[bool, float]], line: int, every: bool = False) -> None:
        """A datum shift: an axis that is not given stays as it is, ``every`` ends them all."""
        shift, angle = frame_of(self.machine)
        for axis, letter in enumerate("xyz"):
            step, value = said.get(letter, (True, 0.0))
            shift[axis] = 0.0 if every else value + (shift[axis] if step else 0.0)
        if any(shift) and angle != 0.0:
            raise GCodeError.at(line, "a datum shift inside of a rotation is not read; shift first, then turn.")
        self._see(shift, angle, line)

    def _turn(self, angle: float, step: bool, line: int) -> None:
        shift, before = frame_of(self.machine)
        self._see(shift, angle + (before if step else 0.0), line)

    def _mirror(self, letters: str, line: int) -> None:
        """CYCL DEF 8.1: X and Y are mirrored about the datum; without letters they are as they were."""
        if not re.fullmatch(r"(?:[XY]\b ?)*", letters):
            raise GCodeError.at(line, f"CYCL DEF 8.1 {letters[:20]} is not read; expected X, Y or both.")
        self.machine.need_compensation_off(Block(line), "CYCL DEF 8")
        factors = (-1.0 if "X" in letters else 1.0, -1.0 if "Y" in letters else 1.0, 1.0)
        self.machine.set_scale(Scale(factors) if letters else None)
        self.pole = None

    def _see(self, shift: list[float], angle: float, line: int) -> None:
        if self.machine.scale is not None and frame_of(self.machine) != (shift, angle):
            raise GCodeError.at(line, "a datum shift or rotation inside of a mirror image is not read; end that first.")
        self.machine.need_compensation_off(Block(line), "A datum shift or rotation")
        if not any(shift) and angle == 0.0:
            turn_back(self.machine)
        else:
            see_frame(self.machine, shift, angle)

    # --- drilling
    @property
    def tenth(self) -> float:
        """A feed counts in tenths of an inch a minute where the program is in inches."""
        return 10.0 if self.machine.unit == "in" else 1.0

    def rate(self, said: str, line: int) -> float:
        """A feed in program units a minute; FAUTO is that of TOOL CALL."""
        if said != "AUTO":
            return self.number(said, line) / self.tenth
        if self.tool_feed is None:
            raise GCodeError.at(line, "FAUTO is the feed of TOOL CALL, which has none; write F there.")
        return self.tool_feed

    def pattern(self, number: int, line: int) -> None:
        """CYCL DEF 220 and 221."""
        raise NotImplementedError

    def cycle_call(self, code: str, line: int) -> str | None:
        rest = code.removeprefix("CYCL CALL").strip()
        if rest.startswith("POS"):
            return self._cycle_at(rest.removeprefix("POS").strip(), line)
        return self.called(rest, line)

    def _cycle_at(self, rest: str, line: int) -> str | None:
        """CYCL CALL POS: in the plane first, where the tool is above; its Z shifts the cycle's heights."""
        places = {letter: (step, self.number(value, line)) for step, letter, value in _AXIS.findall(rest)}
        step, self.raised = places.get("Z", ("", 0.0))
        if step:
            raise GCodeError.at(line, "CYCL CALL POS has IZ, which is not read; its Z shifts the cycle: give Z.")
        machine = self.machine
        if self.drill and not machine.away[2] and machine.p[2] < (high := self.hole_of(line)).clear:
            self._to(TRAVERSE, line, high.retract)
        return self.called(re.sub(rf"Z ?{NUMBER}", "", rest), line)

    def called(self, rest: str, line: int) -> str:
        """A line that does what stands behind CYCL CALL, and drills then."""
        text = self.straight(f"L {' '.join(rest.split())}".strip(), line) or "G17"
        self.due = True
        return text

    def straight(self, code: str, line: int) -> str | None:
        """A straight move in LinuxCNC's words."""
        raise NotImplementedError

    def drill_if_due(self, block: Block) -> None:
        """Drill where a line with M99, CYCL CALL or under M89 has led to."""
        if self.due:
            self.due = False
            if self.drill == 0:
                raise block.refuse("a cycle is called, but none is defined; write CYCL DEF 200 before.")
            hole, self.raised = self.hole_of(block.line), 0.0
            self.drill_here(hole, block.line)

    def hole_of(self, line: int) -> Hole:
        number = self.drill
        surface, safety, depth = self.q(203) + self.raised, abs(self.q(200)), self.q(201)
        if number == 240 and self.q(343) != 0.0:
            raise GCodeError.at(line, "CYCL DEF 240 counts by its diameter (Q343=1), which is not read; give Q201.")
        if depth >= 0.0:
            raise GCodeError.at(line, f"CYCL DEF {number} needs Q201, its depth, below 0; mend it.")
        if self.q(379) != 0.0:
            raise GCodeError.at(line, f"CYCL DEF {number} starts below the surface (Q379), which is not read; give 0.")
        if self.per_turn:
            text = "M136 would count the feeds of a cycle per turn, which is not read; end it by M137 before the cycle."
            raise GCodeError.at(line, text)
        down, pitch = self.q(206) / self.tenth, abs(self.q(239)) if number in (207, 209) else 0.0
        if number in (207, 209) and pitch == 0.0:
            raise GCodeError.at(line, f"CYCL DEF {number} needs Q239, its pitch.")
        out = self._out_of(number, down)
        bottom, clear = surface + depth, surface + safety
        pecks = pecks_of(number, self.q, (surface, bottom, clear), line) if number in (200, 203, 205) else ()
        top = surface + max(safety, self.q(204))
        wait, taps = max(self.q(211), 0.0), number == 206
        above = max(self.q(210), 0.0) if number in (200, 203) else 0.0
        return Hole(top, clear, bottom, wait, down, out, pecks, pitch, taps, above=above)

    def _out_of(self, number: int, down: float) -> float:
        """The feed out of a hole: Q208, and Q206 where that is 0; without a Q208 a rapid, but for tapping."""
        if number == 206:
            return down
        if number not in (201, 203) and not (number == 205 and self.says_out):
            return 0.0
        return 0.0 if self.q(208) >= RAPID_OUT else self.q(208) / self.tenth or down or math.inf


def _written_out(text: str) -> str:
    """An expression without the functions that LinuxCNC does not know by that name."""
    for found in reversed(list(_OWN.finditer(text))):
        start, end, depth = found.end() - 1, found.end(), 1
        while end < len(text) and depth:
            depth += {"[": 1, "]": -1}.get(text[end], 0)
            end += 1
        text = text[: found.start()] + _WRITTEN_OUT[found[1]].format(text[start:end]) + text[end:]
        if len(text) > MAX_EXPRESSION:
            break
    return text


MAX_EXPRESSION = 10_000
_TUNING = (332, 392)
"""Cycles of machine makers that suit the control to the weight of the part and move nothing."""
_LET = "let the CAM system write its moves out"
