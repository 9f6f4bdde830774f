"""HTML made of tags: what is not HTML already is escaped, so that words of files are shown and never read."""

from __future__ import annotations

import html
import re
from collections.abc import Iterable

# What steers a terminal, or turns what stands after it round, is no part of a page; neither is half a character.
_STEERS = re.compile(r"[\x00-\x08\x0b-\x1f\x7f-\x9f\u200e\u200f\u202a-\u202e\u2066-\u2069\ud800-\udfff\ufffe\uffff]")
VOID = {"meta", "rect", "line", "path", "polyline", "polygon", "circle", "col"}


class Html(str):
    """Text that is HTML already. What is added to it is plain text unless it is HTML, too."""

    __slots__ = ()

    def __add__(self, other: str) -> Html:
        return joined((self, other))

    def __radd__(self, other: str) -> Html:
        return joined((other, self))


def escaped(words: object) -> Html:
    """Words as HTML that shows them; HTML stays."""
    if isinstance(words, Html):
        return words
    return Html(html.escape(_STEERS.sub("\ufffd", str(words))))


def joined(parts: Iterable[object]) -> Html:
    """Parts one after the other."""
    return Html("".join(map(escaped, parts)))


def tag(name: str, /, *children: object, **attributes: object) -> Html:
    """An element: ``tag("td", "1 < 2", class_="n")``; an attribute that is None is left out, ``_`` stands for ``-``."""
    said = "".join(
        f' {key.rstrip("_").replace("_", "-")}="{escaped(value)}"'
        for key, value in attributes.items()
        if value is not None
    )
    if name in VOID and not children:
        return Html(f"<{name}{said}/>")
    return Html(f"<{name}{said}>{joined(children)}</{name}>")


def table(head: Iterable[object], rows: Iterable[Iterable[object]], kinds: str, class_: str | None = None) -> Html:
    """A table; ``kinds`` has a letter a column, the class of its cells: n a number, w words, m names in type."""
    top = tag("thead", tag("tr", *(tag("th", title, class_=k, scope="col") for title, k in zip(head, kinds))))
    body = (tag("tr", *(tag("td", cell, class_=k) for cell, k in zip(row, kinds, strict=True))) for row in rows)
    return tag("table", top, tag("tbody", *body), class_=class_)
