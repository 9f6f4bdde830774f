"""Datum shifts, rotations and drilling cycles of Heidenhain's dialogue."""

import math
import re

from robomill.errors import GCodeError
from robomill.toolpath.gcode.frames import frame_of, see_frame, turn_back
from robomill.toolpath.gcode.klartext.pecks import OLD, old_hole, pecks_of
from robomill.toolpath.gcode.klartext.scaling import KlartextScaling
from robomill.toolpath.gcode.klartext.values import NUMBER
from robomill.toolpath.gcode.program import TRAVERSE
from robomill.toolpath.gcode.sinumerik.holes import Hole
from robomill.toolpath.gcode.words import Block
from robomill.units import to_si

_FEEDS = ("Q206", "Q207", "Q208")
"""Feeds of cycles, which AUTO makes that of TOOL CALL."""
RAPID_OUT = 99_999.0
"""Q208 from which on a tool leaves its hole at rapid; what MAX and FMAX stand for."""
_CYCLE = re.compile(r"CYCL DEF ?(\d+)(?: ?\.(\d+))?(.*)")
_TRANSFORM = re.compile(r"TRANS (MIRROR|ROTATION|SCALE) ?(RESET|AXIS(?: ?[XY])+|.+)")
_AXIS = re.compile(rf"(I?)([XYZ]) ?({NUMBER})")
_UNMOVED = re.compile(r"I?[ABCUVW] ?[-+]?0+(?:\.0*)?(?= |$)")
_SETTING = re.compile(r" ?(?:Q[LR]?\d+ ?=|~)")
_ASSIGNED = re.compile(r"Q\d+ ?= ?\S+")
_OTHER_BLOCK = re.compile(r"(?:L|LN|LP|C|CR|CP|CT|CC|TOOL CALL|CYCL|CALL|LBL)(?= |\d|$)")
_FROM_TABLE = "takes its shift from a table, which is not read; write X, Y, Z."
_DRILLS = {
    200: "drilling",
    201: "reaming",
    202: "boring",
    203: "drilling",
    205: "drilling",
    206: "tapping",
    207: "tapping",
    208: "bore milling",
    209: "tapping",
    240: "centring",
}
_PATTERNS = (220, 221)
BORE_MILLING = 208


class KlartextCycles(KlartextScaling):
    """Reads what shifts and drills; moves are those of ``klartext``."""

    drill: int = 0
    old: dict[str, float] = {}
    says_out = False
    due = per_turn = False
    raised = 0.0
    preset: float | None = None
    tool_feed: float | None = None
    """Program units a minute, as the last TOOL CALL says."""

    def cycle_words(self, code: str, line: int) -> str | None:
        """CYCL DEF, CYCL CALL and TRANS DATUM."""
        if code.startswith("CYCL CALL"):
            return self.cycle_call(code, line)
        if code.startswith("TRANS DATUM"):
            said = code.removeprefix("TRANS DATUM").strip()
            if said.startswith("TABLE"):
                raise GCodeError.at(line, f"{code[:40]} {_FROM_TABLE}")
            reset = said.startswith("RESET")
            self._shift({} if reset else self._axes_of(said.removeprefix("AXIS"), "TRANS DATUM", line), line, reset)
            return None
        if (transform := _TRANSFORM.fullmatch(code)) is not None:
            self._transform(transform[1], transform[2], line)
            return None
        found = _CYCLE.match(code)
        if found is None:
            raise GCodeError.at(line, f"{code[:30]} is not read; expected CYCL DEF and its number.")
        number, part, rest = int(found[1][:4]), found[2], found[3]
        if number in _DRILLS or number in _PATTERNS:
            if number in _DRILLS:
                self.drill, self.says_out = number, "Q208" in rest
                if number == 202:
                    text = "CYCL DEF 202 is read as boring; its step aside in the hole (Q214) is left out"
                    self.machine.findings.add("fine-boring", "info", line, text)
            behind = _ASSIGNED.sub("", rest[rest.find("Q") :]).strip() if _ASSIGNED.search(rest) else ""
            if (other := _OTHER_BLOCK.match(behind)) is not None:
                text = f"found {other[0]!r} among the values of CYCL DEF {number}; end the line before it without ~."
                raise GCodeError.at(line, text)
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

    def _transform(self, name: str, said: str, line: int) -> None:
        """TRANS MIRROR, ROTATION and SCALE (TNC7), which say what CYCL DEF 8, 10 and 11 do."""
        ends = said == "RESET"
        if name == "MIRROR":
            self.mirror("" if ends else said.removeprefix("AXIS").strip(), line)
        elif name == "SCALE":
            self.scale("SCL 1" if ends else said, line)
        else:
            self._other_cycle(10, "1", "ROT 0" if ends else said, line)

    def _other_cycle(self, number: int, part: str | None, rest: str, line: int) -> str | None:
        if number == 7 and part != "0":
            if "#" in rest:
                raise GCodeError.at(line, f"CYCL DEF 7 {_FROM_TABLE}")
            if part is not None:
                self._shift(self._axes_of(rest, "CYCL DEF 7", line), line)
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
            self.mirror(rest, line)
        elif number == 11 and part != "0":
            self.scale(rest, line)
        elif number == 26 and part != "0":
            self.stretch(rest, line)
        elif number in OLD:
            self._old_cycle(number, part, rest, line)
        elif number not in (7, 8, 9, 10, 11, 13, 19, 26, 32, 247, *_TUNING):
            name = f"{number} {_SETTING.split(rest, maxsplit=1)[0]}".strip()
            raise GCodeError.at(line, f"CYCL DEF {name:.60} is a cycle that is not read; {_LET}.")
        return None

    def _old_cycle(self, number: int, part: str | None, rest: str, line: int) -> None:
        """A line of CYCL DEF 1 or 2, which say their values one by one."""
        if part == "0":
            self.drill, self.old = number, {}
            return
        name, found = OLD[number].get(part or ""), re.search(rf"({NUMBER}|AUTO) ?$", rest)
        if name is None or found is None or (found[1] == "AUTO" and name != "F"):
            text = f"CYCL DEF {number}.{part or 0} {rest[:20]} is not read; expected {', '.join(OLD[number].values())}."
            raise GCodeError.at(line, text)
        value = self.rate(found[1], line) if name == "F" else self.number(found[1], line)
        self.old = {**self.old, name: value}

    def _old_hole(self, line: int) -> Hole:
        if self.machine.away[2] or self.raised:
            text = f"CYCL DEF {self.drill} begins where the tool stands; lead it there by L Z before the call."
            raise GCodeError.at(line, text)
        mm = to_si(1.0, "mm") / self.machine.factor
        return old_hole(self.drill, self.old, self.here()[2], mm, line)

    def _choose_preset(self, preset: float, line: int) -> None:
        """CYCL DEF 247, which also ends a datum shift, a rotation, a mirror image and a scale."""
        if self.preset is not None and self.preset != preset:
            raise GCodeError.at(line, "CYCL DEF 247 chooses a second preset; split the program there.")
        self.preset = preset
        self.unscale(line)
        if frame_of(self.machine) != ([0.0] * 3, 0.0):
            self._see([0.0] * 3, 0.0, line)

    def _axes_of(self, text: str, what: str, line: int) -> dict[str, tuple[bool, float]]:
        """The shift of each axis; refused where a rotary axis is shifted, or anything else stands there."""
        left = _UNMOVED.sub("", _AXIS.sub("", text)).strip()
        if left:
            raise GCodeError.at(line, f"{what} has {left[:20]!r}, which is not read; expected X, Y and Z.")
        return {letter.lower(): (bool(step), self.number(value, line)) for step, letter, value in _AXIS.findall(text)}

    def _shift(self, said: dict[str, tuple[bool, float]], line: int, every: bool = False) -> None:
        """A datum shift: an axis that is not given stays as it is, ``every`` ends them all."""
        shift, angle = frame_of(self.machine)
        before = shift[:2]
        for axis, letter in enumerate("xyz"):
            step, value = said.get(letter, (True, 0.0))
            shift[axis] = 0.0 if every else value + (shift[axis] if step else 0.0)
        if angle != 0.0 and shift[:2] != before:
            self.machine.stuck = _SHIFTED_TURNED if any(shift[:2]) else ""
        self._see(shift, angle, line)

    def _turn(self, angle: float, step: bool, line: int) -> None:
        shift, before = frame_of(self.machine)
        self._see(shift, angle + (before if step else 0.0), line)

    def _see(self, shift: list[float], angle: float, line: int) -> None:
        before = frame_of(self.machine)
        if self.machine.scale is not None and before != (shift, angle):
            ends = not any(shift) and angle == 0.0 and self.stretched is None
            turns = shift == before[0] and self.stretched is None and self.mirrored == (1.0, 1.0)
            if not (ends or turns):  # which of them comes first makes a difference
                text = "a datum shift or rotation inside of a mirror image or scale is not read; end that first."
                raise GCodeError.at(line, text)
        self.machine.need_compensation_off(Block(line), "A datum shift or rotation")
        if self.machine.stuck == _SHIFTED_TURNED and angle == 0.0:
            self.machine.stuck = ""
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

    def here(self) -> list[float]:
        """The programmed point, in the coordinates in force."""
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
        if self.per_turn:
            text = "M136 would count the feeds of a cycle per turn, which is not read; end it by M137 before the cycle."
            raise GCodeError.at(line, text)
        if number in OLD:
            return self._old_hole(line)
        surface, safety, depth = self.q(203) + self.raised, abs(self.q(200)), self.q(201)
        if number == 240 and self.q(343) != 0.0:
            raise GCodeError.at(line, "CYCL DEF 240 counts by its diameter (Q343=1), which is not read; give Q201.")
        if depth >= 0.0:
            raise GCodeError.at(line, f"CYCL DEF {number} needs Q201, its depth, below 0; mend it.")
        if self.q(379) != 0.0:
            raise GCodeError.at(line, f"CYCL DEF {number} starts below the surface (Q379), which is not read; give 0.")
        down, pitch = self.q(206) / self.tenth, abs(self.q(239)) if number in (207, 209) else 0.0
        if number in (207, 209) and pitch == 0.0:
            raise GCodeError.at(line, f"CYCL DEF {number} needs Q239, its pitch.")
        out = self._out_of(number, down)
        bottom, clear = surface + depth, surface + safety
        pecks = pecks_of(number, self.q, (surface, bottom, clear), line) if number in (200, 203, 205) else ()
        top = surface + max(safety, self.q(204))
        wait = 0.0 if number in (207, 209) else max(self.q(211), 0.0)  # in step with the spindle none has a dwell
        taps = number == 206
        above = max(self.q(210), 0.0) if number in (200, 203) else 0.0
        return Hole(top, clear, bottom, wait, down, out, pecks, pitch, taps, above=above)

    def _out_of(self, number: int, down: float) -> float:
        """The feed out of a hole: Q208, and Q206 where that is 0; without a Q208 a rapid, but for tapping."""
        if number == 206:
            return down
        if number not in (201, 202, 203) and not (number == 205 and self.says_out):
            return 0.0
        return 0.0 if self.q(208) >= RAPID_OUT else self.q(208) / self.tenth or down or math.inf


_SHIFTED_TURNED = "a datum shift inside of a rotation is not read, as controls differ; shift first, then turn."
_TUNING = (332, 392)
"""Cycles of machine makers that suit the control to the weight of the part and move nothing."""
_LET = "let the CAM system write its moves out"
