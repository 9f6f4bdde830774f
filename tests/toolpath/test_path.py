"""The toolpath as a value, and tables of lines."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from robomill.errors import ToolpathError
from robomill.toolpath.path import Toolpath, toolpath_from_lines


def two_lines():
    return toolpath_from_lines([[0, 0, 0], [0, 0.02, 0]], [[0.01, 0, 0], [0.01, 0.02, 0]], 0.03, 200.0)


def test_lines_that_do_not_touch_are_joined_by_a_rapid() -> None:
    path = two_lines()
    assert path.cutting.tolist() == [False, True, False, True]
    assert path.block.tolist() == [1, 1, 2, 2]
    assert path.s[-1] == pytest.approx(0.02)
    assert path.t[-1] == pytest.approx(0.02 / 0.03)


def test_a_path_begins_without_a_feed_and_says_how_large_it_is() -> None:
    path = two_lines()
    np.testing.assert_array_equal(path.v_f, [0, 0.03, 0, 0.03])
    assert repr(path) == "<Toolpath 4 points, 20.0 mm at feed within 10.0 x 20.0 x 0.0 mm>"
    table = path.columns()
    assert table["row"].tolist() == [1, 1, 2, 2]
    np.testing.assert_allclose(table["X_mm"], [0, 10, 0, 10], atol=1e-9)
    np.testing.assert_allclose(table["Y_mm"], [0, 0, 20, 20], atol=1e-9)
    np.testing.assert_allclose(table["station_mm"], [0, 10, 10, 20])
    np.testing.assert_allclose(table["k_z"], 1)
    np.testing.assert_allclose(table["feed_mm_min"], [0, 1800, 0, 1800])
    np.testing.assert_allclose(table["spindle_1_min"], 12000)


def test_lines_that_touch_are_not() -> None:
    path = toolpath_from_lines([[0, 0, 0], [0.01, 0, 0]], [[0.01, 0, 0], [0.01, 0.01, 0]], 0.03)
    assert path.cutting.tolist() == [False, True, True]


@pytest.mark.parametrize(
    ("change", "sentence"),
    [
        (dict(v_f=0.0), "Row 1: feed is 0 mm/min; a cut needs more than 0"),
        (dict(end=[[0.0, 0, 0]]), "Row 1: start and end are the same point"),
        (dict(end=[[np.nan, 0, 0]]), "line ends: expected finite numbers"),
    ],
)
def test_bad_rows_are_named(change: dict, sentence: str) -> None:
    arguments = dict(start=[[0.0, 0, 0]], end=[[0.1, 0, 0]], v_f=0.03) | change
    with pytest.raises(ToolpathError, match=sentence):
        toolpath_from_lines(**arguments)


def test_length_and_time_are_those_of_the_moves_at_feed() -> None:
    starts, ends = [[0, 0, 0], [0, 8e-3, 0]], [[3e-3, 4e-3, 0], [0, 8e-3, 6e-3]]
    path = toolpath_from_lines(starts, ends, [0.01, 0.02], [50.0, 60.0])
    assert path.step_length == pytest.approx([0, 5e-3, 5e-3, 6e-3])
    assert path.s == pytest.approx([0, 5e-3, 5e-3, 11e-3])
    assert path.t == pytest.approx([0, 0.5, 0.5, 0.8])
    assert path.n_s == pytest.approx([50, 50, 60, 60])
    assert path.block.tolist() == [1, 1, 2, 2]
    assert path.extents[0].tolist() == [0, 0, 0]
    assert path.extents[1] == pytest.approx([3e-3, 8e-3, 6e-3])
    rapid = replace(path, cutting=[False, True, False, False])
    assert rapid.extents[1] == pytest.approx([3e-3, 4e-3, 0])
    air = replace(path, cutting=False)
    assert air.extents[1] == pytest.approx([3e-3, 8e-3, 6e-3])
    assert (air.s[-1], air.t[-1]) == (0.0, 0.0)


def test_points_a_nanometre_apart_are_one() -> None:
    near, apart = [0.01, 0.9e-9, 0], [0.01, 1.1e-9, 0]
    for start, moves in ((near, 3), (apart, 4)):
        assert len(toolpath_from_lines([[0, 0, 0], start], [[0.01, 0, 0], [0.02, 0, 0]], 0.03)) == moves
    with pytest.raises(ToolpathError, match="Row 2: start and end are the same point"):
        toolpath_from_lines([[0, 0, 0], [1, 0, 0]], [[1, 0, 0], [1, 0.9e-9, 0]], 0.03)


def test_axes_are_unit_vectors_to_rounding() -> None:
    for size, fits in ((1.0, True), (1 + 0.9e-6, True), (1 + 1.1e-6, False), (1 - 1.1e-6, False)):
        if fits:
            path = toolpath_from_lines([[0, 0, 0]], [[1, 0, 0]], 0.03, k=[0.0, 0.6 * size, 0.8 * size])
            assert path.k[1] == pytest.approx([0, 0.6, 0.8], abs=1e-15)
        else:
            with pytest.raises(ToolpathError, match="found a length that is not 1"):
                toolpath_from_lines([[0, 0, 0]], [[1, 0, 0]], 0.03, k=[0.0, 0.6 * size, 0.8 * size])


@pytest.mark.parametrize("far", [1.001e4, -1e57, 1e305])
def test_a_point_beyond_any_machine_is_refused_by_its_row(far: float) -> None:
    def line(end: float) -> Toolpath:
        return toolpath_from_lines([[0.0, 0.0, 0.0], [0.0, 1.0, 0.0]], [[0.0, 1.0, 0.0], [0.0, end, 0.0]], 0.01)

    with pytest.raises(ToolpathError, match="Row 2"):
        line(far)
    assert line(1e4).s[-1] == 1e4


def cuts(*points: tuple[float, ...]) -> Toolpath:
    """Feed moves through points, mm; a fourth number that is 0 makes a point be reached by a rapid."""
    m, rows = len(points), [(*point, 1.0)[:4] for point in points]
    p, on = np.array([row[:3] for row in rows]) * 1e-3, np.array([row[3] > 0 for row in rows]) & (np.arange(m) > 0)
    return Toolpath(p, [[0.0, 0.0, 1.0]] * m, np.full(m, 0.01), on, np.arange(m), np.zeros(m), np.zeros(m, dtype=int))


@pytest.mark.parametrize("turn", [0.0, 0.7, 2.0, -1.5])
@pytest.mark.parametrize(
    ("points", "line", "way"),
    [
        ([(0, 0, 0), (5, 0, 0), (9, 0, 0)], True, True),
        ([(0, 0, 0), (5, 0, 0), (5, 0, 0), (1, 0, 0), (8, 0, 0)], True, True),  # stands, back, and on
        ([(0, 0, 0), (5, 0, 0), (5, 0.0009, 0)], True, False),  # less than a micrometre aside
        ([(0, 0, 0), (5, 0, 0), (0, 0, 0)], True, True),  # there and back
        ([(0, 0, 0), (5, 0, 0, 0), (9, 3, 0, 0)], False, False),  # no cut at all
        ([(0, 0, 0), (5, 0, 0), (9, 0.002, 0)], False, False),
        ([(0, 0, 0), (5, 0, 0), (5, 3, 0), (9, 0, 0)], False, False),
        ([(0, 0, 5), (0, 0, -1), (9, 0, -1)], True, False),  # a plunge first
        ([(0, 0, 0), (4, 0, -1), (9, 0, 0)], True, False),  # down a ramp and up again, seen from above on one line
        ([(0, 0, 0), (4, 0, -1), (8, 0, -2)], True, True),
        ([(0, 0, 5), (0, 0, -1), (0, 0, 5, 0), (9, 0, 5, 0), (9, 0, -1)], False, True),  # two holes are no groove
        (
            [(0, 7, 0), (0, 0, 0, 0), (5, 0, 0), (9, 4, 0, 0), (6, 0, 0, 0), (8, 0, 0)],
            True,
            True,
        ),  # by rapids
        ([(0, 0, 0), (5, 0, 0), (0, 3, 0, 0), (5, 3, 0)], False, True),  # side by side
    ],
)
def test_cuts_on_one_line_and_cuts_one_way(points, line, way, turn) -> None:
    """Whatever way the whole is turned about Z and moved."""
    path, (c, s) = cuts(*points), (np.cos(turn), np.sin(turn))
    turned = replace(path, p=path.p @ np.array([[c, s, 0], [-s, c, 0], [0, 0, 1]]) + [0.03, -0.2, 0.1])
    assert (turned.on_one_line, turned.goes_one_way) == (line, way)


def test_a_path_without_points_or_with_a_feed_below_zero_is_refused() -> None:
    path = cuts((0, 0, 0), (1, 0, 0))
    with pytest.raises(ToolpathError, match="found no points"):
        Toolpath(np.zeros((0, 3)), [0.0, 0.0, 1.0], *(np.zeros(0),) * 5)
    for bad in (-1e-9, np.nan, np.inf):
        with pytest.raises(ToolpathError, match="feeds must be 0 or more"):
            replace(path, v_f=np.array([0.01, bad]))
    assert replace(path, v_f=np.zeros(2)).t[-1] == 0.0
    with pytest.raises(ToolpathError, match="found no rows"):
        toolpath_from_lines(np.zeros((0, 3)), np.zeros((0, 3)), 0.03)
