"""Cuts and the plunges in them, sample by sample, and where the plunges of a corrected program were meant to go."""

from __future__ import annotations

import numpy as np
import pytest

import robomill as rm
from robomill.simulation.meant import FARTHEST, LINK, _bottoms, _cuts, _plunges

DOWN, RAMP, ALONG, STOP = np.array([[0.0, 0.0, -1.0], [1.0, 0.0, -1.0], [1.0, 0.0, 0.0], [0.0, 0.0, 0.0]]) * 1e-3


def path_of(p: object, cutting: object) -> rm.Toolpath:
    return rm.Toolpath.from_points(np.asarray(p, dtype=float), 0.03, cutting=np.asarray(cutting, dtype=bool))


@pytest.mark.parametrize("seed", range(8))
def test_plunges_are_what_goes_straight_down_without_a_step_of_another_way(seed: int) -> None:
    """Stops on the way are no steps; a plunge may be the first step of a path, and be of one step."""
    rng = np.random.default_rng(seed)
    kinds = [0, *rng.choice(4, 29, p=(0.4, 0.15, 0.2, 0.25)).tolist()]
    p = np.cumsum([STOP, *((DOWN, RAMP, ALONG, STOP)[kind] for kind in kinds)], axis=0)
    path, expected, open_ = path_of(p, np.arange(len(p)) > 0), [], False
    for i, kind in enumerate(kinds, 1):
        if kind == 0 and open_:
            expected[-1] = (expected[-1][0], i)
        elif kind == 0:
            expected.append((i, i))
        open_ = open_ if kind == 3 else kind == 0
    assert _plunges(path, np.arange(len(p))) == expected


def test_a_cut_is_what_follows_a_rapid_with_the_place_where_that_ends_if_it_goes_anywhere() -> None:
    """Of one step, of three, and one that only stands still."""
    x = np.array([0, 9, 10, 20, 21, 21, 22, 30, 30, 40, 41], dtype=float)
    cutting = [0, 0, 1, 0, 1, 1, 1, 0, 1, 0, 1]
    path = path_of(np.column_stack([x, 0 * x, 0 * x]) * 1e-3, cutting)
    assert [some.tolist() for some in _cuts(path)] == [[1, 2], [3, 4, 5, 6], [9, 10]]


def plunged(x: float, top: float, bottom: float, bulge: float = 0.0) -> rm.Toolpath:
    """A way along to x, and down there in four steps, the second and third of which lead aside by ``bulge``; mm."""
    z = np.linspace(top, bottom, 5)
    down = np.column_stack([x + bulge * np.array([0.0, 0.0, 1.0, 1.0, 0.0]), np.zeros(5), z])
    p = np.vstack([[x - 8.0, 0.0, top], down, [x + 5.0, 0.0, bottom]])
    return path_of(p * 1e-3, np.arange(7) > 0)


@pytest.mark.parametrize(
    ("off", "bulge", "led"),
    [
        (0.1, 0.0, True),
        (1.9, 0.0, True),
        (2.2, 0.0, False),
        (0.1, 0.9 * LINK * 1e3, True),
        (0.1, 1.2 * LINK * 1e3, False),
    ],
)
def test_a_corrected_plunge_was_meant_to_be_as_high_above_the_bottom_and_no_higher_than_its_top(
    off: float, bulge: float, led: bool
) -> None:
    """Told from 4 mm down to -3; sent from 5.5 mm, and ``off`` to one side. The steep end of an arc is left alone."""
    wanted, path = plunged(10.0, 4.0, -3.0, bulge), plunged(10.0 + off, 5.5, -2.9)
    every = np.arange(7)
    p = path.p.copy()
    _bottoms(p, path, wanted, every, every)
    expected = path.p.copy()
    if led:
        height = np.minimum(path.p[2:6, 2] - path.p[5, 2], 7e-3)
        expected[2:6] = np.column_stack([np.full(4, 10e-3), np.zeros(4), -3e-3 + height])
        assert height.max() < 7e-3
    np.testing.assert_allclose(p, expected, atol=1e-12)
    assert (off * 1e-3 > FARTHEST) == (off > 2.0)


def test_above_the_top_of_what_was_told_a_plunge_is_meant_to_be_there() -> None:
    """Sent from 12 mm at once down to 9, which are 5 more than were told."""
    wanted, path = plunged(10.0, 1.0, -3.0), plunged(10.1, 9.0, -2.9)
    p, every = path.p.copy(), np.arange(7)
    _bottoms(p, path, wanted, every, every)
    np.testing.assert_allclose(p[2:6, 2], np.minimum(path.p[2:6, 2] - 0.1e-3, 1e-3), atol=1e-12)
    np.testing.assert_allclose(p[2:6, 0], 10e-3, atol=1e-12)


@pytest.mark.parametrize("at", [2, 3, 4])
def test_a_way_down_that_leads_aside_at_any_of_its_samples_is_left_alone(at: int) -> None:
    straight, path, every = plunged(10.0, 4.0, -3.0), plunged(10.1, 5.5, -2.9), np.arange(7)
    for aside, led in ((0.9 * LINK, True), (1.2 * LINK, False)):
        bent, p = straight.p.copy(), path.p.copy()
        bent[at, 1] += aside
        _bottoms(p, path, path_of(bent, straight.cutting), every, every)
        assert (p != path.p).any() == led
