"""Lines and arcs joined to contours, against figures drawn by hand."""

from __future__ import annotations

import math
import random
from dataclasses import replace
from itertools import pairwise, permutations

import numpy as np
import pytest
import shapely

from robomill.toolpath.chaining import GAP, joined
from robomill.toolpath.contour import Contour


def line(a, b, layer="0"):
    return Contour(layer, "line", np.array([a, b], dtype=float) * 1e-3)


SQUARE = [line((0, 0), (10, 0)), line((10, 10), (10, 0)), line((10, 10), (0, 10)), line((0, 0), (0, 10))]


def test_four_lines_drawn_any_way_round_are_one_square_that_runs_counter_clockwise() -> None:
    found, twice, dots = joined(SQUARE)
    (square,) = found
    assert (square.shape, twice, dots) == ("polygon", 0, 0)
    x, y = square.points.T
    assert 0.5 * np.sum(x * np.roll(y, -1) - np.roll(x, -1) * y) == pytest.approx(1e-4)
    assert square.length == pytest.approx(0.04)


def test_an_open_chain_runs_as_its_first_line_was_drawn() -> None:
    found, _, _ = joined([line((10, 0), (20, 0)), line((10, 0), (0, 5)), line((30, 0), (20, 0))])
    np.testing.assert_allclose(found[0].points * 1e3, [[0, 5], [10, 0], [20, 0], [30, 0]])


def test_two_lines_are_no_line_any_more_and_a_polyline_of_two_points_is_one() -> None:
    (bent,), _, _ = joined([line((0, 0), (10, 0)), line((10, 0), (20, 3))])
    (straight,), _, _ = joined([Contour("0", "polyline", np.array([[0.0, 0.0], [0.01, 0.0]]))])
    assert (bent.shape, len(bent.points)) == ("polyline", 3)
    assert (straight.shape, len(straight.points)) == ("line", 2)


def test_where_three_lines_meet_none_are_joined() -> None:
    lines = [line((0, 0), (10, 0)), line((10, 0), (20, 0)), line((10, 0), (10, 10)), line((50, 0), (51, 0))]
    found, _, _ = joined(lines)
    assert [each.shape for each in found] == ["line"] * 4
    for each, drawn in zip(found, lines, strict=True):
        np.testing.assert_array_equal(each.points, drawn.points)


@pytest.mark.parametrize("order", list(permutations(range(4))))
def test_lines_are_joined_up_to_where_three_meet_in_whatever_order_they_were_drawn(order: tuple[int, ...]) -> None:
    lines = [line((0, 0), (10, 5)), line((20, 0), (10, 5)), line((20, 0), (30, 5)), line((20, -9), (20, 0))]
    for turned in range(2):
        drawn = [replace(lines[k], points=lines[k].points[:: -1 if turned else 1]) for k in order]
        ends = {frozenset(map(tuple, (each.points[[0, -1]] * 1e3).round(6).tolist())) for each in joined(drawn)[0]}
        assert ends == {frozenset([(20, 0), end]) for end in ((0, 0), (30, 5), (20, -9))}


@pytest.mark.parametrize("first", range(4))
def test_a_ring_of_lines_begins_where_the_first_one_drawn_does(first: int) -> None:
    corners = [(0, 0), (10, 0), (12, 9), (0, 10)]
    lines = [line(corners[k - 4], corners[k - 3]) for k in range(4)]
    (ring,), _, _ = joined(lines[first:] + lines[:first])
    np.testing.assert_allclose(ring.points * 1e3, corners[first:] + corners[:first])


def test_what_is_drawn_twice_or_has_no_length_is_left_out_and_counted() -> None:
    found, twice, dots = joined([*SQUARE, line((0, 10), (0, 0)), line((3, 3), (3, 3))])
    assert (len(found), twice, dots) == (1, 1, 1)


def test_ends_meet_within_the_gap_and_not_beyond_and_never_over_layers() -> None:
    near, far = GAP * 1e3 * 0.9, GAP * 1e3 * 1.1
    assert len(joined([line((0, 0), (10, 0)), line((10 + near, 0), (20, 0))])[0]) == 1
    assert len(joined([line((0, 0), (10, 0)), line((10 + far, 0), (20, 0))])[0]) == 2
    assert len(joined([line((0, 0), (10, 0)), line((10, 0), (20, 0), "other")])[0]) == 2


def test_two_lines_and_two_arcs_are_a_slot_of_the_length_of_its_formula() -> None:
    def arc(x, first, last):
        angles = np.radians([first, 0.5 * (first + last), last])
        return Contour("0", "arc", 1e-3 * np.column_stack([x + 5 * np.cos(angles), 5 * np.sin(angles)]))

    found, _, _ = joined([line((0, -5), (40, -5)), arc(40, -90, 90), line((0, 5), (40, 5)), arc(0, 90, 270)])
    (slot,) = found
    assert slot.closed
    assert slot.length == pytest.approx(2e-3 * (40 + 5 * math.pi), rel=1e-4)


@pytest.mark.parametrize("gap", [(1, 0), (-1, 0), (0, 1), (0, -1), (0.7, 0.7), (-0.7, 0.7), (0.7, -0.7), (-0.7, -0.7)])
@pytest.mark.parametrize("place", [0.0, 0.5, 0.99])
def test_ends_meet_from_every_side(gap: tuple[float, float], place: float) -> None:
    """However the corners of the search lie between them."""
    at = np.array([100.0 + place, 200.0 + place]) * GAP * 1e3
    other = at + 0.95 * GAP * 1e3 * np.array(gap)
    found, _, _ = joined([line((-9, -9), at), line(other, (30, 9))])
    assert len(found) == 1
    np.testing.assert_allclose(found[0].points * 1e3, [(-9, -9), at, (30, 9)], atol=1.1 * GAP * 1e3)
    beyond = at + 1.02 * GAP * 1e3 * np.array(gap) / np.hypot(*gap)
    assert len(joined([line((-9, -9), at), line(beyond, (30, 9))])[0]) == 2


@pytest.mark.parametrize("seed", range(12))
def test_a_figure_cut_up_and_mixed_is_found_again(seed: int) -> None:
    """Closed or open, its lines in any order and drawn any way: shapely's own merged line, as long and as large."""
    r = random.Random(seed)
    closed, count = seed % 2 == 0, 9
    angles = [2 * math.pi * k / count * (1.0 if closed else 0.8) for k in range(count)]
    corners = [(round(r.uniform(5, 20) * math.cos(t), 3), round(r.uniform(5, 20) * math.sin(t), 3)) for t in angles]
    pairs = [*pairwise(corners), *([(corners[-1], corners[0])] if closed else [])]
    pieces = [line(*(pair if r.random() < 0.5 else pair[::-1])) for pair in pairs]
    r.shuffle(pieces)
    (found,), twice, dots = joined(pieces)
    assert (twice, dots, found.shape) == (0, 0, "polygon" if closed else "polyline")
    merged = shapely.line_merge(shapely.MultiLineString([each.points for each in pieces]))
    drawn = shapely.LineString(found.outline())
    assert drawn.length == pytest.approx(merged.length)
    assert drawn.hausdorff_distance(merged) < 1e-12
    if closed:
        assert shapely.LinearRing(found.points).is_ccw
        assert len(found.points) == count
        assert shapely.Polygon(found.points).area == pytest.approx(shapely.Polygon(np.array(corners) * 1e-3).area)
    else:
        a, b = pieces[0].points
        at = [drawn.project(shapely.Point(each)) for each in (a, b)]
        assert at[0] < at[1], "it runs as its first line was drawn"


def test_a_contour_has_its_layer_and_its_place_from_the_first_of_its_lines() -> None:
    """Two figures in one drawing come in the order in which they were begun, each in its own layer."""
    lines = [line((0, 0), (1, 0), "a"), line((5, 5), (6, 5), "b"), line((1, 0), (1, 3), "a"), line((6, 5), (6, 9), "b")]
    found, _, _ = joined(lines)
    assert [each.layer for each in found] == ["a", "b"]
    assert [each.length * 1e3 for each in found] == pytest.approx([4, 5])


@pytest.mark.parametrize("closed", ["polygon", "polyline"])
def test_a_ring_drawn_clockwise_is_turned_about_and_begins_where_it_began(closed: str) -> None:
    ring = [(1, 1), (1, 5), (7, 5), (9, 1)]
    points = np.array(ring + ([ring[0]] if closed == "polyline" else []), dtype=float) * 1e-3
    (found,), _, _ = joined([Contour("0", closed, points)])
    np.testing.assert_allclose(found.points * 1e3, [(1, 1), (9, 1), (7, 5), (1, 5)])
    (kept,), _, _ = joined([Contour("0", "polygon", found.points)])
    np.testing.assert_array_equal(kept.points, found.points)


def test_there_and_back_is_no_closed_figure() -> None:
    (found,), _, _ = joined([Contour("0", "polyline", np.array([[0, 0], [5, 0], [0, 0]]) * 1e-3)])
    assert found.shape == "polyline"


def test_lines_that_only_look_alike_are_kept() -> None:
    """The two halves of a circle have the same ends; a square and its diagonals have the same box."""

    def half(y: float) -> Contour:
        return Contour("0", "arc", np.array([[-5, 0], [0, y], [5, 0]]) * 1e-3)

    (circle,), twice, _ = joined([half(5), half(-5)])
    assert twice == 0
    assert circle.length == pytest.approx(2 * math.pi * 5e-3, rel=1e-3)
    _, twice, _ = joined([half(5), half(5), line((-5, 0), (5, 0)), line((-5, 0), (5, 0), "other")])
    assert twice == 1
