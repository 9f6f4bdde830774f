"""The scripts of the how-to, each with its first sentence as its title and what it prints below it."""

from __future__ import annotations

import ast
from pathlib import Path

HEAD = """## Whole scripts

Written with these pages only. A test runs each as it stands, and `mypy --strict` passes on them."""
SCRIPTS = Path(__file__).resolve().parents[1] / "scripts"


def pages() -> dict[str, str]:
    """The generated piece by name; without scripts it says nothing."""
    found = sorted(SCRIPTS.glob("*.py"))
    return {"scripts.md": "\n\n".join([HEAD, *map(_section, found)]) if found else "% no script yet\n"}


def _section(script: Path) -> str:
    words = ast.get_docstring(ast.parse(script.read_text(encoding="utf-8"))) or script.stem.replace("_", " ")
    title = words.splitlines()[0].rstrip(".")
    said = f"### {title}\n\n```{{literalinclude}} scripts/{script.name}\n:language: python\n```"
    if script.with_suffix(".txt").is_file():
        said += f"\n\n```{{literalinclude}} scripts/{script.stem}.txt\n:language: text\n```"
    return said
