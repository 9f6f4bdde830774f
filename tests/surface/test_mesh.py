"""The part as a solid: closed, outward, with the volume under its skin; stocks read from solids, asked by ray."""

import itertools

import numpy as np
import pytest
import shapely
from scipy.spatial import ConvexHull

from robomill.cutting.tool import Cutter
from robomill.progress import Progress, watched
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


@pytest.mark.parametrize("ends", [[(-5, 5), (25, 5)], [(-5, 2), (25, 9)], [(8, -5), (12, 17)]])
def test_a_slot_through_the_block_leaves_a_closed_body_without_a_vertex_too_many(ends):
    """Its walls run out to the sides: a foot below each place of the rim, one for the two points of a wall."""
    path = np.array([[x, y, -2.0] for x, y in ends]) * 1e-3
    mesh = to_mesh(cut(STOCK, 1e-3, Cutter("flat", 0.005), path))
    edges = np.concatenate([mesh.faces[:, [i, j]] for i, j in ((0, 1), (1, 2), (2, 0))]).tolist()
    assert {tuple(edge) for edge in edges} == {(b, a) for a, b in edges}
    assert (np.unique(mesh.faces) == np.arange(len(mesh.vertices))).all()
    low = mesh.vertices[mesh.vertices[:, 2] == STOCK.lower[2]]
    assert len(np.unique(low, axis=0)) == len(low)


def test_a_solid_tells_what_is_done_of_it_from_nothing_on():
    told = []
    with watched(Progress(say=lambda progress: told.append((progress.stage, progress.share)))):
        to_mesh(SURFACE)
    assert told[0] == ("Solid", 0.0)
    assert told[-1] == ("Solid", 0.9)


def test_the_skin_is_the_map_and_its_volume_the_maps():
    mesh = to_mesh(SURFACE)
    nx, ny = SURFACE.z.shape
    assert (mesh.skin, mesh.shape) == (nx * ny, (nx, ny))
    np.testing.assert_array_equal(mesh.vertices[: mesh.skin, 2].reshape(nx, ny), SURFACE.z)
    inner = mesh.vertices[: mesh.skin].reshape(nx, ny, 3)[1:-1, 1:-1]
    np.testing.assert_array_equal(inner[:, 0, 0], SURFACE.x[1:-1])
    np.testing.assert_array_equal(inner[0, :, 1], SURFACE.y[1:-1])


def test_the_volume_of_a_part_without_walls_is_that_under_its_skin():
    shallow = cut(STOCK, 1e-3, Cutter("ball", 0.006), np.array([[0.004, 0.005, -0.001], [0.015, 0.008, -0.002]]))
    mesh = to_mesh(shallow)
    x, y = np.array(shallow.x), np.array(shallow.y)
    x[[0, -1]], y[[0, -1]] = (0.0, 0.02), (0.0, 0.012)
    under = 0.0
    for i in range(len(x) - 1):
        for j in range(len(y) - 1):  # two prisms a cell
            area = 0.5 * (x[i + 1] - x[i]) * (y[j + 1] - y[j])
            z = shallow.z[i : i + 2, j : j + 2] - STOCK.lower[2]
            under += area * (z[0, 0] + z[1, 0] + z[1, 1]) / 3 + area * (z[0, 0] + z[1, 1] + z[0, 1]) / 3
    assert volume(mesh) == pytest.approx(under, rel=1e-12)


PLATE = Stock((-0.012, -0.01, -0.006), (0.012, 0.01, 0.0))
TURN = np.linspace(0.2, 4.0, 300)
TRACKS = {
    "beside the cells": [[-0.006, 0.0002295], [0.006, 0.0002295]],
    "out of both sides": [[-0.03, 0.00023], [0.03, 0.00023]],
    "across at 7 degrees": [[-0.03, -0.0036], [0.03, 0.0038]],
    "at 30 degrees": [[-0.005, -0.0029], [0.005, 0.0029]],
    "over a corner": [[0.005, -0.02], [0.02, 0.005]],
    "an arc": np.column_stack([np.cos(TURN), np.sin(TURN)]) * 0.005,
    "a corner": [[-0.006, -0.004], [0.003, -0.004], [0.0042, 0.005]],
}


@pytest.mark.parametrize(("cell", "max_faces"), [(1e-4, 2_000_000), (2.5e-4, 2_000_000), (1e-4, 20_000)])
@pytest.mark.parametrize("track", TRACKS)
def test_walls_stand_where_the_cutter_left_them(track, cell, max_faces):
    """Every wall point against the boundary of the exact track; the volume against its area times the depth."""
    radius, depth = 0.003, 0.002
    plan = np.array(TRACKS[track])
    surface = cut(PLATE, cell, Cutter("flat", 2 * radius), np.column_stack([plan, np.full(len(plan), -depth)]))
    mesh = to_mesh(surface, max_faces=max_faces)
    edges = np.sort(np.concatenate([mesh.faces[:, [i, j]] for i, j in ((0, 1), (1, 2), (2, 0))]), axis=1)
    assert (np.unique(edges, axis=0, return_counts=True)[1] == 2).all()
    grid = (PLATE.size[0] / (mesh.shape[0] - 1) + PLATE.size[1] / (mesh.shape[1] - 1)) / 2
    floor = shapely.LineString(plan).buffer(radius, quad_segs=500)
    block = shapely.box(*PLATE.lower[:2], *PLATE.upper[:2])
    walls = mesh.vertices[mesh.skin :][mesh.owner[mesh.skin :] >= 0]
    away = shapely.distance(floor.boundary, shapely.points(walls[:, :2]))
    sharp = {"a corner": 6, "over a corner": 1}.get(track, 0)  # one cell holds the corner of tracks or of the block
    assert (away > 2e-3 * grid + grid**2 / (4 * radius)).sum() <= 2 * sharp
    exact = block.area * PLATE.size[2] - block.intersection(floor).area * depth
    assert volume(mesh) == pytest.approx(exact, abs=grid**2 / (12 * radius) * floor.length * depth)
    plain = 4 * mesh.skin
    assert len(mesh.faces) < 1.6 * plain


def test_thinning_keeps_the_rim_and_the_number_of_faces():
    for shape, most in (((400, 300), 5000), ((1000, 10), 3000), ((3, 3), 1), ((1, 5), 100)):
        i, j = kept_cells(shape, most)
        assert (i[0], i[-1], j[0], j[-1]) == (0, shape[0] - 1, 0, shape[1] - 1)
        assert len(i) >= 2 <= len(j)
        assert 2 * len(i) * len(j) <= 1.1 * most + 2 * sum(shape) or shape == (3, 3)
        assert 2 * len(i) * len(j) >= min(
            most, 2 * len(i) * shape[1], 2 * shape[0] * len(j)
        )  # and no fewer than need be
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


@pytest.mark.parametrize("side", range(4))
@pytest.mark.parametrize("left", [0.3e-3, 0.45e-3, 0.7e-3])
def test_a_thin_wall_along_the_rim_stands_in_its_place(side, left):
    """A slot beside one side of the block, in cells of 0.5 mm: ``left`` of it stands, more than half a cell."""
    turn = np.array([[np.cos(a), np.sin(a)] for a in np.radians([0, 90, 180, 270])]).round()[side]
    along = np.array([-turn[1], turn[0]])
    rim, length = abs(turn @ PLATE.upper[:2]), 2 * abs(along @ PLATE.upper[:2])
    middle = turn * (rim - left - 0.003)
    ends = np.column_stack([[middle - 0.02 * along, middle + 0.02 * along], [-0.002, -0.002]])
    mesh = to_mesh(cut(PLATE, 5e-4, Cutter("flat", 0.006), ends))
    walls = mesh.vertices[mesh.skin :][mesh.owner[mesh.skin :] >= 0]
    outer, inner = (np.abs(walls[:, :2] @ turn - (rim - left - wide)) < 1e-9 for wide in (0.0, 0.006))
    assert (outer | inner).all()
    cells = mesh.shape[1] if turn[0] else mesh.shape[0]
    assert outer.sum() == inner.sum() == 2 * cells
    assert volume(mesh) == pytest.approx(PLATE.size.prod() - 0.006 * 0.002 * length, rel=1e-9)


@pytest.mark.parametrize("angle", [25, -25, 40, -40, 50, -50, 65, -65])
def test_walls_of_a_slot_run_out_to_the_sides_of_the_block(angle):
    """A slanted slot through the middle: on each side of the block each of its walls ends in two points, one over the
    other, where its line meets that side, to half a cell (what was cut is known in the middle of cells)."""
    feed = np.array([np.cos(np.radians(angle)), np.sin(np.radians(angle))])
    normal, half = np.array([-feed[1], feed[0]]), PLATE.upper[:2]
    ends = np.column_stack([[-0.04 * feed, 0.04 * feed], [-0.002, -0.002]])
    mesh = to_mesh(cut(PLATE, 5e-4, Cutter("flat", 0.006), ends))
    walls = mesh.vertices[mesh.skin :][mesh.owner[mesh.skin :] >= 0]
    met = 0
    for axis, rim, wall in itertools.product((0, 1), (-1.0, 1.0), (-0.003, 0.003)):
        at = np.zeros(2)
        at[axis] = rim * half[axis]
        at[1 - axis] = (wall - at[axis] * normal[axis]) / normal[1 - axis]
        if abs(at[1 - axis]) < half[1 - axis] - 1e-3:
            there = (walls[:, axis] == at[axis]) & (np.abs(walls[:, 1 - axis] - at[1 - axis]) < 2.5e-4)
            assert there.sum() == 2, (axis, rim, wall)
            met += 1
    assert met >= 2
