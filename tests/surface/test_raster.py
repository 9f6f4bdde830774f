"""Heights of a mesh over a grid: against solids in closed form, and ray by ray against a solid modeller."""

from __future__ import annotations

import numpy as np
import pytest

from robomill.surface.raster import binned, skin, skin_on_line, stock_heights, stock_layers
from robomill.surface.stock import Stock, stock_grid

trimesh = pytest.importorskip("trimesh")

R, HOLE, TUBE = 12e-3, 9e-3, 3e-3


def stock_of(solid):
    return Stock(solid.bounds[0], solid.bounds[1], np.asarray(solid.triangles))


def ring():
    """A ring that lies flat: a hole in the middle."""
    return trimesh.creation.torus(HOLE, TUBE, major_sections=240, minor_sections=120)


def standing_ring():
    """A ring that stands: two layers over its middle."""
    return ring().apply_transform(trimesh.transformations.rotation_matrix(np.pi / 2, [1, 0, 0]))


def test_the_skin_of_a_ball_and_of_a_ring():
    ball = stock_of(trimesh.creation.icosphere(subdivisions=5, radius=R))
    x, y = np.linspace(-1.3 * R, 1.3 * R, 41), np.linspace(-1.2 * R, 1.2 * R, 37)
    r = np.hypot(*np.meshgrid(x, y, indexing="ij"))
    top, layers = skin(ball.triangles, x, y)
    inside = r < 0.97 * R
    np.testing.assert_allclose(top[inside], np.sqrt(R * R - r[inside] ** 2), atol=2e-5)
    assert np.isneginf(top[r > R]).all()
    assert (layers[inside] == 2).all()
    heights = stock_heights(ball, x, y)
    np.testing.assert_allclose(heights[r > R], -R, rtol=1e-3)
    flat = stock_of(ring())
    top = stock_heights(flat, x, y)
    over = np.abs(r - HOLE) < 0.97 * TUBE
    np.testing.assert_allclose(top[over], np.sqrt(TUBE**2 - (r[over] - HOLE) ** 2), atol=2e-5)
    np.testing.assert_allclose(top[np.abs(r - HOLE) > 1.02 * TUBE], flat.lower[2])
    assert stock_heights(Stock((0, 0, 0), (1, 1, 0.5)), x, y) == 0.5


def test_layers_begin_and_end_where_rays_meet_the_mesh():
    solid = standing_ring()
    stock = stock_of(solid)
    cells = stock_grid(stock, 1.1e-3)
    heights, mesh = stock_layers(stock, cells, spare=1)
    assert heights.shape == (cells.nx, cells.ny, 6)
    assert len(mesh.triangles) == len(stock.triangles)
    rays = np.array([[x, y, 1.0] for x in cells.x for y in cells.y])
    down = np.broadcast_to([0, 0, -1.0], rays.shape)
    places, index, _ = solid.ray.intersects_location(rays, down, multiple_hits=True)
    for n, (i, j) in enumerate(np.ndindex(cells.nx, cells.ny)):
        met = np.unique(np.round(np.sort(places[index == n, 2])[::-1], 9))[::-1]
        found = heights[i, j][np.isfinite(heights[i, j])]
        if len(met) % 2 == 0:  # a ray along an edge may be counted twice
            np.testing.assert_allclose(found, met, atol=1e-6)
        assert np.isneginf(heights[i, j][len(found) :: 2]).all()
        assert np.isposinf(heights[i, j][len(found) + 1 :: 2]).all()
    assert (np.isfinite(heights).sum(axis=2) == 4).any(), "two layers somewhere"


def test_a_block_is_one_layer():
    block = Stock((0, 0, -2e-3), (5e-3, 4e-3, 1e-3))
    cells = stock_grid(block, 1e-3)
    assert stock_layers(block, cells)[0].tolist() == np.full((5, 4, 1), 1e-3).tolist()
    heights, mesh = stock_layers(block, cells, spare=1)
    assert heights[2, 3].tolist() == [1e-3, -2e-3, -np.inf, np.inf]
    assert len(mesh.triangles) == 0


def test_an_open_mesh_reaches_down_to_the_bottom():
    lid = np.array([[[0, 0, 1e-3], [4e-3, 0, 1e-3], [0, 4e-3, 1e-3]]])
    stock = Stock((0, 0, -2e-3), (4e-3, 4e-3, 1e-3), lid)
    heights, _ = stock_layers(stock, stock_grid(stock, 1e-3))
    assert heights[0, 0].tolist() == pytest.approx([1e-3, -2e-3])
    assert heights[3, 3].tolist() == [-np.inf, np.inf]


def test_every_triangle_is_in_the_squares_it_covers():
    stock = stock_of(standing_ring())
    mesh = binned(stock)
    rows, columns = (int(side / mesh.size) + 1 for side in stock.size[:2])
    assert len(mesh.first) == rows * columns + 1
    rng = np.random.default_rng(1)
    for n in rng.integers(0, len(stock.triangles), 60):
        u = rng.dirichlet([1, 1, 1], 20)
        for x, y, _ in u @ stock.triangles[n]:
            b = int((x - stock.lower[0]) / mesh.size) * columns + int((y - stock.lower[1]) / mesh.size)
            assert n in mesh.faces[mesh.first[b] : mesh.first[b + 1]]


@pytest.mark.parametrize("normal", [(1.0, 0.0, 0.0), (0.0, -1.0, 0.0)])
def test_the_skin_over_a_line_holds_to_the_very_ends_of_a_block(normal):
    """A box of 8 x 6 mm, its faces upright: at its corners' distance and between them its top, beyond its bottom."""
    box = stock_of(trimesh.creation.box((8 / 1024, 8 / 1024, 2 / 1024)))
    height = skin_on_line(box, np.array([0.0, 1 / 1024, 0.0]) * abs(normal[0]), np.array(normal))
    w = np.array([-4.1, -4.0, -3.9, -1.0, 0.0, 2.0, 4.0, 4.1]) / 1024
    np.testing.assert_allclose(height(w) * 1024, [-1, 1, 1, 1, 1, 1, 1, -1], atol=1e-9)


def test_the_skin_over_a_line_is_that_of_a_slope_between_its_corners():
    """One triangle over (0, 0), (6, 0), (0, 6), rising 1 in 2 along X from -3, seen along lines in X and in Y."""
    slope = np.array([[[0, 0, -3.0], [6, 0, 0.0], [0, 6, -3.0]]])
    stock = Stock((0, 0, -9.0), (6, 6, 0.0), slope)
    for centre, normal, points in (
        ((0, 2, 0), (1, 0, 0), {-1.0: -9, 0.0: -3, 2.0: -2, 4.0: -1, 4.5: -9}),
        ((4, 2, 0), (-1, 0, 0), {-0.5: -9, 0.0: -1, 2.0: -2, 4.0: -3}),
        ((2, 0, 0), (0, 1, 0), {-1.0: -9, 0.0: -2, 4.0: -2, 4.1: -9}),
        ((0, 7, 0), (1, 0, 0), {0.0: -9, 3.0: -9}),
    ):
        height = skin_on_line(stock, np.array(centre, float), np.array(normal, float))
        np.testing.assert_allclose(height(np.array([*points])), [*points.values()], atol=1e-12)


@pytest.mark.parametrize("angle", [0.0, 0.4, 1.7])
def test_the_skin_over_a_line_is_the_skin_at_its_points(angle):
    stock = stock_of(standing_ring())
    normal = np.array([np.cos(angle), np.sin(angle), 0.0])
    centre = np.array([1.1e-3, 0.3e-3, 0.0])
    height = skin_on_line(stock, centre, normal)
    w = np.linspace(-15e-3, 15e-3, 61)
    for at, found in zip(w, height(w), strict=True):
        x, y = (centre + at * normal)[:2]
        assert found == pytest.approx(float(stock_heights(stock, np.array([x]), np.array([y]))[0, 0]), abs=2e-6)
    plain = skin_on_line(Stock((0, 0, 0), (1, 1, 0.25)), centre, normal)
    assert plain(w).tolist() == [0.25] * 61


@pytest.mark.parametrize("sides", [(64.0, 32.0), (32.0, 64.0), (64.0, 63.0), (64.0, 1.0)])
@pytest.mark.parametrize("short", [0.0, 0.5e-9, -0.5e-9])
def test_squares_end_with_the_mesh_where_it_ends_with_a_square(sides, short):
    """To half a nanometre: every corner of the mesh is in a square that there is, of its own row and column."""
    x, y = np.array(sides) * 1e-4 - short * np.array([sides[0] < 64, sides[1] < 64])
    corners = np.array([[0.0, 0.0, 0.0], [x, 0.0, 0.0], [x, y, 0.0], [0.0, y, 0.0]])
    stock = Stock((0.0, 0.0, -1e-3), (x, y, 0.0), corners[[[0, 1, 2], [0, 2, 3]]])
    mesh = binned(stock)
    rows, columns = (int(side / mesh.size) + 1 for side in stock.size[:2])
    assert len(mesh.first) == rows * columns + 1
    where = np.minimum(((corners[:, :2] - stock.lower[:2]) / mesh.size).astype(int), [rows - 1, columns - 1])
    for corner, (i, j) in enumerate(where):
        held = set(mesh.faces[mesh.first[i * columns + j] : mesh.first[i * columns + j + 1]])
        assert held >= {n for n, face in enumerate([[0, 1, 2], [0, 2, 3]]) if corner in face}
