"""What is kept for all sessions: bounded by the bytes it takes, made once, the longest unused forgotten first."""

from __future__ import annotations

import threading
from dataclasses import dataclass
from functools import cached_property

import numpy as np
import pytest

from robomill.errors import RobomillError
from robomill.ui.work.commons import ENTRY, Commons

MB = 1_000_000


@dataclass(frozen=True, eq=False)
class Grown:
    """A result that makes more of itself when it is looked at."""

    size: int

    @cached_property
    def surface(self) -> np.ndarray:
        return np.zeros(self.size, dtype=np.uint8)


def test_what_a_result_makes_of_itself_later_is_weighed_too() -> None:
    held = Commons(lambda: 10 * MB)
    first, second = Grown(6 * MB), Grown(6 * MB)
    held.put("a", first)
    held.put("b", second)
    assert len(held) == 2
    for key in "ab":
        assert len(held.find(key).surface) == 6 * MB
    held.put("c", 1)
    assert held.find("a") is None
    assert held.find("b") is second
    assert held.bytes <= 10 * MB


@pytest.mark.parametrize("size", [1, MB, 4 * MB])
def test_bytes_and_not_the_count_are_bounded(size: int) -> None:
    held = Commons(lambda: 10 * MB)
    for n in range(60):
        held.put(n, np.zeros(size, dtype=np.uint8))
        assert held.bytes <= 10 * MB
    assert len(held) == min(60, 10 * MB // (size + ENTRY))
    assert held.find(59) is not None


def test_the_last_stays_though_it_is_too_large_and_the_longest_unused_goes_first() -> None:
    held = Commons(lambda: 3 * MB)
    for name in "abc":
        held.put(name, np.zeros(MB - 2 * ENTRY, dtype=np.uint8))
    held.find("a")
    held.put("d", np.zeros(MB - 2 * ENTRY, dtype=np.uint8))
    assert held.find("b") is None
    assert held.find("a") is not None
    held.put("huge", np.zeros(5 * MB, dtype=np.uint8))
    assert len(held) == 1
    assert held.find("huge") is not None


def test_a_value_is_made_once_for_all_that_ask_at_the_same_time() -> None:
    held, made, gate = Commons(), [], threading.Event()

    def make() -> int:
        gate.wait(20)
        made.append(1)
        return 7

    answers: list[int] = []
    threads = [threading.Thread(target=lambda: answers.append(held.get("k", make))) for _ in range(8)]
    for thread in threads:
        thread.start()
    gate.set()
    for thread in threads:
        thread.join(20)
    assert answers == [7] * 8
    assert len(made) == 1


def test_none_is_an_answer_and_a_refusal_is_not_kept() -> None:
    held, made = Commons(), []

    def nothing() -> None:
        made.append(1)

    assert held.get("none", nothing) is None
    assert held.get("none", nothing) is None
    assert len(made) == 1

    def refuses() -> None:
        made.append(1)
        raise RobomillError("no")

    for _ in range(2):
        with pytest.raises(RobomillError):
            held.get("refused", refuses)
    assert len(made) == 3
