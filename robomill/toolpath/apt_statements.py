"""Statements of APT-CL files as they stand in lines: numbered, joined by ``;``, with a blank for / or in GO TO."""

import re
from typing import NamedTuple

_NUMBERED = re.compile(r"^N?\d+\s+(?=[A-Za-z])")
_APART = re.compile(r"^GO\s+TO(?=\s*[/\s])", re.IGNORECASE)
_NO_SLASH = re.compile(r"^(GOTO|GODLTA|FROM)\s+(?=[-+.\d])", re.IGNORECASE)
_TEXTS = frozenset(("PARTNO", "PPRINT", "TPRINT", "REMARK", "INSERT", "LEADER", "TOOL", "END-OF-PATH", "DISPLY"))
"""Words whose text may hold anything."""
_PLACES = frozenset(("GOTO", "GODLTA", "FROM", "RAPID", "FEDRAT", "GO"))
_UNITS = {"IPM": "in", "IPR": "in", "MMPM": "mm", "MMPR": "mm"}


class OfFeed(NamedTuple):
    """What a feed says of the unit of lengths: the ``unit``, by which ``word``, where."""

    unit: str
    word: str
    line: int


def statements_of(text: str) -> list[tuple[int, str]]:
    """Statements with the line where each starts: ``$$`` begins a comment, ``$`` at the end goes on below."""
    out: list[tuple[int, str]] = []
    pending, start, in_comment = "", 0, False
    for number, raw in enumerate(text.split("\n"), 1):
        whole = raw.strip()
        code = whole.split("$$")[0].strip()
        goes_on = whole.endswith("$") and not whole.endswith("$$")
        if in_comment or not code:
            in_comment = (in_comment or whole.startswith("$$->")) and goes_on
            continue
        start = start or number
        if code.endswith("$"):
            pending += code[:-1]
            continue
        out += [(start, each) for each in _apart(pending + code)]
        pending, start = "", 0
    if pending:
        out += [(start, each) for each in _apart(pending)]
    return out


def _apart(code: str) -> list[str]:
    """The statements of a line, each without its number, as word/values."""
    found: list[str] = []
    while code:
        code = _NUMBERED.sub("", code.strip(), count=1)
        first, semicolon, rest = code.partition(";")
        if _first(code) in _TEXTS:
            first, rest = code, ""
        if first.strip():
            found.append(_NO_SLASH.sub(r"\1/", _APART.sub("GOTO", first.strip(), count=1), count=1))
        code = rest
    return found


def _first(code: str) -> str:
    """The first word of a statement."""
    return re.split(r"[\s/,;=]", code.strip(), maxsplit=1)[0].upper()


def is_broken(word: str) -> bool:
    """Whether what stands before the / holds a word of moves beside others, and is no text."""
    return _first(word) not in _TEXTS and not _PLACES.isdisjoint(re.split(r"[^A-Z0-9]+", word))


def unit_of_feeds(statements: list[tuple[int, str]]) -> OfFeed | None:
    """What the feeds of a file without UNITS say of its lengths; None where they say nothing, or both."""
    found: dict[str, OfFeed] = {}
    for line, code in statements:
        first = _first(code)
        if first in ("UNITS", "UNIT"):
            return None
        if first in ("FEDRAT", "CYCLE"):
            words = re.split(r"[\s,/]+", code.upper())
            for word in words:
                if word in _UNITS:
                    found.setdefault(_UNITS[word], OfFeed(_UNITS[word], word, line))
        if first == "FINI":
            break
    return next(iter(found.values())) if len(found) == 1 else None
