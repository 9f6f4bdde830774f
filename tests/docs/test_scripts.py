"""The scripts of the how-to run as they stand, in a folder of their own, and print what the page shows of them."""

from __future__ import annotations

import os
import subprocess
import sys

import pytest

from tests.docs.documents import DOCS, ROOT

SCRIPTS = sorted((DOCS / "scripts").glob("*.py"))


@pytest.mark.parametrize("script", SCRIPTS, ids=lambda file: file.stem)
def test_a_script_runs_and_prints_what_stands_beside_it(script, tmp_path):
    said = {"PYTHONPATH": str(ROOT), "MPLBACKEND": "Agg", "PYTHONIOENCODING": "utf-8"}
    done = subprocess.run(
        [sys.executable, str(script)],
        cwd=tmp_path,
        env=os.environ | said,
        capture_output=True,
        encoding="utf-8",
        timeout=300,
    )
    assert done.returncode == 0, done.stderr[-3000:]
    shown = script.with_suffix(".txt")
    if shown.is_file():
        assert done.stdout.split() == shown.read_text(encoding="utf-8").split()


@pytest.mark.skipif(not SCRIPTS, reason="there is no script yet")
def test_strict_types_are_seen_in_the_scripts():
    """What a user's own ``mypy --strict`` says: robomill's types reach it."""
    command = [
        sys.executable,
        "-m",
        "mypy",
        "--strict",
        "--config-file=",
        "--follow-imports=silent",
        "--ignore-missing-imports",
        *map(str, SCRIPTS),
    ]
    done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, timeout=300)
    assert done.returncode == 0, done.stdout[-3000:]
