"""The part as a solid: closed, outward, with the volume under its skin; stocks read from solids, asked by ray."""

import numpy as np
import pytest
from scipy.spatial import ConvexHull

from robomill.cutting.tool import Cutter
from robomill.surface.mesh import kept_cells, to_mesh
from robomill.surface.raster import skin, skin_on_line, stock_heights
from robomill.surface.stock import Stock
from robomill.surface.zmap import cut

STOCK = Stock((0.0, 0.0, -0.01), (0.02, 0.012, 0.0))
SURFACE = cut(STOCK, 1e-3, Cutter("ball", 0.006), np.array([[0.004, 0.005, -0.002], [0.015, 0.008, -0.003]]))


def volume(mesh):
    """By the divergence theorem: outward faces make it positive."""
    a, b, c = (mesh.vertices[mesh.faces[:, n]] for n in range(3))
    return float(np.einsum("ij,ij->i", a, np.cross(b, c)).sum() / 6)


@pytest.mark.parametrize("max_faces", [2_000_000, 90])
def test_every_edge_is_shared_by_two_faces_that_run_against_each_other(max_faces):
    mesh = to_mesh(SURFACE, max_faces=max_faces)
    edges = np.concatenate([mesh.faces[:, [i, j]] for i, j in ((0, 1), (1, 2), (2, 0))]).tolist()
    assert len({tuple(edge) for edge in edges}) == len(edges)
    assert {tuple(edge) for edge in edges} == {(b, a) for a, b in edges}
    assert (np.unique(mesh.faces) == np.arange(len(mesh.vertices))).all()
    np.testing.assert_allclose(mesh.vertices.min(axis=0), STOCK.lower, atol=1e-15)
    np.testing.assert_allclose(mesh.vertices.max(axis=0), STOCK.upper, atol=1e-15)


def test_the_skin_is_the_map_and_its_volume_the_maps():
    mesh = to_mesh(SURFACE)
    nx, ny = SURFACE.z.shape
    assert (mesh.skin, mesh.shape) == (nx * ny, (nx, ny))
    np.testing.assert_array_equal(mesh.vertices[: mesh.skin, 2].reshape(nx, ny), SURFACE.z)
    inner = mesh.vertices[: mesh.skin].reshape(nx, ny, 3)[1:-1, 1:-1]
    np.testing.assert_array_equal(inner[:, 0, 0], SURFACE.x[1:-1])
    np.testing.assert_array_equal(inner[0, :, 1], SURFACE.y[1:-1])
    x, y = np.array(SURFACE.x), np.array(SURFACE.y)
    x[[0, -1]], y[[0, -1]] = (0.0, 0.02), (0.0, 0.012)
    under = 0.0
    for i in range(nx - 1):
        for j in range(ny - 1):  # two prisms a cell
            area = 0.5 * (x[i + 1] - x[i]) * (y[j + 1] - y[j])
            z = SURFACE.z[i : i + 2, j : j + 2] - STOCK.lower[2]
            under += area * (z[0, 0] + z[1, 0] + z[1, 1]) / 3 + area * (z[0, 0] + z[1, 1] + z[0, 1]) / 3
    assert volume(mesh) == pytest.approx(under, rel=1e-12)


def test_thinning_keeps_the_rim_and_the_number_of_faces():
    for shape, most in (((400, 300), 5000), ((1000, 10), 3000), ((3, 3), 1), ((1, 5), 100)):
        i, j = kept_cells(shape, most)
        assert (i[0], i[-1], j[0], j[-1]) == (0, shape[0] - 1, 0, shape[1] - 1)
        assert len(i) >= 2 <= len(j)
        assert 2 * len(i) * len(j) <= 1.1 * most + 2 * sum(shape) or shape == (3, 3)
    i, j = kept_cells((400, 300), 5000)
    assert len(i) * len(j) > 0.45 * 5000  # and not fewer than need be
    assert [len(a) for a in kept_cells((40, 30), 2400)] == [40, 30]


def hull(seed=1, count=14):
    points = np.random.default_rng(seed).uniform([0, 0, -0.01], [0.02, 0.012, 0.0], (count, 3))
    return points, points[ConvexHull(points).simplices]


def highest(points, x, y):
    """Top of a convex body over (x, y): the lowest of the planes that bound it from above."""
    nx, ny, nz, d = ConvexHull(points).equations.T
    heights = -(nx * x + ny * y + d) / nz
    top, low = heights[nz > 0].min(), heights[nz < 0].max()
    return top if low <= top else -np.inf


def test_skin_of_a_body_is_its_highest_point():
    points, triangles = hull()
    x, y = np.linspace(-0.001, 0.021, 12), np.linspace(-0.001, 0.013, 9)
    top, layers = skin(triangles, x, y)
    expected = np.array([[highest(points, a, b) for b in y] for a in x])
    np.testing.assert_array_equal(np.isfinite(top), np.isfinite(expected))
    covered = np.isfinite(expected)
    assert 20 < covered.sum() < covered.size
    np.testing.assert_allclose(top[covered], expected[covered], atol=1e-7)  # it looks 1 nm beside
    np.testing.assert_array_equal(layers, np.where(covered, 2, 0))  # in and out again


def test_heights_of_stocks():
    points, triangles = hull(3)
    stock = Stock(points.min(axis=0), points.max(axis=0), triangles)
    x, y = np.linspace(0.0, 0.02, 7), np.linspace(0.0, 0.012, 5)
    heights = stock_heights(stock, x, y)
    for i, a in enumerate(x):
        for j, b in enumerate(y):
            assert heights[i, j] == pytest.approx(max(highest(points, a, b), stock.lower[2]), abs=1e-7)
    assert float(stock_heights(STOCK, x, y)) == 0.0


@pytest.mark.parametrize("angle", [0.0, 0.7, 2.0, np.pi / 2])
def test_skin_along_a_line(angle):
    points, triangles = hull(5)
    stock = Stock(points.min(axis=0), points.max(axis=0), triangles)
    centre, normal = np.array([0.0101, 0.0061, 0.0]), np.array([-np.sin(angle), np.cos(angle), 0.0])
    w = np.linspace(-0.012, 0.012, 25)
    found = skin_on_line(stock, centre, normal)(w)
    for value, q in zip(found, centre + w[:, None] * normal, strict=True):
        assert value == pytest.approx(max(highest(points, q[0], q[1]), stock.lower[2]), abs=1e-7)
    np.testing.assert_array_equal(skin_on_line(STOCK, centre, normal)(w), 0.0)
