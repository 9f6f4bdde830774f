"""The feed moves of a path: which there are, which axes they may have, and how a turning axis is divided."""

from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given, settings, strategies as st

from robomill.cutting.tool import Cutter
from robomill.errors import SurfaceError
from robomill.surface.passes import Passes, at_one_axis, feed_passes, joined, leaning, tool_axes
from robomill.surface.stock import Stock
from robomill.surface.zmap import cut

UP = (0.0, 0.0, 1.0)


def test_axes_are_checked():
    stock, p = Stock((0, 0, -0.01), (0.02, 0.02, 0)), np.array([[0, 0.01, -0.001], [0.02, 0.01, -0.001]])
    for k in ([0.0, 0.0, 2.0], [0.0, 0.0, 0.0], [0.0, np.nan, 1.0], [[0.0, 0.0, 1.0]] * 3, [0.0, 0.0, 1.0 + 2e-6]):
        with pytest.raises(SurfaceError, match="tool axis|Tool axis"):
            cut(stock, 1e-3, Cutter("flat", 0.008), p, k)
    np.testing.assert_array_equal(tool_axes(None, 2), [UP, UP])
    np.testing.assert_allclose(np.linalg.norm(tool_axes([0.0, 0.0, 1.0 + 5e-7], 3), axis=1), 1.0, atol=1e-15)
    np.testing.assert_array_equal(tool_axes([[1.0, 0, 0], UP], 2), [[1.0, 0, 0], UP])


def test_only_feed_moves_with_known_ends():
    p = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [np.nan, 1, 0], [2, 2, 0], [3, 2, 0.0]])
    moves, skipped = feed_passes(p, None, [True, True, False, True, True, True])
    np.testing.assert_array_equal(moves.ends, [[0, 0, 0, 1, 0, 0], [2, 2, 0, 3, 2, 0]])
    np.testing.assert_array_equal(moves.axes, [UP + UP] * 2)
    assert skipped == 2
    with pytest.raises(SurfaceError, match=r"found \(2,\) cutting flags for 6 points"):
        feed_passes(p, None, [True, True])


@pytest.mark.parametrize(
    ("points", "count"),
    [
        ([[0, 0, 0], [1, 0, 0], [3, 0, 0]], 1),
        ([[0, 0, 0], [1, 0, 0], [0.5, 0, 0]], 2),  # back on itself
        ([[0, 0, 0], [1, 0, 0], [2, 1e-6, 0]], 2),  # a bend
        ([[0, 0, 0], [1, 0, 0], [1, 0, 0], [2, 0, 0]], 3),  # a move of no length
    ],
)
def test_only_what_goes_straight_on_is_joined(points, count):
    p = np.array(points, dtype=float)
    ends = np.hstack([p[:-1], p[1:]])
    assert len(joined(Passes(ends, np.tile(UP, (len(ends), 2)))).ends) == count


def test_moves_that_do_not_meet_or_lean_otherwise_are_not_joined():
    ends = np.array([[0, 0, 0, 1, 0, 0], [2, 0, 0, 3, 0, 0.0]])
    assert len(joined(Passes(ends, np.tile(UP, (2, 2)))).ends) == 2
    meeting = np.array([[0, 0, 0, 1, 0, 0], [1, 0, 0, 3, 0, 0.0]])
    lean = np.array([0.0, 0.6, 0.8])
    assert len(joined(Passes(meeting, np.vstack([np.tile(UP, 2), np.tile(lean, 2)]))).ends) == 2
    turning = np.tile(np.append(UP, lean), (2, 1))
    assert len(joined(Passes(meeting, turning)).ends) == 2
    same = joined(Passes(meeting, np.tile(lean, (2, 2))))
    np.testing.assert_array_equal(same.ends, [[0, 0, 0, 3, 0, 0]])
    np.testing.assert_array_equal(same.axes, [np.tile(lean, 2)])


def test_a_turning_axis_is_divided_so_that_no_point_strays():
    R, cell, turn = 0.004, 5e-4, 0.3
    k = np.array([[np.sin(a), 0.0, np.cos(a)] for a in (0.0, turn)])
    moves = Passes(np.array([[0, 0, 0, 0.01, 0.02, -0.003], [0, 0, 0, 1, 0, 0]]), np.vstack([k.ravel(), [*UP, *UP]]))
    ends, axes, owner = at_one_axis(moves, R, cell)
    n = len(ends) - 1  # pieces of the first move
    assert turn / n * R <= 0.2 * cell < turn / (n - 1) * R
    np.testing.assert_array_equal(ends[:n, 3:][:-1], ends[:n, :3][1:])
    np.testing.assert_allclose(ends[:n, 3:] - ends[:n, :3], np.tile([0.01, 0.02, -0.003], (n, 1)) / n, atol=1e-15)
    np.testing.assert_array_equal(np.append(ends[0, :3], ends[n - 1, 3:]), moves.ends[0])
    middle = np.arctan2(axes[:n, 0], axes[:n, 2])
    np.testing.assert_allclose(middle, (np.arange(n) + 0.5) * turn / n, atol=1e-3)
    np.testing.assert_allclose(np.linalg.norm(axes, axis=1), 1.0, atol=1e-15)
    np.testing.assert_array_equal(ends[n], moves.ends[1])
    np.testing.assert_array_equal(axes[n], UP)
    np.testing.assert_array_equal(leaning(axes), [True] * n + [False])


def test_an_axis_may_lean_until_a_tenth_of_it_points_up():
    p = np.array([[0.0, 0, 0], [1, 0, 0]])
    for rise, fine in ((0.11, True), (0.1, True), (0.09, False), (-1.0, False)):
        k = np.array([np.sqrt(1 - rise * rise), 0.0, rise])
        if fine:
            assert len(feed_passes(p, k, None)[0].ends) == 1
        else:
            with pytest.raises(SurfaceError, match=f"its upward part is {rise:.2f}; a height map needs at least 0.1"):
                feed_passes(p, k, None)


def test_an_axis_that_turns_through_the_vertical_is_cut():
    """One of its pieces may be exactly upright."""
    stock = Stock((0, 0, -0.01), (0.03, 0.02, 0))
    p = np.array([[0.005, 0.01, -0.002], [0.025, 0.01, -0.002]])
    k = np.array([[np.sin(a), 0.0, np.cos(a)] for a in (-0.1, 0.1)])
    surface = cut(stock, 5e-4, Cutter("ball", 0.008), p, k)
    mirrored = cut(stock, 5e-4, Cutter("ball", 0.008), p[::-1] * [-1, 1, 1] + [0.03, 0, 0], k[::-1] * [-1, 1, 1])
    np.testing.assert_allclose(surface.z, mirrored.z[::-1], atol=1e-12)
    assert surface.z.min() == pytest.approx(-0.002, abs=5e-5)


steps = st.integers(-6, 6).map(lambda n: n * 1.7e-3)


points = st.tuples(steps, steps, st.integers(-8, -1).map(lambda n: n * 4e-4))


paths = st.lists(points, min_size=2, max_size=6, unique=True).map(np.array)


few = settings(max_examples=25, deadline=None)


@few
@given(paths, st.integers(2, 9))
def test_joined_moves_are_the_undivided_path(p, pieces):
    t = np.arange(pieces) / pieces
    divided = np.vstack([*(a + t[:, None] * (b - a) for a, b in pairwise(p)), p[-1:]])
    ends = np.hstack([divided[:-1], divided[1:]])
    whole, _ = joined(Passes(ends, np.tile([0.0, 0.0, 1.0], (len(ends), 2))))
    assert len(whole) <= len(p) - 1
    np.testing.assert_array_equal(whole[0, :3], p[0])
    np.testing.assert_array_equal(whole[-1, 3:], p[-1])
    turning = np.tile([0.0, 0.0, 1.0], (len(ends), 2))
    turning[:, 3] = np.arange(len(ends)) * 1e-3
    assert len(joined(Passes(ends, turning)).ends) == len(ends)
