"""A groove followed in its section: walls and floors drawn by hand, so that every number has a closed form."""

from __future__ import annotations

import numpy as np
import pytest

from robomill.surface.trace import WALL_LEVELS, trace_groove

DEPTH, RADIUS = 2e-3, 4e-3


def flat(w):
    return np.zeros_like(w)


def section(left, right, floor=lambda w: 0.0 * w - DEPTH):
    """The height over w of a groove with its walls at w = left(z) > 0 and w = -right(z) < 0, drawn by inversion."""
    z = np.linspace(-1.5 * DEPTH, 0.0, 30001)
    w_left, w_right = left(z), right(z)

    def height(w):
        on_wall = np.where(w > 0, np.interp(w, w_left, z), np.interp(-w, w_right, z))
        inside = (w < w_left[-1]) & (w > -w_right[-1])
        return np.where(inside, np.maximum(floor(w), on_wall), 0.0)

    return height


def leaning(at, lean):
    return lambda z: at + lean * z


@pytest.mark.parametrize("at", [4e-3, 6.3e-3, 12.3e-3])
@pytest.mark.parametrize(("lean_left", "lean_right"), [(0.1, 0.3), (0.02, 0.5), (0.5, 0.02)])
def test_walls_that_lean_outwards_however_far_they_stand(at, lean_left, lean_right):
    height = section(leaning(at, lean_left), leaning(at + 0.1e-3, lean_right))
    found = trace_groove(height, 0.0, -15e-3, 15e-3, RADIUS, flat)
    assert found.left == pytest.approx(at, abs=1e-9)
    assert found.right == pytest.approx(-at - 0.1e-3, abs=1e-9)
    assert found.left_angle == pytest.approx(np.pi / 2 + np.arctan(lean_left), abs=1e-6)
    assert found.right_angle == pytest.approx(np.pi / 2 + np.arctan(lean_right), abs=1e-6)
    assert found.left_straightness == pytest.approx(0.0, abs=1e-9)
    assert (found.floor, found.top) == (-DEPTH, 0.0)
    assert found.floor_tilt == pytest.approx(0.0, abs=1e-12)


def test_a_bowed_wall_is_off_its_line_by_the_bow():
    bow, lean = 20.0, 0.1  # 1/m
    found = trace_groove(
        section(lambda z: 4e-3 + lean * z - bow * z * z, leaning(4e-3, 0.1)), 0.0, -9e-3, 9e-3, RADIUS, flat
    )
    step = 0.58 * DEPTH / (WALL_LEVELS - 1)
    mean = 0.31 * DEPTH
    slope = lean + 2 * bow * mean  # of the line through equally spaced points of a parabola
    # k^2 of nine points, k = -4 ... 4, leaves 16 of spread whatever line is taken off.
    assert found.left_straightness == pytest.approx(16 * bow * step**2 / np.hypot(1, slope), rel=1e-3)
    assert found.left_angle == pytest.approx(np.pi / 2 + np.arctan(slope), abs=1e-5)


@pytest.mark.parametrize(
    ("left", "right", "stock", "span"),
    [
        (20e-3, 20e-3, (-30e-3, 30e-3), (-2e-3, 2e-3)),  # a pocket: half the radius to either side
        (1e-3, 1.6e-3, (-30e-3, 30e-3), (-0.8e-3, 0.5e-3)),  # narrow: half way to the walls
        (1e-3, 20e-3, (-30e-3, 30e-3), (-2e-3, 0.5e-3)),
        (20e-3, 20e-3, (-1.2e-3, 30e-3), (-0.6e-3, 2e-3)),  # the stock ends before the wall
        (20e-3, 20e-3, (-30e-3, 1.4e-3), (-2e-3, 0.7e-3)),
    ],
)
def test_the_floor_leans_as_it_does_around_the_axis(left, right, stock, span):
    """Nothing outside the span counts, everything up to its ends does."""

    def tilt(low, high):
        """Of a floor that leans by one tenth between low and high and lies deeper beyond."""

        def floor(w):
            return -DEPTH + 0.1 * w - 0.5e-3 * ((w < low) | (w > high))

        return trace_groove(
            section(leaning(left, 0.0), leaning(right, 0.0), floor), 0.0, *stock, RADIUS, flat
        ).floor_tilt

    low, high = span
    assert tilt(low - 1e-6, high + 1e-6) == pytest.approx(0.1, abs=1e-9)
    assert tilt(low + 1e-6, high + 1e-6) > 0.11
    assert tilt(low - 1e-6, high - 1e-6) < 0.09


def test_beside_a_lower_stock_a_wall_is_where_nothing_was_cut():
    def skin(w):
        return np.where(w > 2.5e-3, -1e-3, 0.0)

    def height(w):
        return np.where(np.abs(w) < 4e-3, -DEPTH, skin(w))

    found = trace_groove(height, 0.0, -9e-3, 9e-3, RADIUS, skin)
    assert found.left == pytest.approx(4e-3, abs=1e-9)
    assert found.left_angle == pytest.approx(np.pi / 2, abs=1e-9)
    assert found.right == pytest.approx(-4e-3, abs=1e-9)


def test_a_wall_beyond_the_stock_is_not_known_and_nothing_cut_is_no_groove():
    height = section(leaning(4e-3, 0.0), leaning(4e-3, 0.0))
    found = trace_groove(height, 0.0, -3e-3, 9e-3, RADIUS, flat)
    assert np.isnan([found.right, found.right_angle, found.right_straightness]).all()
    assert found.left == pytest.approx(4e-3, abs=1e-9)
    assert trace_groove(height, 6e-3, -9e-3, 9e-3, RADIUS, flat) is None


@pytest.mark.parametrize("high", [-1.9, -1.3, -0.9, -0.1])
def test_a_step_lower_than_the_stock_is_no_wall(high):
    """To the left only a step stands, up to where the stock ends."""

    def height(w):
        return np.where(w > 4e-3, high * 1e-3, np.where(w > -4e-3, -DEPTH, 0.0))

    found = trace_groove(height, 0.0, -9e-3, 9e-3, RADIUS, flat)
    assert np.isnan([found.left, found.left_angle, found.left_straightness]).all()
    assert found.right == pytest.approx(-4e-3, abs=1e-9)
    assert found.right_angle == pytest.approx(np.pi / 2, abs=1e-6)
