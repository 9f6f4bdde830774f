"""Moves that must not cut: told as points of the block tell them that are taken away one after the other."""

import numpy as np
import pytest

from robomill.cutting.tool import Cutter
from robomill.cutting.tooling import Tooling
from robomill.surface.collisions import collisions
from robomill.surface.passes import Passes
from robomill.surface.stock import Stock, stock_grid

STOCK, CELL = Stock((0.0, 0.0, -6e-3), (12e-3, 9e-3, 0.0)), 0.5e-3
FINE = 1e-4  # m: apart stand the points of a column, and the places of a cutter on its move


def reach(cutter, points, tip, k):
    """How far (m) above the cutter's lower side points (q, 3) lie, along its axis; -inf beside it."""
    h = (points - tip) @ k
    r = np.linalg.norm(points - tip - h[:, None] * k, axis=1)
    profile = np.zeros(len(r))
    if cutter.kind == "ball":
        profile = cutter.radius - np.sqrt(np.maximum(cutter.radius**2 - r**2, 0.0))
    return np.where(r <= cutter.radius, h - profile, -np.inf)


def by_points(moves, cutters, feed, done=None):
    """How deep (m) each move goes into points that are still there, and into how many; feed moves take them away."""
    cells = stock_grid(STOCK, CELL)
    x, y, z = np.meshgrid(cells.x, cells.y, np.arange(-6e-3 + FINE, 0.0, FINE), indexing="ij")
    points = np.column_stack([x.ravel(), y.ravel(), z.ravel()])
    there = np.ones(len(points), dtype=bool) if done is None else done
    deep, near = np.zeros(len(feed)), np.zeros(len(feed))
    for n, (ends, axes) in enumerate(zip(moves.ends, moves.axes, strict=True)):
        count = int(np.linalg.norm(ends[3:] - ends[:3]) / FINE) + 2
        within = np.full(len(points), -np.inf)
        for t in np.linspace(0.0, 1.0, count):
            tip = ends[:3] + t * (ends[3:] - ends[:3])
            within = np.maximum(within, reach(cutters[n], points, tip, axes[:3]))
        met = within[there]
        deep[n], near[n] = met.max(initial=-np.inf), (met > 0.0).sum()
        if feed[n]:
            there &= within < 0.0
    return deep, near, there


@pytest.mark.parametrize("seed", range(6))
def test_what_points_that_go_one_after_the_other_say(seed):
    """Two cutters, one of them leaning at times, at feed and not."""
    r = np.random.default_rng(seed)
    flat, ball = Cutter("flat", 3e-3), Cutter("ball", 4e-3)
    p = np.column_stack([r.uniform(-2e-3, 14e-3, 24), r.uniform(-2e-3, 11e-3, 24), r.uniform(-3e-3, 1e-3, 24)])
    p[::3] = p[1::3]  # some moves stand still
    ends = np.hstack([p[:-1], p[1:]])
    tilt, turn = np.where(r.random(23) < 0.4, 0.3, 0.0), r.uniform(0.0, 6.0, 23)
    k = np.column_stack([np.sin(tilt) * np.cos(turn), np.sin(tilt) * np.sin(turn), np.cos(tilt)])
    moves, which = Passes(ends, np.hstack([k, k])), r.integers(0, 2, 23)
    feed = r.random(23) < 0.5
    cutters = [(flat, ball)[i] for i in which]
    found = collisions(STOCK, CELL, Tooling((flat, ball), which), moves, (feed, ~feed))
    deep, count, after = by_points(moves, cutters, feed)
    for said, (depth, points) in (
        (found.early, (deep, count)),
        (found.never, by_points(moves, cutters, feed, after)[:2]),
    ):
        clear = ~feed & ((depth < -2 * FINE) | ((depth > 2 * FINE) & (points > 6)))
        assert clear.sum() >= 4
        np.testing.assert_array_equal(said[clear], depth[clear] > 0.0)
        assert not said[feed].any(), "feed moves are meant to cut"


@pytest.mark.parametrize("lean", [0.0, 0.2])
@pytest.mark.parametrize("kind", ["flat", "ball"])
@pytest.mark.parametrize(("deeper", "meets"), [(-1e-6, False), (0.0, False), (0.5e-6, False), (2e-6, True)])
def test_a_rapid_back_through_its_own_groove_meets_nothing_but_what_it_goes_deeper(kind, lean, deeper, meets):
    """A groove cut there at feed; back on the same way, and a micrometre is rounding."""
    cutter, k = Cutter(kind, 4e-3), np.array([np.sin(lean), 0.0, np.cos(lean)])
    there = np.array([-3e-3, 4.2e-3, -2e-3, 15e-3, 4.7e-3, -2.5e-3])
    back = np.concatenate([there[3:], there[:3]]) - deeper * np.array([0.0, 0.0, 1.0] * 2)
    moves, feed = Passes(np.array([there, back]), np.tile(k, (2, 2))), np.array([True, False])
    found = collisions(STOCK, CELL, Tooling((cutter,), np.zeros(2, dtype=int)), moves, (feed, ~feed))
    np.testing.assert_array_equal(found.early, [False, meets])
    np.testing.assert_array_equal(found.never, [False, meets])
