"""Dialects: what a program looks like that was not written for LinuxCNC, and what it means then."""

import re
from collections.abc import Container
from dataclasses import dataclass
from decimal import Decimal

from robomill.errors import GCodeError
from robomill.toolpath.gcode.codes import g_name
from robomill.toolpath.gcode.findings import Findings
from robomill.toolpath.gcode.machine import Machine
from robomill.toolpath.gcode.sinumerik import translated
from robomill.toolpath.gcode.words import Block

NAMES = ("linuxcnc", "fanuc", "grbl", "sinumerik")

SAMPLE = 200_000
"""Bytes at the start of a program from which its dialect is guessed."""

LONGEST = 300
"""Characters of a line that are looked at for signs of a dialect."""

HARMLESS: dict[str, frozenset[int]] = {
    "linuxcnc": frozenset(),
    "fanuc": frozenset({90, 150, 220, 230, 401, 501, 500, 620, 630, 670, 690, 1870}),
    "grbl": frozenset(),
    "sinumerik": frozenset({600, 601, 602, 6010, 6020, 6030, 6410, 6420, 6430, 6440, 6450, 4500, 4510}),
}
"""G words that move nothing, by dialect; they are counted as ignored."""

_COMMENT = re.compile(r"\([^()\n]*\)|;[^\n]*")
_VERBATIM_OR_CODE = re.compile(r"\([^()\n]*\)?|;.*|<[^>]*>?|\"[^\"]*\"?|[^(;<\"]+")


def _words(*words: str) -> tuple[tuple[str, str], ...]:
    return tuple((word, rf"\b{re.escape(word)}\b") for word in words)


_LINUXCNC = (("#<", "#<"), ("o", r"\n[ \t]*o[ \t]*(?:<[^>\n]+>|\d+)[ \t]*(?:sub|if|while|do|repeat|call)"))
_SINUMERIK_TEXT = (("msg", r"\bmsg[ \t]*\([ \t]*\""), ("$path", r"\n[ \t]*;[ \t]*\$path"))
_GRBL = (("$", r"\n[ \t]*\$(?:h|x|\d+=|j=)"),)
_SINUMERIK = (
    *_words("g710", "g700", "g500", "g601", "g641", "g642", "g643", "g644", "g645", "m17"),
    ("=", r"\b(?:(?:cr|ar|turn)|[xyzijkabcfs]\d?)[ \t]*="),
    ("def", r"\bdef[ \t]+(?:real|int)"),
    ("g7", r"\n[^\n]*\bg7[01]\b(?![^\n]*[qpuwrd][ \t]*[-.\d#\[])"),
)
_FANUC = (
    *_words("g65", "g54.1", "g05", "g43.4"),
    (":", r"\n[ \t]*:\d{4,}[ \t]*(?=\n)"),
    ("o", r"\n[ \t]*o\d{4,}[ \t]*(?=\n)"),
    ("m98", r"\bm98[ \t]*p"),
    ("goto", r"\bif[ \t]*\[.*\bgoto\b"),
    ("g28", r"\bg28[ \t]*u0"),
)
"""Signs of a dialect in lower-case text: characters that are quickly missed, and the pattern that they must be in."""


def _shows(text: str, signs: tuple[tuple[str, str], ...]) -> bool:
    return any(mark in text and re.search(pattern, text) for mark, pattern in signs)


@dataclass(frozen=True)
class Dialect:
    """How a program is read; ``guessed`` says that nobody stated it."""

    name: str
    guessed: bool = True

    def line(self, raw: str, number: int, machine: Machine) -> str:
        """The line in LinuxCNC's words; what is left out on the way is noted."""
        findings = machine.findings
        raw = _plain_numbers(raw, number, findings)
        if self.name == "sinumerik" and len(raw) <= 10 * LONGEST:
            return translated(raw, number, machine)
        if self.name == "fanuc":
            if _TIP.search(raw):
                findings.add(
                    "tip-control",
                    "info",
                    number,
                    "G43.4 (tool centre point control) is read as G43: points are tip points",
                )
            if _SMOOTHING.search(raw):
                findings.add("harmless-g", "ignored", number, "G5.1 Q is left out: it moves nothing")
            code = _SMOOTHING.sub("", "O" + raw[1:] if raw[:1] == ":" else raw)
            if _dwells(code, machine.motion):
                code = _IN_MS.sub(_in_seconds, code)
            return _TIP.sub("G43", _DWELL.sub(r"\1P", code))
        if self.name == "grbl" and raw.lstrip()[:1] in ("$", "!", "~", "?"):
            return _from_grbl(raw, number, findings)
        return raw

    def unknown(self, machine: Machine, block: Block) -> None:
        """Refuse unknown G words (they may move the machine); count unknown M words and harmless G words."""
        for code in block.unknown_g:
            if code in HARMLESS[self.name]:
                machine.note("harmless-g", "ignored", f"{g_name(code)} is left out: it moves nothing")
            else:
                raise block.refuse(f"{g_name(code)} is not known; it may move the machine, so reading stops here.")
        for code in block.unknown_m:
            machine.note("unknown-m", "ignored", f"M{code} is not known and is left out")

    def unused_word(self, machine: Machine, block: Block, letter: str, use: str) -> None:
        """A word that nothing on its line uses: refused, or counted where the dialect is known to have such."""
        if letter == "p" and block.words[letter] == -1.0:
            return
        if self.name == "linuxcnc" or letter in "ijkr":
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


def choose_dialect(text: str, wanted: str) -> Dialect:
    """The dialect ``wanted``, or for ``"auto"`` the one the text looks like. Raises GCodeError for other names."""
    if wanted != "auto":
        if wanted not in NAMES:
            raise GCodeError(f"Dialect {wanted!r} is not known; expected auto, {', '.join(NAMES)}.")
        return Dialect(wanted, guessed=False)
    lines = "\n".join(line[:LONGEST] for line in text.lower().split("\n"))
    text = f"\n{lines}\n"
    if _shows(text, _LINUXCNC):
        return Dialect("linuxcnc")
    if _shows(text, _SINUMERIK_TEXT):
        return Dialect("sinumerik")
    text = _COMMENT.sub("", text)
    for name, signs in (("grbl", _GRBL), ("sinumerik", _SINUMERIK), ("fanuc", _FANUC)):
        if _shows(text, signs):
            return Dialect(name)
    return Dialect("linuxcnc")


_TIP = re.compile(r"\bG43\.[45]\b", re.IGNORECASE)
_SMOOTHING = re.compile(r"\bG0?5\.1\s*Q[01]\b(?:\s*R\d+)?", re.IGNORECASE)
_IN_MS = re.compile(r"P\s*(\d+)(?![\d.])", re.IGNORECASE)
_G_WORD = re.compile(r"G0*(\d+(?:\.\d+)?)|M0*9[789]\b", re.IGNORECASE)
_CYCLES = frozenset({"73", "74", "76", "81", "82", "83", "84", "85", "86", "87", "88", "89"})
_MOVES = frozenset({"0", "1", "2", "3", "33", "80"})
_DWELL = re.compile(r"(\bG0?4\s*)[XU](?=[\d.])", re.IGNORECASE)
_EXPONENT = re.compile(r"(?<![A-Za-z_])([A-Za-z]\s*[-+]?(?:\d+\.?\d*|\.\d+))[eE]([-+]?\d{1,3})(?![\d.])")
_USES_E = re.compile(r"\bG0*76\b|\bM0*6[678]\b", re.IGNORECASE)


def _plain_numbers(raw: str, number: int, findings: Findings) -> str:
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


def _dwells(code: str, motion: int) -> bool:
    """Whether P is a dwell on a line of Fanuc's: of G4 or of a cycle, which may be in force (``motion``)."""
    words = {found[1] or "call" for found in _G_WORD.finditer(_COMMENT.sub("", code))}
    if words & {"10", "65", "66", "54.1", "call"}:
        return False
    in_force = str(motion // 10) in _CYCLES and not words & _MOVES
    return bool(words & ({"4"} | _CYCLES)) or in_force


def _in_seconds(found: re.Match[str]) -> str:
    """A dwell as these controls count it: milliseconds where its number has no point."""
    return f"P{int(found[1][:12]) / 1000:.3f}"


def _from_grbl(raw: str, number: int, findings: Findings) -> str:
    text = raw.strip().upper()
    if text.startswith(("$H", "$J")):
        raise GCodeError.at(number, f"{text[:2]} moves the machine in a way the program does not say; remove it.")
    findings.add("controller-line", "ignored", number, "lines for the controller ($, !, ~, ?) are left out")
    return ""
