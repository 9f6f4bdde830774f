"""Reach and the largest machining box, against brute force; the lines of Fig. 8."""

import itertools

import numpy as np
import pytest

import robomill as rm
from robomill.errors import WorkspaceError
from robomill.workspace.grid import PAPER_BOX, Grid, box_grid
from robomill.workspace.lines import border_and_middle_lines, line_deviation
from robomill.workspace.reach import against_paper, largest_box, machining_box, reach


def brute_force(mask, grid):
    best = 0.0
    axes = (grid.x, grid.y, grid.z)
    ranges = [[(i, j) for i in range(n) for j in range(i, n)] for n in mask.shape]
    for (i, i2), (j, j2), (k, k2) in itertools.product(*ranges):
        if mask[i : i2 + 1, j : j2 + 1, k : k2 + 1].all():
            size = [
                1.0 if len(a) == 1 else a[e] - a[s] for a, (s, e) in zip(axes, ((i, i2), (j, j2), (k, k2)), strict=True)
            ]
            best = max(best, float(np.prod(size)))
    return best


@pytest.mark.parametrize("seed", range(12))
def test_largest_box_against_brute_force(seed):
    rng = np.random.default_rng(seed)
    shape = [(5, 6, 4), (7, 1, 5), (1, 1, 6), (6, 6, 1)][seed % 4]
    grid = Grid(*(np.cumsum(rng.uniform(0.5, 2, n)) for n in shape))
    mask = rng.random(shape) < 0.8
    box = largest_box(mask, grid)
    expected = brute_force(mask, grid)
    if expected == 0.0:
        assert box is None
        return
    size = np.array([1.0 if n == 1 else s for n, s in zip(shape, box.size, strict=True)])
    assert np.prod(size) == pytest.approx(expected)
    inside = [
        (a >= lo - 1e-12) & (a <= hi + 1e-12)
        for a, lo, hi in zip((grid.x, grid.y, grid.z), box.lower, box.upper, strict=True)
    ]
    assert mask[np.ix_(*inside)].all()


def test_the_paper_box_is_inside_the_reach():
    robot = rm.load_robot("slavkovic_5r")
    assert reach(robot, box_grid(*PAPER_BOX, 0.1)).all()
    box = machining_box(robot, box_grid([-1.5, -2.3, -1.0], [1.5, 0.0, 1.5], 0.1))
    assert against_paper(box)["holds_paper_box"]
    assert against_paper(box)["volume_ratio"] > 1
    tilted = machining_box(robot, box_grid([-1.5, -2.3, -1.0], [1.5, 0.0, 1.5], 0.1), [(0, 0), (0.5, 0), (0, 0.5)])
    assert tilted.volume < box.volume


def test_a_grid_out_of_reach_is_refused_with_a_reason():
    robot = rm.load_robot("slavkovic_5r")
    with pytest.raises(WorkspaceError, match="reaches no point"):
        machining_box(robot, box_grid([5, 5, 5], [6, 6, 6], 0.5))


def test_fig_8_lines():
    robot = rm.load_robot("slavkovic_5r")
    lines = border_and_middle_lines(robot)
    assert len(lines) == 6
    assert all(line.reached.all() for line in lines)
    middle = lines[1]  # along X_M through the milling test
    assert middle.delta[30, 1] == pytest.approx(0.2295e-3, abs=5e-8)
    np.testing.assert_allclose(middle.F, [0, 100, 0], atol=1e-12)
    np.testing.assert_allclose(middle.along_normal().sum(axis=1), middle.delta @ middle.normal, atol=1e-15)
    # Symmetry of the arm about X_M = 0.
    np.testing.assert_allclose(lines[3].along_normal().sum(axis=1), lines[5].along_normal().sum(axis=1), rtol=1e-9)
    # Along Y_M the force is along -X_M: the left of the feed.
    np.testing.assert_allclose(lines[4].F, [-100, 0, 0], atol=1e-12)


def test_lines_out_of_reach_are_nan():
    robot = rm.load_robot("slavkovic_5r")
    line = line_deviation(robot, [0, -1.5, 0], [0, -3, 0])
    assert 0 < line.reached.sum() < 61
    np.testing.assert_array_equal(np.isnan(line.delta).any(axis=1), ~line.reached)
    with pytest.raises(WorkspaceError, match="two different ends"):
        line_deviation(robot, [0, -1.5, 0], [0, -1.5, 0])
    with pytest.raises(WorkspaceError, match="along the tool axis"):
        line_deviation(robot, [0, -1.5, 0], [0, -1.5, 0.1])
