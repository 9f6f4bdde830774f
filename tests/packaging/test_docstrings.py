"""What a public name promises: every part of its docstring is there, and its example prints what it says."""

from __future__ import annotations

import doctest
import inspect
import re
from types import ModuleType
from typing import Any

import pytest

import robomill as rm
from robomill import learn

EVERY = [*((rm, name) for name in rm.__all__), *((learn, name) for name in learn.__all__)]
OPTIONS = doctest.NORMALIZE_WHITESPACE | doctest.ELLIPSIS
NOTHING_REFUSED = {"material_names", "robot_names", "map_quantities", "sample_names", "samples"}  # they take any input
HEAD = re.compile(r"^(\w+)\n-+$", re.MULTILINE)


def own_methods(kind: type) -> list[tuple[str, Any]]:
    """Public methods and constructors that a class of ours defines."""
    found = ((name, getattr(kind, name)) for name in vars(kind) if not name.startswith("_"))
    return [(name, each) for name, each in found if inspect.isroutine(each)]


def sections(documented: Any) -> dict[str, str]:
    """Sections of a docstring by their heads."""
    text = inspect.getdoc(documented) or ""
    parts = HEAD.split(text)
    return dict(zip(parts[1::2], parts[2::2], strict=True))


def called(given: Any) -> str:
    return given if isinstance(given, str) else str(given.__name__)


@pytest.mark.parametrize(("room", "name"), EVERY, ids=called)
def test_a_public_name_says_what_it_takes_gives_and_refuses(room: ModuleType, name: str) -> None:
    public = getattr(room, name)
    found, said = sections(public), inspect.getdoc(public) or ""
    assert re.match(r"\S.*[.:]$", said.partition("\n\n")[0].replace("\n", " ")), "a summary in a sentence"
    assert ">>> " in found.get("Examples", ""), "an example"
    if inspect.isclass(public):
        return
    taken = [each for each in inspect.signature(public).parameters if each not in ("choices", "given")]
    for parameter in taken:
        assert re.search(rf"^(.*, )?{parameter}(,.*)? :", found["Parameters"], re.MULTILINE), parameter
    assert found["Returns"].strip()
    assert name in NOTHING_REFUSED or re.search(r"^\w+Error$", found["Raises"], re.MULTILINE)


@pytest.mark.parametrize(("room", "name"), [each for each in EVERY if inspect.isclass(getattr(*each))], ids=called)
def test_a_public_method_says_what_it_is(room: ModuleType, name: str) -> None:
    silent = [each for each, method in own_methods(getattr(room, name)) if not (inspect.getdoc(method) or "").strip()]
    assert not silent


@pytest.mark.parametrize(("room", "name"), EVERY, ids=called)
def test_an_example_prints_what_it_says(room: ModuleType, name: str) -> None:
    public = getattr(room, name)
    found = doctest.DocTestFinder(recurse=inspect.isclass(public)).find(public, name, globs={})
    tests = [test for test in found if test.examples]
    assert tests
    for test in tests:
        said: list[str] = []
        result = doctest.DocTestRunner(optionflags=OPTIONS).run(test, out=said.append)
        assert not result.failed, "".join(said)
