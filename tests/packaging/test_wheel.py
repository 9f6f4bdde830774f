"""The wheel carries app, pages, theme and samples, so that ``robomill`` starts from any folder."""

from __future__ import annotations

import zipfile
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]


@pytest.fixture(scope="module")
def names(tmp_path_factory) -> set[str]:
    from hatchling.builders.wheel import WheelBuilder

    folder = tmp_path_factory.mktemp("wheel")
    (wheel,) = WheelBuilder(str(ROOT)).build(directory=str(folder), versions=["standard"])
    return set(zipfile.ZipFile(wheel).namelist())


def test_everything_the_app_needs_travels(names: set[str]) -> None:
    tracked = [ROOT / "app.py", *ROOT.glob("pages/*.py"), ROOT / ".streamlit/config.toml"]
    tracked += [f for f in ROOT.glob("samples/**/*") if f.is_file() and "__pycache__" not in f.parts]
    for file in tracked:
        assert f"robomill/_app/{file.relative_to(ROOT).as_posix()}" in names
    for file in ROOT.glob("robomill/**/*.py"):
        assert file.relative_to(ROOT).as_posix() in names


def test_nothing_else_does(names: set[str]) -> None:
    assert not [n for n in names if n.startswith("tests/") or n.endswith((".pyc", ".ipynb"))]


def test_no_lock_file_or_constraint_names_a_host() -> None:
    text = (ROOT / "constraints.txt").read_text() + (ROOT / "pyproject.toml").read_text()
    assert "://" not in text
