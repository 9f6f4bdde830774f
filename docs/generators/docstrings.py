"""Docstrings list fields in columns, ``name   what it is``, as one reads them in an editor; pages show lists."""

from __future__ import annotations

import re
from collections.abc import Iterator
from itertools import groupby
from typing import Any

from sphinx.application import Sphinx

ENTRY = re.compile(r"(?P<names>[\w.]+(?:, [\w.]+)*)(?P<gap>\s{2,})(?P<text>\S.*)")
SECOND = re.compile(r"\S\s{3,}\S")


def setup(app: Sphinx) -> dict[str, Any]:
    app.connect("autodoc-process-docstring", _process)
    return {"parallel_read_safe": True, "parallel_write_safe": True}


def _process(app: Sphinx, what: str, name: str, value: object, options: object, lines: list[str]) -> None:
    lines[:] = [line for is_text, group in groupby(lines, key=bool) for line in _shown(is_text, list(group))]


def _shown(is_text: bool, paragraph: list[str]) -> Iterator[str]:
    """A paragraph as reStructuredText: lists of fields as a list, two columns of them as they stand."""
    if not is_text or not _lists_fields(paragraph):
        yield from paragraph
    elif any(SECOND.search(line[ENTRY.match(line).start("text") :]) for line in paragraph if ENTRY.match(line)):
        yield from ("::", "", *(f"    {line}" for line in paragraph))
    else:
        for line in paragraph:
            entry = ENTRY.match(line)
            names = "" if entry is None else ", ".join(f"``{each}``" for each in entry["names"].split(", "))
            yield f"  {line.strip()}" if entry is None else f"- {names}: {entry['text']}"


def _lists_fields(paragraph: list[str]) -> bool:
    """Whether it is a list of fields: entries, and deep lines that carry one on."""
    first = ENTRY.match(paragraph[0])
    if first is None or len(paragraph) < 2:
        return False
    return all(ENTRY.match(line) or line.startswith("  ") for line in paragraph)
