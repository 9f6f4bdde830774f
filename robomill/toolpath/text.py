"""Program text from a path, a string or bytes: encodings, line ends, and what is no program at all."""

import codecs
import os
import re
from pathlib import Path

from robomill.errors import GCodeError
from robomill.files import PROGRAM, check_size, read_file, shown_place

Source = str | bytes | bytearray | Path
SUFFIXES = (
    *(".nc", ".ngc", ".tap", ".gcode", ".cnc", ".txt", ".g", ".mpf", ".spf", ".eia", ".min"),
    *(".apt", ".aptsource", ".cls", ".cl", ".ncl", ".ncf", ".ptp", ".iso", ".h"),
    *(".din", ".dnc", ".fnc", ".hnc", ".ncc", ".pgm", ".prg", ".sub"),
)
NO_PROGRAMS = (
    *(".toml", ".urdf", ".csv", ".parquet", ".json", ".jsonl", ".xlsx", ".dxf", ".svg", ".html", ".htm"),
    *(".pdf", ".png", ".stl", ".obj", ".ply", ".3mf", ".vti", ".py"),
)
"""Endings of other files: a program of such a name would be taken for one."""

DOS_END, FILLING = b"\x1a", b"\x1a\0 \t\r\n"  # Ctrl-Z ends a program from DOS, whose last block is filled up
TAPE = b"\0\x03\x04\x11\x12\x13\x14\x7f"
"""What readers of tapes and serial lines pass over: no hole (NUL), ends of text, reader or punch on or off, rub-out."""
_CONTROLS = bytes(c for c in range(32) if c not in (9, 10, 12, 13, 27))
_GOTO = re.compile(
    rb"^[ \t]*(?:N?\d+[ \t]+)?(?:[A-Z]+[ \t]*(?:/[^\n(;]*)?;[ \t]*){0,9}"
    rb"(?:(?:GO[ \t]?TO|FROM)[ \t]*(?:/|[ \t][-+.\d]+[ \t]*,)|(?:PARTNO|UNITS|FEDRAT)[ \t]*/)",
    re.IGNORECASE | re.MULTILINE,
)


def read_source(source: Source) -> tuple[bytes, str]:
    """Bytes of the program (ASCII-compatible, "\\n" line ends not yet made) and a name for messages.

    A ``Path`` is a file, bytes are content. A string is a file if it has one line and either names an existing
    file or ends like a program's name; otherwise it is the program itself. Raises GCodeError for what cannot
    be read, is empty, too large or binary.
    """
    if isinstance(source, Path):
        return _read_file(source), source.name
    if isinstance(source, bytes | bytearray):
        return as_plain_bytes(bytes(source)), "program"
    if not isinstance(source, str):
        raise GCodeError(f"Program: expected text, bytes or a path, found {type(source).__name__}.")
    if _is_path(source):
        return _read_file(Path(source)), os.path.basename(source)
    return as_plain_bytes(source.encode("utf-8", "surrogateescape")), "program"


def is_apt(data: bytes) -> bool:
    """True if the bytes of a file look like APT-CL (statements such as GOTO/ near the start)."""
    return _GOTO.search(data[:200_000]) is not None


def check_program_name(place: Path) -> None:
    """Refuse to write a program under the name of another file. Raises GCodeError."""
    if place.suffix.lower() in NO_PROGRAMS:
        raise GCodeError(f"{shown_place(place)}: a program is written there; give a name that ends in .nc.")


def split_lines(text: str) -> list[str]:
    """Lines as the reader counts them, whatever ends them; the empty one after the last end is none."""
    lines = _plain_ends(text.encode("utf-8", "surrogateescape")).decode("utf-8", "surrogateescape").split("\n")
    return lines if lines[-1] else lines[:-1]


def _is_path(text: str) -> bool:
    if "\n" in text or "\r" in text or "\0" in text or not 0 < len(text) < 4096:
        return False
    try:
        return os.path.splitext(text)[1].lower() in SUFFIXES or os.path.isfile(text)
    except ValueError:
        return False


def named_as_file(refused: GCodeError, source: Source) -> GCodeError:
    """The refusal of what was read as a program; a text of one word may have been meant as the name of a file."""
    if not isinstance(source, str) or len(source.split()) != 1 or _is_path(source):
        return refused
    words = f"there is no file {source!r:.80}, and it is no program: {refused}"
    return GCodeError(words, line=refused.line)


def _read_file(path: Path) -> bytes:
    return as_plain_bytes(read_file(path, PROGRAM, GCodeError), path.name)


def as_plain_bytes(data: bytes, name: str = "Program") -> bytes:
    """``data`` without byte-order mark, UTF-16 and UTF-32 recoded to UTF-8, "\\r" line ends made "\\n".

    Raises GCodeError for an empty or binary file.
    """
    check_size(len(data), PROGRAM, GCodeError, name)
    for mark, encoding in (
        (codecs.BOM_UTF8, ""),
        (codecs.BOM_UTF32_LE, "utf-32"),
        (codecs.BOM_UTF16_LE, "utf-16"),
        (codecs.BOM_UTF16_BE, "utf-16"),
    ):
        if data.startswith(mark):
            data = data[len(mark) :] if not encoding else _recode(data, encoding, name)
            break
    text, _, rest = data.partition(DOS_END)
    data = _without_tape(data if rest.strip(FILLING) else text)
    if not data.strip():
        raise GCodeError(f"{name}: found an empty file; expected a program.")
    head = data[:65536]
    if _controls(head) * 100 > len(head):
        raise GCodeError(f"{name}: found a binary file; expected program text.")
    return _plain_ends(data)


def _without_tape(data: bytes) -> bytes:
    """``data`` as a control reads it that was sent it by DNC or tape. Raises GCodeError where a NUL byte is of a binary
    file: beside controls that no tape has."""
    if not any(sign in data for sign in TAPE):
        return data
    plain, nul = data.translate(None, TAPE), data.find(b"\0")
    if nul >= 0 and _controls(plain[:65536]):
        line = data.count(b"\n", 0, nul) + 1
        raise GCodeError.at(line, "found a NUL byte; this is a binary file, expected program text.")
    return plain


def _controls(head: bytes) -> int:
    return len(head) - len(head.translate(None, _CONTROLS))


def _plain_ends(data: bytes) -> bytes:
    """Lines that end as any machine ends them, each with "\n"."""
    return data.replace(b"\r\n", b"\n").replace(b"\r", b"\n") if b"\r" in data else data


def _recode(data: bytes, encoding: str, name: str) -> bytes:
    try:
        return data.decode(encoding).encode("utf-8")
    except UnicodeError as exc:
        raise GCodeError(f"{name}: starts like {encoding.upper()} text but is not; save it as plain text.") from exc
