"""Dialects: what a program looks like that was not written for LinuxCNC, and what it means then."""

import re
from collections.abc import Container
from dataclasses import dataclass
from decimal import Decimal

from robomill.errors import GCodeError
from robomill.toolpath.findings import Findings
from robomill.toolpath.gcode import codes as modal
from robomill.toolpath.gcode.codes import g_name
from robomill.toolpath.gcode.corners import LEGS, ROUND, Corner
from robomill.toolpath.gcode.fanuc.cycles import FANUC_WORDS
from robomill.toolpath.gcode.foreign import meant_elsewhere
from robomill.toolpath.gcode.frames import turn_about, turn_back
from robomill.toolpath.gcode.grbl import for_controller
from robomill.toolpath.gcode.machine import UNITS, Machine
from robomill.toolpath.gcode.not_read import not_read
from robomill.toolpath.gcode.offsets import select_extended
from robomill.toolpath.gcode.once import holds_once
from robomill.toolpath.gcode.rules.motion_rules import LINE, is_arc
from robomill.toolpath.gcode.scan import COMMENT
from robomill.toolpath.gcode.sinumerik.lines import translated
from robomill.toolpath.gcode.standing import settle
from robomill.toolpath.gcode.tilted import of_fanuc
from robomill.toolpath.gcode.words import Block, flattened
from robomill.units import to_si

NAMES = ("linuxcnc", "fanuc", "grbl", "sinumerik", "heidenhain")

SAMPLE = 200_000
"""Bytes at the start of a program from which its dialect is guessed."""

LONGEST = 300
"""Characters of a line that are looked at for signs of a dialect."""

_POLAR = "G112 alone on its line begins polar interpolation, which is not read; for Haas's older G112 write G154 P3."

HARMLESS: dict[str, frozenset[int]] = {
    "linuxcnc": frozenset(),
    "fanuc": frozenset({90, 150, 220, 230, 401, 501, 500, 600, 620, 630, 670, 690, 1870}),
    "grbl": frozenset(),
    "heidenhain": frozenset(),
    "sinumerik": frozenset({90, 600, 4600, 601, 602, 6010, 6020, 6030, 6410, 6420, 6430, 6440, 6450}),
}
"""G words that move nothing, by dialect; they are counted as ignored."""

_VERBATIM_OR_CODE = re.compile(r"\([^()\n]*\)?|;.*|<[^>]*>?|\"[^\"]*\"?|[^(;<\"]+")


def _words(*words: str) -> tuple[tuple[str, str], ...]:
    return tuple((word, rf"\b{re.escape(word)}\b") for word in words)


_LINUXCNC = (("#<", "#<"), ("o", r"\n[ \t]*o[ \t]*(?:<[^>\n]+>|\d+)[ \t]*(?:sub|if|while|do|repeat|call)"))
_SINUMERIK_TEXT = (
    ("msg", r"\bmsg[ \t]*\([ \t]*\""),
    ("$path", r"\n[ \t]*;[ \t]*\$path"),
    ("workpiece", r"\n[ \t]*(?:n\d+[ \t]*)?workpiece[ \t]*\("),
    ("cycle8", r"\n[ \t]*(?:n\d+[ \t]*)?cycle8\d+[ \t]*\("),
)
_HEIDENHAIN = (("begin pgm", r"\n[ \t]*n?\d*[ \t]*begin pgm\b"), ("%", r"\A\s*%[^\s*]+[ \t]+g7[01][ \t]*\*"))
_GRBL = (("$", r"\n[ \t]*\$(?:[a-z#$]{0,2}[ \t]*(?=\n)|h|\d+=|n\d*=|j=|rst=)"),)
_SINUMERIK = (
    *_words("g710", "g700", "g500", "g601", "g641", "g642", "g643", "g644", "g645"),
    ("m17", r"\n[ \t]*(?:n\d+[ \t]*)?m17[ \t]*(?:\n\s*)*$"),
    ("=", r"\b(?:(?:cr|ar|ap|rp|turn|rndm?|chf|chr)|[xyzijkabcfsr]\d*|t(?=[ \t]*=[ \t]*\"))[ \t]*="),
    ("mcall", r"\bmcall\b"),
    ("trans", r"\n[ \t]*(?:n\d+[ \t]*)?a?trans[ \t]+[xyz]"),
    ("traori", r"\btraori\b"),
    ("supa", r"\bsupa\b"),
    ("%_n_", r"\n%_n_\w+_[ms]pf\b"),
    ("def", r"\bdef[ \t]+(?:real|int)"),
    ("g7", r"\A(?![^\0]*\bg43\b)[^\0]*\n[^\n]*\bg7[01]\b(?![^\n]*(?:[qpuwrdl][ \t]*[-.\d#\[]|g9[01]\.1))"),
)
_FANUC = (
    *_words("g65", "g54.1", "g43.4", "g68.2"),
    ("g05", r"\bg05(?:\.\d)?[ \t]*[pqr]"),
    (":", r"\n[ \t]*:\d{4,}[ \t]*(?=\n)"),
    ("o", r"\n[ \t]*o\d{4,}[ \t]*(?=\n)|\A\s*%[^\n]*\n\s*o\d+[ \t]*(?=\n)"),
    ("m98", r"\bm98[ \t]*p"),
    ("[", r"\bif[ \t]*\[.*\bgoto|\bwhile[ \t]*\[.*\][ \t]*do[ \t]*[1-3]\b"),
    ("g28", r"\bg28[ \t]*u0"),
)
"""Signs of a dialect in lower-case text: characters that are quickly missed, and the pattern that they must be in."""


def _shows(text: str, signs: tuple[tuple[str, str], ...]) -> bool:
    return any(mark in text and re.search(pattern, text) for mark, pattern in signs)


@dataclass(frozen=True)
class Dialect:
    """How a program is read; ``guessed`` says that nobody stated it, ``marked`` that it shows in the text at least.

    G70 and G71 alone mark none: Hurco, NUM, Fagor and others write them, too.
    """

    name: str
    guessed: bool = True
    marked: bool = True

    @property
    def strict(self) -> bool:
        """Somebody has said that LinuxCNC runs it: what LinuxCNC refuses is refused."""
        return self.name == "linuxcnc" and not self.guessed

    @property
    def has_macros(self) -> bool:
        """Whether Macro B is read."""
        return self._is_fanuc_like

    @property
    def keeps_heights(self) -> bool:
        """Whether R and Z of a drilling cycle stay the heights that they are when G91 comes behind them."""
        return self.name == "fanuc" or not self.marked

    def keeps_motion(self, machine: Machine) -> bool:
        """Whether G80 leaves the last of G0 to G3 in force, and a program begins with G0.

        Fanuc's and Haas's cycles are a modal group of their own (09), beside that of G0 to G3 (01); grbl begins in G0.
        """
        return self._is_fanuc_like or (not self.strict and not len(machine.recorder))

    def first_motion(self, machine: Machine, fed: bool) -> int:
        """The motion that outlasts G80, or that a program begins in: G0, on a Sinumerik G1 once there is a feed."""
        begins = self.name == "sinumerik" and not len(machine.recorder) and (fed or machine.feed > 0.0)
        return LINE if begins else machine.straight

    def kept(self, machine: Machine) -> str:
        """Why a motion is in force that the line does not say."""
        if not len(machine.recorder):
            return "in which controls begin; write the word"
        return "which was in force before the cycle, as Fanuc and Haas keep it; LinuxCNC stops here"

    def line(self, raw: str, number: int, machine: Machine) -> str:
        """The line in LinuxCNC's words; what is left out on the way is noted."""
        findings = machine.findings
        raw = plain_numbers(raw, number, findings)
        if not self.strict and raw.count("(") > 1:
            raw = flattened(raw)
        if raw[:1] == ":" and not self.strict and _MAIN_BLOCK.match(raw):
            raw = "N" + raw[1:]
        if self.name == "sinumerik" and len(raw) <= 10 * LONGEST:
            return translated(raw, number, machine)
        if self._is_fanuc_like:
            raw = self._without_smoothing(raw, number, findings)
        if self.name == "fanuc":
            if tip := _TIP.search(raw):
                text = f"{tip[0].upper()} (tool centre point control) is read as G43: points are tip points"
                findings.add("tip-control", "info", number, text)
            raw = _take_corner(raw, machine)
            if "." in raw and _POINT.search(raw):  # Z. is Z0.
                raw = _VERBATIM_OR_CODE.sub(
                    lambda part: part[0] if part[0][0] in '(;<"' else _POINT.sub(r"\g<1>0.", part[0]), raw
                )
            raw = "O" + raw[1:] if raw[:1] == ":" else raw
            if _dwells(raw, machine.motion):
                raw = _IN_MS.sub(_in_seconds, raw)
            return _TIP.sub("G43", _DWELL.sub(r"\1P", raw))
        if self._is_fanuc_like:
            return _DWELL.sub(r"\1P", _take_corner(raw, machine)) if not self.strict else raw
        if self.name == "grbl" and raw.lstrip()[:1] in ("$", "!", "~", "?"):
            return for_controller(raw, number, findings)
        return raw

    @property
    def _is_fanuc_like(self) -> bool:
        return self.name == "fanuc" or (self.name == "linuxcnc" and self.guessed)

    def _without_smoothing(self, raw: str, number: int, findings: Findings) -> str:
        if not any(letter in raw for letter in "GgPp"):
            return raw
        for found in _SMOOTHING.finditer(raw):
            findings.add("harmless-g", "ignored", number, f"{_named(found)} is left out: it moves nothing")
        return _SMOOTHING.sub("", raw)

    def meant_otherwise(self, machine: Machine, block: Block) -> None:
        """Refuse G words that LinuxCNC knows and that mean something else on this control, and count F as grbl does."""
        if block.twice and self.strict:
            raise block.refuse(block.twice)
        if machine.moved:
            settle(machine, block)
        unit = block.g.get(modal.UNITS, machine.unit_code)
        if self.name in ("grbl", "fanuc") and unit != machine.unit_code:
            if machine.feed_mode != 930 and "f" in block.words:
                block.words["f"] *= to_si(1.0, UNITS[unit]) / machine.factor
            if self.name == "fanuc" and not block.words.keys().isdisjoint("xyzijkrqf"):
                text = (
                    f"{g_name(unit)} stands beside other words, which count in {UNITS[unit]} here; Fanuc controls want"
                )
                machine.note("units-beside", "warning", f"{text} it on a line of its own, before any place")
        if self.name == "fanuc" and block.g.get(modal.NON_MODAL) == 921:
            for letter in "xyzabc":  # which axes it presets; nothing moves
                block.words.pop(letter, None)
        motion = block.g.get(modal.MOTION, machine.motion)
        if self.name == "fanuc" and is_arc(motion) and "r" in block.words and block.words.keys() & {"i", "j", "k"}:
            for letter in "ijk":
                block.words.pop(letter, None)
            machine.note("radius-counts", "info", "an arc with R and I, J or K is that of R, as on Fanuc controls")
        if self.name in ("fanuc", "sinumerik") and modal.DIAMETER in block.g:
            code, control = g_name(block.g[modal.DIAMETER]), self.name.title()
            raise block.refuse(f"{code} of a {control} control is not read; remove the word.")
        if self.name == "sinumerik" and block.g.get(modal.COORDINATES) in (580, 590):
            raise block.refuse(
                f"{g_name(block.g[modal.COORDINATES])} shifts coordinates on a Sinumerik, which is not read; write "
                "TRANS or ATRANS."
            )

    def unknown(self, machine: Machine, block: Block) -> None:
        """Refuse unknown G words (they may move the machine); count unknown M words and harmless G words."""
        for code in block.unknown_g:
            harmless = HARMLESS["fanuc"] if self._is_fanuc_like else HARMLESS[self.name]
            if self.has_macros and any(do(machine, block, code) for do in (self._turns, _selects, *FANUC_WORDS)):
                continue
            if code in (700, 710) and not self.marked and block.words.keys().isdisjoint("pquwrdl"):
                units = 200 if code == 700 else 210
                block.g.setdefault(modal.UNITS, units)
                machine.note("mach3-units", "info", f"{g_name(code)} is read as {g_name(units)}, as Mach3 does")
                continue
            if self.name == "sinumerik" and 5050 <= code <= 5990 and code % 10 == 0:
                select_extended(machine, block, code / 10 - 500)
                continue
            if holds_once(machine, block, code, self.name, self.has_macros):
                continue
            if self.name == "sinumerik" and code in (4500, 4510):
                machine.sharp = code == 4510
                continue
            if code == 600 and self._is_fanuc_like and not block.words.keys().isdisjoint("xyzabc"):
                raise block.refuse("G60 with axis words goes there at rapid, from one side; write G0.")
            if code == 500 and not block.words.keys().isdisjoint("xyzabc"):
                raise block.refuse("G50 with axis words sets a coordinate system, which is not read; remove the line.")
            if self.name == "fanuc" and code in (650, 660):
                raise block.refuse(f"{g_name(code)} stands first on its line; put the other words on a line before it.")
            if code in harmless:
                for letter in "xyzijk" if code == 220 else "":  # of G22, the limits of the machine
                    block.words.pop(letter, None)
                machine.note("harmless-g", "ignored", f"{g_name(code)} is left out: it moves nothing")
            else:
                raise block.refuse(not_read(code))
        for code in block.unknown_m:
            if code == 96 and {"p", "q"} <= block.words.keys():
                raise block.refuse("M96 jumps by an input of the machine (Haas), which is not known; write GOTO.")
            machine.note("unknown-m", "ignored", f"M{code} is not known and is left out")

    def _turns(self, machine: Machine, block: Block, code: int) -> bool:
        """G68, G68.2 and G69 turn coordinates, G16 and G15 make X and Y a radius and an angle; False for others."""
        if of_fanuc(machine, block, code):
            return True
        if code == 680:
            turn_about(machine, block)
        elif code == 690 and machine.before_turn is not None:
            turn_back(machine)
        elif code == 160 or (code == 150 and machine.polar_words):
            machine.polar_words = code == 160
        else:
            return False
        return True

    def unused_word(self, machine: Machine, block: Block, letter: str, use: str) -> None:
        """A word that nothing on its line uses: refused, or counted where the dialect is known to have such."""
        if letter == "p" and block.words[letter] == -1.0:
            return
        if self._is_fanuc_like and letter == "p" and block.g.get(modal.COORDINATES) == 540:
            del block.g[modal.COORDINATES]
            select_extended(machine, block, block.words["p"])
            return
        if meant := meant_elsewhere(letter, block.words, self.name, is_arc(block.motion)):
            raise block.refuse(meant)
        if block.unknown_m or modal.USER in block.m:
            code = [*block.unknown_m, block.m.get(modal.USER)][0]
            machine.note("unused-word", "ignored", f"{letter.upper()} beside M{code} is left out with it")
            return
        powered = letter == "p" and modal.SPINDLE in block.m and not self.strict  # Snapmaker's M3 P100
        if (self.name == "linuxcnc" and not powered) or letter in "ijkr":
            raise block.refuse(f"{letter.upper()} has no use here; it needs {use} on its line.")
        machine.note("unused-word", "ignored", f"{letter.upper()} without {use} is left out")

    def subprogram(self, block: Block, code: int = 98, known: Container[str] = ()) -> tuple[int, int]:
        """Number and repeats of M98 P L; Fanuc writes P<repeats><number> too, if that number is not ``known``."""
        p = block.words["p"]
        if abs(p - round(p)) > 1e-4 or p < 0:
            raise block.refuse(f"M{code} has P{p:g}; expected the number of a {'line' if code == 97 else 'program'}.")
        number, repeats = round(p), round(block.words.get("l", 1.0))
        whole = code == 97 or "l" in block.words or str(number) in known
        if self.name == "fanuc" and number > 9999 and not whole:
            number, repeats = number % 10000, number // 10000
        if repeats > 1_000_000:
            raise block.refuse(f"M{code} has L{repeats}; at most 1000000 repeats are made.")
        return number, repeats


def _selects(machine: Machine, block: Block, code: int) -> bool:
    """G54.1 P, G154 P and G110 to G129 (Haas: G154 P1 to P20) select a coordinate system; False for other words."""
    if code in (541, 1540):
        if "p" not in block.words:
            raise block.refuse(f"{g_name(code)} needs P, the number of its coordinate system.")
        select_extended(machine, block, block.words.pop("p"))
    elif code == 1120 and not block.words:
        raise block.refuse(_POLAR)
    elif 1100 <= code <= 1290 and code % 10 == 0:
        select_extended(machine, block, code / 10 - 109)
    else:
        return False
    return True


def choose_dialect(text: str, wanted: str) -> Dialect:
    """The dialect ``wanted``, or for ``"auto"`` the one the text looks like. Raises GCodeError for other names."""
    if wanted != "auto":
        if wanted not in NAMES:
            raise GCodeError(f"Dialect {wanted!r} is not known; expected auto, {', '.join(NAMES)}.")
        return Dialect(wanted, guessed=False)
    lines = text.lower().split("\n")
    if max(map(len, lines)) > LONGEST:
        lines = [line[:LONGEST] for line in lines]
    text = "\n".join(["", *lines, ""])
    if _shows(text[: 20 * LONGEST], _HEIDENHAIN):
        return Dialect("heidenhain")
    if _shows(text, _LINUXCNC):
        return Dialect("linuxcnc")
    if _shows(text, _SINUMERIK_TEXT):
        return Dialect("sinumerik")
    if "(" in text or ";" in text:
        text = COMMENT.sub("", text)
    for name, signs in (("grbl", _GRBL), ("sinumerik", _SINUMERIK), ("fanuc", _FANUC)):
        if _shows(text, signs):
            return Dialect(name, marked=signs is not _SINUMERIK or _shows(text, _SINUMERIK[:-1]))
    return Dialect("linuxcnc", marked=False)


_MAIN_BLOCK = re.compile(r":[ \t]*\d+[ \t]*[A-Z]", re.IGNORECASE)
"""The number of a line from which a program may be begun, as Sinumerik and NX's posts write it."""
_POINT = re.compile(r"(?<![A-Za-z_])([A-Za-z]\s*[-+]?)\.(?![\d.])")
_TIP = re.compile(r"\bG43\.[145]\b", re.IGNORECASE)
_SMOOTHING = re.compile(
    r"\bG0?5\.1\s*Q[0123]\b(?:\s*[RXYZ]\d+\.?)*|\bG0?5\s*P(?:10000|[0123])\b|\bG0?8\s*P[01]\b|"
    r"\bG187\b(?:\s*[PE]\s*[\d.]+)*|\bG103\b(?:\s*P\s*\d+)?|\b(?:POPEN|PCLOS)\b|\b[BD]PRNT\s*\[.*\]",
    re.IGNORECASE,
)
_IN_MS = re.compile(r"P\s*(\d+)(?![\d.])", re.IGNORECASE)
_G_WORD = re.compile(r"G0*(\d+(?:\.\d+)?)|M0*9[789]\b", re.IGNORECASE)
_CYCLES = frozenset({"73", "74", "76", "81", "82", "83", "84", "85", "86", "87", "88", "89"})
_MOVES = frozenset({"0", "1", "2", "3", "33", "80"})
_CORNER = re.compile(r",\s*([RC])\s*(\d+(?:\.\d*)?|\.\d+)", re.IGNORECASE)
_DWELL = re.compile(r"(\bG0?4\s*)[XU](?=[\d.])", re.IGNORECASE)
_EXPONENT = re.compile(r"(?<![A-Za-z_])([A-Za-z]\s*[-+]?(?:\d+(?:\.\d*)?|\.\d+))[eE]([-+]?\d{1,3})(?![\d.])")
_USES_E = re.compile(r"\bG0*76\b|\bM0*6[678]\b", re.IGNORECASE)


def plain_numbers(raw: str, number: int, findings: Findings) -> str:
    """Numbers with an exponent (X-1.776e-15), as programs print them that know no better, written out."""
    if ("e" not in raw and "E" not in raw) or not _EXPONENT.search(raw) or _USES_E.search(raw):
        return raw

    def written_out(found: re.Match[str]) -> str:
        letter, value = found[1][0], found[1][1:].strip()
        return f"{letter}{Decimal(f'{value}e{found[2]}'):f}"

    plain, changed = _VERBATIM_OR_CODE.subn(
        lambda part: part[0] if part[0][0] in '(;<"' else _EXPONENT.sub(written_out, part[0]), raw
    )
    if plain != raw:
        findings.add(
            "exponent", "warning", number, "numbers with an exponent (X1.5e-3) are read; most controls refuse them"
        )
    return plain


def _take_corner(raw: str, machine: Machine) -> str:
    """``,R5`` rounds the corner at the end of its line, ``,C5`` cuts 5 off both sides of it."""
    found = _CORNER.search(raw) if "," in raw else None
    if found is None or "(" in raw[: found.start()] or ";" in raw[: found.start()]:
        return raw
    machine.corner = Corner(ROUND if found[1] in "Rr" else LEGS, float(found[2]))
    return raw[: found.start()] + raw[found.end() :]


def _dwells(code: str, motion: int) -> bool:
    """Whether P is a dwell on a line of Fanuc's: of G4 or of a cycle, which may be in force (``motion``)."""
    words = {found[1] or "call" for found in _G_WORD.finditer(COMMENT.sub("", code))}
    if words & {"10", "65", "66", "54.1", "call"}:
        return False
    in_force = str(motion // 10) in _CYCLES and not words & _MOVES
    return bool(words & ({"4"} | _CYCLES)) or in_force


def _in_seconds(found: re.Match[str]) -> str:
    """A dwell as these controls count it: milliseconds where its number has no point."""
    return f"P{int(found[1][:12]) / 1000:.3f}"


def _named(found: re.Match[str]) -> str:
    """The code that words begin with."""
    code = re.match(r"[A-Z]+[\d.]*", found[0].upper())
    assert code is not None
    return code[0]
