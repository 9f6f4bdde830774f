"""Paths given point by point in set-up files: read back to the same digest, refused by key."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings, strategies as st

import robomill as rm
from robomill.errors import ProjectError
from robomill.io.setups.projects import setup_from_toml, setup_to_toml
from robomill.toolpath.path import Toolpath

PAPER = rm.load_setup("samples/paper_flute")
PATH = rm.Toolpath.from_points(p_mm=[[0, 0, 5], [0, 0, -2], [60, 0, -2]], feed_mm_min=[0, 300, 1800])


def back(path: Toolpath) -> rm.SimulationSetup:
    setup = PAPER.replace(source=path)
    again = setup_from_toml(setup_to_toml(setup))
    assert again.digest() == setup.digest()
    return again


def test_points_come_back_and_usual_things_are_not_written() -> None:
    again = back(PATH)
    assert again.source.kind == "points"
    assert again.toolpath.digest() == PATH.digest()
    (table,) = (part for part in setup_to_toml(again).split("\n[") if part.startswith("path]"))
    keys = [line.split(" = ")[0] for line in table.splitlines() if " = " in line]
    assert keys == ["points_mm", "points_name", "feed_mm_min"]


@settings(max_examples=25, deadline=None)
@given(seed=st.integers(0, 10**9))
def test_any_path_comes_back_bit_by_bit(seed: int) -> None:
    rng = np.random.default_rng(seed)
    m = int(rng.integers(2, 30))
    k = rng.normal(size=(m, 3))
    path = Toolpath(
        p=rng.normal(size=(m, 3)),
        k=k / np.linalg.norm(k, axis=1, keepdims=True),
        v_f=rng.uniform(0, 0.1, m),
        cutting=rng.random(m) < 0.7,
        block=rng.integers(1, 90, m),
        n_s=np.where(rng.random(m) < 0.2, np.nan, rng.uniform(0, 300, m)),
        tool=rng.integers(0, 5, m),
        ccw=rng.random(m) < 0.5,
        thread=rng.random(m) < 0.5,
        dwell=rng.uniform(0, 1, m),
        units="in",
    )
    back(path)


def test_a_path_that_was_read_can_be_given_as_it_is() -> None:
    """The paper's program as a toolpath: the same run as from the program, to the last bit."""
    one, other = rm.simulate(PAPER), rm.simulate(back(PAPER.toolpath))
    assert np.array_equal(one.delta, other.delta)
    assert np.array_equal(one.path.block, other.path.block)
    assert one.verdict.level == other.verdict.level


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        ("feed_mm_min", "feed_mm_mn", "feed_mm_min: missing"),
        ("points_name", "axis = [[0, 0, 1]]\npoints_name", "axis: expected 3 rows"),
        ("points_name", "axis = [[0, 0, 2], [0, 0, 2], [0, 0, 2]]\npoints_name", "length that is not 1"),
        ("points_name", "tool = [1, 2]\npoints_name", "tool: expected 3 values"),
        ("points_name", "cutting = [1, 0, 1]\npoints_name", "cutting: expected a list of true and false"),
        ("points_name", "lines_mm = []\npoints_name", "expected one of"),
        ("points_name", "name = 3\npoints_name", "name: this key is not known"),
    ],
)
def test_what_cannot_be_is_refused_by_its_key(old: str, new: str, words: str) -> None:
    text = setup_to_toml(PAPER.replace(source=PATH))
    with pytest.raises(ProjectError, match=words):
        setup_from_toml(text.replace(old, new, 1))
