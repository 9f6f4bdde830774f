"""The source archive holds all that is in the repository, so that it can be tested, documented and packed from it."""

from __future__ import annotations

import shutil
import subprocess
import tarfile
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]


@pytest.mark.skipif(not (ROOT / ".git").exists() or not shutil.which("git"), reason="no repository to compare with")
def test_every_file_of_the_repository_is_in_it(tmp_path: Path) -> None:
    from hatchling.builders.sdist import SdistBuilder

    (built,) = SdistBuilder(str(ROOT)).build(directory=str(tmp_path), versions=["standard"])
    with tarfile.open(built) as archive:
        inside = {name.partition("/")[2] for name in archive.getnames()}
    listed = subprocess.run(["git", "ls-files"], cwd=ROOT, capture_output=True, text=True, check=True)
    assert {name for name in listed.stdout.split("\n") if name and (ROOT / name).is_file()} <= inside
    assert not [name for name in inside if "__pycache__" in name or name.startswith((".venv", "docs/_build"))]
