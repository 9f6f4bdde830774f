"""Heights and shares of cells by brute force: stamps of the cutter, areas of shapes, tiles that do not show."""

from itertools import pairwise

import numpy as np
import pytest
import shapely

from robomill.cutting.tool import Cutter
from robomill.surface.stock import Stock
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
