"""Heidenhain's DIN/ISO (``.i``): its blocks in the words of the dialogue, which reads them.

``%NAME G71 *`` begins and ends a program. I and J are the pole, in G90 from zero; R and H are a polar radius and angle;
G98 L1 is a label and L1,2 its call. (HEIDENHAIN, TNC 640, User's Manual for ISO Programming.)
"""

import re

from robomill.errors import GCodeError
from robomill.lazy import cached_property
from robomill.toolpath.gcode.klartext.planes import KlartextPlanes
from robomill.toolpath.gcode.klartext.values import NUMBER

_FIRST = re.compile(rb"\A\s*%[^\s*]+[ \t]+G7[01][ \t]*\*?[ \t]*$", re.MULTILINE | re.IGNORECASE)
_ENDS = re.compile(r"%\S+ G7([01])")
_REMARK = re.compile(r";[^*~]*?(?=Q\d+ ?=|\*|~|$)")
_TOKEN = re.compile(rf" ?(?:F ?(MAX)|([A-Z]) ?({NUMBER}))(?= |$|[A-Z])")
_CALL = re.compile(r"L ?(\d+|\"[^\"]+\") ?[.,] ?(\d+)")  # a comma before a digit is read as a point
_LABEL = re.compile(r"G98 ?L ?(\d+|\"[^\"]+\")")
_CYCLE = re.compile(r"G(2\d\d)\b([^=]*?)((?: ?Q\d+ ?= ?\S+)+)")
_MIRROR = re.compile(r"G28((?: ?[XYZ])*)")
_CORNER = re.compile(rf"G2([45]) ?R ?({NUMBER})(?: ?F ?({NUMBER}))?")
_Q = re.compile(rf"D0*(\d+) ?(?:(Q[LR]?\d+) )?P01 ?({NUMBER})(?: P02 ?({NUMBER}))?(?: P03 ?(\d+))?")
_REACH = re.compile(rf"(M ?118)(?: ?[XYZABC] ?{NUMBER})+|(M ?1(?:03|20|28)) ?(?:F|LA) ?(?:MAX|{NUMBER})")
_TWO = {1: "+", 2: "-", 3: "*", 4: "DIV", 8: "LEN", 13: "ANG"}
_COMPARES = {9: "EQU", 10: "NE", 11: "GT", 12: "LT"}
_MOVES = {0: "L", 1: "L", 2: "C", 3: "C", 6: "CT", 10: "LP", 11: "LP", 12: "CP", 13: "CP", 16: "CTP"}
_SIDES = {40: "R0", 41: "RL", 42: "RR"}
_ALONE = {4: "F", 29: "", 30: "XYZ", 31: "XYZ", 38: "", 54: "XYZ", 72: "F", 73: "H", 79: "F", 80: "ABC", 99: "TLR"}
_LET = "write it in G00 to G03, G10 to G13, G40 to G42 and cycles from G200 on"


class KlartextIso(KlartextPlanes):
    """Turns blocks of DIN/ISO into lines of the dialogue; ``KlartextPlanes`` and its kin read those."""

    iso_motion: int | None = None
    iso_steps = False

    @cached_property
    def is_iso(self) -> bool:
        """Whether the program is in DIN/ISO, by its first line."""
        return _FIRST.match(self.main.lines.data) is not None

    def iso_text(self, raw: str) -> str:
        """A line without its comments and the * that ends it; corners are written as in the dialogue."""
        text = _REMARK.sub(" ", raw).strip().removesuffix("*").rstrip()
        found = _CORNER.search(text.upper())
        if found is None:
            return text
        feed = f" F{found[3]}" if found[3] else ""
        return f"{'CHF' if found[1] == '4' else 'RND'} R{found[2]}{feed}".replace("CHF R", "CHF ")

    def iso_lines(self, code: str, line: int) -> list[str]:
        """A block (capitals, no number) as lines of the dialogue, of which one at most moves."""
        code = _REACH.sub(r"\1\2", code)
        if code[:5] == "PLANE" or code[:3] in ("RND", "CHF"):
            return [code]
        if (ends := _ENDS.fullmatch(code)) is not None:
            units = "MM" if ends[1] == "1" else "INCH"
            return [f"END PGM A {units}" if self.machine.unit_said else f"BEGIN PGM A {units}"]
        if (call := _CALL.fullmatch(code)) is not None:
            return [f"CALL LBL {call[1]}" + (f" REP {call[2]}" if int(call[2][:6]) else "")]
        if (label := _LABEL.fullmatch(code)) is not None:
            return [f"LBL {label[1]}"]
        if (cycle := _CYCLE.fullmatch(code)) is not None:
            return [f"CYCL DEF {cycle[1]} {cycle[3]}"]
        if (mirror := _MIRROR.fullmatch(code)) is not None:
            return [f"CYCL DEF 8.1 {' '.join(re.findall('[XYZ]', mirror[1]))}".strip()]
        if (value := _Q.fullmatch(code)) is not None:
            return [self._of_q(value, line)]
        return self._of_words(code, line)

    def _of_q(self, found: re.Match[str], line: int) -> str:
        """D00 to D13 are FN 0 to 13."""
        kind, name, first, second, label = int(found[1][:4]), *found.groups()[1:]
        if kind in _COMPARES and second and label and not name:
            return f"FN {kind}: IF {first} {_COMPARES[kind]} {second} GOTO LBL {label}"
        if kind in _TWO and name and second and not label:
            return f"FN {kind}: {name} = {first} {_TWO[kind]} {second}"
        if kind in (0, 5, 6, 7) and name and not second and not label:
            return f"FN {kind}: {name} = {first}"
        raise GCodeError.at(line, f"{found[0][:30]} is not read; expected D00 to D13 with their Q and P01, P02.")

    def _of_words(self, code: str, line: int) -> list[str]:
        words: dict[str, str] = {}
        codes: list[int] = []
        stops: list[str] = []
        at = 0
        while at < len(code):
            found = _TOKEN.match(code, at)
            if found is None:
                raise GCodeError.at(line, f"found {code[at : at + 20].strip()!r} in a block of DIN/ISO; {_LET}.")
            at = found.end()
            letter, value = ("F", "MAX") if found[1] else (found[2], found[3].replace(" ", ""))
            if letter == "G":
                self._take_code(value, codes, line)
            elif letter == "M":
                stops.append(f"M{value}")
            elif letter in words or letter not in "XYZABCIJKRHFSTL":
                raise GCodeError.at(
                    line, f"{letter}{value} has no use in a block of DIN/ISO, or is given twice; {_LET}."
                )
            else:
                step = letter in "XYZABCIJKH" or (letter == "R" and self._is_polar(codes))
                words[letter] = f"I{value}" if self.iso_steps and step else value
        of_block = self._of_move if _ALONE.keys().isdisjoint(codes) else self._of_alone
        return of_block(codes, words, stops, line)

    def _take_code(self, value: str, codes: list[int], line: int) -> None:
        code = int(value) if value.isdigit() else -1
        if code in (90, 91):
            self.iso_steps = code == 91
        elif code in (*_MOVES, *_SIDES, *_ALONE, 17):
            codes.append(code)
        else:
            raise GCodeError.at(line, f"G{value} of Heidenhain's DIN/ISO is not read; {_LET}.")

    def _is_polar(self, codes: list[int]) -> bool:
        motion = next((each for each in codes if each in _MOVES), self.iso_motion)
        return motion is not None and motion >= 10

    def _of_alone(self, codes: list[int], words: dict[str, str], stops: list[str], line: int) -> list[str]:
        """Blocks whose G code says all of them, but for the axis of the tool that G17 says once more."""
        said = [_stepped(letter, value) for letter, value in words.items() if letter in "XYZABC"]
        kind, more = next(each for each in codes if each in _ALONE), " ".join(stops)
        beside = sum(each != 17 for each in codes) > 1 or (stops and kind not in (38, 79))
        if beside or not words.keys() <= set(_ALONE[kind]):
            raise GCodeError.at(line, f"G{kind} stands beside other words; {_LET}.")
        if kind == 79:
            feed = f" F{words['F']}" if "F" in words else ""
            return [f"CYCL CALL{feed} {more}".strip()]
        if kind == 99:
            return [f"TOOL DEF {words.get('T', '')} L{words.get('L', '0')} R{words.get('R', '0')}"]
        turn = words.get("H", "0")
        out = {
            4: f"CYCL DEF 9.1 {words.get('F', '0')}",
            29: "CC",
            30: "BLK FORM",
            31: "BLK FORM",
            38: "STOP",
            54: f"CYCL DEF 7.1 {' '.join(said)}",
            72: f"CYCL DEF 11.1 SCL {words.get('F', '1')}",
            73: f"CYCL DEF 10.1 {'IROT' if turn[0] == 'I' else 'ROT'}{turn.lstrip('I')}",
            80: f"CYCL DEF 19.1 {' '.join(said)}".strip(),
        }
        return [out[kind]]

    def _of_move(self, codes: list[int], words: dict[str, str], stops: list[str], line: int) -> list[str]:
        out: list[str] = []
        if "T" in words or "S" in words:
            tool, turns = (f" {words['T']} Z" if "T" in words else ""), (f" S{words['S']}" if "S" in words else "")
            out.append(f"TOOL CALL{tool}{turns}")
            stops = [each for each in stops if each not in ("M6", "M06")]
        motions = [each for each in codes if each in _MOVES]
        self.iso_motion = motions[-1] if motions else self.iso_motion
        pole = [_stepped("XYZ"["IJK".index(letter)], words[letter]) for letter in "IJK" if letter in words]
        if pole:
            out.append(f"CC {' '.join(pole)}")
        places = [_stepped(letter, words[letter]) for letter in "XYZABC" if letter in words]
        polar = self._is_polar([])
        if polar:
            places += [_stepped(f"P{'RA'['RH'.index(letter)]}", words[letter]) for letter in "RH" if letter in words]
        sides = [_SIDES[each] for each in codes if each in _SIDES]
        side = sides[-1] if sides else ""
        used = {*"TSFXYZABCIJK", *("RH" if polar and places else "R" if places else "")}
        if left := sorted(words.keys() - used):
            raise GCodeError.at(line, f"{left[0]}{words[left[0]]} has no use in its block of DIN/ISO; {_LET}.")
        if len(sides) > 1 or len(motions) > 1:
            raise GCodeError.at(line, f"a block of DIN/ISO has one of G00 to G16 and one of G40 to G42; {_LET}.")
        turns_round = bool(motions) and motions[-1] in (2, 3)
        if not places and not (turns_round and pole):
            rest = [side, f"F{words['F']}" if "F" in words else "", *stops]
            return [*out, " ".join(["L", *filter(None, rest)])] if any(rest) else out
        motion = self.iso_motion
        if motion is None or ("R" in words and not polar and (motion not in (2, 3) or pole)):
            raise GCodeError.at(line, f"a block of DIN/ISO needs one G00 to G16, and R or I and J on an arc; {_LET}.")
        kind = "CR" if "R" in words and motion in (2, 3) else _MOVES[motion]
        form = [f"R{words['R']}"] if kind == "CR" else []
        form += ["DR-" if motion in (2, 12) else "DR+"] if motion in (2, 3, 12, 13) else []
        feed = words.get("F", "")
        if motion in (0, 10):
            out += [f"F{feed}"] if feed not in ("", "MAX") else []
            feed = "MAX"
        return [*out, " ".join(filter(None, [kind, *places, *form, side, f"F{feed}" if feed else "", *stops]))]


def _stepped(letter: str, value: str) -> str:
    """The word of the dialogue: IX+5 where the value counts as a step."""
    return f"I{letter}{value[1:]}" if value[:1] == "I" else f"{letter}{value}"
