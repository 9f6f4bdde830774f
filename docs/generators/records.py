"""Keys of what the verbs print as JSON and columns of what they write, from records that are made here."""

from __future__ import annotations

import io
import json
from collections.abc import Collection, Iterator, Mapping
from contextlib import chdir, redirect_stdout
from fnmatch import fnmatchcase
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

from generators.formats import UnsaidKeyError
from generators.record_words import COLUMNS, COMMON, WORDS
from robomill.cli import main

ROBOT = "slavkovic_5r"
POINTS = ("--fit-points", "both", "--model", "joints+bending+tool")
RUNS: dict[str, tuple[tuple[str, ...], ...]] = {
    "robots": ((),),
    "pose": ((ROBOT, "--theta-deg", "0,0,0,0,0"),),
    "ik": ((ROBOT, "--pose", "0,-1300,0,0,0"),),
    "gcode": (("spiral", "--moves", "moves.jsonl"),),
    "map": ((ROBOT, "--quantity", "C_yy", "--z", "0", "--x", "0", "--y", "-1300", "--out", "map.csv"),),
    "identify": (
        (ROBOT, "nine_points", "--sheet", "sheet.csv"),
        (ROBOT, "tilted_bending_tool", *POINTS),
        (ROBOT, "one_joint_at_a_time"),
    ),
    "simulate": (
        ("paper_flute", "--out", "out"),
        ("paper_flute/setup_process",),
        ("paper_flute/setup_measured_map",),
        ("two_tools",),
    ),
    "report": (("paper_flute", "--out", "report.html"),),
    "advise": (("paper_flute/setup_process",),),
    "turn": (("paper_flute", "--robot", "fanuc_r2000ic"),),
    "place": (("paper_flute", "--x", "-200:200", "--y", "-2300:-1100", "--candidates", "30", "--out", "moved.toml"),),
    "design": (("paper_flute", "--tolerance-mm", "0.2"),),
    "compensate": (("paper_flute/setup_process", "--out", "corrected.nc"), ("two_tools", "--out", "corrected.nc")),
    "study": (("paper_flute/study", "--out", "study"),),
    "grade": (("answers", "--out", "marks.csv"),),
    "samples": (("heart",),),
    "reproduce": ((),),
}


def pages() -> dict[str, str]:
    """The generated pieces by name."""
    with TemporaryDirectory() as folder, chdir(folder):
        found = {verb: set().union(*(_keys(verb, words) for words in runs)) for verb, runs in RUNS.items()}
        headers = {name: Path("out", name).read_text(encoding="utf-8").splitlines()[0] for name in COLUMNS}
    parts = [_table("Many records", COMMON, set().union(*found.values()), None)]
    parts += [_table(f"`robomill {verb} --json`", words, found[verb], COMMON) for verb, words in WORDS.items()]
    columns = [_table(f"`{name}`", words, set(headers[name].split(",")), ()) for name, words in COLUMNS.items()]
    return {"records.md": "\n\n".join(parts), "columns.md": "\n\n".join(columns)}


def _keys(verb: str, words: tuple[str, ...]) -> set[str]:
    """Keys of what a verb prints."""
    said = io.StringIO()
    with redirect_stdout(said):
        main([verb, *words, "--json"])
    return {*_flat(json.loads(said.getvalue()))}


def _flat(value: Any, key: str = "") -> Iterator[str]:
    """The keys that hold something; of what is empty its own."""
    if isinstance(value, dict) and value:
        for name, each in value.items():
            yield from _flat(each, f"{key}.{name}" if key else name)
    elif isinstance(value, list) and value and isinstance(value[0], dict):
        for each in value:
            yield from _flat(each, f"{key}[]")
    else:
        yield key


def _tells(pattern: str, key: str) -> bool:
    """Whether a sentence is about a key, or about what would stand in it."""
    return fnmatchcase(key, pattern.replace("[", "[[]")) or pattern.startswith((f"{key}[", f"{key}."))


def _table(title: str, words: Mapping[str, str], found: set[str], elsewhere: Collection[str] | None) -> str:
    """A table of keys. Every key found has its sentence, here or ``elsewhere`` (None: this is a part of them)."""
    unsaid = {key for key in found if not any(_tells(pattern, key) for pattern in (*words, *(elsewhere or ())))}
    idle = [pattern for pattern in words if not any(_tells(pattern, key) for key in found)]
    if idle or (unsaid and elsewhere is not None):
        raise UnsaidKeyError(f"{title}: keys without a sentence: {sorted(unsaid)}; sentences without a key: {idle}.")
    rows = [f"| `{pattern}` | {text} |" for pattern, text in words.items()]
    return "\n".join([f"## {title}", "", "| key | meaning |", "|---|---|", *rows])
