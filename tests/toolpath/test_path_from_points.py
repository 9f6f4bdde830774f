"""Paths from arrays of points."""

from __future__ import annotations

import numpy as np
import pytest

import robomill as rm
from robomill.errors import ToolpathError

P = np.array([[0, 0, 5.0], [0, 0, -2], [100, 0, -2], [100, 0, 5]])


def test_points_in_mm_and_in_m_are_the_same_path() -> None:
    in_mm = rm.Toolpath.from_points(p_mm=P, feed_mm_min=[0, 300, 1800, 0], spindle_1_min=12_000)
    in_si = rm.Toolpath.from_points(P * 1e-3, [0, 300 * 1e-3 / 60, 1800 * 1e-3 / 60, 0], n_s=12_000 * (1 / 60))
    assert in_mm.digest() == in_si.digest()
    assert in_mm.cutting.tolist() == [False, True, True, False]
    assert in_mm.block.tolist() == [1, 2, 3, 4]
    np.testing.assert_allclose(in_mm.v_f, [0, 0.005, 0.03, 0])


def test_it_is_the_program_that_says_the_same() -> None:
    """Read from G-code, whose start is at the origin: the same moves and feeds."""
    read = rm.read_gcode("G21 G90 G94\nG0 X0 Y0 Z5\nS12000 M3\nG1 Z-2 F300\nX100 F1800\nG0 Z5\nM2\n")
    made = rm.Toolpath.from_points(p_mm=P, feed_mm_min=[0, 300, 1800, 0], spindle_1_min=12_000)
    np.testing.assert_allclose(read.p[-4:], made.p, atol=1e-15)
    np.testing.assert_allclose(read.v_f[-4:], made.v_f)
    assert read.cutting[-4:].tolist() == made.cutting.tolist()


def test_rapids_are_where_no_feed_is_or_where_they_are_named() -> None:
    path = rm.Toolpath.from_points(p_mm=P, feed_mm_min=600, cutting=[True, False, True, True])
    assert path.cutting.tolist() == [False, False, True, True]
    assert path.v_f.tolist() == [0.0, 0.0, 0.01, 0.01]


def test_a_tool_axis_of_any_length_is_one_of_length_1() -> None:
    path = rm.Toolpath.from_points(p_mm=P, feed_mm_min=600, k=[0, 0.6, 1.6])
    np.testing.assert_allclose(np.linalg.norm(path.k, axis=1), 1.0, rtol=1e-15)
    each = rm.Toolpath.from_points(p_mm=P, feed_mm_min=600, k=np.tile([0, 0, 2.0], (4, 1)), tool=[1, 1, 2, 2])
    assert each.k.tolist() == [[0, 0, 1]] * 4
    assert each.tool.tolist() == [1, 1, 2, 2]


@pytest.mark.parametrize(
    ("given", "words"),
    [
        ({"p": P, "v_f": 0.03}, "found 100 m, .* give p in m, or p_mm"),
        ({"p": P * 1e-3, "v_f": 1800}, "found 1800 m/s, .* feed_mm_min=1800"),
        ({"p": P * 1e-3, "v_f": 0.03, "n_s": 12_000}, "spindle_1_min=12000"),
        ({"p_mm": P}, "give v_f or feed_mm_min"),
        ({"feed_mm_min": 600}, "give p or p_mm"),
        ({"p": P * 1e-3, "p_mm": P, "v_f": 0.03}, "give one of them"),
        ({"p_mm": P, "feed_mm_min": [1, 2]}, "or 4, one a point"),
        ({"p_mm": P, "feed_mm_min": -5}, "found −5 mm/min; expected 0 mm/min to 600.000 mm/min"),
        ({"p_mm": P, "feed_mm_min": 1e7}, "expected 0 mm/min to 600.000 mm/min"),
        ({"p_mm": P, "feed_mm_min": 600, "spindle_1_min": 0.5}, "expected at least 1: .* n_s=0.5"),
        ({"p_mm": P, "feed_mm_min": 600, "spindle_1_min": -5}, "found −5 min⁻¹; expected 0 min⁻¹ or more"),
        ({"p_mm": P, "feed_mm_min": 600, "k": (0, 0, 0)}, "without length"),
        ({"p_mm": P[:, :2], "feed_mm_min": 600}, "three numbers .* found 4 x 2"),
        ({"p_mm": P[0], "feed_mm_min": 600}, "three numbers .* found 3"),
        ({"p_mm": [], "feed_mm_min": 600}, "three numbers .* found 0"),
        ({"p_mm": P, "feed_mm_min": 600, "cutting": ["no"] * 4}, "Cutting: expected True or False"),
        ({"p_mm": P, "feed_mm_min": 600, "tool": 1.5}, "Tool: expected whole numbers from 0"),
        ({"p_mm": P, "feed_mm_min": 600, "tool": "T1"}, "Tool: expected whole numbers from 0"),
        ({"p_mm": P * np.nan, "feed_mm_min": 600}, "finite"),
    ],
)
def test_what_is_no_path_is_refused(given, words: str) -> None:
    with pytest.raises(ToolpathError, match=words):
        rm.Toolpath.from_points(**given)


@pytest.mark.parametrize("points", [[[0, 0, -2]], np.empty((0, 3))])
def test_a_path_has_a_start_and_an_end(points) -> None:
    with pytest.raises(ToolpathError, match="^Points: found (1 point|0 points), expected two at least"):
        rm.Toolpath.from_points(p_mm=points, feed_mm_min=600)


@pytest.mark.parametrize("away", [0.0, 400.0])
@pytest.mark.parametrize(("size", "read"), [(0.09, False), (0.11, True)])
def test_a_path_in_mm_is_not_as_small_as_a_tenth_wherever_it_lies(away: float, size: float, read: bool) -> None:
    """Its size is that of its extents, be they about zero or far from it."""
    points = np.array([away, 0, -away]) + size * np.array([[0, 0, 0], [1, 0.5, 0], [1, 1, 1]])
    given = {"feed_mm_min": 600, "spindle_1_min": 9000}
    if read:
        assert len(rm.Toolpath.from_points(p_mm=points, **given)) == 3
    else:
        with pytest.raises(ToolpathError, match=r"Points: the whole path lies within 0\.09 mm: p_mm is in mm"):
            rm.Toolpath.from_points(p_mm=points, **given)


def test_every_point_has_an_axis_of_some_length() -> None:
    """However short: a direction is all that is asked."""
    axes = np.tile([0, 3e-9, 4e-9], (4, 1))
    path = rm.Toolpath.from_points(p_mm=P, feed_mm_min=600, k=axes)
    np.testing.assert_allclose(path.k, np.tile([0, 0.6, 0.8], (4, 1)), atol=1e-12)
    for row in range(4):
        short = axes.copy()
        short[row] = 0.0
        with pytest.raises(ToolpathError, match=r"^Tool axis: found one without length"):
            rm.Toolpath.from_points(p_mm=P, feed_mm_min=600, k=short)
