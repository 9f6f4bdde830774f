"""What a study can ask of every run, from its own declaration."""

from __future__ import annotations

from robomill.study.responses import RESPONSES, USUAL


def pages() -> dict[str, str]:
    """The generated piece by name."""
    rows = ["| response | is | asked for by itself |", "|---|---|---|"]
    rows += [f"| `{name}` | {each.title} | {'yes' if name in USUAL else ''} |" for name, each in RESPONSES.items()]
    return {"responses.md": "\n".join(rows)}
