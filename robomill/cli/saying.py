"""What every verb ends with: its record as JSON or as lines, the files it wrote, and its exit code."""

import sys
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from robomill import __version__
from robomill.console import harmless, put, shows_all


@dataclass(frozen=True)
class Written:
    """A file that a verb wrote, and whether one stood there before."""

    path: Path
    replaced: bool

    @classmethod
    def before(cls, paths: Sequence[Path]) -> "list[Written]":
        """What will have been written, asked before it is."""
        return [cls(path, path.exists()) for path in paths]

    @property
    def size(self) -> int:
        return self.path.stat().st_size if self.path.is_file() else 0

    def record(self) -> dict[str, Any]:
        return {"path": str(self.path), "bytes": self.size, "replaced": self.replaced}

    def line(self) -> str:
        """``wrote     out/result.json, 12 kB``."""
        from robomill.units import format_bytes

        return f"wrote     {self.path}, {format_bytes(self.size)}{', replacing an older one' * self.replaced}"


def say(
    arguments: Any,
    record: Mapping[str, Any],
    lines: Sequence[str],
    code: int = 0,
    files: Sequence[Written] | None = None,
) -> int:
    """Print the record as JSON, or its lines for a person; returns the exit code, also where nobody reads on.

    ``files`` are those that were written; None of a verb that writes none.
    """
    from robomill.io.results import json_text
    from robomill.report.plain import assumed_lines
    from robomill.report.records import jsonable

    if arguments.json:
        whole = {"robomill": __version__, **record}
        if files is not None:
            whole["files"] = [file.record() for file in files]
        text = json_text(jsonable(whole), ascii_only=not shows_all(sys.stdout))
    else:
        said = [*lines, *assumed_lines(record.get("assumed", ())), *(file.line() for file in files or ())]
        text = harmless("\n".join(said)) + "\n"
    put(text, sys.stdout)
    return code
