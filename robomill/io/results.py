"""A run's results as files."""

import json
import re
from collections.abc import Mapping
from contextlib import ExitStack
from pathlib import Path

from robomill.errors import ProjectError
from robomill.files import written

_HALVES = re.compile("[\ud800-\udfff]")  # names of files hold them for bytes that are no text


def write_files(folder: Path, files: Mapping[str, str | bytes]) -> None:
    """Write named files into ``folder``, made if need be: all of them, or none and a ProjectError."""
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError as exc:
        raise ProjectError(f"{folder}: cannot write there ({exc.strerror}); give another --out folder.") from None
    with ExitStack() as every:
        for name, content in files.items():
            place = every.enter_context(written(folder / name, ProjectError))
            place.write_bytes(content.encode() if isinstance(content, str) else content)


def json_text(record: object, ascii_only: bool = False) -> str:
    """A record as one JSON object; other characters escaped with ``ascii_only``, halves of one always."""
    text = json.dumps(record, indent=1, ensure_ascii=ascii_only, allow_nan=False) + "\n"
    return _HALVES.sub(lambda half: f"\\u{ord(half[0]):04x}", text)
