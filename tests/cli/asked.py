"""The command line as a test asks it."""

from __future__ import annotations

import json

from robomill.cli import main


def run(capsys, *words: object) -> tuple[int, str, str]:
    """Exit code, and what stands on the screen and on the channel of errors."""
    code = main([str(w) for w in words])
    out, err = capsys.readouterr()
    return code, out, err


def record(capsys, *words: object) -> dict:
    """The JSON object of a verb that is done."""
    code, out, err = run(capsys, *words, "--json")
    assert code == 0, err
    return json.loads(out)
