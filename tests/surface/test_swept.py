"""The height a leaning cutter leaves on a line, by looking along every vertical for the cutter's solid."""

from __future__ import annotations

import numpy as np
import pytest

from robomill.cutting.tool import Cutter
from robomill.cutting.tooling import Tooling
from robomill.errors import SurfaceError
from robomill.surface.stock import Stock
from robomill.surface.swept import station_at, swept_path

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
