"""Lines and arcs joined to contours, against figures drawn by hand."""

from __future__ import annotations

import math

import numpy as np
import pytest

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
    found, _, _ = joined([line((0, 0), (10, 0)), line((10, 0), (20, 0)), line((10, 0), (10, 10))])
    assert [each.shape for each in found] == ["line"] * 3


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
