"""The one door through which a file that another file names is opened.

What comes through a browser names no file: everything is in it. A set-up read from a folder may name what lies there or
below, and the samples; anything else only where its reader allows it.
"""

import os
from dataclasses import dataclass
from pathlib import Path

from robomill.errors import RobomillError
from robomill.files import FileKind, read_file
from robomill.io.samples import samples_dir
from robomill.io.tables import PATHS, Table

ALLOW = "--allow-outside"


@dataclass(frozen=True)
class Beside:
    """Which files may be named: those in ``folder`` and below (None: none at all), with ``outside`` any."""

    folder: Path | None = None
    outside: bool = False

    def read(self, table: Table, key: str, kind: FileKind) -> tuple[bytes, str]:
        """Bytes and name of the file that ``key`` names; what may not be named is not even looked for."""
        named = table.text(key)
        if self.folder is None:
            raise table.refuse(
                key,
                f"{named!r:.60} is the name of a file, expected what is in it ({kind.expected}): what is opened here "
                "names no files. Open that file on its own page, or save the project in the app, which puts it in.",
            )
        if not named.isprintable():
            raise table.refuse(key, f"{named!r:.80} is no name of a file. {PATHS}")
        place = self.place(self.folder, named)
        if place is None:
            raise table.refuse(
                key,
                f"{named!r:.80} is not in the folder of the set-up nor below it; bring it there, or allow it with "
                f"{ALLOW}.",
            )
        try:
            return read_file(place, kind, table.error, regular=True, said=named), Path(named).name
        except RobomillError as exc:
            raise table.refuse(key, str(exc)) from None

    def place(self, folder: Path, named: str) -> Path | None:
        """Where a file named in ``folder`` is, links followed; None where it may not be."""
        if "\0" in named or Path(named).drive not in ("", folder.drive):  # another machine is not even asked
            return None
        roots = [Path(os.path.realpath(root)) for root in (folder, samples_dir())]
        for name in dict.fromkeys((named.replace("\\", "/"), named)):  # as Windows writes it, and as it stands
            place = Path(os.path.realpath(folder / name))
            allowed = self.outside or any(place.is_relative_to(root) for root in roots)
            if allowed and (name == named or os.path.exists(place)):
                return place
        return None


ALONE = Beside()
