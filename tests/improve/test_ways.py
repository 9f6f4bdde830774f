"""Paths that cut the same part otherwise, by their geometry."""

from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest

import robomill as rm
from robomill.errors import ToolpathError
from robomill.improve.ways import CLEAR, PLUNGE_FEED, fed, in_levels, turned_round

PATH = rm.read_gcode("G21 G90 S12000 M3\nG0 X-10 Y0 Z5\nG0 Z-2\nG1 X30 F1200\nG1 Y10 F600\nG0 Z5\nG0 X-10 Y0\nM2\n")


def cuts(path: rm.Toolpath) -> set[tuple[tuple[float, ...], tuple[float, ...], float]]:
    """Straight cuts below the face of the part as start, end and feed, mm."""
    ends = np.round(path.p * 1e3, 6) + 0.0
    moves = [
        (tuple(ends[i - 1]), tuple(ends[i]), round(float(path.v_f[i] * 6e4), 6))
        for i in range(1, len(path))
        if path.cutting[i]
    ]
    return {move for move in moves if move[0] != move[1]}


def test_another_feed_changes_nothing_but_the_time() -> None:
    quick = fed(PATH, 2.0)
    assert quick.t[-1] == pytest.approx(PATH.t[-1] / 2.0)
    np.testing.assert_array_equal(quick.p, PATH.p)


def test_turned_round_the_same_cuts_go_backwards_each_with_its_feed() -> None:
    back = turned_round(PATH, 0.0)
    there = {(end, start, feed) for start, end, feed in cuts(PATH)}
    extra = cuts(back) - there
    assert there <= cuts(back)
    assert len(extra) == 1, "the way into the material, where it came out as a rapid"
    ((start, end, feed),) = extra
    assert (start[2], end[2]) == (2.0, -2.0), "from where rapids go above the part"
    assert feed == pytest.approx(PLUNGE_FEED * 6e4)
    assert back.t[-1] == pytest.approx(PATH.t[-1] + 4e-3 / PLUNGE_FEED)
    twice = turned_round(back, 0.0).p
    stop = np.flatnonzero(np.isclose(twice[:, 2], 2e-3))
    np.testing.assert_allclose(np.delete(twice, stop, axis=0), PATH.p)


def test_each_move_keeps_its_line_whichever_way_it_goes() -> None:
    """Line 4 cuts along x and line 5 along y; round again, the tool starts where line 7 led and ends where 2 began."""
    back, twice = turned_round(PATH, 0.0), in_levels(PATH, np.array([1e-3, 0.0]), 0.0)
    for path in (PATH, back, twice):
        step = np.diff(path.p, axis=0)
        cut = path.cutting[1:] & (step[:, 2] == 0.0)
        np.testing.assert_array_equal(path.block[1:][cut], np.where(step[cut, 0] != 0.0, 4, 5))
    assert (back.block[0], back.block[-1]) == (7, 2)
    three = rm.Toolpath.from_points(p_mm=[[0, 0, -1], [9, 0, -1], [9, 5, -1]], feed_mm_min=600)
    levels = in_levels(replace(three, block=np.array([4, 5, 6])), np.array([1e-3, 0.0]), 0.0)
    np.testing.assert_array_equal(levels.block, [4, 5, 6, 4, 4, 4, 5, 6])  # over to where line 4 leads


def test_a_rapid_that_rises_aslant_is_stopped_on_its_line_and_waits_at_its_end_alone() -> None:
    """From 4 mm under the stop to 2 mm above it: at two thirds of the way, leaning as the tool leant before."""
    path = rm.Toolpath.from_points(p_mm=[[0, 0, -2], [9, 0, -2], [18, 3, 4]], feed_mm_min=600)
    path = replace(path, cutting=np.array([False, True, False]), dwell=np.array([0.0, 0.0, 3.0]))
    back = turned_round(path, 0.0)
    np.testing.assert_allclose(back.p * 1e3, [[18, 3, 4], [15, 2, 2], [9, 0, -2], [0, 0, -2]], atol=1e-12)
    assert back.dwell.sum() == 3.0
    np.testing.assert_array_equal(back.cutting, [False, False, True, True])


def test_levels_end_on_the_path_and_go_over_the_part_between() -> None:
    path = in_levels(PATH, np.array([1e-3, 0.0]), 0.0)
    assert cuts(PATH) <= cuts(path)
    raised = {((*a[:2], a[2] + 1.0), (*b[:2], b[2] + 1.0), feed) for a, b, feed in cuts(PATH)}
    assert cuts(path) == cuts(PATH) | raised
    aside = np.linalg.norm(np.diff(path.p[:, :2], axis=0), axis=1) > 1e-9
    rapid = aside & ~path.cutting[1:]
    high = in_levels(PATH, np.array([1e-3, 0.0]), 7e-3)
    assert high.p[:, 2].max() == pytest.approx(7e-3 + CLEAR)  # above the stock where that is higher than the path
    between = len(PATH)
    assert (path.p[between : between + 2, 2] >= 5e-3 + CLEAR - 1e-12).all()
    assert (path.p[1:][rapid][:, 2] >= -2e-3).all()
    assert path.t[-1] == pytest.approx(2.0 * PATH.t[-1])


def test_what_would_cut_air_is_a_rapid_and_a_tool_that_leans_is_refused() -> None:
    high = in_levels(PATH, np.array([3e-3, 0.0]), 0.0)
    assert high.t[-1] == pytest.approx(PATH.t[-1])
    leaning = rm.Toolpath.from_points(p_mm=[[0, 0, -2], [9, 0, -2]], feed_mm_min=600, k=(0.0, 0.1, 1.0))
    with pytest.raises(ToolpathError, match="leans"):
        in_levels(leaning, np.zeros(2), 0.0)


def test_turned_round_a_program_that_ends_in_the_part_begins_there_and_what_goes_level_stays_a_rapid() -> None:
    """Down from Z 5, across below the face, with the tool leaning otherwise at every point; nothing comes out."""
    p = np.array([[-10, 0, 5], [-10, 0, -2], [30, 0, -2], [30, 40, -2], [-10, 40, -2]]) * 1e-3
    k = np.array([[0.0, 0.0, 1.0], [0.0, 0.6, 0.8], [0.6, 0.0, 0.8], [0.0, -0.6, 0.8], [-0.6, 0.0, 0.8]])
    path = rm.Toolpath.from_points(p, [0.0, 0.0, 0.002, 0.0, 0.01], cutting=[0, 0, 1, 0, 1], k=k)
    back = turned_round(path, 0.0)
    np.testing.assert_array_equal(back.p, p[::-1])
    np.testing.assert_array_equal(back.k, k[::-1])
    assert back.cutting.tolist() == [False, True, False, True, False]
    np.testing.assert_allclose(back.v_f[[1, 3]], [0.01, 0.002])


@pytest.mark.parametrize("feed", [120.0, 300.0, 900.0])
def test_turned_round_it_goes_in_with_the_lowest_feed_of_the_program_or_that_of_plunges(feed: float) -> None:
    text = f"G21 G90 S12000 M3\nG0 X-10 Y0 Z5\nG0 Z-2\nG1 X30 F1200\nG1 Y10 F{feed}\nG0 Z5\nM2\n"
    back = turned_round(rm.read_gcode(text), 0.0)
    down = back.cutting & (np.diff(back.p[:, 2], prepend=9.0) < 0.0)
    assert down.sum() == 1
    assert 6e4 * back.v_f[down][0] == pytest.approx(min(feed, 300.0))


def test_a_path_leans_if_the_tool_does_at_one_of_its_points() -> None:
    k = np.array([[0.0, 0.0, 1.0], [0.0, 0.6, 0.8], [0.0, 0.0, 1.0]])
    path = rm.Toolpath.from_points(p_mm=[[0, 0, -2], [9, 0, -2], [9, 5, -2]], feed_mm_min=600, k=k)
    with pytest.raises(ToolpathError, match="leans"):
        in_levels(path, np.zeros(2), 0.0)


@pytest.mark.parametrize("raised", [0.0, 1.0, 2.0, 3.5])
def test_a_move_cuts_air_where_both_of_its_ends_lie_on_the_face_or_above_it(raised: float) -> None:
    """In and out at feed, through the air, down to the face, along it, and into the material aslant."""
    p = np.array(
        [[0, 50, 1], [0, 51, -2], [9, 52, -2], [9, 53, 1], [18, 54, 1], [18, 55, 0], [27, 56, 0], [30, 57, -1]]
    )
    path = rm.Toolpath.from_points(p_mm=p, feed_mm_min=600, cutting=[False] + [True] * 7)
    found = in_levels(path, np.array([raised * 1e-3]), 0.0)
    z = p[:, 2] + raised
    cuts_ = [False, *(min(a, b) < 0.0 for a, b in pairwise(z))]
    np.testing.assert_array_equal(found.cutting, cuts_)
    np.testing.assert_allclose(found.v_f, np.where(cuts_, 0.01, 0.0))


def test_between_levels_it_rises_where_one_ends_goes_over_to_where_the_next_begins_and_down() -> None:
    path = rm.Toolpath.from_points(p_mm=[[0, 0, -3], [9, 1, -4], [8, 5, -5], [7, 6, -6]], feed_mm_min=600)
    found = in_levels(path, np.array([2e-3, 0.0]), -1e-3)
    over = [[7, 6, 1], [0, 0, 1], [0, 0, -3]]  # 2 mm above the stock
    told = np.array([[0, 0, -1], [9, 1, -2], [8, 5, -3], [7, 6, -4], *over, [9, 1, -4], [8, 5, -5], [7, 6, -6]])
    np.testing.assert_allclose(found.p, told * 1e-3, atol=1e-15)
    assert not found.cutting[4:7].any()
