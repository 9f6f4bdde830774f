"""Findings as sentences and records, and numbers named in a sentence."""

from __future__ import annotations

import pytest

from robomill.errors import RobomillError
from robomill.provenance import KINDS, Finding, Provenance, kind_word, named


def test_a_finding_says_its_line_and_keeps_its_code() -> None:
    found = Finding("warning", "it rubs.", 12, count=3, code="rubs")
    assert found.sentence == "Line 12: it rubs."
    assert Finding("warning", "It rubs.").sentence == "It rubs."
    assert found.record() == {"level": "warning", "line": 12, "message": "it rubs.", "count": 3, "code": "rubs"}


@pytest.mark.parametrize(
    ("numbers", "words"),
    [((), ""), ((7,), "7"), ((9, 3, 3, 5), "3, 5, 9"), (range(4, 0, -1), "1, 2, 3 and more")],
)
def test_numbers_are_named_once_in_order_and_not_all_of_many(numbers, words) -> None:
    assert named(numbers) == words


def test_a_provenance_is_of_a_kind() -> None:
    with pytest.raises(RobomillError, match="kind is 'guessed'; expected one of paper, "):
        Provenance("guessed", "a hunch")  # type: ignore[arg-type]


def test_what_was_stated_for_another_path_is_assumed_there_and_keeps_where_it_came_from() -> None:
    measured = Provenance("measured", "dynamometer")
    once = measured.carried("Flute")
    assert (once.kind, once.carried_from) == ("assumed", "Flute")
    assert once.carried("Pocket") == once
    assert measured.carried_from == ""
    assert Provenance(**once.record()) == once
    assert measured.record() == {"kind": "measured", "source": "dynamometer"}


def test_what_a_paper_gives_is_published() -> None:
    assert [kind_word(kind) for kind in KINDS] == ["published", *KINDS[1:]]
