"""The height a leaning cutter leaves on a line, by looking along every vertical for the cutter's solid."""

from __future__ import annotations

import numpy as np
import pytest

from robomill.cutting.tool import Cutter
from robomill.cutting.tooling import Tooling
from robomill.errors import SurfaceError
from robomill.surface.stock import Stock
from robomill.surface.swept import Body, station_at, swept_path

R, LONG = 4e-3, 60e-3
BLOCK = Stock([-40e-3, -40e-3, -20e-3], [40e-3, 40e-3, 0.0])
Z = np.arange(-12e-3, 0.0, 4e-6)


def looked_at(x, y, tips, k):
    """Where the material begins, seen from above at (x, y): cylinders of radius R stand above the tips along k.

    What lies under an overhang is not seen.
    """
    line = np.stack([np.full(len(Z), x), np.full(len(Z), y), Z], axis=1)
    gone = np.zeros(len(Z), dtype=bool)
    for tip in tips:
        along = (line - tip) @ k
        beside = np.linalg.norm(line - tip - along[:, None] * k, axis=1)
        gone |= (along >= 0) & (along <= LONG) & (beside <= R)
    left = Z[~gone]
    return left[-1] + Z[1] - Z[0] if len(left) else Z[0]


@pytest.mark.parametrize("lean_deg", [0.0, 20.0, 40.0])
@pytest.mark.parametrize("turn", [0.0, 2.0, 4.0])
@pytest.mark.parametrize("away", [-6e-3, 0.0, 6e-3, 10e-3])
def test_a_leaning_cutter_reaches_lines_far_from_its_tip(lean_deg, turn, away):
    lean = np.radians(lean_deg)
    side, feed = np.array([np.cos(turn), np.sin(turn), 0.0]), np.array([-np.sin(turn), np.cos(turn), 0.0])
    k = np.sin(lean) * side + np.array([0.0, 0.0, np.cos(lean)])
    ends = np.stack([-0.5e-3 * feed, 0.5e-3 * feed]) + np.array([1e-3, -2e-3, -8e-3])
    path = swept_path(
        BLOCK, Tooling.single(Cutter("flat", 2 * R), 2), ends, np.tile(k, (2, 1)), np.array([False, True])
    )
    centre = ends.mean(axis=0) + away * side
    w = np.array([-5e-3, -3e-3, -1e-3, 0.0, 2e-3, 3.5e-3])
    height = path.heights(centre, feed, 6e-3)(w)
    tips = ends[0] + np.linspace(0, 1, 21)[:, None] * (ends[1] - ends[0])
    expected = [looked_at(*(centre + v * feed)[:2], tips, k) for v in w]
    np.testing.assert_allclose(height, expected, atol=3e-5)


@pytest.mark.parametrize("rapids", [0, 1, 3])
def test_a_station_counts_feed_moves_alone(rapids):
    """Along a straight line: rapids of 5 mm, a feed of 10 mm, a rapid of 5 mm, a feed of 20 mm."""
    lengths = np.array([5e-3] * rapids + [10e-3, 5e-3, 20e-3])
    x = np.concatenate([[0.0], np.cumsum(lengths)])
    p, cutting = np.column_stack([x, 0 * x, 0 * x]), np.array([False] * (rapids + 1) + [True, False, True])
    begin = 5e-3 * rapids
    for station, at in ((0.0, 0.0), (4e-3, 4e-3), (9.9e-3, 9.9e-3), (12e-3, 17e-3), (30e-3, 35e-3)):
        found = station_at(p, cutting, station)
        assert found.centre[0] == pytest.approx(begin + at, abs=1e-15)
        np.testing.assert_allclose(found.normal, [0.0, 1.0, 0.0], atol=1e-15)
    with pytest.raises(SurfaceError):
        station_at(p, cutting, 31e-3)
    with pytest.raises(SurfaceError):
        station_at(p, np.zeros(len(p), dtype=bool), 0.0)


def test_moves_near_a_line_are_those_whose_track_may_meet_it():
    """Plunges beside a line along Y of 10 mm either way: of 4 mm radius, up to 4 mm beside or beyond it."""
    places = np.array([(4, 0), (4.1, 0), (-4, 0), (-4.1, 0), (0, 14), (0, 14.1), (0, -14), (0, -14.1), (4, -14)])
    ends = np.column_stack([places, 0 * places[:, 0], places, 0 * places[:, 0] - 4]) / 1024
    body = Body(Cutter("flat", 8 / 1024), ends, np.tile([0.0, 0.0, 1.0], (len(ends), 1)))
    found, axes = body.near((np.zeros(3), np.array([0.0, 1.0, 0.0]), 10 / 1024), 0.0)
    np.testing.assert_array_equal(found, ends[[0, 2, 4, 6, 8]])
    assert axes.shape == (5, 3)
    turned, _ = body.near((np.zeros(3), np.array([1.0, 0.0, 0.0]), 10 / 1024), 0.0)
    np.testing.assert_array_equal(turned, ends[:4])


def test_moves_that_pass_a_line_by_are_near_it():
    """Ends on either side of the line, or one at its foot; leaning, as far as the side of the tool reaches below 0."""
    ends = np.array([[-50, 3, -4, 60, 3, -4], [-50, 15, -4, 60, 15, -4], [0, -30, -4, 0, 30, -4], [6, 0, -5, 9, 0, -5]])
    upright, leaning = np.tile([0.0, 0.0, 1.0], (4, 1)), np.tile([-0.6, 0.0, 0.8], (4, 1))
    line = (np.zeros(3), np.array([0.0, 1.0, 0.0]), 10e-3)
    for axes, expected in ((upright, [0, 2]), (leaning, [0, 1, 2, 3])):
        found, _ = Body(Cutter("flat", 8e-3), ends * 1e-3, axes).near(line, 0.0)
        np.testing.assert_array_equal(found, ends[expected] * 1e-3)


def test_a_station_at_a_corner_is_the_end_of_the_move_before_and_the_begin_has_the_first():
    p = np.array([[0.0, 0, 0], [3, 0, 0], [3, 0, 0], [3, 4, 0], [3, 4, -2]])
    cutting = np.array([False, True, True, True, True])
    for station, entry, fraction, centre, normal in (
        (0.0, 1, 0.0, (0, 0, 0), (0, 1, 0)),
        (3.0, 1, 1.0, (3, 0, 0), (0, 1, 0)),
        (5.0, 3, 0.5, (3, 2, 0), (-1, 0, 0)),
        (7.0, 3, 1.0, (3, 4, 0), (-1, 0, 0)),
        (8.0, 4, 0.5, (3, 4, -1), None),
        (9.0, 4, 1.0, (3, 4, -2), None),
    ):
        found = station_at(p, cutting, station)
        assert (found.entry, found.fraction) == (entry, pytest.approx(fraction))
        np.testing.assert_allclose(found.centre, centre)
        if normal is None:
            assert found.normal is None
        else:
            np.testing.assert_allclose(found.normal, normal, atol=1e-15)
    for station in (-1e-6, 9.0 + 1e-6):
        with pytest.raises(SurfaceError, match="the feed path runs from 0 to"):
            station_at(p, cutting, station)
    lead = station_at(np.vstack([[[-9.0, 0, 0]], p]), np.append(False, cutting), 0.0)
    assert (lead.entry, lead.fraction) == (2, 0.0)
