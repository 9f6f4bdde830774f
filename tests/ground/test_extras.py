"""What is not installed is named with the extra that brings it."""

from __future__ import annotations

import re
import tomllib
from importlib.util import find_spec
from pathlib import Path

import pytest

from robomill import extras
from robomill.errors import MissingExtraError
from robomill.extras import BROUGHT_BY, missing, needed

DECLARED = tomllib.loads((Path(__file__).resolve().parents[2] / "pyproject.toml").read_text())["project"]
OPTIONAL = DECLARED["optional-dependencies"]


def installs(extra: str) -> set[str]:
    """The packages of an extra, those of the extras that it names included."""
    found: set[str] = set()
    for line in OPTIONAL[extra]:
        name, inner = re.match(r"([\w.-]+)(?:\[([\w,]+)\])?", line).groups()  # type: ignore[union-attr]
        found |= {name.lower()} if inner is None else set().union(*(installs(each) for each in inner.split(",")))
    return found


@pytest.mark.parametrize("module", BROUGHT_BY)
def test_the_extra_that_is_named_brings_it_and_the_core_does_not(module: str) -> None:
    name, extra = BROUGHT_BY[module]
    assert name in installs(extra)
    assert name in installs("all")
    assert not any(line.lower().startswith(name) for line in DECLARED["dependencies"])


def test_what_is_missing_is_named_with_what_brings_it(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(BROUGHT_BY, "no_such_module", ("no-such-package", "film"))
    told = 'A film as MP4 needs no-such-package, which is not installed here; get it with: pip install "robomill[film]"'
    with pytest.raises(MissingExtraError) as caught, needed("A film as MP4"):
        import no_such_module  # noqa: F401
    assert str(caught.value) == told
    assert caught.value.extra == "film"
    assert str(missing("A film as MP4", "film", "numpy", "no_such_module")) == told
    assert missing("A film as MP4", "film", "numpy") is None


def test_another_module_that_is_missing_is_a_bug_and_seen() -> None:
    with pytest.raises(ModuleNotFoundError, match="no_such_module"), needed("A film"):
        import no_such_module  # noqa: F401
    with pytest.raises(ModuleNotFoundError, match="plotly.no_such_part"), needed("A figure"):
        import plotly.no_such_part  # noqa: F401


def test_asking_what_is_missing_imports_nothing(monkeypatch: pytest.MonkeyPatch) -> None:
    asked: list[str] = []
    monkeypatch.setattr(extras, "find_spec", lambda name: asked.append(name) or find_spec(name))
    assert missing("A surface", "render", "numpy", "scipy") is None
    assert asked == ["numpy", "scipy"]
