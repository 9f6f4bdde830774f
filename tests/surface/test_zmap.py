"""Cutting a path into the stock: exact volumes, heights by brute force."""

from dataclasses import replace

import numpy as np
import pytest
import shapely

from robomill.cutting.tool import Cutter
from robomill.cutting.tooling import Tooling
from robomill.errors import SurfaceError
from robomill.surface.stock import Stock
from robomill.surface.zmap import cut

FLAT = Cutter("flat", 0.008)
STOCK = Stock((0.0, 0.0, -0.02), (0.06, 0.04, 0.0))
CUTTERS = {
    "flat": FLAT,
    "ball": Cutter("ball", 0.008),
    "bull": Cutter("bull", 0.008, corner_radius=0.0015),
    "chamfer": Cutter("chamfer", 0.008, tip_angle=np.radians(90.0), tip_diameter=0.001),
}


def walk(n=25, depth=0.002, ramp=0.0, seed=1):
    rng = np.random.default_rng(seed)
    return np.column_stack([rng.uniform(0.003, 0.057, n), rng.uniform(0.003, 0.037, n), -depth - ramp * rng.random(n)])


def capsules(p, R, stock=STOCK):
    lines = [shapely.LineString(p[i : i + 2, :2]).buffer(R, quad_segs=2000) for i in range(len(p) - 1)]
    return shapely.union_all(lines).intersection(shapely.box(*stock.lower[:2], *stock.upper[:2]))


def test_level_cut_is_the_union_of_capsules():
    p = walk()
    exact = capsules(p, 0.004).area * 0.002
    assert cut(STOCK, 1e-4, FLAT, p).removed_volume == pytest.approx(exact, rel=1e-5)


def test_heights_at_cell_centres_are_exact():
    p = walk(8)
    surface = cut(STOCK, 5e-4, FLAT, p)
    area = capsules(p, 0.004)
    x, y = np.meshgrid(surface.x, surface.y, indexing="ij")
    inside = shapely.contains_xy(area, x, y)
    np.testing.assert_array_equal(surface.z, np.where(inside, -0.002, 0.0))


def test_the_same_path_gives_the_same_bits():
    p = walk()
    delta = np.zeros(5) @ np.zeros((5, 3))
    ideal, machined = (cut(STOCK, 3e-4, FLAT, q) for q in (p, p + delta))
    assert ideal.digest() == machined.digest()


def test_order_of_moves_and_their_direction_do_not_matter():
    p = walk(10, ramp=0.002)
    forth, back = cut(STOCK, 3e-4, FLAT, p), cut(STOCK, 3e-4, FLAT, p[::-1])
    np.testing.assert_array_equal(forth.z, back.z)
    assert forth.removed_volume == pytest.approx(back.removed_volume, rel=2e-5)  # edge cells of ramps only


def test_dividing_a_line_changes_nothing():
    a, b = np.array([0.006, 0.007, -0.002]), np.array([0.05, 0.031, -0.003])
    whole = cut(STOCK, 3e-4, FLAT, np.stack([a, b]))
    pieces = cut(STOCK, 3e-4, FLAT, a + np.linspace(0, 1, 40)[:, None] * (b - a))
    np.testing.assert_allclose(pieces.z, whole.z, atol=1e-12)
    assert pieces.removed_volume == pytest.approx(whole.removed_volume, rel=3e-4)  # edge cells of a ramp


def test_touching_passes_leave_no_rib():
    """Passes exactly one diameter apart share a wall that falls inside a row of cells."""
    y = np.array([0.0081, 0.0161, 0.0241])
    p = np.array([[x, q, -0.002] for i, q in enumerate(y) for x in ((-0.01, 0.07) if i % 2 == 0 else (0.07, -0.01))])
    keep = np.array([False, True, False, True, False, True])
    surface = cut(STOCK, 3.1e-4, FLAT, p, None, keep)
    assert surface.removed_volume == pytest.approx(0.06 * 0.024 * 0.002, rel=1e-9)


def test_rapids_do_not_cut_and_unreached_moves_are_counted():
    p = np.array([[0.01, 0.02, -0.002], [0.03, 0.02, -0.002], [0.03, np.nan, -0.002], [0.05, 0.02, -0.002]])
    surface = cut(STOCK, 5e-4, FLAT, p, cutting=[False, True, True, True])
    assert surface.skipped == 2
    assert "not-cut" in {note.code for note in surface.notes()}
    assert surface.removed_volume == pytest.approx(capsules(p[:2], 0.004).area * 0.002, rel=1e-3)
    with pytest.raises(SurfaceError, match="no feed move"):
        cut(STOCK, 5e-4, FLAT, p[:2], cutting=[False, False])


def test_cutting_through_ends_at_the_bottom():
    p = np.array([[0.01, 0.02, -0.05], [0.03, 0.02, -0.05]])
    surface = cut(STOCK, 5e-4, FLAT, p)
    assert surface.z.min() == STOCK.lower[2]
    assert surface.mean.min() == STOCK.lower[2]
    assert "through-bottom" in {note.code for note in surface.notes()}


def test_a_path_that_misses_the_stock_says_where_both_are():
    above = np.array([[0.01, 0.02, 0.001], [0.03, 0.02, 0.001]])
    with pytest.raises(SurfaceError, match=r"never touches it.*Z 1.0 mm.*stock −20.0 mm to 0.0 mm"):
        cut(STOCK, 5e-4, FLAT, above)
    assert cut(STOCK, 5e-4, FLAT, above, must_touch=False).removed_volume == 0.0
    with pytest.raises(SurfaceError, match="never touches"):
        cut(STOCK, 5e-4, FLAT, above + np.array([1.0, 0.0, -0.01]))


@pytest.mark.parametrize("cell", [0.0, -1e-4, np.nan, np.inf])
def test_a_cell_must_have_a_size(cell):
    with pytest.raises(SurfaceError, match="Cell size"):
        cut(STOCK, cell, FLAT, walk(3))


def test_tiles_do_not_show(monkeypatch):
    p = walk(12, ramp=0.002)
    whole = cut(STOCK, 3e-4, CUTTERS["ball"], p)
    monkeypatch.setattr("robomill.surface.removal.TILE_CELLS", 1500)
    tiled = cut(STOCK, 3e-4, CUTTERS["ball"], p)
    np.testing.assert_allclose(tiled.z, whole.z, atol=1e-15)
    assert tiled.removed_volume == pytest.approx(whole.removed_volume, rel=1e-12)


def test_notes_stand_at_no_line_and_only_where_there_is_something_to_say():
    plain = cut(STOCK, 5e-4, FLAT, np.array([[0.01, 0.02, -0.002], [0.03, 0.02, -0.002]]))
    assert plain.notes() == ()
    odd = replace(plain, overhang=3, leaning=True, skipped=1, below=True, filled=1e-9)
    found = odd.notes()
    assert [note.code for note in found] == ["undercut", "walls-to-a-cell", "not-cut", "through-bottom", "void-filled"]
    assert {note.line for note in found} == {0}
    # A void smaller than a cube of one cell is rounding.
    cube = plain.dx * plain.dy * plain.cell
    assert replace(plain, filled=cube).notes() == ()
    assert replace(plain, filled=1.01 * cube).notes() != ()


def test_cells_of_one_row_are_as_large_as_they_are():
    thin = cut(Stock((0, 0, -0.01), (0.06, 4e-4, 0)), 5e-4, FLAT, np.array([[0.01, 0.0, -0.002], [0.03, 0.0, -0.002]]))
    assert thin.z.shape == (120, 1)
    assert (thin.dx, thin.dy) == (pytest.approx(5e-4), 5e-4)
    along_y = np.array([[0.0, 0.01, -0.002], [0.0, 0.03, -0.002]])
    turned = cut(Stock((0, 0, -0.01), (4e-4, 0.06, 0)), 5e-4, FLAT, along_y)
    assert (turned.dx, turned.dy) == (5e-4, pytest.approx(5e-4))


def test_walls_of_an_earlier_cutter_stand_where_a_later_one_does_not_cut():
    """Slots of two mills that cross: what is left is what the polygons of both leave, cell by cell."""
    big, small = FLAT, Cutter("flat", 0.005)
    p = np.array([[0.01, 0.0203, -0.002], [0.05, 0.0203, -0.002], [0.0301, 0.005, -0.002], [0.0301, 0.035, -0.002]])
    cutting = np.array([False, True, False, True])
    both = cut(STOCK, 7e-4, Tooling((big, small), [0, 0, 1, 1]), p, None, cutting)
    plans = capsules(p[:2], 0.004), capsules(p[2:], 0.0025)
    union = shapely.union_all(plans)
    assert both.removed_volume == pytest.approx(union.area * 0.002, rel=1e-3)
    i, j = np.divmod(both.edge.index, both.z.shape[1])
    assert len(np.unique(both.edge.index)) == len(both.edge.index)
    centres = shapely.points(both.x[i], both.y[j])
    near = np.hypot(both.dx, both.dy) / 2
    for plan in plans:
        assert (shapely.distance(plan.boundary, centres) < near).sum() > 20
    assert (shapely.distance(union.boundary, centres) < near).all()
    assert (both.z.ravel()[both.edge.index] > -0.002).sum() > 20
    swapped = cut(STOCK, 7e-4, Tooling((small, big), [1, 1, 0, 0]), p, None, cutting)
    np.testing.assert_array_equal(swapped.z, both.z)
    # No wall of the earlier slot is left in the later one.
    assert swapped.removed_volume == pytest.approx(union.area * 0.002, rel=1e-3)
    i, j = np.divmod(swapped.edge.index, swapped.z.shape[1])
    assert (shapely.distance(union.boundary, shapely.points(swapped.x[i], swapped.y[j])) < near).all()


def test_where_no_move_is_reached_nothing_is_cut():
    p = walk(5)
    p[1::2] = np.nan  # every move has an end that is not
    with pytest.raises(SurfaceError, match="no feed move of the path is reached"):
        cut(STOCK, 1e-3, FLAT, p)
