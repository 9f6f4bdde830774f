"""The wheel carries app, pages, theme and samples, so that ``robomill`` starts from any folder."""

from __future__ import annotations

import re
import zipfile
from email import message_from_string
from email.message import Message
from pathlib import Path

import pytest
from trove_classifiers import classifiers

from robomill import __version__

ROOT = Path(__file__).resolve().parents[2]
ADDRESS = "https://github.com/robomill/robomill"


@pytest.fixture(scope="module")
def wheel(tmp_path_factory) -> zipfile.ZipFile:
    from hatchling.builders.wheel import WheelBuilder

    folder = tmp_path_factory.mktemp("wheel")
    (built,) = WheelBuilder(str(ROOT)).build(directory=str(folder), versions=["standard"])
    return zipfile.ZipFile(built)


@pytest.fixture(scope="module")
def names(wheel: zipfile.ZipFile) -> set[str]:
    return set(wheel.namelist())


@pytest.fixture(scope="module")
def told(wheel: zipfile.ZipFile) -> Message:
    """What an index shows of it."""
    (name,) = (name for name in wheel.namelist() if name.endswith(".dist-info/METADATA"))
    return message_from_string(wheel.read(name).decode())


def test_everything_the_app_needs_travels(names: set[str]) -> None:
    tracked = [ROOT / "app.py", *ROOT.glob("pages/*.py"), ROOT / ".streamlit/config.toml"]
    tracked += [f for f in ROOT.glob("samples/**/*") if f.is_file() and "__pycache__" not in f.parts]
    for file in tracked:
        assert f"robomill/_app/{file.relative_to(ROOT).as_posix()}" in names
    for file in ROOT.glob("robomill/**/*"):
        if file.is_file() and "__pycache__" not in file.parts:  # scripts, styles, pictures and the mark of types, too
            assert file.relative_to(ROOT).as_posix() in names
    assert "robomill/py.typed" in names


def test_nothing_else_does(names: set[str]) -> None:
    assert not [n for n in names if n.startswith(("tests/", "docs/")) or n.endswith((".pyc", ".ipynb"))]


def test_the_constraints_name_no_host_and_the_project_only_its_own() -> None:
    assert "://" not in (ROOT / "constraints.txt").read_text()
    named = re.findall(r"https?://[\w.-]+/robomill/robomill\b", (ROOT / "pyproject.toml").read_text())
    assert len(named) == (ROOT / "pyproject.toml").read_text().count("://")


def test_an_index_is_told_where_it_lives_and_whom_it_is_for(told: Message) -> None:
    assert told["Version"] == __version__
    links = dict(link.split(", ") for link in told.get_all("Project-URL", []))
    assert {"Homepage", "Documentation", "Source", "Issues", "Changelog"} <= set(links)
    assert all(link.startswith(ADDRESS) for link in links.values())
    said = set(told.get_all("Classifier", []))
    assert said <= classifiers
    assert {"Typing :: Typed", "Topic :: Scientific/Engineering"} <= said
    assert {"app", "render", "film", "data", "plot", "all"} <= set(told.get_all("Provides-Extra", []))


def test_the_readme_s_pictures_and_files_are_found_from_anywhere(told: Message) -> None:
    targets = re.findall(r"\]\(([^)]+)\)", str(told.get_payload()))
    assert targets
    for target in targets:
        assert target.startswith(("https://", "#")), target
