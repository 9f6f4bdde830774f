"""Grids: ends, steps, orders, budgets."""

import numpy as np
import pytest

from robomill import budgets
from robomill.errors import WorkspaceError
from robomill.workspace import grid as grids
from robomill.workspace.grid import Grid, axis_points, box_grid, plane_grid


def test_an_axis_has_its_ends_where_they_fall_on_a_step():
    np.testing.assert_allclose(axis_points(0.0, 1.0, 0.25), [0.0, 0.25, 0.5, 0.75, 1.0])
    np.testing.assert_allclose(axis_points(0.0, 1.0, 0.3), [0.0, 0.3, 0.6, 0.9])
    np.testing.assert_allclose(axis_points(-0.1, 0.2, 0.1), [-0.1, 0.0, 0.1, 0.2], atol=1e-15)
    np.testing.assert_array_equal(axis_points(2.0, 2.0, 0.5), [2.0])
    assert len(axis_points(0.0, grids.LARGEST_AXIS - 1.0, 1.0)) == grids.LARGEST_AXIS
    with pytest.raises(WorkspaceError, match="100.001 points; at most 100.000"):
        axis_points(0.0, grids.LARGEST_AXIS, 1.0, "x")
    with pytest.raises(WorkspaceError, match=r"axis y ends \(1\) before it begins \(2\)"):
        axis_points(2.0, 1.0, 0.1, "y")
    for step in (0.0, -0.1, np.nan, np.inf):
        with pytest.raises(WorkspaceError, match="a step above zero"):
            axis_points(0.0, 1.0, step, "z")


def test_points_stand_in_the_order_of_their_axes():
    grid = Grid([0.0, 1.0], [5.0, 6.0, 8.0], [2.0])
    assert (grid.shape, grid.cells, grid.step) == ((2, 3, 1), 6, 1.0)
    points = grid.points()
    for i, j, k in np.ndindex(2, 3, 1):
        np.testing.assert_array_equal(points[i, j, k], [grid.x[i], grid.y[j], grid.z[k]])
    assert Grid(1.0, 2.0, 3.0).step == 0.0
    assert Grid(1.0, [0.0, 0.5, 0.7], [0.0, 0.3]).step == pytest.approx(0.2)
    for axes in (([], [0], [0]), ([0.0], [1.0, 1.0], [0.0]), ([0], [0], [2.0, 1.0])):
        with pytest.raises(WorkspaceError, match="at least one coordinate|must rise"):
            Grid(*axes)
    with pytest.raises(WorkspaceError, match="Grid axis z"):
        Grid(0.0, 0.0, np.nan)
    with pytest.raises(WorkspaceError, match="axis x needs at least one"):
        Grid(np.zeros((2, 2)), 0.0, 0.0)


@pytest.mark.parametrize("axis", ["x", "y", "z"])
@pytest.mark.parametrize("side", [-1.0, 1.0])
def test_a_grid_goes_as_far_as_it_says_and_no_further(axis: str, side: float) -> None:
    """200 m of {M} either way, in m and in mm; behind them somebody meant another unit."""
    axes = {"x": 0.0, "y": 0.0, "z": 0.0}
    for unit, far in (("", 200.0), ("_mm", 200e3)):
        named = {name + unit: value for name, value in axes.items()}
        assert getattr(Grid(**{**named, axis + unit: side * far}), axis)[0] == side * 200.0
        with pytest.raises(WorkspaceError, match=f"axis {axis}"):
            Grid(**{**named, axis + unit: side * far * 1.001})


@pytest.mark.parametrize(("normal", "fixed"), [("x", 0), ("y", 1), ("z", 2)])
def test_a_plane_has_one_axis_of_one(normal, fixed):
    grid = plane_grid(normal, 0.7, [0, 0, 0], [1, 2, 3], 0.5)
    axes = [grid.x, grid.y, grid.z]
    np.testing.assert_array_equal(axes[fixed], [0.7])
    assert [len(axis) for axis in axes] == [1 if i == fixed else n for i, n in enumerate((3, 5, 7))]


def test_the_budget_counts_bytes_and_names_the_step_that_fits(monkeypatch):
    monkeypatch.setattr(budgets, "map_bytes", lambda: 1 << 30)
    grid = box_grid([0, 0, 0], [1, 1, 1], 0.1)
    assert grid.cells == 1331
    grid.check_budget(budgets.map_bytes() // 1331)
    with pytest.raises(WorkspaceError, match="11 x 11 x 11 = 1331 cells needs 2.0 GiB") as refused:
        grid.check_budget(2 * budgets.map_bytes() // 1331 + 1)
    # Half the cells fit: the step grows by the cube root of two.
    assert "665 cells fit" in str(refused.value)
    assert "step of 126" in str(refused.value)
    # In a plane by the square root: 0.1 sqrt(121 / 31), rounded up to a tenth of a millimetre.
    with pytest.raises(WorkspaceError, match="step of 197.6 mm"):
        plane_grid("z", 0, [0, 0, 0], [1, 1, 0], 0.1).check_budget(budgets.map_bytes() // 31)


def test_a_step_in_mm_is_not_one_cell():
    with pytest.raises(WorkspaceError, match=r"a step of 50 m is far longer than the box \(1.2 m\).*50 mm are 0.05"):
        plane_grid("z", 0, [-0.6, -1.6, 0], [0.6, -1.0, 0], 50)
    assert plane_grid("z", 0, [-0.6, -1.6, 0], [0.6, -1.0, 0], 2.0).cells == 1
    box = ([-0.6, -1.6, 0], [-0.6, -0.9, 0.2])  # ten times its longest side
    assert box_grid(*box, 6.99).cells == 1
    with pytest.raises(WorkspaceError, match="far longer than the box"):
        box_grid(*box, 7.01)
    assert box_grid([0.1, 0.2, 0.3], [0.1, 0.2, 0.3], 1.0).cells == 1


def test_the_corners_of_a_plane_have_three_numbers():
    with pytest.raises(WorkspaceError, match="Plane, lower corner"):
        plane_grid("z", 0, [-0.6, -1.6], [0.6, -1.0], 0.05)


def test_a_grid_in_words_has_its_points_and_its_ends_along_each_axis():
    """In millimetres; one number where an axis has one point."""
    said = Grid([-0.1, 0.05, 0.3], [1.0, 1.25], 0.02)._said()
    counts, ends = said.split(" cells at X, Y, Z = ")
    assert [int(n) for n in counts.split(" × ")] == [3, 2, 1]
    spans = [
        [float(n) for n in each.replace("\u2212", "-").replace("\u202f", "").removesuffix(" mm").split(" to ")]
        for each in ends.split("; ")
    ]
    assert spans == [[-100.0, 300.0], [1000.0, 1250.0], [20.0]]
