"""Regions robomill proposes: planar arms, everything in reach, the largest box, the paper's box."""

from __future__ import annotations

import numpy as np
import pytest

import robomill as rm
from robomill.workspace.grid import PAPER_BOX_SIZE, Grid
from robomill.workspace.reach import reach
from robomill.workspace.region import (
    FLAT,
    coarse_cells,
    coarse_grid,
    flat_axis,
    holds_paper_box,
    largest_region,
    reach_extent,
)


def test_planar_arms_lie_in_a_plane_and_others_do_not() -> None:
    assert flat_axis(rm.load_robot("planar_2r")) == 2
    assert flat_axis(rm.load_robot("slavkovic_5r")) is None


def test_a_planar_arm_turned_upright_lies_in_xz() -> None:
    arm = rm.load_robot("planar_2r")
    turned = np.eye(4)
    turned[:3, :3] = [[1, 0, 0], [0, 0, -1], [0, 1, 0]]
    assert flat_axis(arm.replace(T_base=turned)) == 1


def test_the_extent_of_a_two_link_arm_is_its_ring() -> None:
    arm = rm.load_robot("planar_2r")
    extent = reach_extent(arm)
    assert extent is not None
    np.testing.assert_allclose(extent.upper[:2], 0.9, atol=0.02)
    assert extent.size[2] == 0.0


def test_nothing_outside_the_extent_is_reached() -> None:
    robot = rm.load_robot("slavkovic_5r")
    extent = reach_extent(robot)
    assert extent is not None
    grid = coarse_grid(robot, extent.lower - 0.5, extent.upper + 0.5, 4000)
    points = grid.points()[reach(robot, grid)]
    slack = 0.15  # a cell of the coarse grid
    assert (points >= extent.lower - slack).all()
    assert (points <= extent.upper + slack).all()


def test_the_largest_region_is_reached_and_holds_the_papers_box() -> None:
    robot = rm.load_robot("slavkovic_5r")
    box = largest_region(robot)
    assert box is not None
    assert box.holds(PAPER_BOX_SIZE)
    inside = coarse_grid(robot, box.lower, box.upper, 3000)
    assert reach(robot, inside).mean() > 0.97
    assert holds_paper_box(robot)


def test_no_region_at_a_tilt_that_is_never_reached() -> None:
    robot = rm.load_robot("slavkovic_5r")
    stiff = robot.replace(limits=np.radians([[-5, 5]] * 5))
    assert reach_extent(stiff, A=np.radians(170)) is None
    assert largest_region(stiff, A=np.radians(170)) is None


@pytest.mark.parametrize("cells", [50, 500])
def test_a_coarse_grid_has_about_the_cells_it_is_asked_for(cells: int) -> None:
    robot = rm.load_robot("slavkovic_5r")
    grid = coarse_grid(robot, np.array([-0.6, -1.6, -0.4]), np.array([0.6, -1.0, 0.1]), cells)
    assert cells / 2 < grid.cells < 3 * cells
    assert coarse_grid(robot, np.zeros(3), np.zeros(3)).cells == 1


@pytest.mark.parametrize("flat", [0, 1])
def test_the_region_of_a_planar_arm_turns_with_its_plane(flat: int) -> None:
    arm = rm.load_robot("planar_2r")
    level = largest_region(arm)
    assert level is not None
    T_base = np.eye(4)
    order = {0: [2, 0, 1], 1: [1, 2, 0]}[flat]  # x, y, z of the level arm become these axes' values
    T_base[:3, :3] = np.eye(3)[order]
    turned = largest_region(arm.replace(T_base=T_base @ arm.T_base), A=0.0, B=0.0)
    assert flat_axis(arm.replace(T_base=T_base @ arm.T_base)) == flat
    assert turned is not None
    np.testing.assert_allclose(turned.size[flat], 0.0, atol=1e-12)
    np.testing.assert_allclose(np.prod(np.delete(turned.size, flat)), np.prod(level.size[:2]), rtol=0.05)


def test_an_arm_that_is_solved_numerically_is_looked_at_in_fewer_places() -> None:
    assert coarse_cells(rm.load_robot("slavkovic_5r")) > 10 * coarse_cells(rm.load_robot("planar_3r"))


@pytest.mark.parametrize("flat", [(), (0,), (1, 2), (0, 1, 2)])
def test_a_coarse_grid_has_cells_of_equal_edges_and_one_place_along_what_is_flat(flat: tuple[int, ...]) -> None:
    low, span = np.array([-0.5, 1.0, 0.2]), np.array([1.2, 0.6, 0.9])
    low[[*flat]], span[[*flat]] = 0.0, FLAT
    grid = coarse_grid(rm.load_robot("slavkovic_5r"), low, low + span, 600)
    steps = []
    for i, axis in enumerate((grid.x, grid.y, grid.z)):
        assert axis[0] == low[i]
        if i in flat:
            assert len(axis) == 1
            continue
        assert axis[-1] == pytest.approx(low[i] + span[i])
        steps += np.diff(axis).tolist()
    assert not steps or max(steps) < 1.25 * min(steps)
    cells = np.prod([max(n - 1, 1) for n in grid.shape])
    assert len(flat) == 3 or 450 < cells < 800


def test_what_is_in_reach_lies_within_the_extent_and_a_cell_of_it_does_not() -> None:
    """Looked at on a grid of its own; the extent is a cell wider than the outermost places on either side."""
    robot = rm.load_robot("slavkovic_5r")
    extent = reach_extent(robot)
    assert extent is not None
    grid = coarse_grid(robot, extent.lower, extent.upper, 9000)
    found = grid.points()[reach(robot, grid)]
    step = max(np.diff(axis).max() for axis in (grid.x, grid.y, grid.z))
    assert (found.min(axis=0) - extent.lower < 2.5 * step).all()
    assert (extent.upper - found.max(axis=0) < 2.5 * step).all()


@pytest.mark.parametrize(("tilt", "name"), [(0.0, "slavkovic_5r"), (0.5, "slavkovic_5r"), (0.0, "kuka_kr500")])
def test_the_extent_is_one_cell_wider_than_what_is_reached(tilt: float, name: str) -> None:
    """On the lines of the coarse grid, whose cells are as large as those of a box round random tips."""
    robot = rm.load_robot(name)
    extent = reach_extent(robot, A=tilt)
    assert extent is not None
    theta = np.random.default_rng(8).uniform(robot.limits[:, 0], robot.limits[:, 1], (20_000, robot.n))
    edge = np.cbrt(np.prod(np.ptp(rm.tool_pose(robot, theta)[:, :3, 3], axis=0)) / coarse_cells(robot))
    lines = [
        np.linspace(low, high, round((high - low) / edge) + 1)
        for low, high in zip(extent.lower, extent.upper, strict=True)
    ]
    found = np.argwhere(reach(robot, Grid(*lines), ((tilt, 0.0),)))
    for first, last, count in zip(found.min(axis=0), found.max(axis=0), map(len, lines), strict=True):
        assert first in (0, 1)
        assert last in (count - 1, count - 2)


@pytest.mark.parametrize("corner", [0, 1, -1, -2])
def test_the_extent_is_one_cell_more_than_what_is_reached_and_no_more_than_was_looked_at(corner, monkeypatch) -> None:
    """One cell of the grid alone, at a corner or one off it, or all of them."""
    looked = []

    def one(robot, grid, tilts):
        looked[:] = [grid.x, grid.y, grid.z]
        found = np.zeros(tuple(map(len, looked)), dtype=bool)
        found[corner, corner, corner] = True
        return found

    monkeypatch.setattr("robomill.workspace.region.reach", one)
    extent = reach_extent(rm.load_robot("slavkovic_5r"))
    for axis, low, high in zip(looked, extent.lower, extent.upper, strict=True):
        at = corner % len(axis)
        beside = [axis[k] for k in (at - 1, at, at + 1) if 0 <= k < len(axis)]
        assert (low, high) == (min(beside), max(beside))
