"""What a run is to cut of its track: places in plan, one by one, by what the run and its neighbours sweep."""

from __future__ import annotations

import math

import numpy as np
import pytest

from robomill.surface.contact.material_kernels import AXIS, ENDS, MOVE
from robomill.surface.contact.track_kernels import ahead_of, follows, goes_on, leaves, way_in_plan


def runs_through(*points):
    """One run after the other through points (3,), with the same numbers in all other columns."""
    runs = np.tile(np.linspace(0.1, 0.9, MOVE), (len(points) - 1, 1))
    runs[:, ENDS : ENDS + 3], runs[:, ENDS + 3 : AXIS] = points[:-1], points[1:]
    return runs


def test_a_run_goes_on_where_place_tool_and_axis_are_those_before():
    runs = runs_through((0, 0, 0), (1, 0, 0), (1, 2, 0))
    assert not goes_on(runs, 0)
    assert goes_on(runs, 1)
    for column in range(MOVE):
        changed = runs.copy()
        changed[1, column] += 1e-9
        assert goes_on(changed, 1) == (ENDS + 3 <= column < AXIS), column


@pytest.mark.parametrize("first", [-1.0, 0.0, 1.0])
@pytest.mark.parametrize("second", [-1.0, 0.0, 1.0])
@pytest.mark.parametrize("level", [0.0, 2.0])
def test_a_run_follows_unless_it_goes_down_and_leaves_unless_it_goes_up_or_straight_down(first, second, level):
    """``first`` and ``second`` are what two runs rise by, the first one over a way of ``level`` in plan."""
    runs = runs_through((0, 0, 0), (level, 0, first), (level, 3, first + second))
    assert not follows(runs, 0)
    assert follows(runs, 1) == (second >= 0.0)
    assert leaves(runs, 0) == (first <= 0.0 and level > 0.0)
    assert not leaves(runs, 1)
    apart = runs.copy()
    apart[1, ENDS] += 0.5
    assert not follows(apart, 1)
    assert not leaves(apart, 0)


@pytest.mark.parametrize("angle", np.linspace(-3.0, 3.0, 7))
def test_the_way_of_a_run_in_plan_is_a_unit_vector_whatever_it_rises_by(angle):
    c, s = math.cos(angle), math.sin(angle)
    runs = runs_through((1, 2, 3), (1 + 4 * c, 2 + 4 * s, 9), (1 + 4 * c, 2 + 4 * s, -2))
    assert way_in_plan(runs, 0) == pytest.approx((c, s), abs=1e-12)
    assert way_in_plan(runs, 1) == (0.0, 0.0)


@pytest.mark.parametrize("back", [0.0, 0.3])
@pytest.mark.parametrize(
    "way", [(1.0, 0.0), (-1.0, 0.0), (0.0, 1.0), (0.0, -1.0), (0.6, 0.8), (-0.6, 0.8), (0.8, -0.6)]
)
def test_ahead_of_a_place_is_what_lies_on_along_its_way(way, back):
    place = np.array([0.2, -0.5, 7.0])
    for x in (-1.03, 0.05, 0.21, 1.4):
        low, high = ahead_of(place, way, x, back)
        for y in np.linspace(-4.0, 4.0, 161) + 0.0123:
            on = (x - place[0]) * way[0] + (y - place[1]) * way[1]
            assert (low <= y <= high) == (on >= -back)


def test_where_there_is_no_way_everything_is_ahead():
    assert ahead_of(np.zeros(3), (0.0, 0.0), 5.0, 0.0) == (-math.inf, math.inf)
