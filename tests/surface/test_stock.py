"""The block and its cells: cells that fill it, the smallest cell that fits, blocks round paths."""

import itertools
import math
import re

import numpy as np
import pytest
import shapely

from robomill.cutting.tool import Cutter
from robomill.errors import SurfaceError
from robomill.quantities import quantities
from robomill.surface.stock import Stock, cells_about, fitting_cell, stock_grid, stock_span
from robomill.surface.zmap import cut
from robomill.toolpath.path import Toolpath

STOCK = Stock((0.0, 0.0, -0.02), (0.03, 0.02, 0.0))
CUTTER = Cutter("flat", 0.008)


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


@pytest.mark.parametrize(
    ("low", "high", "x", "y"),
    [
        ((5.2, 3.7), (9.1, 4.3), (3.5, 10.5), (2.5, 5.5)),  # two more on every side
        ((-9.0, 0.4), (40.0, 19.6), (0.5, 29.5), (0.5, 19.5)),  # not beyond the others
        ((-9.0, 30.0), (-5.0, 40.0), (0.5, 0.5), (19.5, 19.5)),  # one, where there are none
    ],
)
def test_cells_between_two_corners_stand_where_those_of_the_stock_do(low, high, x, y):
    cells = stock_grid(STOCK, 1e-3)
    some = cells_about(cells, 1e-3 * np.array(low), 1e-3 * np.array(high))
    assert (some.dx, some.dy) == (cells.dx, cells.dy)
    np.testing.assert_allclose(1e3 * some.x[[0, -1]], x, atol=1e-9)
    np.testing.assert_allclose(1e3 * some.y[[0, -1]], y, atol=1e-9)


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


@pytest.mark.parametrize("side", [0.0, 1.0])
def test_a_line_along_the_border_is_over_the_stock(side):
    y, along = 0.02 * side, np.array([1.0, 0.0, 0.0])
    assert stock_span(STOCK, np.array([0.01, y, 0.0]), along) == pytest.approx((-0.01, 0.02))
    low, high = stock_span(STOCK, np.array([0.01, y + (2 * side - 1) * 1e-9, 0.0]), along)
    assert low > high


def test_a_stock_round_a_path():
    """The cutter's radius and 2 mm beside it, 5 mm beneath and, above zero, 1 mm on top."""
    stock = Stock.around(Toolpath.from_points([[0.0, -0.02, 0.002], [0.05, 0.0, 0.01]], 0.01), CUTTER)
    np.testing.assert_allclose(stock.lower, [-0.006, -0.026, -0.003], atol=1e-15)
    np.testing.assert_allclose(stock.upper, [0.056, 0.006, 0.011], atol=1e-15)
    np.testing.assert_allclose(stock.size, [0.062, 0.032, 0.014], atol=1e-15)


def test_odd_stocks_are_said():
    assert "check the unit" in Stock((0, 0, 0), (6.0, 1, 1)).warnings(CUTTER)[0].message
    assert "check the unit" in Stock((0, 0, 0), (1e-3, 1e-3, 1e-3)).warnings(CUTTER)[0].message
    assert Stock((0, 0, 0), (4.9, 0.1, 0.1)).warnings(CUTTER) == ()
    assert Stock((0, 0, 0), (1, 0.0081, 1)).warnings(CUTTER) == ()
    assert len(Stock((0, 0, 0), (0.0079, 1, 1)).warnings(CUTTER)) == 1


def test_too_many_cells_are_refused_with_the_size_that_fits(monkeypatch):
    monkeypatch.setattr("robomill.budgets.cells", lambda: 50_000_000)
    with pytest.raises(SurfaceError, match=r"at most 50 million fit, so use 0.00\d\d mm or more"):
        cut(STOCK, 1e-6, CUTTER, np.array([[0.01, 0.01, -0.002], [0.02, 0.01, -0.002]]))
    for length, width in ((0.06, 0.04), (0.123, 1.7), (2.0, 2e-4)):
        cell = fitting_cell(length, width, 50_000_000)
        nx, ny, _, _, dx, dy = stock_grid(Stock((0, 0, 0), (length, width, 1)), cell, 50_000_000)
        assert nx * ny <= 50_000_000
        assert max(dx, dy) <= cell * (1 + 1e-9)


def test_a_block_is_thicker_than_a_nanometre():
    for axis in range(3):
        upper = np.ones(3)
        upper[axis] = 1e-9
        with pytest.raises(SurfaceError, match=f"Stock in {'XYZ'[axis]}"):
            Stock((0, 0, 0), upper)
        upper[axis] = 1.1e-9
        assert Stock((0, 0, 0), upper).size[axis] == 1.1e-9


def test_stock_refusals_and_defaults():
    with pytest.raises(SurfaceError, match="Stock in Y.*upper end must lie above"):
        Stock((0, 1, 0), (1, 1, 1))
    with pytest.raises(SurfaceError, match="finite"):
        Stock((0, np.nan, 0), (1, 1, 1))
    assert Stock((0, 0, 0), (1, 0.005, 1)).warnings(CUTTER)[0].code == "wide-cutter"
    assert not STOCK.warnings(CUTTER)


def test_corners_are_shown_to_a_hundredth_of_a_millimetre():
    assert [(each.unit, each.digits) for each in quantities(Stock).values()] == [("mm", 2)] * 2


def test_odd_sizes_are_said_from_two_millimetres_and_five_metres_on():
    for longest, odd in ((2e-3, False), (1.99e-3, True), (5.0, False), (5.01, True)):
        found = Stock((0, 0, 0), (longest, longest, 1e-3)).warnings(Cutter("flat", 1e-3))
        assert [(each.code, each.line) for each in found] == [("stock-unit", 0)] * odd
    (found,) = Stock((0, 0, 0), (1, 0.0079, 1)).warnings(CUTTER)
    assert (found.code, found.line) == ("wide-cutter", 0)
    assert Stock((0, 0, 0), (1, 0.008, 1)).warnings(CUTTER) == ()


def test_part_zero_is_on_top_where_the_path_cuts_below_zero():
    """By more than a nanometre; else the top is a millimetre above the highest point."""
    for z, top in ((-1e-3, 0.0), (-2e-9, 0.0), (-0.5e-9, 1e-3), (0.0, 1e-3), (2e-3, 3e-3)):
        stock = Stock.around(Toolpath.from_points([[0.0, 0.0, z], [0.01, 0.0, z]], 0.01), CUTTER)
        assert stock.upper[2] == pytest.approx(top, abs=2e-6)
        assert stock.lower[2] == pytest.approx(z - 5e-3)
        np.testing.assert_allclose(stock.lower[:2], [-6e-3, -6e-3])


@pytest.mark.parametrize("cell", [1e-300, 5e-324, 1e-12])
def test_a_cell_that_is_next_to_nothing_is_refused(cell: float) -> None:
    with pytest.raises(SurfaceError, match=r"Cell size: .* million cells .* use .* or more"):
        stock_grid(Stock([0.0, 0.0, 0.0], [1.0, 1.0, 0.1]), cell)


@pytest.mark.parametrize(("n", "m"), [(100, 100), (50, 200), (3, 7)])
def test_cells_that_use_the_whole_budget_fit(n, m):
    assert fitting_cell(n * 1e-3, m * 1e-3, n * m) == pytest.approx(1e-3, abs=1e-9)


@pytest.mark.parametrize(("length", "width", "cell"), [(0.5, 0.3, 1e-4), (0.3, 0.5, 1e-4), (2.0, 0.01, 5e-5)])
def test_the_refusal_counts_cells_and_names_the_smallest_size_that_fits(length, width, cell):
    """Counted as rows times columns; of all sizes in steps of 0.1 um none below the one named fits."""
    budget = 1_000_000

    def count(tenths):
        return math.ceil(round(length / (tenths * 1e-7), 6)) * math.ceil(round(width / (tenths * 1e-7), 6))

    fits = next(tenths for tenths in itertools.count(1) if count(tenths) <= budget)
    with pytest.raises(SurfaceError) as refused:
        stock_grid(Stock((0, 0, 0), (length, width, 1)), cell, budget)
    needed, said = re.search(r"needs (\S+) million .* use (\S+) mm or more", str(refused.value)).groups()
    assert float(needed) == pytest.approx(round(length / cell) * round(width / cell) / 1e6, rel=1e-3)
    assert float(said) * 1e-3 == pytest.approx(fits * 1e-7, rel=1.5e-3)
    assert float(said) * 1e-3 >= fits * 1e-7 * (1 - 1e-3)


def test_a_block_less_than_any_part_was_meant_in_metres_unless_it_is_of_a_mesh():
    """Half a millimetre is asked about, with its size; two millimetres are only doubted."""
    with pytest.raises(SurfaceError, match="was it meant in m"):
        Stock(lower_mm=(0, 0, -0.02), upper_mm=(0.06, 0.04, 0.0))
    assert Stock((0, 0, -2e-3), (2e-3, 1e-3, 0.0)).size.max() == 2e-3
    corner = np.array([[[0.0, 0, 0], [6e-5, 0, 0], [0, 4e-5, 2e-5]]])
    assert Stock((0, 0, 0), (6e-5, 4e-5, 2e-5), corner).triangles.shape == (1, 3, 3)


def test_a_block_says_its_size_corner_and_triangles():
    block = Stock((-0.01, 0.002, -0.02), (0.03, 0.02, 0.0))
    said = repr(block).replace("−", "-")
    assert re.search(r"40.00 x 18.00 x 20.00 mm.*-10.00, 2.00, -20.00 mm", said)
    assert "triangle" not in said
    mesh = Stock((0, 0, 0), (1, 1, 1), np.random.default_rng(0).uniform(0, 1, (12, 3, 3)))
    assert "solid of 12 triangles" in repr(mesh)
