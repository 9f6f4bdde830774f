"""Text from a path, from itself or from an upload's bytes: one way to read it and one sentence for what is none."""

from __future__ import annotations

import codecs
from pathlib import Path

from robomill.errors import RobomillError

LONGEST_PLACE = 80  # characters of a path that a refusal shows


def read_text(given: str | Path | bytes, error: type[RobomillError], expected: str, name: str = "") -> tuple[str, str]:
    """(text, name). A ``str`` with a line break, or a blank one, is the text itself; any other names a file.

    UTF-8 or UTF-16 with its byte-order mark; ``name`` is the file's own unless given, and empty for a text.
    Raises ``error`` saying what was ``expected`` ("a CSV table") where there is no such file, or no text in it.
    """
    if isinstance(given, bytes):
        raw = given
    elif isinstance(given, str) and (not given.strip() or "\n" in given or "\r" in given):
        return given.removeprefix("\ufeff"), name
    else:
        name = name or Path(given).name or str(given)
        try:
            raw = Path(given).read_bytes()
        except (OSError, ValueError) as exc:
            why = getattr(exc, "strerror", None) or exc
            place = str(given)
            place = place if len(place) <= LONGEST_PLACE else f"…{place[1 - LONGEST_PLACE :]}"  # the file's name shows
            raise error(f"{place}: cannot be opened ({why}); expected {expected}.") from None
    try:
        text = raw.decode("utf-16" if raw.startswith((codecs.BOM_UTF16_LE, codecs.BOM_UTF16_BE)) else "utf-8-sig")
    except UnicodeDecodeError:
        text = "\0"
    if "\0" in text:
        raise error(f"{name or 'This'}{':' if name else ' file:'} this is not a text file; expected {expected}.")
    return text, name
