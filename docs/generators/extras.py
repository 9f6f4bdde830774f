"""What an installation brings, from the project's own declaration."""

from __future__ import annotations

import re
import tomllib
from pathlib import Path

PROJECT = Path(__file__).resolve().parents[2] / "pyproject.toml"
WORDS = {
    "app": "the app in the browser: `robomill` alone, `robomill serve`",
    "data": "tables and maps as pandas DataFrames, xarray and Parquet",
    "drawing": "paths along the lines of DXF and SVG drawings",
    "study": "studies: many runs of a set-up, kept as Parquet, here or on Dask",
    "plot": "the pictures that `robomill simulate --out` writes",
    "render": "rendered pictures of the machined part",
    "film": "films of the cut",
    "all": "all of these",
}
DEVELOPERS = {"docs", "test", "benchmark"}


def pages() -> dict[str, str]:
    """The generated piece by name."""
    project = tomllib.loads(PROJECT.read_text(encoding="utf-8"))["project"]
    extras = project["optional-dependencies"]
    if set(extras) != set(WORDS) | DEVELOPERS:
        raise ValueError(f"Extras without a sentence, or the reverse: {set(extras) ^ (set(WORDS) | DEVELOPERS)}.")
    rows = ["| install | brings | for |", "|---|---|---|"]
    rows.append(f"| `pip install robomill` | {_names(project['dependencies'])} | the library and the command line |")
    rows += [f'| `pip install "robomill[{name}]"` | {_names(extras[name])} | {what} |' for name, what in WORDS.items()]
    return {"extras.md": "\n".join(rows)}


def _names(requirements: list[str]) -> str:
    return ", ".join(re.split(r"[<>=;~! ]", each)[0] for each in requirements)
