"""The one place where files are opened: read up to a limit of their kind, written whole or not at all."""

import os
import stat
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from robomill.arrays import brief
from robomill.errors import RobomillError
from robomill.units import format_number

LONGEST_PLACE = 80  # characters of a path that a refusal shows


@dataclass(frozen=True)
class FileKind:
    """A kind of file: what a refusal says was ``expected``, and how many megabytes of it are read at most."""

    expected: str
    most_MB: int
    any_code: bool = False  # text may be in the code page of western Windows, as Excel saves it
    smaller: str = ""  # what makes one smaller

    @property
    def most(self) -> int:
        """Bytes that are read at most."""
        return self.most_MB * 1_000_000


PROGRAM = FileKind("a program in text (G-code or APT)", 200, smaller="; split the program")
SETUP = FileKind("a set-up (.toml)", 25)
STUDY = FileKind("a study (.toml)", 5)
ROBOT = FileKind("a robot (.toml or .urdf)", 5)
MATERIAL = FileKind("a material row (.toml)", 1)
TOOLS = FileKind("a tool table (.tbl, .csv or .toml)", 2, any_code=True)
TABLE = FileKind("a CSV table", 60, any_code=True, smaller="; split the table")
POINTS = FileKind("points of a path (.csv or .parquet)", 60, any_code=True, smaller="; split the table")
DRAWING = FileKind("a drawing (.dxf or .svg)", 10)
STL = FileKind("a stock as STL, OBJ, PLY or 3MF", 80, smaller="; coarsen its mesh")


def read_file(
    path: str | Path, kind: FileKind, error: type[RobomillError], *, regular: bool = False, said: str = ""
) -> bytes:
    """What the file holds. Raises ``error`` where it cannot be opened, or holds more than its ``kind`` may.

    A pipe or a device is read up to the limit, which is for whoever names it himself; ``regular`` refuses it unread.
    ``said`` is what refusals call the file, its path unless given.
    """
    check_place(path, kind.expected, error)
    place = shown_place(said or path)
    calm = getattr(os, "O_NONBLOCK", 0) if regular else 0  # a pipe that nobody writes to is opened without waiting
    try:
        with open(os.open(path, os.O_RDONLY | getattr(os, "O_BINARY", 0) | calm), "rb") as stream:
            status = os.fstat(stream.fileno())
            if regular and not stat.S_ISREG(status.st_mode):
                raise error(f"{place}: this is a pipe or a device; expected {kind.expected}.")
            data = b"" if status.st_size > kind.most else stream.read(kind.most + 1)
            size = max(status.st_size if stat.S_ISREG(status.st_mode) else 0, len(data))
    except (OSError, ValueError) as exc:
        if isinstance(exc, RobomillError):
            raise
        why = getattr(exc, "strerror", None) or exc
        raise error(f"{place}: cannot be opened ({why}); expected {kind.expected}.") from None
    check_size(size, kind, error, place)
    return data


def check_place(given: Any, expected: str, error: type[RobomillError]) -> None:
    """Refuse what is no file's name: a number, a table, a value that was given in its place."""
    if not isinstance(given, str | os.PathLike):
        raise error(f"Expected the name of a file, found {brief(given)}; expected {expected}.")


def name_of(path: str | Path) -> str:
    """The name of a file as text that can be kept and written; bytes that are none are marked."""
    return os.fsencode(Path(path).name).decode("utf-8", "replace")


def check_size(size: int, kind: FileKind, error: type[RobomillError], place: str) -> None:
    """Refuse what is larger than its kind may be."""
    if size > kind.most:
        found = format_number(size / 1e6, 1) if size > kind.most + 1 else f"more than {kind.most_MB}"
        raise error(f"{place}: found {found} MB, expected {kind.expected} of at most {kind.most_MB} MB{kind.smaller}.")


def shown_place(path: str | Path) -> str:
    """A path as refusals show it: of a long one its end, where the file's name is."""
    text = str(path)
    return text if len(text) <= LONGEST_PLACE else f"…{text[1 - LONGEST_PLACE :]}"


def check_no_folder(path: str | Path, said: str, error: type[RobomillError]) -> None:
    """Refuse a folder where a file is to be written; ``said`` is what the refusal calls the place."""
    if Path(path).is_dir():
        raise error(f"{said}: this is a folder; give the name of a file.")


def check_folder_there(path: str | Path, said: str, error: type[RobomillError]) -> None:
    """Refuse a place in a folder that is not there."""
    folder = Path(path).parent
    if not folder.is_dir():
        raise error(f"{said}: the folder {shown_place(folder)} is not there; make it first.")


def write_whole(path: str | Path, content: str | bytes, error: type[RobomillError]) -> Path:
    """Write a file, its text as UTF-8, whole or not at all (see ``written``). Returns its place."""
    with written(path, error) as place:
        place.write_bytes(content.encode() if isinstance(content, str) else content)
    return Path(path)


@contextmanager
def written(path: str | Path, error: type[RobomillError], advice: str = "give another place.") -> Iterator[Path]:
    """Where to write what shall stand at ``path``: beside it, and put in its place when it is complete.

    Nothing is left where that fails, and what stood there before stays; raises ``error`` then, with the ``advice``. A
    pipe or a device is written to as it is.
    """
    try:
        target = Path(os.path.realpath(path))
        if target.exists() and not target.is_file():
            yield target
            return
        beside = target.with_name(f".{target.stem[:100]}.{os.getpid()}.part{target.suffix}")
        try:
            yield beside
            with beside.open("rb+") as complete:
                os.fsync(complete.fileno())
            beside.replace(target)
        finally:
            with suppress(OSError):
                beside.unlink(missing_ok=True)
    except (OSError, ValueError) as exc:
        if isinstance(exc, RobomillError):
            raise
        why = getattr(exc, "strerror", None) or exc
        raise error(f"{shown_place(path)}: cannot be written ({why}); {advice}") from None
