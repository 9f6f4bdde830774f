"""Where samples stand that are corrected: ways down and what goes on from them, the room that it has, ways out."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

import robomill as rm
from robomill.improve.correction import Places

PUSHED = 0.1e-3  # m: how far the tool is off everywhere
RAMP, PLUNGE = np.array([5e-3, 0.0, -1e-3]), np.array([0.0, 0.0, -2e-3])


def places_of(parts: list[tuple[np.ndarray, float]]) -> tuple[Places, list[int], list[tuple[int, int]]]:
    """A rapid, then ways down in two steps each, behind which a level cut begins on the spot, with a first step of so
    much, a second one and a way out along the tool; the samples that go out, and those of ways down with the first one
    of the cut that goes on."""
    steps, along, out, down = [np.zeros(3)], [0.0], [], []
    for way, room in parts:
        first = len(steps)
        ways = [way, way, np.zeros(3), np.array([0.0, room, 0.0]), np.array([0.0, 9e-3, 0.0]), -2.0 * way * [0, 0, 1]]
        steps += ways
        along += [way[2] / np.linalg.norm(way)] * 2 + [0.0, 0.0, 0.0, 1.0]
        down += [(first, first + 2), (first + 1, first + 2)]
        out.append(first + 5)
    p, rise = np.cumsum(steps, axis=0), np.array(along)
    path = rm.Toolpath.from_points(p, 0.03, cutting=np.arange(len(p)) > 0)
    conditions = SimpleNamespace(along=rise, mostly_axial=np.abs(rise) > 0.9)
    delta = np.tile([0.0, 0.6 * PUSHED, 0.8 * PUSHED], (len(p), 1))
    return Places.along(run_along(path, conditions, delta)), out, down


def run_along(path: rm.Toolpath, conditions: SimpleNamespace, delta: np.ndarray, coupling: bool = False) -> Any:
    """A run whose feeds lead the way of each step across the tool, or of the next one where a step goes nowhere."""
    across = np.diff(path.p, axis=0, prepend=path.p[:1])[:, :2]
    for i in reversed(range(len(across) - 1)):
        across[i] = across[i] if across[i].any() else across[i + 1]
    x = across / np.maximum(np.linalg.norm(across, axis=1, keepdims=True), 1e-12)
    feed = np.column_stack([x, np.zeros(len(x))])
    axis = np.tile([0.0, 0.0, 1.0], (len(x), 1))
    R_MF = np.stack([feed, np.cross(axis, feed), axis], axis=-1)
    block = SimpleNamespace(upper=np.zeros(3))
    setup = SimpleNamespace(T_MW=np.eye(4), coupling=coupling, stock_block=block)
    over = path.p[:, 2] < 0.0
    return SimpleNamespace(path=path, conditions=conditions, delta=delta, R_MF=R_MF, setup=setup, over_stock=over)


def hole(heights: list[float], feeds: list[float], push: float = PUSHED) -> tuple[rm.Toolpath, Places]:
    """Straight down over the origin to ``heights`` mm, 0 a rapid, where all is pushed up by ``push`` m."""
    p = np.array([[0.0, 0.0, z] for z in heights]) * 1e-3
    path = rm.Toolpath.from_points(p, np.array(feeds), cutting=np.array(feeds) > 0.0)
    steep = np.ones(len(p), dtype=bool)
    conditions = SimpleNamespace(along=-np.ones(len(p)), mostly_axial=steep)
    return path, Places.along(run_along(path, conditions, np.tile([0.0, 0.0, push], (len(p), 1))))


@pytest.mark.parametrize(
    ("heights", "feeds", "early"),
    [
        ([9, 0.1, 0.1, -1], [0, 0, 0.03, 0.03], [0, 1, 1, 0]),  # a rapid to just above the part
        ([9, 5, 5, -1], [0, 0, 0.03, 0.03], [0, 0, 0, 0]),  # to far above it: it stays above it
        ([9, -1, -1, -2], [0, 0, 0.03, 0.03], [0, 1, 1, 0]),  # to the bottom of a hole
        ([9, 9, 5, 0.1, -1], [0, 0.1, 0.1, 0.1, 0.03], [0, 1, 1, 1, 0]),  # fast, then slowly: all of the fast way
        ([9, 9, 5, 0.1, -1], [0, 0.03, 0.03, 0.03, 0.03], [0, 0, 0, 0, 0]),
        ([9, 9, -1, -2], [0, 0.1, 0.1, 0.03], [0, 0, 0, 0]),  # it cuts with both: what pushes it has to be undone
    ],
)
def test_what_a_hole_is_gone_to_fast_is_led_beside_it_and_not_down(
    heights: list[float], feeds: list[float], early: list[int]
) -> None:
    path, places = hole(heights, feeds)
    assert places.early.tolist() == [bool(each) for each in early]
    c = np.tile([3e-5, 0.0, -1e-4], (len(path), 1))
    found = places.upright(c)
    assert (found[:, 0] == 3e-5).all()
    arrives = [i for i in range(len(early) - 1) if feeds[i] == 0.0 < feeds[i + 1] and heights[i] == heights[i + 1]]
    kept = [bool(each) or (i in arrives and bool(early[i + 1])) for i, each in enumerate(early)]
    np.testing.assert_allclose(found[:, 2], np.where(kept, 0.0, -1e-4), atol=1e-18)


@pytest.mark.parametrize("seed", range(6))
def test_a_level_cut_behind_a_ramp_is_short_where_its_first_step_is_less_than_the_tool_is_pushed(seed: int) -> None:
    """With all that stands where it begins. Behind a plunge it ends the way down however long that step is."""
    rng = np.random.default_rng(seed)
    parts = [((RAMP, PLUNGE)[i], share * PUSHED) for i, share in zip(rng.integers(0, 2, 7), rng.choice([0.9, 1.1], 7))]
    places, out, down = places_of(parts)
    p, m = places.path.p, len(places.path)
    assert np.flatnonzero(places.out).tolist() == out
    assert [(i, int(places.then[i])) for i in np.flatnonzero(places.then >= 0)] == down
    np.testing.assert_array_equal(places.place[1:] == places.place[:-1], (p[1:] == p[:-1]).all(axis=1))
    short, ends = np.zeros(m, dtype=bool), []
    for n, (way, room) in enumerate(parts):
        begins = down[2 * n][1]
        if way is RAMP and room < PUSHED:
            short[[begins - 1, begins]] = True
        else:
            ends.append(begins)
    np.testing.assert_array_equal(places.alone, short)
    assert places.ends().tolist() == ends


def test_where_a_path_ends_on_the_level_behind_a_ramp_there_is_no_room() -> None:
    p = np.array([[0, 0, 1], [5, 0, 0], [10, 0, -1], [10, 0, -1]]) * 1e-3
    path = rm.Toolpath.from_points(p, 0.03, cutting=np.arange(4) > 0)
    conditions = SimpleNamespace(along=np.array([0.0, -0.2, -0.2, 0.0]), mostly_axial=np.zeros(4, dtype=bool))
    places = Places.along(run_along(path, conditions, np.full((4, 3), PUSHED)))
    assert places.alone.tolist() == [False, False, True, True]
    assert not len(places.ends())


@pytest.mark.parametrize(("turn", "alone"), [(0.0, True), (9.0, True), (11.0, False), (90.0, False)])
@pytest.mark.parametrize("coupling", [False, True])
def test_a_ramp_whose_cut_goes_on_its_way_ends_alone(turn: float, alone: bool, coupling: bool) -> None:
    """There is room. A ramp of a run without coupling is not held to what pushes it later."""
    c, s = np.cos(np.radians(turn)), np.sin(np.radians(turn))
    p = np.array([[0, 0, 1], [5, 0, 0], [10, 0, -1], [10, 0, -1], [10 + 9 * c, 9 * s, -1]]) * 1e-3
    path = rm.Toolpath.from_points(p, 0.03, cutting=np.arange(5) > 0)
    conditions = SimpleNamespace(along=np.array([0.0, -0.2, -0.2, 0.0, 0.0]), mostly_axial=np.zeros(5, dtype=bool))
    places = Places.along(run_along(path, conditions, np.full((5, 3), PUSHED), coupling))
    assert places.alone.tolist() == [False, False, alone, alone, False]
    assert places.ends().tolist() == ([] if alone else [3])
    assert places.falling.tolist() == [False, not coupling, not coupling, False, False]
