"""What a corrected program says of itself, so that nobody takes its lines for the path that was meant: two comments at
its head that name the path it was corrected for."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass

from robomill.arrays import digest

SAID = "corrected by robomill for"
HEAD = 40  # lines in which a program says what it is
LONGEST = 40  # characters of a name
KEY = 12  # characters of a path's key
_SAID = re.compile(
    rf"[(;]\s*{SAID} (?P<name>.*), (?P<key>[0-9a-f]{{{KEY}}})( in (?P<in>[a-z ]+))?\s*\)?\s*$", re.IGNORECASE
)
_BEFORE = re.compile(r"\s*(%|[O:]\d+|;\s*\$PATH|$)", re.IGNORECASE)  # what a control expects ahead of all else


@dataclass(frozen=True)
class Mark:
    """The path that a program was corrected for: its ``name`` and its ``key``; and in which ``components`` it was
    corrected, () where it does not say."""

    name: str
    key: str
    components: tuple[str, ...] = ()


def key_of(lines: Sequence[str]) -> str:
    """What tells a path's lines from those of another, wherever they are kept."""
    return digest([line.strip() for line in lines])[:KEY]


def mark_of(text: str) -> Mark | None:
    """What a program's head says it was corrected for; None where it says nothing."""
    for line in text.split("\n", HEAD)[:HEAD]:
        found = _SAID.search(line.rstrip())
        if found is not None:
            return Mark(found["name"], found["key"].lower(), tuple((found["in"] or "").lower().split()))
    return None


def marked(lines: Sequence[str], of: Mark, dialect: str) -> list[str]:
    """A program's ``lines`` with what it is corrected for, and how that is checked, beneath what has to come first."""
    name, within = of.name, f" in {' '.join(of.components)}" if of.components else ""
    plain = "".join(c if c.isascii() and c.isprintable() and c not in "();" else "_" for c in name)[-LONGEST:]
    begin, end = ("; ", "") if dialect == "sinumerik" else ("(", ")")
    told = [f"{begin}{SAID} {plain}, {of.key}{within}{end}"]
    told.append(f"{begin}to check: robomill simulate SETUP --program THIS --wanted {plain}{end}")
    first = 0
    while first < len(lines) and _BEFORE.match(lines[first]):
        first += 1
    return [*lines[:first], *told, *lines[first:]]
