"""Every public name loads what it says, for the reader and for the type checker alike."""

from __future__ import annotations

import ast
import inspect
import subprocess
import sys
from pathlib import Path

import pytest

import robomill as rm
from robomill.lazy import cached_property

ROOT = Path(__file__).resolve().parents[2]
STUB = ast.parse((ROOT / "robomill" / "__init__.pyi").read_text())
# Classes whose constructor is written down for type checkers, beside the one that the dataclass makes.
IN_UNITS = [found for name in rm.__all__ if hasattr(found := getattr(rm, name), "door") and found is not rm.Robot]


def test_type_checkers_pass_every_name_on() -> None:
    for node in ast.walk(STUB):
        for alias in node.names if isinstance(node, ast.ImportFrom) else ():
            assert alias.asname == alias.name, f"{alias.name}: only 'import x as x' is passed on to users"


@pytest.mark.parametrize("name", rm.__all__)
def test_every_name_loads_and_says_what_it_is(name: str) -> None:
    found = getattr(rm, name)
    assert found.__name__ == name
    assert found.__module__.startswith("robomill.")
    assert inspect.getdoc(found)


def test_completion_offers_every_name() -> None:
    assert {*rm.__all__} <= {*dir(rm)}
    fresh = "import robomill as rm; assert {*rm.__all__} <= {*dir(rm)}; assert 'numpy' not in __import__('sys').modules"
    subprocess.run([sys.executable, "-c", fresh], check=True)


def test_a_name_that_is_none_is_no_attribute() -> None:
    with pytest.raises(AttributeError, match="attribute compensat"):
        rm.compensat  # noqa: B018


def written_down(cls: type) -> set[str]:
    """Parameters of the constructor that a class states for type checkers."""
    (made,) = ast.parse(inspect.getsource(cls)).body
    (stated,) = (f for f in ast.walk(made) if isinstance(f, ast.FunctionDef) and f.name == "__init__")
    return {a.arg for a in (*stated.args.args, *stated.args.kwonlyargs)} - {"self"}


@pytest.mark.parametrize("cls", IN_UNITS, ids=lambda cls: cls.__name__)
def test_what_a_type_checker_is_told_is_what_the_constructor_takes(cls: type) -> None:
    assert written_down(cls) == {*inspect.signature(cls).parameters}


@pytest.mark.parametrize("name", rm.__all__)
def test_help_shows_what_is_asked_and_what_each_part_is(name: str) -> None:
    """No address of a function as a default, and no method or property without a word."""
    found = getattr(rm, name)
    assert " at 0x" not in str(inspect.signature(found))
    if not inspect.isclass(found):
        return
    for part, value in vars(found).items():
        made = inspect.isroutine(value) or isinstance(value, property | cached_property | classmethod)
        if not part.startswith("_") and made:
            assert inspect.getdoc(getattr(found, part)), f"{name}.{part}"
