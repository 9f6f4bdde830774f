"""A section followed outwards: walls and floors drawn by hand, so that every number has a closed form."""

from __future__ import annotations

import numpy as np
import pytest

from robomill.surface.sections.trace import LEVELS, WALL_LEVELS, Line, first_above, side_of, wall_form

DEPTH, RADIUS = 2e-3, 4e-3
OWN = (-DEPTH, 0.0)


def flat(w):
    return np.zeros_like(w)


def line(height, skin=flat, low=-15e-3, high=15e-3):
    return Line(height, skin, low, high, RADIUS)


def section(left, right):
    """The height over w of a groove with its walls at w = left(z) > 0 and w = -right(z) < 0, drawn by inversion."""
    z = np.linspace(-1.5 * DEPTH, 0.0, 30001)
    w_left, w_right = left(z), right(z)

    def height(w):
        on_wall = np.where(w > 0, np.interp(w, w_left, z), np.interp(-w, w_right, z))
        inside = (w < w_left[-1]) & (w > -w_right[-1])
        return np.where(inside, np.maximum(-DEPTH, on_wall), 0.0)

    return height


def leaning(at, lean):
    return lambda z: at + lean * z


@pytest.mark.parametrize("at", [4e-3, 6.3e-3, 12.3e-3])
@pytest.mark.parametrize(("lean_left", "lean_right"), [(0.1, 0.3), (0.02, 0.5), (0.5, 0.02)])
def test_walls_that_lean_outwards_however_far_they_stand(at, lean_left, lean_right):
    seen = line(section(leaning(at, lean_left), leaning(at + 0.1e-3, lean_right)))
    for side, edge, lean in ((1.0, at, lean_left), (-1.0, -at - 0.1e-3, lean_right)):
        found, form = side_of(seen, 0.0, side), wall_form(seen, 0.0, side, OWN)
        assert (found.ends, found.of_stock, found.top) == ("wall", True, 0.0)
        assert found.w == pytest.approx(edge, abs=1e-9)
        assert form.angle == pytest.approx(np.pi / 2 + np.arctan(lean), abs=1e-6)
        assert form.straightness == pytest.approx(0.0, abs=1e-9)
        assert form.why == ""


def test_a_bowed_wall_is_off_its_line_by_the_bow():
    bow, lean = 20.0, 0.1  # 1/m
    seen = line(section(lambda z: 4e-3 + lean * z - bow * z * z, leaning(4e-3, 0.1)))
    found = wall_form(seen, 0.0, 1.0, OWN)
    step = (LEVELS[1] - LEVELS[0]) * DEPTH / (WALL_LEVELS - 1)
    mean = DEPTH * (1.0 - 0.5 * sum(LEVELS))
    slope = lean + 2 * bow * mean  # of the line through equally spaced points of a parabola
    # k^2 of nine points, k = -4 ... 4, leaves 16 of spread whatever line is taken off.
    assert found.straightness == pytest.approx(16 * bow * step**2 / np.hypot(1, slope), rel=1e-3)
    assert found.angle == pytest.approx(np.pi / 2 + np.arctan(slope), abs=1e-5)


def test_beside_a_lower_stock_a_wall_is_where_nothing_was_cut():
    def skin(w):
        return np.where(w > 2.5e-3, -1e-3, 0.0)

    def height(w):
        return np.where(np.abs(w) < 4e-3, -DEPTH, skin(w))

    left, right = (side_of(line(height, skin, -9e-3, 9e-3), 0.0, side) for side in (1.0, -1.0))
    assert (left.ends, left.top) == ("wall", -1e-3)
    assert left.w == pytest.approx(4e-3, abs=1e-9)
    assert right.w == pytest.approx(-4e-3, abs=1e-9)


def test_where_the_stock_ends_or_is_as_low_as_the_floor_the_cut_is_open():
    height = section(leaning(4e-3, 0.0), leaning(4e-3, 0.0))
    assert side_of(line(height, low=-3e-3), 0.0, -1.0).ends == "open"
    assert side_of(line(height, low=-3e-3), 0.0, 1.0).ends == "wall"

    def skin(w):
        return np.where(w > 1e-3, -DEPTH, 0.0)

    over_a_void = line(lambda w: np.minimum(height(w), skin(w)), skin)
    assert side_of(over_a_void, 0.0, 1.0).ends == "open"


@pytest.mark.parametrize("high", [-1.85, -1.3, -0.9, -0.1])
def test_a_ledge_lower_than_the_stock_is_a_wall_half_way_up(high):
    """To the left a ledge stands, up to where the stock ends."""

    def height(w):
        on_flank = -DEPTH + (w - 4e-3) * 10.0
        ledge = np.clip(on_flank, -DEPTH, high * 1e-3)
        return np.where(w > 4e-3, ledge, np.where(w > -4e-3, -DEPTH, 0.0))

    found = side_of(line(height, high=9e-3), 0.0, 1.0)
    rise = DEPTH + high * 1e-3
    assert (found.ends, found.of_stock) == ("wall", False)
    assert found.top == pytest.approx(high * 1e-3)
    assert found.w == pytest.approx(4e-3 + 0.05 * rise, abs=1e-9)


def test_a_ledge_lower_than_a_tenth_of_a_millimetre_or_narrow_is_passed_over():
    def height(w):
        low = np.where(w > 2e-3, -DEPTH + 0.09e-3, -DEPTH)
        narrow = np.where(w > 5e-3, np.where(w < 5.9e-3, -1e-3, 0.0), low)
        return np.where(w > -4e-3, narrow, 0.0)

    found = side_of(line(height), 0.0, 1.0)
    assert (found.ends, found.of_stock) == ("wall", True)
    assert found.w == pytest.approx(5.9e-3, abs=1e-9)


def test_what_lies_lower_a_crest_and_a_long_slope_are_no_walls():
    def lower(w):
        return np.where(w > 4e-3, -DEPTH - 0.2e-3, -DEPTH)

    def crests(w):
        return -DEPTH + 0.01e-3 * np.abs(np.sin(w / 1e-3))

    def slope(w):
        return np.minimum(-DEPTH + 0.2 * np.maximum(w, 0.0), 0.0)

    assert side_of(line(lower), 0.0, 1.0).ends == "lower"
    assert side_of(line(crests), 0.0, 1.0).ends == "crest"
    assert side_of(line(slope), 0.0, 1.0).ends == "slope"


def test_a_wall_in_steps_or_lower_than_a_tenth_of_a_millimetre_has_no_lean():
    def stairs(w):
        return np.where(w > 5e-3, 0.0, np.where(w > 4e-3, -1e-3, -DEPTH))

    found = wall_form(line(stairs), 0.0, 1.0, OWN)
    assert np.isnan([found.angle, found.straightness]).all()
    assert "not one" in found.why
    low = wall_form(line(stairs), 0.0, 1.0, (-0.09e-3, 0.0))
    assert "too low" in low.why


def test_material_is_found_above_each_level_or_not_at_all():
    seen = line(section(leaning(4e-3, 0.5), leaning(4e-3, 0.0)))
    found = first_above(seen, 0.0, 1.0, np.array([-1.5e-3, -0.5e-3]))
    assert found == pytest.approx([4e-3 - 0.75e-3, 4e-3 - 0.25e-3], abs=1e-9)
    assert np.isnan(first_above(seen, 0.0, 1.0, np.array([-0.5e-3]), most=3e-3)).all()
