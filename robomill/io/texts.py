"""Text from a path, from itself or from an upload's bytes: one way to read it and one sentence for what is none."""

import codecs
import re
from pathlib import Path

from robomill.errors import RobomillError
from robomill.files import FileKind, check_place, check_size, name_of, read_file

WINDOWS = "cp1252"
# Control characters that no text holds, and bytes that the code page has no character for.
BINARY = re.compile(rb"[\x00-\x08\x0e-\x19\x1b-\x1f\x7f\x81\x8d\x8f\x90\x9d]")


def read_text(given: str | Path | bytes, error: type[RobomillError], kind: FileKind, name: str = "") -> tuple[str, str]:
    """(text, name). A ``str`` with a line break, or a blank one, is the text itself; any other names a file.

    UTF-8 or UTF-16 with its byte-order mark, a table in Windows' code page 1252 too; ``name`` is the file's own unless
    given, and empty for a text.
    Raises ``error`` saying what was expected where there is no such file, or no text in it, or too much.
    """
    if isinstance(given, str) and (not given.strip() or "\n" in given or "\r" in given):
        check_size(len(given), kind, error, name or "This text")
        return given.removeprefix("\ufeff"), name
    if isinstance(given, bytes):
        raw = given
        check_size(len(raw), kind, error, name or "This file")
    else:
        check_place(given, kind.expected, error)
        name = name or name_of(given) or str(given)
        raw = read_file(given, kind, error)
    called = f"{name}:" if name else "This file:"
    utf_16 = raw.startswith((codecs.BOM_UTF16_LE, codecs.BOM_UTF16_BE))
    try:
        text = raw.decode("utf-16" if utf_16 else "utf-8-sig")
    except UnicodeDecodeError as exc:
        text = "\0" if utf_16 or BINARY.search(raw) else raw.decode(WINDOWS, "replace")
        if "\0" not in text and not kind.any_code:
            line = raw.count(b"\n", 0, exc.start) + 1
            raise error(
                f"{called} line {line} is not in UTF-8, which {kind.expected} is; save it with that encoding."
            ) from None
    if "\0" in text:
        raise error(f"{called} this is not a text file; expected {kind.expected}.")
    return text, name
