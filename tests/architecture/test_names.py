"""A reader finds the tests of a module by its name: tests mirror the package, a file begins with the module it tests.

``robomill/kinematics/inverse.py`` is tested by ``tests/kinematics/test_inverse.py``, and by ``test_inverse_5r.py``
where that grew too long. Tests of whole walks through several rooms stand in folders that name their subject.
"""

from __future__ import annotations

from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
# What is no room of the package: tests of everything at once, by what they are about.
SUBJECTS = ("architecture", "benchmarks", "cli", "convergence", "docs", "packaging", "paper", "properties", "samples")
SCREEN = ("pages", "browser")
FILES = sorted(p for p in (ROOT / "tests").rglob("test_*.py") if p.relative_to(ROOT / "tests").parts[0] not in SUBJECTS)


def names(folder: Path) -> set[str]:
    """Modules and packages of a folder."""
    return {p.stem for p in folder.iterdir() if p.suffix == ".py" or (p / "__init__.py").is_file()} - {"__init__"}


def namesakes(file: Path) -> set[str]:
    """What a test file of this folder may be named by: modules of its room, or what stands beside it."""
    room = file.parent.relative_to(ROOT / "tests").as_posix()
    beside = {p.stem for p in file.parent.glob("*.py") if not p.stem.startswith("test_")}
    if room in SCREEN:
        pages = {p.stem.partition("_")[2].lower() for p in (ROOT / "pages").glob("*.py")}
        return beside | pages | {p.parent.name for p in (ROOT / "robomill" / "ui").glob("*/__init__.py")}
    return beside | names(ROOT / "robomill" / ("" if room == "ground" else room))


@pytest.mark.parametrize("file", FILES, ids=lambda f: f.relative_to(ROOT / "tests").as_posix())
def test_a_test_is_named_by_the_module_it_tests(file: Path) -> None:
    about = file.stem.removeprefix("test_")
    assert any(about == name or about.startswith(f"{name}_") for name in namesakes(file))
