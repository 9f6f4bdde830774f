"""A line of a program as its words where they stand, so that some can be changed and all others stay as they were."""

import re
from collections.abc import Sequence
from dataclasses import dataclass, replace

AXES, ROTARY, CENTRES = "XYZ", "ABC", "IJK"
_REMARK = r"\([^()\n]*(?:\([^()\n]*\)[^()\n]*)*\)"  # which may hold another
_PART = re.compile(
    rf"(?P<space>\s+)|(?P<comment>{_REMARK}|;.*)|(?P<skip>/\d?(?=\s*(?:N|$|[A-Z])))"
    r"|(?P<named>[A-Z]{2,}\d*\s*=\s*[^\s;]+)"
    r"|(?P<word>(?P<letter>[A-Z])\s*(?P<number>[-+]?\s*(?:\d+\.?\d*|\.\d+))(?![\d.\[#]))"
    r"|(?P<corner>,\s*[RC]\s*\d*\.?\d*)"
    r"|(?P<computed>(?P<of>[A-Z])\s*(?:=\s*[^\s;]+|[-+]?(?:#<[^>]*>|#+\d+|#*\[)))",
    re.IGNORECASE,
)
COMMENT = re.compile(rf"{_REMARK}|;[^\n]*")
"""What a line says to people."""
COMMENT_BYTES = re.compile(COMMENT.pattern.encode())
CALLS = (97, 98, 198)
"""M codes that call a subprogram."""
_CALLS = frozenset(f"M{code}" for code in (*CALLS, 99))
_PARAMETER = re.compile("#"), re.compile(r"#|\bR\d")
_BLOCK = re.compile(r"\s*/?\s*N?\d")
_SCALED = re.compile(r"\s*((?:N\d+\s*)?)(A?)(?:MIRROR|SCALE)\b", re.IGNORECASE)


def behind_remark(lines: Sequence[str], index: int) -> int:
    """The first line from ``index`` on that goes on with no remark above it: Heidenhain's go on behind ~, without a
    block number."""
    while index < len(lines) and lines[index - 1].rstrip().endswith("~") and not _BLOCK.match(lines[index]):
        index += 1
    return index


@dataclass(frozen=True)
class Token:
    """A piece of a line as written: a ``letter`` with its ``value`` (None: computed), or what is no word ("")."""

    text: str
    letter: str = ""
    value: float | None = None

    @property
    def code(self) -> str:
        """``"G1"`` for G01, ``"M30"``; "" for other words."""
        return f"{self.letter}{self.value:g}" if self.letter in ("G", "M") and self.value is not None else ""

    @property
    def is_space(self) -> bool:
        return not self.letter and not self.text.strip()

    @property
    def is_comment(self) -> bool:
        return not self.letter and self.text[:1] in ("(", ";")

    def said(self, number: str) -> "Token":
        """The same word with another number."""
        return replace(self, text=f"{self.text[0]}{number}", value=float(number))


def scan(line: str) -> list[Token] | None:
    """The words of a line of G-code in order; None for a line that is made of other things, too."""
    at, found = 0, []
    while at < len(line):
        part = _PART.match(line, at)
        if part is None:
            return None
        end = part.end()
        if part["computed"] is not None:
            end = _past_brackets(line, at, end)
            found.append(Token(line[at:end], part["of"].upper()))
        elif part["word"] is not None:
            number = re.sub(r"\s", "", part["number"])
            found.append(Token(line[at:end], part["letter"].upper(), float(number)))
        elif part["named"] is not None or part["corner"] is not None:
            found.append(Token(line[at:end], re.split(r"[=\d\s]", part[0].lstrip(", "))[0].upper() + "="))
        else:
            found.append(Token(line[at:end]))
        at = end
    return found


def _past_brackets(line: str, start: int, end: int) -> int:
    """Where a value ends whose last bracket was opened before ``end``."""
    depth = line.count("[", start, end) - line.count("]", start, end)
    while depth > 0 and end < len(line):
        depth += {"[": 1, "]": -1}.get(line[end], 0)
        end += 1
    return end


def joined(tokens: list[Token]) -> str:
    return "".join(token.text for token in tokens)


def without(tokens: list[Token], gone: set[int]) -> list[Token]:
    """The tokens but those at some places, each with the space before it."""
    also = {i - 1 for i in gone if i > 0 and tokens[i - 1].is_space}
    return [token for i, token in enumerate(tokens) if i not in gone | also]


def notes(line: str, dialect: str) -> list[str]:
    """What a line says to people, as a line of its own; brackets are none on a Sinumerik, where they hold values."""
    found = [each[0] for each in COMMENT.finditer(line) if dialect != "sinumerik" or each[0][0] == ";"]
    return [" ".join(found)] if found else []


def letters_of_call(beside_length: bool) -> frozenset[str]:
    """Letters that say what is called, where it begins and how often; beside G43 its H is the number of a length."""
    return frozenset("PLQ" if beside_length else "PLQH")


def uncalled(line: str) -> str:
    """A line without its call by M97, M98 or M198, or its M99, where other words stand beside that; else as it is."""
    tokens = (scan(line) or []) if "9" in line else []
    if not any(token.code in _CALLS for token in tokens):
        return line
    letters = letters_of_call(any(token.code == "G43" for token in tokens))
    gone = {i for i, token in enumerate(tokens) if token.code in _CALLS or token.letter in letters}
    left = [token for i, token in enumerate(tokens) if i not in gone]
    return joined(without(tokens, gone)) if any(token.letter and token.letter != "N" for token in left) else line


def varies(line: str, dialect: str) -> bool:
    """Whether a line counts by parameters."""
    return _PARAMETER[dialect == "sinumerik"].search(COMMENT.sub("", line)) is not None


def unscaled(text: str) -> list[str] | None:
    """What is left of a Sinumerik line that mirrors or scales, once places are written as they are; None for others.

    MIRROR and SCALE end TRANS and ROT too, AMIRROR and ASCALE do not.
    """
    found = _SCALED.match(text)
    return None if found is None else [] if found[2] else [f"{found[1]}TRANS"]
