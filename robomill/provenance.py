"""Words that every floor uses: where a number comes from, and what was noticed about it."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import Any, Literal, get_args

from robomill.arguments import asking, refuse_unknown
from robomill.arrays import of_kind
from robomill.errors import RobomillError

Kind = Literal["paper", "measured", "assumed", "user", "computed", "synthetic"]
KINDS: tuple[Kind, ...] = get_args(Kind)
MADE_UP: tuple[Kind, ...] = ("assumed", "synthetic")  # what nobody has measured or stated
Level = Literal["error", "warning", "suspicious", "ignored", "info"]
LEVELS: tuple[Level, ...] = get_args(Level)  # the grave ones first


def kind_word(kind: str) -> str:
    """The word for a kind on screens: what a paper gives is published."""
    return "published" if kind == "paper" else kind


MANY = 3  # numbers that a sentence names


@asking
@dataclass(frozen=True)
class Provenance:
    """Where a block of numbers comes from: a kind and the source in words.

    ``carried_from`` names the set-up in which they were stated, where they now stand beside another path and nobody has
    said yet that they hold there.

    Examples
    --------
    >>> import robomill as rm
    >>> rm.Provenance("measured", "load tests of 3 May").record()
    {'kind': 'measured', 'source': 'load tests of 3 May'}
    """

    kind: Kind
    source: str
    carried_from: str = ""

    def __post_init__(self) -> None:
        if self.kind not in KINDS:
            raise RobomillError(f"Provenance: kind is {self.kind!r}; expected one of {', '.join(KINDS)}.")

    def carried(self, name: str) -> Provenance:
        """The same numbers beside a path that they were not stated for in the set-up ``name``: an assumption there."""
        if self.carried_from:
            return self
        return Provenance("assumed", f"carried over from {name!r}: {self.source}", name)

    def record(self) -> dict[str, str]:
        """As files carry it."""
        return {name: value for name, value in vars(self).items() if value or name in ("kind", "source")}


# What a block counts as until someone says more.
UNSTATED = Provenance("user", "not stated")
BY_HAND = Provenance("user", "entered by hand")
# What numbers are that were given in code.
GIVEN = Provenance("user", "given in code")


def stated_blocks(said: Any, error: type[RobomillError], known: Iterable[str] | None = None) -> dict[str, Provenance]:
    """Where blocks of numbers come from, as a person gives it; ``error`` for what says nothing of a source, and for a
    block that is none of the ``known`` ones (None: any)."""
    of_kind(said, Mapping, "provenance", "a mapping of blocks to rm.Provenance", error)
    for block, each in said.items():
        of_kind(block, str, "provenance", "the name of a block", error)
        of_kind(each, Provenance, "provenance", 'rm.Provenance("measured", "where from")', error)
    if known is not None:
        refuse_unknown(said, known, "provenance")
    return dict(said)


TYPED = Provenance("user", "entered in the app")


@asking
@dataclass(frozen=True)
class Finding:
    """What was noticed. ``code`` says which kind it is, for code; ``message`` is for people and nothing branches on it.

    ``line`` is the 1-based source line (0: the whole), ``count`` how often it was noticed; ``place`` is what ``line``
    counts, where the path is none of a program: "row", "shape" or "point"; "" where the message names it itself.

    Examples
    --------
    >>> import robomill as rm
    >>> rm.Finding("warning", "the feed is high.", line=7).sentence
    'Line 7: the feed is high.'
    """

    level: Level
    message: str
    line: int = 0
    count: int = 1
    code: str = ""
    place: str = "line"

    @property
    def order(self) -> tuple[int, int, str]:
        """Its place in a list: the grave ones first, then by line."""
        return LEVELS.index(self.level), self.line, self.message

    @property
    def sentence(self) -> str:
        """The message, with its line before it where it has one and does not name it."""
        return f"{self.place.capitalize()} {self.line}: {self.message}" if self.line and self.place else self.message

    def record(self) -> dict[str, Any]:
        """As JSON carries it."""
        return {name: getattr(self, name) for name in ("line", "level", "code", "message", "count")}


def named(numbers: Iterable[int]) -> str:
    """Numbers of lines, joints or blocks in order, the first few: ``"3, 5, 9 and more"``."""
    every = sorted(set(numbers))
    return ", ".join(map(str, every[:MANY])) + (" and more" if len(every) > MANY else "")
