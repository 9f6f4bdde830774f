"""Programs as people bring them: files and bytes in any encoding, refused where they are no text."""

from pathlib import Path

from robomill.arguments import asked
from robomill.errors import ProjectError
from robomill.files import PROGRAM, check_size, name_of, read_file
from robomill.io.samples import sample_or_file
from robomill.toolpath.source import GCodeSource


@asked
def read_program(path: str | Path, dialect: str = "auto") -> GCodeSource:
    """A program's file as the source of a set-up's path.

    Parameters
    ----------
    path : str or Path
        G-code or APT, or the name of a sample.
    dialect : str
        "auto" guesses and says so.

    Returns
    -------
    GCodeSource
        The text with its name; it is read as a path when the set-up asks for it.

    Raises
    ------
    ProjectError
        Where the file is missing, too large or not text.

    Examples
    --------
    >>> import robomill as rm
    >>> rm.read_program("heart").name
    'heart.nc'
    """
    file = sample_or_file("program", path, ProjectError)
    return program_from_bytes(read_file(file, PROGRAM, ProjectError), name_of(file), dialect)


def program_from_bytes(data: bytes, name: str, dialect: str = "auto") -> GCodeSource:
    """What a person dropped or named, as a source (UTF-8, UTF-16 with its mark, else Latin-1)."""
    check_size(len(data), PROGRAM, ProjectError, name)
    if data.startswith((b"\xff\xfe", b"\xfe\xff")):
        return GCodeSource(data.decode("utf-16", errors="replace"), name, dialect)
    if b"\0" in data[:4096]:
        raise ProjectError(f"{name}: this is a binary file; expected a program in text (G-code).")
    if not data.strip():
        raise ProjectError(f"{name}: the file is empty; expected a program in text (G-code).")
    try:
        return GCodeSource(data.decode("utf-8-sig"), name, dialect)
    except UnicodeDecodeError:
        return GCodeSource(data.decode("latin-1"), name, dialect)
