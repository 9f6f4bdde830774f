"""Docstrings as pages show them: NumPy's sections, and fields in columns (``name   what it is``) as lists."""

from __future__ import annotations

import re
from collections.abc import Iterator
from itertools import groupby
from typing import Any

from sphinx.application import Sphinx
from sphinx.ext.napoleon import Config
from sphinx.ext.napoleon.docstring import NumpyDocstring

SECTIONS = Config(napoleon_use_rtype=False)
NAMES = re.compile(r"\w[\w.]*(?:,? \w[\w.]*)*")
ENTRY = re.compile(rf"(?P<names>{NAMES.pattern})\s{{2,}}(?P<text>\S.*)")
BAR = re.compile(r"(``.*?``)|\|")
SECOND = re.compile(r"\S\s{3,}\S")


def setup(app: Sphinx) -> dict[str, Any]:
    app.connect("autodoc-process-docstring", _process)
    return {"parallel_read_safe": True, "parallel_write_safe": True}


def _process(app: Sphinx, what: str, name: str, value: object, options: object, lines: list[str]) -> None:
    # A property's docstring is a sentence, not "type: what it is", as Napoleon by itself would read it.
    kind = "method" if what in ("property", "attribute") else what
    told = NumpyDocstring(lines, SECTIONS, app, kind, name, value, options).lines()
    lines[:] = [line for is_text, group in groupby(told, key=bool) for line in _shown(is_text, list(group))]


def _shown(is_text: bool, paragraph: list[str]) -> Iterator[str]:
    """A paragraph as reStructuredText: lists of fields as a list, two columns of them as they stand."""
    entries = [_entry(line, paragraph) for line in paragraph] if is_text else []
    if (
        len(entries) < 2
        or not entries[0]
        or any(not e and not line.startswith("  ") for e, line in zip(entries, paragraph))
    ):
        yield from (_plain(line) for line in paragraph)
    elif any(SECOND.search(each[1]) for each in entries if each):
        yield from ("::", "", *(f"    {line}" for line in paragraph))
    else:
        for each, line in zip(entries, paragraph):
            names = ", ".join(f"``{name}``" for name in each[0].split(", ")) if each else ""
            yield f"- {names}: {_plain(each[1])}" if each else f"  {_plain(line.strip())}"


def _entry(line: str, paragraph: list[str]) -> tuple[str, str] | None:
    """Names and text of a line that begins an entry: the text two blanks behind, or where that of the first is."""
    found, first = ENTRY.fullmatch(line), ENTRY.fullmatch(paragraph[0])
    if found is not None:
        return found["names"], found["text"]
    column = 0 if first is None else first.start("text")
    names, text = line[:column], line[column:]
    aligned = NAMES.fullmatch(names.rstrip()) and names.endswith(" ") and text[:1].strip()
    return (names.rstrip(), text) if aligned else None


def _plain(line: str) -> str:
    """A size such as |F| is no substitution."""
    return BAR.sub(lambda m: m[1] or r"\|", line)
