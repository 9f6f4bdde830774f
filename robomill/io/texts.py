"""Text from a path, from itself or from an upload's bytes: one way to read it and one sentence for what is none."""

import codecs
from pathlib import Path

from robomill.errors import RobomillError
from robomill.files import FileKind, check_size, name_of, read_file


def read_text(given: str | Path | bytes, error: type[RobomillError], kind: FileKind, name: str = "") -> tuple[str, str]:
    """(text, name). A ``str`` with a line break, or a blank one, is the text itself; any other names a file.

    UTF-8 or UTF-16 with its byte-order mark; ``name`` is the file's own unless given, and empty for a text.
    Raises ``error`` saying what was expected where there is no such file, or no text in it, or too much.
    """
    if isinstance(given, str) and (not given.strip() or "\n" in given or "\r" in given):
        check_size(len(given), kind, error, name or "This text")
        return given.removeprefix("\ufeff"), name
    if isinstance(given, bytes):
        raw = given
        check_size(len(raw), kind, error, name or "This file")
    else:
        name = name or name_of(given) or str(given)
        raw = read_file(given, kind, error)
    try:
        text = raw.decode("utf-16" if raw.startswith((codecs.BOM_UTF16_LE, codecs.BOM_UTF16_BE)) else "utf-8-sig")
    except UnicodeDecodeError:
        text = "\0"
    if "\0" in text:
        raise error(f"{name or 'This'}{':' if name else ' file:'} this is not a text file; expected {kind.expected}.")
    return text, name
