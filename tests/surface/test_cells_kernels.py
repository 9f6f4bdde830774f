"""Cells that an edge crosses: the share of them that is covered, measured by area."""

import numpy as np
import pytest
import shapely
import shapely.affinity

from robomill.cutting.tool import Cutter
from robomill.surface.cells_kernels import (
    EdgeRecord,
    Heights,
    Hidden,
    any_above,
    cells_between,
    columns_near,
    covered_share,
    cut_moves,
    cut_tilted_moves,
    lower_along,
    note_share,
    rows_near,
    settle,
    union_share,
)
from robomill.surface.envelope_kernels import move_between
from robomill.surface.tilt_kernels import TiltedMoves

MM = 1e-3
CUTTERS = {
    "flat": Cutter("flat", 8 * MM),
    "ball": Cutter("ball", 8 * MM),
    "bull": Cutter("bull", 8 * MM, corner_radius=1.5 * MM),
    "chamfer": Cutter("chamfer", 8 * MM, tip_angle=np.radians(80), tip_diameter=1 * MM),
}
UP = np.array([0.0, 0.0, 1.0])


def test_covered_share_is_an_area():
    rng = np.random.default_rng(11)
    u, v = (np.arange(1000) + 0.5) / 1000 - 0.5, (np.arange(1000) + 0.5) / 1000 - 0.5
    for _ in range(30):
        dx, dy, angle, d = rng.uniform(0.5, 2), rng.uniform(0.5, 2), rng.uniform(0, 7), rng.uniform(-1, 1)
        n = np.cos(angle), np.sin(angle)
        expected = (u[:, None] * dx * n[0] + v[None, :] * dy * n[1] <= d).mean()
        share = covered_share(d, *n, dx, dy)
        assert share == pytest.approx(expected, abs=2e-3)


def half_plane(d, angle, reach=5.0):
    """The inner side of an edge whose outward normal has this angle, ``d`` from the origin."""
    square = shapely.box(-reach, -reach, d, reach)
    return shapely.affinity.rotate(square, angle, origin=(0, 0), use_radians=True)


@pytest.mark.parametrize("turn", [np.pi, np.pi / 2, 0.3, 0.0])
def test_two_edges_of_a_cell_cover_their_union(turn):
    """Opposite walls add up, crossing ones overlap as if independent, and one wall cut again counts once."""
    cell, angle = shapely.box(-0.5, -0.5, 0.5, 0.5), 0.0
    for d, e in ((-0.2, -0.1), (-0.1, -0.4), (0.1, -0.3)):
        record = np.zeros(11)
        edges = ((d, angle), (e, angle + turn))
        for depth, a in edges:
            note_share(record, covered_share(depth, np.cos(a), np.sin(a), 1.0, 1.0), (np.cos(a), np.sin(a), depth))
        one, two = (half_plane(depth, a).intersection(cell) for depth, a in edges)
        both = one.union(two).area
        expected = max(one.area, two.area) if turn == 0.3 else both
        assert union_share(record) == pytest.approx(expected, abs=1e-12)


@pytest.mark.parametrize("step", [1.0, 0.25])
def test_cells_between_two_places_are_those_whose_centres_lie_there(step):
    centres = 2.0 + step * np.arange(7)
    ends = np.append(np.arange(0.0, 10.0, 0.125), 1e9)
    for low in ends:
        for high in ends[::3]:
            first, end = cells_between(low, high, 2.0, step, 7)
            assert [*range(first, end)] == np.flatnonzero((centres >= low) & (centres <= high)).tolist()


def tile(nx=24, ny=18):
    return Heights(np.zeros((nx, ny)), 0.5 * MM, -3.0 * MM, 1.0 * MM, 0.9 * MM)


def places(cells):
    nx, ny = cells.z.shape
    return np.meshgrid(cells.x0 + cells.dx * np.arange(nx), cells.y0 + cells.dy * np.arange(ny), indexing="ij")


def record(cells):
    shape = cells.z.shape
    inf = np.full(shape, np.inf)
    return EdgeRecord(inf, inf.copy(), np.zeros((*shape, 11)), np.empty(cells.z.size, int), np.zeros(1, int))


def beside(ends, x, y):
    """Distance in plan of points from a straight move."""
    a, b = ends[:2], ends[3:5]
    w = np.stack([x, y], axis=-1) - a
    t = np.clip(w @ (b - a) / max((b - a) @ (b - a), 1e-30), 0.0, 1.0)
    return np.linalg.norm(w - t[..., None] * (b - a), axis=-1)


def test_rows_and_columns_near_a_move_hold_every_centre_that_is():
    cells = tile()
    x, y = places(cells)
    rng = np.random.default_rng(0)
    for _ in range(40):
        ends = np.concatenate([rng.uniform([-8, -8], [30, 22], (2, 2)) * MM, np.zeros((2, 1))], axis=1).ravel()
        move, reach = move_between(*ends), rng.uniform(0.1, 6.0) * MM
        near = beside(ends, x, y) <= reach
        first, end = rows_near(move, reach, cells)
        assert not near[:first].any()
        assert not near[end:].any()
        for i in range(first, end):
            j, j_end = columns_near(move, reach, x[i, 0], cells)
            np.testing.assert_array_equal(np.flatnonzero(near[i]), np.arange(j, j_end))


def test_any_above_is_any_above():
    row = np.array([1.0, 3.0, 2.0])
    assert [any_above(row, height) for height in (0.5, 2.9, 3.0)] == [True, True, False]
    assert not any_above(row[:0], -1.0)


def stamped(cutter, ends, x, y):
    """Lowest stamp of a cutter along moves, and the distance in plan from their tracks."""
    lowest, near = np.full(x.shape, np.inf), np.full(x.shape, np.inf)
    for end in ends:
        near = np.minimum(near, beside(end, x, y))
        for share in np.linspace(0.0, 1.0, 801):
            tip = end[:3] + share * (end[3:] - end[:3])
            lowest = np.minimum(lowest, tip[2] + cutter.profile(np.hypot(x - tip[0], y - tip[1])))
    return lowest, near


WALK = np.array([[4, 2, -2, 15, 6, -2], [15, 6, -2, 18, 6, -4], [18, 6, -4, 8, 9, -1], [9, 4, -3, 9, 4, -5.0]]) * MM


@pytest.mark.parametrize("kind", CUTTERS)
@pytest.mark.parametrize("order", [slice(None), slice(None, None, -1)])
def test_moves_into_a_tile_leave_the_lowest_stamp_at_every_centre(kind, order):
    cutter, cells = CUTTERS[kind], tile()
    ends, edge = np.ascontiguousarray(WALK[order]), record(cells)
    cut_moves.plain(cutter.solid, ends, np.arange(len(ends)), cells, edge)
    count = int(edge.noted[0])
    mean, wall, noted = np.empty(count), np.empty((count, 6)), edge.cells[:count].copy()
    settle.plain(cells, edge, mean, wall)
    x, y = places(cells)
    expected, near = stamped(cutter, ends, x, y)
    sure = np.abs(near - 4 * MM) > 0.02 * MM  # a stamp may miss the rim
    np.testing.assert_allclose(cells.z[sure], np.minimum(expected, 0.0)[sure], atol=6e-6)
    assert len(np.unique(noted)) == count
    top = cells.z.ravel()[noted]
    assert (mean <= 1e-15).all()
    assert (mean >= -5 * MM).all()
    kept = ~np.isnan(wall[:, 0])
    assert kept.any()
    np.testing.assert_allclose(np.linalg.norm(wall[kept, :2], axis=1), 1.0)
    # Nothing is left of the record.
    assert np.isposinf(edge.z_centre).all()
    assert np.isposinf(edge.z_low).all()
    assert not edge.share.any()
    # Where a later cut was as deep all over a cell it has no wall.
    np.testing.assert_allclose(mean[~kept], top[~kept])


def test_only_chosen_moves_are_cut():
    cells, edge = tile(), record(tile())
    cut_moves.plain(CUTTERS["flat"].solid, WALK, np.array([1]), cells, edge)
    x, y = places(cells)
    assert (cells.z[beside(WALK[1], x, y) > 5 * MM] == 0.0).all()
    assert (cells.z < 0.0).any()


@pytest.mark.parametrize("kind", ["flat", "ball"])
def test_heights_along_a_line_are_the_lowest_stamps_upright_or_leaning(kind):
    cutter = CUTTERS[kind]
    x = np.linspace(2.0, 20.0, 37) * MM
    y = 0.4 * x + 0.31 * MM
    z = np.zeros(37)
    lower_along.plain(cutter.solid, WALK, np.tile(UP, (4, 1)), x, y, z)
    expected, near = stamped(cutter, WALK, x, y)
    sure = np.abs(near - 4 * MM) > 0.02 * MM
    np.testing.assert_allclose(z[sure], np.minimum(expected, 0.0)[sure], atol=6e-6)
    # Leaning by next to nothing, alone or beside an upright move, it is nearly the same.
    axes = np.tile([1e-6, 0.0, 1.0], (4, 1))
    for upright in (0, 2):
        axes[:upright] = UP
        leaning = np.zeros(37)
        lower_along.plain(cutter.solid, WALK, axes, x, y, leaning)
        np.testing.assert_allclose(leaning[sure], z[sure], atol=2e-5)


def test_a_leaning_cutter_leaves_what_it_does_not_reach_from_above_as_a_void():
    """A cylinder lying at 45 degrees under the top: what it takes is between two planes through its sides."""
    k = np.array([np.sqrt(0.5), 0.0, np.sqrt(0.5)])
    cells = Heights(np.zeros((40, 3)), 0.0, -1.0 * MM, 1.0 * MM, 1.0 * MM)
    ends = np.array([[5.0, -50, -20, 5, 50, -20]]) * MM
    moves = TiltedMoves(ends, k[None], np.array([[0.0, 39.0, -1.0, 1.0]]) * MM)
    hidden = Hidden(np.full((40, 3), np.inf), np.full((40, 3), -np.inf))
    cut_tilted_moves.plain(CUTTERS["flat"].solid, moves, np.array([0]), cells, hidden)
    reach = 4 * MM * np.sqrt(2.0)
    for i, x in enumerate(np.arange(40) * MM):
        # In the plane of the lean: the sides are the lines z + 20 = (x - 5) -+ reach, the end the line z + 20 = 5 - x.
        low = max(-20 * MM + (x - 5 * MM) - reach, -20 * MM - (x - 5 * MM))
        high = min(-20 * MM + (x - 5 * MM) + reach, 0.0)
        if low >= high:
            assert cells.z[i, 1] == 0.0
            assert hidden.high[i, 1] == -np.inf
        elif high == 0.0:
            assert cells.z[i, 1] == pytest.approx(low, abs=1e-7)
        else:
            assert cells.z[i, 1] == 0.0
            assert (hidden.low[i, 1], hidden.high[i, 1]) == pytest.approx((low, high), abs=1e-7)
