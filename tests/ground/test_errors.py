"""Refusals: one family, each with its sentence and its place as data."""

from __future__ import annotations

import pytest

from robomill import errors
from robomill.errors import GCodeError, RobomillError, ToolpathError

FAMILY = [kind for kind in vars(errors).values() if isinstance(kind, type) and issubclass(kind, Exception)]


@pytest.mark.parametrize("kind", FAMILY, ids=lambda kind: kind.__name__)
def test_every_refusal_is_caught_as_one_and_as_a_wrong_value(kind: type[RobomillError]) -> None:
    refusal = kind("Line 3: no.")
    assert isinstance(refusal, RobomillError)
    assert isinstance(refusal, ValueError)
    assert str(refusal) == "Line 3: no."
    assert refusal.where is None


def test_the_place_is_data() -> None:
    assert RobomillError("no.", where="row 2").where == "row 2"
    assert GCodeError("no.", line=3).where == "line 3"
    assert GCodeError("no.", line=3).line == 3
    assert GCodeError("no.").where is None
    assert GCodeError("no.").line == 0
    assert issubclass(GCodeError, ToolpathError)


@pytest.mark.parametrize("kind", [RobomillError, GCodeError])
def test_a_word_without_an_end_is_not_quoted_to_its_end(kind: type[RobomillError]) -> None:
    said = str(kind(f"Line 3: {'A' * 5000} is not known; {'b' * 299} is."))
    assert said == f"Line 3: {'A' * 100}… is not known; {'b' * 299} is."
