"""Writes what is generated before Sphinx reads the pages: only what has changed, so that little is built again."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from sphinx.application import Sphinx
from sphinx.util import logging

GENERATED = "_generated"
PICTURES = "pictures"


def setup(app: Sphinx) -> dict[str, Any]:
    app.connect("builder-inited", _write)
    return {"parallel_read_safe": True, "parallel_write_safe": True}


def _write(app: Sphinx) -> None:
    docs = Path(app.srcdir)
    for folder in (GENERATED, PICTURES):
        (docs / folder).mkdir(exist_ok=True)
    pieces = everything(docs / PICTURES)
    for name, text in pieces.items():
        place = docs / GENERATED / name
        if not place.is_file() or place.read_text(encoding="utf-8") != text:
            place.write_text(text, encoding="utf-8")
    logging.getLogger(__name__).info("%d pieces generated", len(pieces))


def everything(pictures: Path) -> dict[str, str]:
    """All generated pieces by the name of their file."""
    from generators import (
        extras,
        formats,
        gallery,
        names,
        records,
        responses,
        scripts,
        validation,
        verbs,
    )  # here: they load all of robomill

    return {
        **extras.pages(),
        **formats.pages(),
        **verbs.pages(),
        **names.pages(),
        **records.pages(),
        **responses.pages(),
        **scripts.pages(),
        **validation.pages(),
        **gallery.pages(pictures),
    }
