"""Heidenhain's dialogue (Klartext, ``.h``): its lines in LinuxCNC's words, with the labels and jumps between them.

A line becomes G0, G1, G2 or G3 to an absolute place and is then read as any other. What is not read is refused by its
first words. (HEIDENHAIN, TNC 640, User's Manual for Conversational Programming.)
"""

import math
import re

from robomill.errors import GCodeError
from robomill.lazy import cached_property
from robomill.rigid import axis_from_tilt
from robomill.toolpath.gcode.corners import LEGS, ROUND, Corner
from robomill.toolpath.gcode.dialects import plain_numbers
from robomill.toolpath.gcode.klartext.planes import WORD, Words
from robomill.toolpath.gcode.klartext.tools import BY_TOOTH, KlartextTools
from robomill.toolpath.gcode.klartext.values import NUMBER
from robomill.toolpath.gcode.program import FEED
from robomill.toolpath.gcode.rules.motion_rules import MINUTE
from robomill.toolpath.gcode.scan import behind_remark
from robomill.toolpath.gcode.tool_axis import angles_of
from robomill.toolpath.gcode.words import Block
from robomill.toolpath.plane import axes, centre_by_radius, polar

_NUMBERED = re.compile(r"^\s*(/?)\s*(?:N?\d+(?![\d.,])\s*)?(/?)\s*")
_LABEL = re.compile(r"^[ \t]*N?\d*[ \t]*(?:LBL[ \t]+|G98[ \t]*L[ \t]*)(\"[^\"\n]+\"|\d+)", re.MULTILINE | re.IGNORECASE)
_FEED = re.compile(rf"(?<![A-Z])F(U?)[ \t]*(MAX|AUTO|{NUMBER})")
_BY_TOOTH = re.compile(r"(?<![A-Z])FZ")
_RADIUS = re.compile(rf"(?<![A-Z])R[ \t]*({NUMBER})")
_NORMAL = re.compile(rf"N[XYZ] ?{NUMBER}")
_WITH_M = re.compile(
    rf"(M118(?: ?[XYZABC] ?{NUMBER})*|M128|M140 ?MB ?(?:MAX|{NUMBER})|M120|M124|M103|M138)"
    rf"(?: ?(?:F|LA|T) ?(?:MAX|AUTO|{NUMBER})| [ABC]\b)*"
)
_BACK = re.compile(rf"MB ?(MAX|{NUMBER})(?: ?F ?(MAX|AUTO|{NUMBER}))?")
_SIDE = re.compile(r"(?<![A-Z])R(0|L|R)(?![\d.,])")
_SENSE = re.compile(r"DR[ \t]*([-+])")
_M = re.compile(r"(?<![A-Z])M[ \t]*(\d+)")
_M_WORD = re.compile(r"(?<![A-Z])M ?\d+")
_CALL = re.compile(r"CALL LBL (\"[^\"]+\"|\d+)(?: REP(?: ?(\d+)(?:/\d+)?)?)?")
_REPEAT = re.compile(r"REP(\d)")
_CORNER = re.compile(rf"(RND ?R?|CHF ?L?) ?({NUMBER})(?: ?F ?(?:({NUMBER})|.*))?")
_SILENT = re.compile(
    r"BLK FORM|TOOL DEF|FUNCTION (?:RESET )?TCPM|FUNCTION MODE MILL|FUNCTION (?:SPINDLE-PULSE|PARAXCOMP DISPLAY)|"
    r"M1(?:07|08|16|17|20|24|26|27|38)\b|"
    r"DECLARE STRING|QS\d+ ?=|FN ?(?:16|20|29|37|38) ?:"
)
MAX_CODE, MAX_LINES = 1000, 100
"""Characters of a line and lines of a block that can be read."""
_CARRIED = re.compile(r"[ \t]+(?:R[0LR]?|DR[-+]|F|M)(?:[ \t]*\d|[ \t\r]|$)", re.IGNORECASE)
"""The second line of a block as a TNC 155 prints it: indented and without a number, where blocks have numbers."""
_MOVES, _EMPTY = re.compile(r"(?:L|C|CR|LP|CP|CT) "), re.compile(r" [RFM](?= (?!MAX\b|AUTO\b|[-+.\dQ])|$)")
"""Lines that move, and their R, F and M with nothing behind them: as it was."""
_PLANES = {frozenset({0, 1}): 17, frozenset({0, 2}): 18, frozenset({1, 2}): 19}
_KEPT_M = (0, 1, 2, 3, 4, 5, 7, 8, 9, 30)
_PAIRS = {13: "M3 M8", 14: "M4 M8"}


class Klartext(KlartextTools):
    """Reads what stands in a dialogue; what is left of a line goes on to the reader of words."""

    heading: tuple[float, float] | None = None
    leaving: tuple[float, float] | None = None
    modal_cycle = False

    def klartext_line(self, index: int) -> str | None:
        """Line ``index``, and those that continue it, in LinuxCNC's words; None where it is done."""
        line = index + 1
        code, self.pc, skipped = self.joined_block(index)
        if skipped:
            self.machine.findings.add("block-delete", "info", line, "block delete (/) is off: these lines are executed")
        if not code or code[0] in "*(":
            return None
        said = self.iso_lines(code, line) if self.is_iso else [code]
        return " ".join(filter(None, [self._dialogue_line(each, index) for each in said])) or None

    def _dialogue_line(self, code: str, index: int) -> str | None:
        line = index + 1
        if (code[:5] == "PLANE" or self.leans or self.machine.stuck) and self.plane_line(code, line):
            return None
        first = code.split(" ", 1)[0]
        if first in ("L", "LN", "LP", "C", "CR", "CP", "CT", "CTP") or _FEED.match(code) or _M.match(code):
            return self._move("L" if first[0] in "FM" else first, code, line)
        if first == "CC":
            self._check_left_over("CC", code, line)
            self.set_pole(code, line)
            stops = _M_WORD.findall(code)
            return self._move("L", " ".join(stops), line) if stops else None
        if first in ("APPR", "DEP"):
            return self.approach(code, line)
        if first in ("RND", "CHF") or re.match(r"RND|CHF", first):
            raise GCodeError.at(line, f"{first[:3]} is read behind a cut alone (L; for RND also C, CR, CT or CP).")
        if code.startswith("TOOL CALL"):
            return self.tool_call(code, line)
        if code.startswith("LBL"):
            if re.fullmatch(r"LBL ?0", code) and self.machine.store.level > 0:
                self._repeat_or_leave()
            return None
        if code.startswith("CALL LBL"):
            self._call_label(code, index)
            return None
        if code.startswith(("CYCL", "TRANS ")):
            return self.cycle_words(code, line)
        if code.startswith("BEGIN PGM"):
            return f"G17 G90 G94 {'G20' if code.endswith('INCH') else 'G21'}"
        if code.startswith("END PGM"):
            return "M2"
        if first == "STOP":
            return self._stop(code, line)
        if self.tool_defined(code, line):
            return None
        if _SILENT.match(code):
            name = " ".join(code.split(" ")[:2])
            self.machine.findings.add("harmless-word", "ignored", line, f"{name} is left out: it moves nothing")
            return None
        if self.pattern_line(code, line) or self.values_line(code, line):
            return None
        if code.startswith("CALL PGM"):
            text = f'{code[:40]} calls another program; paste it in behind M30 as LBL "NAME" ... LBL 0, and call that.'
            raise GCodeError.at(line, text)
        raise GCodeError.at(line, f"{' '.join(code.split(' ')[:3])} is of Heidenhain's and is not read; {_LET}.")

    def _stop(self, code: str, line: int) -> str:
        """STOP with what its M say; M2 and M30 end the program as in any block."""
        rest = code.removeprefix("STOP").strip()
        if _M_WORD.sub("", rest).strip():
            raise GCodeError.at(line, f"found {rest[:20]!r} behind STOP; expected M words alone.")
        words = (rest and self._move("L", rest, line)) or ""
        return words if {"M0", "M2", "M30"} & {*words.split(" ")} else f"M0 {words}".rstrip()

    def joined_block(self, index: int) -> tuple[str, int, bool]:
        """The block at ``index`` in capitals, without number and comment; what comes next; whether / stands before."""
        lines, skipped, found = self.file.lines, False, None
        parts: list[str] = []
        while index < len(lines):
            raw = plain_numbers(lines[index], index + 1, self.machine.findings)
            text = (self.iso_text(raw) if self.is_iso else raw.partition(";")[0].rstrip()).removesuffix("~")
            if not parts:
                found = _NUMBERED.match(text)
                skipped = found is not None and "/" in found[0]
                text = text[found.end() :] if found is not None else text
            parts.append(text.strip())
            index += 1
            if len(text) > MAX_CODE or len(parts) > MAX_LINES:
                raise GCodeError.at(index, f"a block is over {MAX_CODE} characters or {MAX_LINES} lines; split it.")
            moves = found is not None and found[0].strip("/ \t") and _MOVES.match(parts[0].upper())
            carried = moves and index < len(lines) and _CARRIED.match(lines[index])
            if not raw.rstrip().endswith("~") and not carried:
                break
            if parts == [""] and found is not None and found[0].strip("/ \t"):
                return "", behind_remark(lines, index), skipped
        code = " ".join(re.sub(r"(?<=[-+\dXYZABC]),(?=\d)", ".", " ".join(parts).upper()).split())
        return _EMPTY.sub("", code) if _MOVES.match(code) else code, index, skipped

    # --- moves
    def here(self) -> list[float]:
        """The programmed point, in the coordinates in force."""
        return self.machine.said_point()

    def set_pole(self, code: str, line: int) -> None:
        """CC: a centre or pole in the plane of its two axes; one that is not given stays, without any it is here."""
        at, said = self.here(), {}
        for step, letter, value in WORD.findall(code):
            axis = "XYZABC".find(letter)
            said[axis] = self.number(value, line) + (at[axis] if step else 0.0)
        plane, old = (17, None) if self.pole is None else (self.pole[0], self.pole[1:])
        plane = _PLANES.get(frozenset(said), plane if len(said) < 2 else 0)
        if plane == 0 or not said.keys() <= set(axes(plane)[:2]) or (len(said) == 1 and old is None):
            raise GCodeError.at(line, "CC needs two of X, Y and Z, the centre or pole in their plane.")
        first, second, _ = axes(plane)
        u, v = (at[first], at[second]) if old is None or not said else old
        self.pole = plane, said.get(first, u), said.get(second, v)

    def _pole(self, line: int) -> tuple[int, float, float]:
        if self.pole is None:
            raise GCodeError.at(line, "a circle or polar coordinates need their centre; give CC X Y before.")
        return self.pole

    def pole_in_plane(self, line: int) -> tuple[float, float]:
        """The centre or pole in the plane XY."""
        plane, *pole = self._pole(line)
        if plane != 17:
            raise GCodeError.at(line, "APPR is read before contours in the plane XY alone.")
        return pole[0], pole[1]

    def straight(self, code: str, line: int) -> str | None:
        """A straight move in LinuxCNC's words."""
        return self._move("L", code, line)

    def _move(self, kind: str, code: str, line: int) -> str | None:
        """A line that moves, or that holds F and M alone."""
        machine = self.machine
        rest = _WITH_M.sub(lambda found: found[1][:4], code)
        feed, side = _FEED.search(rest), _SIDE.search(rest)
        self._check_left_over(kind, rest, line)
        words = self.words_of(kind, rest, line)
        codes = [int(number[:6]) for number in _M.findall(rest)]
        where, arc = self._end(kind, words, rest, line)
        out = [self.compensated(side[1] if side else self.side, line)]
        if not arc and machine.plane != 17:
            out.append("G17")
        if 136 in codes or 137 in codes:
            self.per_turn = 136 in codes
            out.append("G95" if self.per_turn else "G94")
        if feed is not None and feed[2] != "MAX":
            out.append(self.feed_words(feed[1], feed[2], line))
        if 140 in codes:
            at = self.here()
            if arc or any(abs(value - at["XYZABC".index(letter)]) > 1e-9 for letter, value in where.items()):
                raise GCodeError.at(line, "M140 beside a move is not read; put it on a line of its own.")
            where = {}  # the place where the tool is, said once more
        machine.machine_word = "M140" if 140 in codes else "M91" if 91 in codes else "M92"
        if where:
            if not {91, 92} & {*codes} and (feed is None or feed[2] != "MAX"):
                self.need_upright_tool(line)
            if 91 in codes or 92 in codes:
                out.append("G53")
            places = " ".join(f"{letter}{value:.12f}" for letter, value in where.items())
            out.append(f"{arc or ('G0' if feed is not None and feed[2] == 'MAX' else 'G1')} {places}")
            self._look_ahead(kind)
        out += [f"M{m}" if m in _KEPT_M else _PAIRS[m] for m in codes if m in _KEPT_M or m in _PAIRS]
        self._say_m([m for m in codes if m not in _KEPT_M and m not in _PAIRS], line)
        if 140 in codes:
            out.append(self._retract(code, line))
        self.modal_cycle = self.modal_cycle or 89 in codes
        self.due = 99 in codes or (self.modal_cycle and bool(where))
        self.modal_cycle = self.modal_cycle and 99 not in codes
        return " ".join(word for word in out if word) or ("G90" if self.due else None)

    def _check_left_over(self, kind: str, code: str, line: int) -> None:
        """Refuse what no rule of a line that moves has a use for."""
        if _BY_TOOTH.search(code):
            raise GCodeError.at(line, BY_TOOTH)
        left = code.removeprefix(kind)
        for pattern in (_FEED, _SENSE, _SIDE, WORD, _NORMAL, _M, *((_RADIUS,) if kind == "CR" else ())):
            left = pattern.sub("", left)
        if left.strip():
            raise GCodeError.at(line, f"found {left.strip()[:20]!r} in a line that begins with {kind}; {_LET}.")

    def _say_m(self, codes: list[int], line: int) -> None:
        for m in codes:
            if m not in (89, 91, 92, 99, 136, 137, 140):
                self.machine.findings.add("unknown-m", "ignored", line, f"M{m} is left out: it moves nothing")

    def _retract(self, code: str, line: int) -> str:
        """M140 goes back along the tool by MB, at its own F, which holds for that alone, or at rapid."""
        found = _BACK.search(code)
        if found is None or found[1] == "MAX":
            return "G53 G0 Z0"
        machine, at, far = self.machine, self.here(), self.number(found[1], line)
        axis = axis_from_tilt(math.radians(at[3]), math.radians(at[4])).tolist()  # of the tool, which may lean
        if any(away and k for away, k in zip(machine.away, axis)):
            return ""
        if found[2] in (None, "MAX"):
            return "G0 " + " ".join(f"{letter}{p + far * k:.9f}" for letter, p, k in zip("XYZ", at, axis) if k)
        if self.per_turn:
            raise GCodeError.at(line, "M136 would count the F of M140 per turn, which is not read; end it by M137.")
        machine.need_compensation_off(Block(line), "M140 with F")
        end = [*(p + far * k for p, k in zip(machine.p, axis)), *machine.p[3:]]
        machine.go(FEED, line, end, self.rate(found[2], line) * machine.factor / MINUTE)
        machine.p = end
        return ""

    def _end(self, kind: str, words: Words, code: str, line: int) -> tuple[dict[str, float], str]:
        """Where a line leads, by letter, and the words of its arc ("" for a straight move)."""
        at = self.here()
        end = list(at)
        for axis, letter in enumerate("XYZABC"):
            if letter in words:
                step, value = words[letter]
                if step and axis < 3 and self.machine.away[axis]:
                    text = f"I{letter} counts from a place that only the machine knows; give {letter} before."
                    raise GCodeError.at(line, text)
                end[axis] = value + (at[axis] if step else 0.0)
        if kind == "LN" and {"TX", "TY", "TZ"} <= words.keys():
            axis3 = words["TX"][1], words["TY"][1], words["TZ"][1]
            if max(map(abs, axis3)) < 1e-9:
                raise GCodeError.at(line, "the tool axis TX TY TZ is 0; expected a direction.")
            end[3], end[4] = angles_of(axis3, (at[3], at[4]))
        if kind in ("LP", "CP", "CTP"):
            self.polar_place(words, at, end, line)
        moved = {letter for letter in "XYZABC" if letter in words}
        if kind in ("LP", "CP", "C", "CTP"):
            moved |= {"XYZ"[axis] for axis in axes(self._pole(line)[0])[:2]}
        moved |= {"X", "Y"} if kind in ("CR", "CT") else {"A", "B"} if "TX" in words else set()
        places = {letter: end["XYZABC".index(letter)] for letter in sorted(moved)}
        arc = "" if kind[0] == "L" else self._arc(kind, words, code, at, end, line)
        if places:
            self.heading = self.leaving if arc else (end[0] - at[0], end[1] - at[1])
            if self.heading is None or any(self.heading):
                self.course = self.heading
        return places, arc

    def polar_place(self, places: Words, at: list[float], end: list[float], line: int) -> None:
        plane, *pole = self._pole(line)
        first, second, _ = axes(plane)
        radius = math.hypot(at[first] - pole[0], at[second] - pole[1])
        angle = math.degrees(math.atan2(at[second] - pole[1], at[first] - pole[0]))
        if "PR" in places:
            radius = places["PR"][1] + (radius if places["PR"][0] else 0.0)
        if "PA" in places:
            angle = places["PA"][1] + (angle if places["PA"][0] else 0.0)
        end[first], end[second] = polar(radius, math.radians(angle), *pole)

    def _arc(self, kind: str, words: Words, code: str, at: list[float], end: list[float], line: int) -> str:
        """G2 or G3 with what says its form; ``leaving`` is its direction at its end."""
        sense = _SENSE.search(code)
        if kind in ("CT", "CTP"):
            return self._tangent(at, end, line)
        if sense is None:
            raise GCodeError.at(line, f"{kind} needs DR+ or DR-, the way round.")
        turn, name = (1, "G3") if sense[1] == "+" else (-1, "G2")
        if kind == "CR":
            radius = _RADIUS.search(_SIDE.sub("", _SENSE.sub("", code)))
            if radius is None:
                raise GCodeError.at(line, "CR needs R, its radius.")
            size = self.number(radius[1], line)
            middle = centre_by_radius(at, end, size, turn)
            self.leaving = -turn * (end[1] - middle[1]), turn * (end[0] - middle[0])
            return f"G17 {name} R{size:.12f}"
        plane, *pole = self._pole(line)
        first, second, _ = axes(plane)
        self.leaving = (-turn * (end[1] - pole[1]), turn * (end[0] - pole[0])) if plane == 17 else None
        out = f"G{plane} {name} {'IJK'[first]}{pole[0] - at[first]:.12f} {'IJK'[second]}{pole[1] - at[second]:.12f}"
        if "PA" in words and words["PA"][0]:
            step = words["PA"][1]
            if step * turn < 0.0:
                raise GCodeError.at(line, "CP has IPA against its DR; give both the same sign.")
            out += f" P{max(math.ceil(abs(step) / 360.0 - 1e-9), 1)}"
        return out

    def _tangent(self, at: list[float], end: list[float], line: int) -> str:
        """CT goes on in the direction of the line before."""
        if self.heading is None or math.hypot(*self.heading) < 1e-9:
            raise GCodeError.at(line, "CT goes on tangentially, and the line before has no direction in the plane.")
        size = math.hypot(*self.heading)
        u, v = self.heading[0] / size, self.heading[1] / size
        dx, dy = end[0] - at[0], end[1] - at[1]
        across = u * dy - v * dx
        if abs(across) < 1e-9:
            raise GCodeError.at(line, "CT ends straight ahead; write it as L.")
        radius = (dx * dx + dy * dy) / (2.0 * across)
        centre = at[0] - v * radius, at[1] + u * radius
        turn = 1.0 if radius > 0.0 else -1.0
        self.leaving = -turn * (end[1] - centre[1]), turn * (end[0] - centre[0])
        return f"G17 {'G3' if turn > 0.0 else 'G2'} I{centre[0] - at[0]:.12f} J{centre[1] - at[1]:.12f}"

    def _look_ahead(self, kind: str) -> None:
        """A corner that the next line rounds or chamfers."""
        code, after, _ = self.joined_block(self.pc)
        while not code and after < min(len(self.file.lines), self.pc + MAX_LINES):
            code, after, _ = self.joined_block(after)
        found = _CORNER.fullmatch(code)
        if found is not None:
            line = self.pc + 1
            if kind != "L" and code[0] == "C":
                raise GCodeError.at(line, "CHF is read between two straight cuts (L) alone.")
            feed = self.number(found[3], line) / self.tenth if found[3] else 0.0
            size = self.number(found[2], line) * self.similar("RND or CHF", line)
            self.machine.corner = Corner(ROUND if code[0] == "R" else LEGS, size, feed)
            self.pc = after

    # --- labels
    @cached_property
    def _places(self) -> dict[str, int]:
        """Labels, each with the line behind it."""
        lines = self.main.lines
        found = _LABEL.finditer(lines.data.decode("latin-1"))
        return {each[1].upper().lstrip("0") or "0": lines.index_at(each.start(1)) + 1 for each in found}

    def label(self, name: str, line: int) -> int:
        """The index of the line behind a label."""
        start = self._places.get(name.lstrip("0"))
        if start is None:
            raise GCodeError.at(line, f"LBL {name} is called, but there is no such label in the program; add it.")
        return start

    def _call_label(self, code: str, index: int) -> None:
        code = _REPEAT.sub(r"REP \1", code)
        found = _CALL.fullmatch(code)
        if found is None:
            raise GCodeError.at(index + 1, f"{code[:40]} is not read; expected CALL LBL 1 or CALL LBL 1 REP 2.")
        start = self.label(found[1], index + 1)
        if found[2] is None:
            self._enter(Block(index + 1), found[1], start, 1)
            return
        key = (self.machine.store.level, index)
        left = self.rounds.get(key, int(found[2][:6]))
        if left > 0:
            self.rounds[key], self.pc = left - 1, start
        else:
            self.rounds.pop(key, None)


_LET = "let the CAM system write its moves out with L, C and CC"
