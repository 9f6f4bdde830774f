"""Tiles of a height map: every tile has the moves that reach its cells, and the walls of its own cells."""

import numpy as np
import pytest

from robomill.cutting.tool import Cutter
from robomill.surface.removal import TILE_CELLS, cut_tilted, cut_upright, rows_of_tile, tiles
from robomill.surface.stock import Cells

MILL = Cutter("flat", 8e-3)


@pytest.mark.parametrize(
    ("shape", "rows"),
    [((10, 20), 10), ((10_000, 100), TILE_CELLS // 100), ((3, TILE_CELLS + 1), 1), ((TILE_CELLS + 5, 1), TILE_CELLS)],
)
def test_a_tile_has_whole_rows_and_about_a_quarter_of_a_million_cells(shape, rows):
    assert rows_of_tile(shape) == rows


def test_a_tile_has_the_moves_that_reach_the_centres_of_its_cells(monkeypatch):
    """Eleven rows of four cells, centres at 0, 1, ... 10 along X, in tiles of three rows."""
    monkeypatch.setattr("robomill.surface.removal.TILE_CELLS", 12)
    cells = Cells(11, 4, 0.0, 0.0, 1.0, 1.0)
    low = np.array([-3.0, 2.0, 2.1, 2.1, 5.0, 9.5, -9.0, 11.0])
    high = np.array([-1.0, 2.0, 2.9, 3.0, 6.0, 20.0, 19.0, 12.0])
    expected = {}
    for tile in range(4):
        rows = np.arange(3 * tile, min(3 * tile + 3, 11))
        chosen = [n for n in range(len(low)) if low[n] <= rows[-1] and high[n] >= rows[0]]
        expected[3 * tile] = chosen
    found = {i: chosen.tolist() for i, chosen in tiles((11, 4), cells, low, high)}
    assert found == expected == {0: [1, 6], 3: [3, 4, 6], 6: [4, 6], 9: [5, 6]}
    assert [i for i, _ in tiles((11, 4), cells, low[4:5], high[4:5])] == [3, 6]


def test_with_x_and_y_exchanged_a_cut_is_the_same():
    cells, exchanged = Cells(40, 6, 0.5e-3, 0.5e-3, 1e-3, 1e-3), Cells(6, 40, 0.5e-3, 0.5e-3, 1e-3, 1e-3)
    z, other = np.zeros((40, 6)), np.zeros((6, 40))
    found = cut_upright(z, cells, MILL, np.array([[5e-3, 2e-3, -2e-3, 31e-3, 4e-3, -1e-3]]))
    turned = cut_upright(other, exchanged, MILL, np.array([[2e-3, 5e-3, -2e-3, 4e-3, 31e-3, -1e-3]]))
    np.testing.assert_allclose(other, z.T, atol=1e-15)
    i, j = np.divmod(turned.index, 40)
    order, same = np.argsort(found.index), np.argsort(j * 6 + i)
    np.testing.assert_array_equal((j * 6 + i)[same], found.index[order])
    np.testing.assert_allclose(turned.mean[same], found.mean[order], atol=1e-14)


@pytest.mark.parametrize("rows", [1, 2, 5, 40])
def test_walls_of_cells_are_kept_by_their_number_in_the_whole_map(monkeypatch, rows):
    cells = Cells(24, 18, 0.5e-3, 0.5e-3, 1e-3, 1e-3)
    ends = np.array([[5e-3, 6e-3, -2e-3, 17e-3, 11e-3, -2e-3]])
    whole = np.zeros((24, 18))
    known = cut_upright(whole, cells, MILL, ends)
    monkeypatch.setattr("robomill.surface.removal.TILE_CELLS", 18 * rows)
    z = np.zeros((24, 18))
    found = cut_upright(z, cells, MILL, ends)
    np.testing.assert_array_equal(z, whole)
    order, known_order = np.argsort(found.index), np.argsort(known.index)
    for name in ("index", "mean", "wall"):
        np.testing.assert_allclose(getattr(found, name)[order], getattr(known, name)[known_order], atol=1e-14)
    # Every cell that the rim passes through, and no other.
    x, y = (0.5e-3 + 1e-3 * q for q in np.divmod(known.index, 18))
    a, b, p = ends[0, :2], ends[0, 3:5], np.stack([x, y], axis=1)
    t = np.clip((p - a) @ (b - a) / ((b - a) @ (b - a)), 0.0, 1.0)[:, None]
    distance = np.linalg.norm(p - a - t * (b - a), axis=1)
    assert (np.abs(distance - 4e-3) < np.sqrt(0.5) * 1e-3).all()
    first, d = known.wall[:, :2], known.wall[:, 2]
    np.testing.assert_allclose(first, (p - a - t * (b - a)) / distance[:, None], atol=1e-12)
    np.testing.assert_allclose(d, 4e-3 - distance, atol=1e-15)
    assert not known.wall[:, 3:].any()


@pytest.mark.parametrize("rows", [1, 3, 40])
def test_a_leaning_cutter_in_tiles_leaves_what_it_leaves_at_once(monkeypatch, rows):
    cells = Cells(24, 18, 0.5e-3, 0.5e-3, 1e-3, 1e-3)
    ends = np.array([[5e-3, 6e-3, -3e-3, 17e-3, 11e-3, -2e-3], [20e-3, 5e-3, -1e-3, 20e-3, 12e-3, -4e-3]])
    axes = np.array([[0.6, 0.0, 0.8], [-0.28, 0.0, 0.96]])
    whole = np.zeros((24, 18))
    undercut = cut_tilted(whole, cells, MILL, (ends, axes))
    assert undercut.any()
    monkeypatch.setattr("robomill.surface.removal.TILE_CELLS", 18 * rows)
    z = np.zeros((24, 18))
    np.testing.assert_array_equal(cut_tilted(z, cells, MILL, (ends, axes)), undercut)
    np.testing.assert_allclose(z, whole, atol=1e-15)


@pytest.mark.parametrize("pit", [-0.2e-3, -4e-3, -30e-3])
def test_how_high_a_leaning_tool_cuts_is_told_by_what_stands_highest(pit):
    """A pit in one corner of the block changes nothing elsewhere: the side of the tool cuts up to the top."""
    cells = Cells(24, 18, 0.5e-3, 0.5e-3, 1e-3, 1e-3)
    ends, axes = np.array([[6e-3, 6e-3, -6e-3, 9e-3, 11e-3, -5e-3]]), np.array([[0.6, 0.0, 0.8]])
    plain, pitted = np.zeros((24, 18)), np.zeros((24, 18))
    pitted[0, 0] = pit
    undercut = cut_tilted(plain, cells, MILL, (ends, axes))
    np.testing.assert_array_equal(cut_tilted(pitted, cells, MILL, (ends, axes)), undercut)
    assert plain[0, 0] == 0.0
    plain[0, 0] = pit
    np.testing.assert_array_equal(pitted, plain)
    # As far along X as the lower side of the tool goes at the top: the tip, the lean up to it, and the radius.
    reached = cells.x0 + cells.dx * np.flatnonzero((pitted < 0.0).any(axis=1)).max()
    assert reached == pytest.approx(9e-3 + 5e-3 * 0.75 + 4e-3 / 0.8, abs=1.5e-3)


def test_voids_that_a_later_move_lays_open_are_as_deep_as_they_were_cut():
    """Two leaning moves under the same metal, then one from above through half of it: along every column, points that
    lie in a cutter's body at some stamp of its way are gone."""
    cells = Cells(24, 18, 0.5e-3, 0.5e-3, 1e-3, 1e-3)
    k, up = np.array([0.6, 0.0, 0.8]), np.array([0.0, 0.06, np.sqrt(1.0 - 0.06**2)])
    ends = np.array([[10, 3, -9, 10, 15, -9], [7, 3, -7, 7, 15, -7], [2, 9, -6, 22, 9, -3]]) * 1e-3
    axes = np.array([k, k, up])
    z = np.zeros((24, 18))
    overhang = cut_tilted(z, cells, MILL, (ends, axes))
    levels = np.arange(-11.95e-3, 0.0, 0.1e-3)
    x, y = np.meshgrid(cells.x0 + cells.dx * np.arange(24), cells.y0 + cells.dy * np.arange(18), indexing="ij")
    gone = np.zeros((24, 18, len(levels)), dtype=bool)
    for row, axis in zip(ends, axes, strict=True):
        for tip in np.linspace(row[:3], row[3:], 41):
            from_tip = np.stack(np.broadcast_arrays(x[..., None] - tip[0], y[..., None] - tip[1], levels - tip[2]), -1)
            along = from_tip @ axis
            gone |= (along >= 0.0) & ((from_tip**2).sum(axis=-1) - along**2 <= MILL.radius**2)
    open_down_to = np.logical_and.accumulate(gone[..., ::-1], axis=-1).sum(axis=-1)
    np.testing.assert_array_equal(overhang, gone.sum(axis=-1) > open_down_to)
    assert ((z < -4e-3) & (y > 6e-3) & (y < 12e-3)).sum() > 20
    assert overhang.sum() > 20
    assert np.quantile(np.abs(z + 0.1e-3 * open_down_to), 0.99) < 0.15e-3
