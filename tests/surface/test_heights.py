"""Heights and shares of cells by brute force: stamps of the cutter, areas of shapes, tiles that do not show."""

from itertools import pairwise

import numpy as np
import pytest
import shapely

from robomill.cutting.tool import Cutter
from robomill.surface.stock import Stock, fitting_cell, stock_grid, stock_span
from robomill.surface.zmap import cut

STOCK = Stock((0.0, 0.0, -0.02), (0.03, 0.02, 0.0))
CUTTERS = {
    "flat": Cutter("flat", 0.008),
    "ball": Cutter("ball", 0.008),
    "bull": Cutter("bull", 0.008, corner_radius=0.0015),
    "chamfer": Cutter("chamfer", 0.008, tip_angle=np.radians(90.0), tip_diameter=0.001),
}


def stamped(cutter, p, x, y, n=3001):
    """Heights left where the cutter is set down at many places along each move."""
    X, Y = np.meshgrid(x, y, indexing="ij")
    z = np.zeros(X.shape)
    for a, b in pairwise(p):
        for t in np.linspace(0, 1, n):
            tip = a + t * (b - a)
            r = np.hypot(X - tip[0], Y - tip[1])
            near = r <= cutter.radius
            z[near] = np.minimum(z[near], tip[2] + cutter.profile(r[near]))
    return z


@pytest.mark.parametrize("kind", CUTTERS)
def test_heights_are_the_lowest_stamps(kind, monkeypatch):
    monkeypatch.setattr("robomill.surface.removal.TILE_CELLS", 137)
    rng = np.random.default_rng(8)
    p = np.column_stack([rng.uniform(-0.001, 0.031, 6), rng.uniform(-0.001, 0.021, 6), rng.uniform(-4e-3, -1e-3, 6)])
    surface = cut(STOCK, 1e-3, CUTTERS[kind], p)
    expected = stamped(CUTTERS[kind], p, surface.x, surface.y)
    missed = expected - surface.z
    assert missed.min() > -1e-12
    assert missed.max() < 3.5e-3
    assert (missed > 2e-5).mean() < 0.02  # a stamp may miss the rim
    assert (surface.z < 0).mean() > 0.4


@pytest.mark.parametrize("angle", [0.0, 0.4, np.pi / 2, 2.2])
def test_cells_know_their_covered_share(angle):
    """A level slot: mean height of every cell = depth times the area of the cell inside the track."""
    way = np.array([np.cos(angle), np.sin(angle)])
    ends = np.array([[0.0152, 0.0097]]) + np.array([[-0.004], [0.0045]]) * way
    p = np.column_stack([ends, [-0.002, -0.002]])
    surface = cut(STOCK, 7.3e-4, CUTTERS["flat"], p)
    track = shapely.LineString(ends).buffer(0.004, quad_segs=4096)
    half = 0.5 * np.array([surface.dx, surface.dy])
    for i, x in enumerate(surface.x):
        for j, y in enumerate(surface.y):
            cell = shapely.box(x - half[0], y - half[1], x + half[0], y + half[1])
            share = track.intersection(cell).area / cell.area
            assert surface.mean[i, j] == pytest.approx(-0.002 * share, abs=0.02 * 0.002)
            assert (surface.z[i, j] < 0) == track.contains(shapely.Point(x, y))
            assert surface.cut_mask[i, j] == (surface.z[i, j] < 0)
    assert surface.removed_volume == pytest.approx(track.area * 0.002, rel=2e-3)
    assert surface.removed_volume == pytest.approx(-float(surface.mean.sum()) * surface.dx * surface.dy, rel=1e-12)


def test_two_walls_in_one_cell_leave_a_rib():
    """Two slots 0.3 mm apart, seen on cells of 1 mm: the rib is narrower than a cell and still there."""
    p = np.array([[0.0, 0.0056, -0.002], [0.03, 0.0056, -0.002], [0.03, 0.0139, -0.002], [0.0, 0.0139, -0.002]])
    surface = cut(
        Stock((0.004, 0, -0.01), (0.02, 0.02, 0)), 1e-3, CUTTERS["flat"], p, cutting=[False, True, False, True]
    )
    assert surface.removed_volume == pytest.approx(0.016 * 0.016 * 0.002, rel=1e-9)
    row = surface.mean[5]
    assert row[9] == pytest.approx(-0.002 * 0.7, abs=1e-9)


def test_cells_fill_the_stock():
    cells = stock_grid(Stock((0.001, 0.002, 0), (0.0313, 0.0081, 1)), 1e-3)
    assert (cells.nx, cells.ny) == (31, 7)
    assert cells.x[0] - 0.5 * cells.dx == pytest.approx(0.001, abs=1e-15)
    assert cells.x[-1] + 0.5 * cells.dx == pytest.approx(0.0313, abs=1e-15)
    assert cells.y[0] - 0.5 * cells.dy == pytest.approx(0.002, abs=1e-15)
    assert cells.y[-1] + 0.5 * cells.dy == pytest.approx(0.0081, abs=1e-15)
    assert (len(cells.x), len(cells.y)) == (31, 7)
    exact = stock_grid(Stock((0, 0, 0), (0.03, 0.02, 1)), 1e-3)
    assert (exact.nx, exact.ny) == (30, 20)
    assert stock_grid(Stock((0, 0, 0), (0.03, 0.02, 1)), 1.0)[:2] == (1, 1)


def test_the_smallest_cell_that_fits_is_not_much_too_large():
    for length, width, budget in ((0.06, 0.04, 50_000_000), (0.2, 0.1, 10_000), (1.0, 3e-4, 1000)):
        cell = fitting_cell(length, width, budget)
        finer = cell * 0.95
        assert np.ceil(length / cell - 1e-6) * np.ceil(width / cell - 1e-6) <= budget
        assert np.ceil(length / finer) * np.ceil(width / finer) > 0.9 * budget


def test_a_line_over_the_stock():
    rng = np.random.default_rng(4)
    box = shapely.box(0, 0, 0.03, 0.02)
    for angle in [0.0, np.pi / 2, *rng.uniform(0, 7, 30)]:
        centre = np.append(rng.uniform(-0.01, 0.04, 2), 0.0)
        normal = np.array([round(np.cos(angle), 15), round(np.sin(angle), 15), 0.0])
        line = shapely.LineString([centre[:2] - normal[:2], centre[:2] + normal[:2]])
        over = line.intersection(box)
        low, high = stock_span(STOCK, centre, normal)
        if over.is_empty:
            assert low >= high
        else:
            w = (np.array(over.coords) - centre[:2]) @ normal[:2]
            assert (low, high) == pytest.approx((w.min(), w.max()), abs=1e-12)


def test_a_stock_round_a_path():
    cutter = CUTTERS["flat"]
    p = np.array([[0.5, 0.5, 0.05], [0.0, 0.0, 0.01], [0.05, -0.02, 0.002], [9.0, 9.0, 0.05]])
    stock = Stock.from_path(p, cutter, [False, False, True, False])
    np.testing.assert_allclose(stock.lower, [-0.006, -0.026, -0.003], atol=1e-15)
    np.testing.assert_allclose(stock.upper, [0.056, 0.006, 0.011], atol=1e-15)
    np.testing.assert_allclose(Stock.from_path(p[1:3], cutter).upper[2], 0.011)
    np.testing.assert_allclose(Stock.from_path(p[1:3], cutter, top=0.02).upper[2], 0.02)
    np.testing.assert_allclose(stock.size, [0.062, 0.032, 0.014], atol=1e-15)


def test_odd_stocks_are_said():
    cutter = CUTTERS["flat"]
    assert "check the unit" in Stock((0, 0, 0), (6.0, 1, 1)).warnings(cutter)[0]
    assert "check the unit" in Stock((0, 0, 0), (1e-3, 1e-3, 1e-3)).warnings(cutter)[0]
    assert Stock((0, 0, 0), (4.9, 0.1, 0.1)).warnings(cutter) == ()
    assert Stock((0, 0, 0), (1, 0.0081, 1)).warnings(cutter) == ()
    assert len(Stock((0, 0, 0), (0.0079, 1, 1)).warnings(cutter)) == 1
