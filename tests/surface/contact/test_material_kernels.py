"""What is still material: points against a solid modeller, columns by their definition, swept bodies by stamping."""

from __future__ import annotations

import numpy as np
import pytest

from robomill.cutting.tool import Cutter
from robomill.surface.contact.material_kernels import (
    AXIS,
    ENDS,
    FAR,
    RUN,
    Bounds,
    Dexels,
    cell_of,
    cells_around,
    height_of_run,
    in_column,
    in_stock,
    is_upright,
    looked_up,
    see_move,
)
from robomill.surface.raster import binned
from robomill.surface.stock import Stock


def test_points_of_a_stock_with_a_hole():
    trimesh = pytest.importorskip("trimesh")
    solid = trimesh.creation.torus(9e-3, 3e-3, major_sections=60, minor_sections=30)
    solid.apply_transform(trimesh.transformations.rotation_matrix(0.7, [1, 0.3, 0]))
    stock = Stock(solid.bounds[0], solid.bounds[1], np.asarray(solid.triangles))
    bounds, facets = Bounds(*stock.lower, *stock.upper), binned(stock)
    points = np.random.default_rng(2).uniform(stock.lower - 1e-3, stock.upper + 1e-3, (400, 3))
    found = [in_stock(bounds, facets, tuple(p)) for p in points]
    np.testing.assert_array_equal(found, solid.contains(points))
    assert 40 < sum(found) < 360


def dexels(heights, slack):
    nx, ny, n = heights.shape
    names = np.zeros((nx, ny, 1 + n), dtype=np.int32)
    return Dexels(heights, names, np.zeros(1, dtype=np.int64), 10.0, -4.0, 2.0, 0.5, slack)


def test_a_height_in_a_column_of_layers():
    """Two layers from 5 to 3 and from 1 to -2: the way to the nearest end, positive inside."""
    made = dexels(np.array([[[5.0, 3, 1, -2, -np.inf, np.inf]]]), 0.1)
    for z in np.arange(-3, 6.5, 0.05) + 0.013:
        inside = 3 < z < 5 or -2 < z < 1
        near = min(abs(z - end) for end in (5, 3, 1, -2))
        assert in_column(made, 0, 0, z) == pytest.approx(near if inside else -near)


def test_cells_are_found_by_their_centres():
    """Centres at 10, 12, 14, 16 and -4, -3.5, -3; beyond them the nearest."""
    made = dexels(np.zeros((4, 3, 2)), 0.0)
    x, y = np.array([10, 12, 14, 16.0]), np.array([-4, -3.5, -3])
    rng = np.random.default_rng(0)
    for at in rng.uniform([7, -5], [19, -2], (200, 2)):
        assert cell_of(made, *at) == (np.abs(x - at[0]).argmin(), np.abs(y - at[1]).argmin())
        i, a, j, b = cells_around(made, *at)
        for first, after, axis, place in ((i, a, x, at[0]), (j, b, y, at[1])):
            below, above = np.flatnonzero(axis <= place), np.flatnonzero(axis > place)
            assert first == (below[-1] if len(below) else 0)
            assert after == (above[0] if len(above) else len(axis) - 1)


def test_cells_must_agree():
    """The least of the four, ``FAR`` at most, where all lie on one side by more than the slack; else 0."""
    rng = np.random.default_rng(5)
    heights = 1e-3 * (np.array([5.5, 4.0, 2.5, 0.5]) + rng.uniform(-0.4, 0.4, (2, 2, 4)))
    made = dexels(heights, 5e-5)
    said = set()
    for z in 1e-3 * rng.uniform(-0.5, 6.5, 300):
        deep = np.array([in_column(made, i, j, z) for i in (0, 1) for j in (0, 1)])
        sure = (deep > made.slack).all() or (deep < -made.slack).all()
        truth = np.sign(deep[0]) * min(np.abs(deep).min(), FAR) if sure else 0.0
        assert looked_up(made, (0, 1, 0, 1), z) == pytest.approx(truth, abs=1e-15)
        said.add(np.sign(truth))
    assert said == {-1.0, 0.0, 1.0}


CUTTERS = [
    Cutter("flat", 8e-3),
    Cutter("ball", 8e-3),
    Cutter("bull", 8e-3, corner_radius=1.5e-3),
    Cutter("chamfer", 8e-3, tip_angle=np.radians(80), tip_diameter=1e-3),
]


@pytest.mark.parametrize("lean", [(0.0, 0.0), (0.2, 0.0), (0.1, -0.25)])
@pytest.mark.parametrize("cutter", CUTTERS, ids=lambda c: c.kind)
@pytest.mark.parametrize("end", [(0.012, -0.005, 0.0), (0.01, 0.004, -0.003), (0, 0, -0.004)])
@pytest.mark.parametrize("above", [0.0, 0.05])
def test_what_a_run_sweeps_is_what_its_stamps_cover(cutter, lean, end, above):
    """Height along the tool's axis above the swept surface: the highest of stamps along the move; below 0 under its
    tip, however high above the zero of the part."""
    k = np.array([np.sin(lean[0]), -np.sin(lean[1]) * np.cos(lean[0]), np.cos(lean[1]) * np.cos(lean[0])])
    run = np.zeros((1, RUN))
    run[0, :5] = cutter.solid
    start = np.array([0.001, 0.002, above])
    stop = start + end
    run[0, ENDS:AXIS] = [*start, *stop]
    run[0, AXIS : AXIS + 3] = k
    assert is_upright(run[0]) == (lean == (0.0, 0.0))
    see_move(run[0])
    tips = start + np.linspace(0, 1, 2001)[:, None] * (stop - start)
    rng = np.random.default_rng(6)
    checked = 0
    for point in rng.uniform([-0.006, -0.01, -0.005], [0.02, 0.012, 0.006], (150, 3)):
        point[2] += above
        from_tip = point - tips
        along = from_tip @ k
        across = np.linalg.norm(from_tip - along[:, None] * k, axis=1)
        under = across < cutter.radius
        truth = (along - cutter.profile(np.minimum(across, cutter.radius)))[under].max(initial=-np.inf)
        found = height_of_run(run, 0, *point)
        if under.any() and along[under].max() > 2e-5:
            assert found == pytest.approx(truth, abs=3e-5)
            checked += 1
        elif under.any() and along[under].max() < -2e-5:
            assert found < 0.0
        elif not (across < cutter.radius + 2e-5).any():
            assert found == -np.inf
    assert checked > 10
