"""A run's results as files."""

from __future__ import annotations

import json
from collections.abc import Mapping
from pathlib import Path

from robomill.errors import ProjectError


def write_files(folder: Path, files: Mapping[str, str | bytes]) -> None:
    """Write named files into ``folder``, made if need be; ProjectError where that cannot be done."""
    try:
        folder.mkdir(parents=True, exist_ok=True)
        for name, content in files.items():
            (folder / name).write_bytes(content.encode() if isinstance(content, str) else content)
    except OSError as exc:
        raise ProjectError(f"{folder}: cannot write there ({exc.strerror}); give another --out folder.") from None


def json_text(record: object) -> str:
    return json.dumps(record, indent=1, ensure_ascii=False, allow_nan=False) + "\n"
