"""Q parameters and jumps of Heidenhain's dialogue."""

import math
import re

from robomill.errors import GCodeError
from robomill.toolpath.gcode.expressions import Reader
from robomill.toolpath.gcode.sinumerik.procs import SinumerikProcs
from robomill.toolpath.gcode.words import normalise

NUMBER = r"[-+]? ?(?:\d+(?:\.\d*)?|\.\d+|Q[LR]?\d+)"
FIRST_Q = {"Q": 1000, "QL": 3000, "QR": 4000}
MOST_Q = {"Q": 1999, "QL": 499, "QR": 499}
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


class KlartextValues(SinumerikProcs):
    """Reads what computes; cycles and moves are those of the modules beside it."""

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
