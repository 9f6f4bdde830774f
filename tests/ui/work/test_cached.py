"""What is kept for all sessions is found again by its numbers and its words: nobody is shown those of another."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable

import pytest

import robomill as rm
from robomill.provenance import Provenance
from robomill.simulation.setup import SimulationSetup
from robomill.ui.work import cached

MINE = Provenance("measured", "words that only I may see")
Change = Callable[[SimulationSetup], SimulationSetup]

WORDS: dict[str, Change] = {
    "provenance": lambda setup: setup.replace(provenance={**setup.provenance, "force": MINE}),
    "description": lambda setup: setup.replace(description="words that only I may see"),
    "name": lambda setup: setup.replace(name="words that only I may see"),
    "program": lambda setup: setup.replace(source=dataclasses.replace(setup.source, name="mine.nc")),  # type: ignore[type-var]
    "robot's provenance": lambda setup: setup.replace(robot=setup.robot.replace(provenance={"lengths": MINE})),
    "robot's title": lambda setup: setup.replace(robot=setup.robot.replace(title="my own arm")),
    "force": lambda setup: setup.replace(force=dataclasses.replace(setup.force, provenance=MINE)),  # type: ignore[type-var]
}


@pytest.mark.parametrize("words", WORDS)
def test_equal_numbers_with_other_words_are_another_entry(words: str) -> None:
    theirs = rm.load_setup("samples/paper_flute")
    mine = WORDS[words](theirs)
    cached.commons.clear()
    first = cached.result(theirs)
    assert cached.result(theirs) is first
    assert cached.held(mine) is None
    found = cached.result(mine)
    assert found.setup is mine
    assert "that only I may see" not in repr(cached.result(theirs).setup)
    assert len(cached.commons) == 2
