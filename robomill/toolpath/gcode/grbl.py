"""What grbl 1.1 knows: a program that is stated as grbl's is refused where grbl itself would stop.

The words are those of grbl's own list ("List of Supported G-Codes in Grbl v1.1" in its README). M words stay what they
are everywhere: what is not known is counted, as senders of grbl leave them out (M6) before it sees them.
"""

import re

from robomill.errors import GCodeError
from robomill.toolpath.findings import Findings

_G = (
    *("0", "1", "2", "3", "4", "10", "17", "18", "19", "20", "21", "28", "28.1", "30", "30.1", "38.2", "38.3", "38.4"),
    *("38.5", "40", "43.1", "49", "53", "54", "55", "56", "57", "58", "59", "61", "80", "90", "91", "91.1", "92"),
    *("92.1", "93", "94"),
)
_KNOWN = "|".join(re.escape(code) for code in _G)
_OTHER = re.compile(
    rf"G[ \t]*0*+(?!(?:{_KNOWN})0*(?![\d.]))\d+(?:\.\d+)?|M[ \t]*0*9[789](?!\d)|"
    r"(?:[ABCDHOQUVW]|(?<![\d.])E)(?=[ \t]*[-+.\d\[#<])|[#\[@^]",
    re.IGNORECASE,
)
_LIKELY = re.compile(rb"[ABCDEHOQUVWabcdehoquvw#\[@^]|[Gg][ \t]*0*(?:[5-9](?!\d)|[1-9]\d)|[Mm][ \t]*0*9[789]")
_COMMENT = re.compile(r"\([^()]*\)?|;.*")
_END = re.compile(r"M[ \t]*0*(?:2|30)(?!\d)", re.IGNORECASE)
_SYSTEM = ("$", "!", "~", "?")


def check_grbl(data: bytes, stated: bool, findings: Findings) -> None:
    """Refuse the first word that grbl 1.1 does not know; count it where nobody has ``stated`` that grbl is meant.

    Raises GCodeError naming the line and the word.
    """
    for number, raw in enumerate(data.split(b"\n"), 1):
        if not _LIKELY.search(raw) and b"%" not in raw and b"M" not in raw and b"m" not in raw:
            continue
        line = _COMMENT.sub(" ", raw.decode("utf-8", "replace")).strip()
        if not line or line.startswith(_SYSTEM):
            continue
        found = _OTHER.search(line)
        if found is not None:
            word = re.sub(r"[ \t]", "", found[0]).upper()
            if stated:
                text = f"{word} is not known to grbl 1.1, which stops there; choose the dialect auto, or remove it."
                raise GCodeError.at(number, text)
            text = f"{word} is not known to grbl 1.1; it is read as LinuxCNC and grblHAL read it"
            findings.add("not-grbl", "suspicious", number, text)
            return
        if _END.search(line):
            return


def for_controller(raw: str, number: int, findings: Findings) -> str:
    """What is left of a line for the controller: nothing, or a refusal of what would move the machine."""
    text = raw.strip().upper()
    if text.startswith(("$H", "$J")):
        raise GCodeError.at(number, f"{text[:2]} moves the machine in a way the program does not say; remove it.")
    findings.add("controller-line", "ignored", number, "lines for the controller ($, !, ~, ?) are left out")
    return ""
