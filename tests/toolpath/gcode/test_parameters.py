"""Numbered and named parameters against plain dictionaries: one for each level of subroutines, one for all."""

from __future__ import annotations

import math
import random

import pytest

from robomill.errors import GCodeError
from robomill.toolpath.gcode.expressions import Reader
from robomill.toolpath.gcode.parameters import COUNT, LEVELS, MAX_NAMED, READ_ONLY, RETURNED, Parameters
from robomill.toolpath.gcode.rules.flow_rules import enter_names

PROVIDED = {"_x": 4.5, "_y": -2.0}


def provide(key: str | int) -> float:
    return PROVIDED[key] if isinstance(key, str) else key / 10.0


@pytest.mark.parametrize("seed", range(6))
@pytest.mark.parametrize("names", [(), ("_x", "_y")])
def test_names_are_a_dictionary_a_level_and_one_for_all(names: tuple[str, ...], seed: int) -> None:
    r = random.Random(seed)
    store = Parameters(provide if names else None, names)
    everywhere: dict[str, float] = {}
    levels: list[dict[str, float]] = [{}]
    known = [*("_" * r.randint(0, 1) + "".join(r.choices("abz0", k=r.randint(1, 4))) for _ in range(200)), "_x2", "x"]
    for step in range(1500):
        name = r.choice(known)
        if r.random() < 0.5:
            (everywhere if name.startswith("_") else levels[-1])[name] = float(step)
            store.set(name, float(step))
        elif r.random() < 0.05 and len(levels) < LEVELS:
            levels.append({})
            enter_names(store.arrays)
        elif r.random() < 0.05 and len(levels) > 1:
            levels.pop()
            store.arrays.level[0] -= 1
        assert store.level == len(levels) - 1
        for asked in (name, r.choice(known)):
            expected = (everywhere if asked.startswith("_") else levels[-1]).get(asked)
            assert store.get_named(asked) == expected, asked
            if expected is not None:  # and as a line reads it
                assert Reader(f"#<{asked}>", 1, store).value() == expected
    for name, value in PROVIDED.items() if names else ():
        assert store.get_named(name) == value


def test_what_the_machine_provides_is_read_and_never_set() -> None:
    store = Parameters(provide, tuple(PROVIDED))
    for index in (5399, 5400, 5413, 5414, 5419, 5420, 5428, 5429):
        assert store.get(index) == (index / 10.0 if index in READ_ONLY else 0.0)
        if index in READ_ONLY:
            with pytest.raises(GCodeError, match=f"#{index} is provided by the machine"):
                store.set(index, 1.0)
        else:
            store.set(index, 7.0)
            assert store.get(index) == 7.0
    for name in PROVIDED:
        with pytest.raises(GCodeError, match=f"#<{name}> is provided by the machine"):
            store.set(name, 1.0)
    store.ask("_x")
    assert store.arrays.named[len(RETURNED)] == PROVIDED["_x"]
    store.arrays.figures[0] = 5421.0
    store.ask(None)
    assert store.arrays.numbered[5421] == 542.1
    store.forget()
    assert math.isnan(store.arrays.named[len(RETURNED)])
    assert math.isnan(store.arrays.numbered[5421])


def test_numbers_run_from_one_to_the_last() -> None:
    store = Parameters()
    for key in (1, 2, COUNT - 1):
        store.set(key, key / 2)
        assert store.get(key) == key / 2
    assert store.get(5220) == 1.0  # the first coordinate system
    for key in (0, -1, COUNT):
        with pytest.raises(GCodeError, match="does not exist"):
            store.set(key, 1.0)
        with pytest.raises(GCodeError, match="does not exist"):
            Reader(f"#{key}", 1, store).value()
    assert Reader(f"#{COUNT - 1}", 1, store).value() == (COUNT - 1) / 2
    store.put(7, [1.0, 2.0, 3.0])
    assert store.values(6, 5) == [0.0, 1.0, 2.0, 3.0, 0.0]


@pytest.mark.parametrize("names", [(), ("_x", "_y")])
def test_there_are_as_many_names_as_are_said(names: tuple[str, ...]) -> None:
    store = Parameters(provide if names else None, names)
    for k in range(MAX_NAMED):
        store.set(f"n{k}", float(k))
    with pytest.raises(GCodeError, match="more than"):
        store.set("one_more", 0.0)
    assert all(store.get_named(f"n{k}") == k for k in range(0, MAX_NAMED, 97))


@pytest.mark.parametrize(
    ("comment", "shown"),
    [
        ("", ""),
        ("plain", "plain"),
        ("at #1 and #1", "at 2.500000 and 2.500000"),
        ("#1#2", "2.500000-0.000010"),
        ("#<width>mm", "3.000000mm"),
        ("#< W idth >", "3.000000"),
        ("#<unknown>", "######"),
        ("#<open", "#<open"),
        ("#", "#"),
        ("##1", "#2.500000"),
        ("# 1", "# 1"),
        ("#0 #5602 #5601", "###### ###### 6.000000"),
        ("#3", "0.000000"),
        ("#4", "0.000001"),
        ("#99999999999", "######"),
        ("1 > 2 #<width>", "1 > 2 3.000000"),
    ],
)
def test_comments_show_values(comment: str, shown: str) -> None:
    store = Parameters()
    for key, value in ((1, 2.5), (2, -1e-5), (3, -9e-7), (4, 1e-6), (5601, 6.0), ("width", 3.0)):
        store.set(key, value)
    assert store.expand(comment) == shown
