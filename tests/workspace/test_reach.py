"""Reach and the largest machining box, against brute force; the lines of Fig. 8."""

import itertools

import numpy as np
import pytest

import robomill as rm
from robomill.errors import WorkspaceError
from robomill.workspace.fields import compliance_map
from robomill.workspace.grid import PAPER_BOX, Grid, box_grid
from robomill.workspace.lines import border_and_middle_lines, line_deviation
from robomill.workspace.reach import ReachBox, against_paper, largest_box, paper_box_in, reach
from tests.telling import told


def corners(grid):
    """Points as things without length: low and high are the same."""
    axes = (grid.x, grid.y, grid.z)
    return axes, axes


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
    box = largest_box(mask, *corners(grid))
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
    grid = box_grid([-1.5, -2.3, -1.0], [1.5, 0.0, 1.5], 0.1)
    box = largest_box(reach(robot, grid), *corners(grid))
    assert against_paper(box)["holds_paper_box"]
    assert against_paper(box)["volume_ratio"] > 1
    tilted = largest_box(reach(robot, grid, [(0, 0), (0.5, 0), (0, 0.5)]), *corners(grid))
    assert tilted.volume < box.volume


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


@pytest.mark.parametrize("robot", ["slavkovic_5r", "kuka_kr500"])
def test_reach_is_every_tilt_at_every_point(robot):
    robot = rm.load_robot(robot)
    low, high = ([-1.8, -2.6, -0.6], [1.8, 0.4, 0.6]) if robot.n == 5 else ([0.4, -2.0, -0.2], [3.2, 2.0, 0.8])
    grid, tilts = box_grid(low, high, 0.6), [(0.0, 0.0), (0.4, -0.2)]
    mask = reach(robot, grid, tilts)
    assert 0 < mask.sum() < mask.size
    for index in np.ndindex(mask.shape):
        poses = [rm.pose_from_world([*grid.points()[index], A, B]) for A, B in tilts]
        assert mask[index] == all(bool(rm.inverse_kinematics(robot, T).reached) for T in poses)
    with pytest.raises(WorkspaceError, match="at least one tool tilt"):
        reach(robot, grid, [])


def test_boxes_hold_what_fits():
    box = ReachBox(np.array([0.0, 0.0, 0.0]), np.array([1.2, 0.6, 0.5]))
    assert box.volume == pytest.approx(0.36)
    assert against_paper(box) == {"holds_paper_box": True, "volume_ratio": pytest.approx(1.0)}
    assert not box.holds(np.array([1.2, 0.6, 0.5001]))
    assert not box.holds(np.array([1.2001, 0.6, 0.5]))
    assert against_paper(ReachBox(box.lower, box.upper * [2, 1, 1]))["volume_ratio"] == pytest.approx(2.0)


def test_where_the_papers_box_stands_to_another_is_where_all_its_corners_are():
    low, high = PAPER_BOX
    inside = list(itertools.product(*zip(low, high, strict=True)))
    rng = np.random.default_rng(11)
    met = set()
    for _ in range(300):
        lower = low + rng.uniform(-0.5, 0.3, 3) * rng.integers(0, 2)
        box = ReachBox(lower, lower + rng.choice([0.4, 0.6, 1.2, 1.3], 3) * rng.choice([1.0, 1.5]))
        found = paper_box_in(box)
        met.add(found)
        assert (found == "inside") == all((box.lower <= p).all() and (p <= box.upper).all() for p in inside)
        a, b, c = box.size + 1e-9
        assert (found in ("inside", "outside")) == (a >= 1.2 and b >= 0.6 and c >= 0.5)
        assert found != "turned" or (a >= 0.6 and b >= 1.2 and c >= 0.5)
        assert found != "larger" or not ((a >= 0.6 and b >= 1.2 and c >= 0.5) or (a >= 1.2 and b >= 0.6 and c >= 0.5))
    assert paper_box_in(ReachBox(low, high)) == "inside"
    assert met == {"inside", "outside", "turned", "larger"}


def test_a_line_is_a_row_of_poses():
    """Each point of a ramp by itself: pose, force to the left of the feed, push times compliance."""
    robot = rm.load_robot("slavkovic_5r")
    start, end = np.array([-0.2, -1.4, 0.0]), np.array([0.3, -1.2, 0.05])
    line = line_deviation(robot, start, end, 80.0, 5, name="ramp")
    k = np.array([0.0, 0.0, 1.0])
    feed = (end - start) / np.linalg.norm(end - start)
    left = np.cross(k, feed) / np.linalg.norm(np.cross(k, feed))
    np.testing.assert_allclose(line.feed, feed)
    np.testing.assert_allclose(line.normal, left)
    np.testing.assert_allclose(line.F, 80.0 * left)
    np.testing.assert_allclose(line.s, np.linspace(0, np.linalg.norm(end - start), 5), atol=1e-15)
    for i, t in enumerate(np.linspace(0, 1, 5)):
        p = start + t * (end - start)
        np.testing.assert_allclose(line.p[i], p, atol=1e-15)
        T = rm.tool_pose(robot, line.ik.theta[i])
        np.testing.assert_allclose(T[:3, 3], p, atol=1e-9)
        np.testing.assert_allclose(T[:3, 2], k, atol=1e-9)
        delta = rm.cartesian_compliance(robot, line.ik.theta[i]) @ (80.0 * left)
        np.testing.assert_allclose(line.delta[i], delta, atol=1e-12)
        assert line.along_normal()[i].sum() == pytest.approx(delta @ left)
    assert len(line_deviation(robot, start, end, points=2).p) == 2
    with pytest.raises(WorkspaceError, match="at least two points"):
        line_deviation(robot, start, end, points=1)


def test_six_lines_on_borders_and_middle():
    robot = rm.load_robot("slavkovic_5r")
    lines = border_and_middle_lines(robot, [-0.4, -1.5], [0.2, -1.1], z=-0.1, force=50.0, points=3)
    ends = [(tuple(line.p[0]), tuple(line.p[-1])) for line in lines]
    across = [((-0.4, y, -0.1), (0.2, y, -0.1)) for y in (-1.5, -1.3, -1.1)]
    along = [((x, -1.5, -0.1), (x, -1.1, -0.1)) for x in (-0.4, -0.1, 0.2)]
    np.testing.assert_allclose(ends, across + along, atol=1e-12)
    assert [np.linalg.norm(line.F) for line in lines] == pytest.approx([50.0] * 6)
    assert [len(line.p) for line in lines] == [3] * 6
    assert lines[0].name == "along X_M at Y_M = −1500 mm"
    assert lines[5].name == "along Y_M at X_M = 200 mm"


def test_a_long_search_says_how_far_it_is(monkeypatch):
    """Points block by block, boxes height by height, each from nothing on in even parts."""
    monkeypatch.setattr("robomill.workspace.reach.BLOCK", 30)
    monkeypatch.setattr("robomill.workspace.solve.BLOCK", 30)
    robot, grid = rm.load_robot("slavkovic_5r"), box_grid([-0.3, -1.5, 0.0], [0.3, -1.2, 0.2], 0.1)
    mask = reach(robot, grid)
    assert mask.all()
    assert mask.size == 84
    for work, stage in ((lambda: reach(robot, grid), "Reach"), (lambda: compliance_map(robot, grid), "Map")):
        assert told(work)[stage] == pytest.approx([0.0, 30 / 84, 60 / 84])
    boxes = told(lambda: largest_box(mask, *corners(grid)))["Boxes"]
    assert set(boxes) == {1 / 3, 2 / 3}  # boxes of one height have none


def test_reach_asks_for_what_it_keeps(monkeypatch):
    """Three coordinates and a flag a point."""
    asked = []
    monkeypatch.setattr(Grid, "check_budget", lambda grid, bytes_per_cell: asked.append(bytes_per_cell))
    grid = box_grid([-0.1, -1.4, 0.0], [0.1, -1.2, 0.0], 0.1)
    mask = reach(rm.load_robot("slavkovic_5r"), grid)
    assert asked == [(grid.points().nbytes + mask.nbytes) / grid.cells]
