"""Boxes without a singular configuration: det(J) minimised inside, singular places put between grid points."""

import itertools
from types import SimpleNamespace

import numpy as np
import pytest
from scipy.optimize import minimize

import robomill as rm
from robomill.workspace.clear import _cell_of, _finer, _wrapped, clear_cells, largest_clear_box
from robomill.workspace.grid import PAPER_BOX_SIZE, Grid
from robomill.workspace.reach import ReachBox
from robomill.workspace.region import largest_region
from tests.kinematics.oracles import numeric_jacobian, pose
from tests.telling import told

QUARTER = np.radians(90.0)


def det(robot, theta):
    """det of the task Jacobian by differences of the pose: the tip, and the tool axis on two axes square to it."""
    J, k = numeric_jacobian(robot, theta), pose(robot, theta)[:3, 2]
    if robot.n == 6:
        return np.linalg.det(J)
    x = np.cross(np.cross(k, [1.0, 0, 0]), k)  # R_x(A) R_y(B) has its x axis in the plane of k and X
    x /= np.linalg.norm(x)
    return np.linalg.det(np.vstack([J[:3], x @ J[3:], np.cross(k, x) @ J[3:]]))


@pytest.mark.parametrize(
    ("name", "A", "B"),
    [("slavkovic_5r", 0, 0), ("slavkovic_5r", 0.3, 0.2), ("kuka_kr500", 0, 0), ("kuka_kr500", 0.2, -0.4)],
)
def test_nowhere_in_the_box_is_the_arm_singular(name, A, B):
    robot = rm.load_robot(name)
    box = largest_region(robot, A, B)

    def at(u):
        x = box.lower + np.clip(u, 0, 1) * box.size
        ik = rm.inverse_kinematics(robot, rm.pose_from_world([*x, A, B]))
        assert ik.reached
        return det(robot, ik.theta)

    rng = np.random.default_rng(4)
    places = [*rng.random((200, 3)), *map(np.array, itertools.product([0.0, 0.5, 1.0], repeat=3))]
    found = np.array([at(u) for u in places])
    assert (np.sign(found) == np.sign(found[0])).all()
    for k in np.argsort(np.abs(found))[:3]:  # downhill from the smallest
        least = minimize(lambda u: abs(at(u)), places[k], method="Nelder-Mead", options={"maxiter": 150})
        assert at(least.x) * found[0] > 0
        assert abs(at(least.x)) > 0.01 * np.abs(found).max()


def test_the_papers_box_fits_into_the_largest_of_its_arm():
    assert largest_region(rm.load_robot("slavkovic_5r")).holds(PAPER_BOX_SIZE)


@pytest.mark.parametrize("seed", range(8))
def test_a_singular_place_between_grid_points_is_seen(seed):
    """The tool along axis 4: joint 4 turns nothing. The tilt is that of the pose; the place lies within a cell."""
    robot = rm.load_robot("slavkovic_5r")
    rng = np.random.default_rng(seed)
    while True:
        theta = np.array(
            [rng.uniform(-1, 1), *rng.uniform([-0.9, -0.6], [0.3, 0.6]), rng.uniform(-0.5, 0.5), np.pi / 2]
        )
        X, Y, Z, A, B = rm.world_from_pose(pose(robot, theta))
        if max(abs(A), abs(B)) < 1.0:
            break
    assert abs(det(robot, theta)) < 1e-7
    step, offset = 0.12, rng.uniform(0.2, 0.8, 3)
    grid = Grid(*(centre + step * (np.arange(-1, 3) - f) for centre, f in zip((X, Y, Z), offset, strict=True)))
    clear = clear_cells(robot, grid, A, B)
    assert not clear[1, 1, 1]
    assert clear.shape == (3, 3, 3)


def test_cells_of_a_plane_and_of_a_planar_arm():
    robot = rm.load_robot("planar_2r")
    axis = np.linspace(-0.85, 0.85, 35)
    clear = clear_cells(robot, Grid(axis, axis, [0.0]))
    assert clear.shape == (34, 34, 1)
    middle = 0.5 * (axis[1:] + axis[:-1])
    r = np.hypot(*np.meshgrid(middle, middle, indexing="ij"))
    assert not clear[r > 0.9].any()
    assert not clear[r < 0.1].any()
    assert clear.any()


@pytest.mark.parametrize("cell", [(0, 0, 0), (3, 2, 1), (0, 2, 1), (3, 0, 0), (1, 1, 0), (2, 0, 1)])
def test_what_only_a_finer_grid_shows_is_left_out(monkeypatch, cell):
    """One bad place that cells of the coarse grid do not see: the box is the largest of all boxes without that cell."""
    grid = Grid(np.linspace(0, 0.4, 5), np.linspace(1, 1.24, 4), np.linspace(-1, -0.84, 3))
    place = [axis[i] + 0.55 * (axis[1] - axis[0]) for axis, i in zip((grid.x, grid.y, grid.z), cell, strict=True)]

    def cells(robot, looked, A, B):
        axes = (looked.x, looked.y, looked.z)
        found = np.ones([len(axis) - 1 for axis in axes], dtype=bool)
        if axes[0][1] - axes[0][0] < 0.05:
            at = [np.searchsorted(axis, p) - 1 for axis, p in zip(axes, place, strict=True)]
            if all(0 <= i < n for i, n in zip(at, found.shape, strict=True)):
                found[tuple(at)] = False
        return found

    monkeypatch.setattr("robomill.workspace.clear.clear_cells", cells)
    found = []
    said = told(lambda: found.append(largest_clear_box(rm.load_robot("planar_2r"), grid)))
    (box,) = found
    rounds = said["Boxes without a singularity"]
    assert rounds[0] == 0.0
    assert len(rounds) > 1  # which ``told`` holds between 0 and 1
    spans = [list(itertools.combinations(axis, 2)) for axis in (grid.x, grid.y, grid.z)]
    volumes = [
        np.prod([high - low for low, high in ends])
        for ends in itertools.product(*spans)
        if not all(low < p < high for (low, high), p in zip(ends, place, strict=True))
    ]
    assert np.prod(box.size) == pytest.approx(max(volumes))
    assert not ((box.lower < place) & (place < box.upper)).all()


@pytest.mark.parametrize("points", [(1, 3, 2), (2, 2, 2), (2, 1, 4), (1, 1, 1)])
def test_cells_lie_between_points(points):
    """One less than points along an axis, one layer of a single one; each tells of its own corners alone."""
    robot = rm.load_robot("slavkovic_5r")
    axes = [c + 0.02 * np.arange(n) for c, n in zip((0.0, -1.3, 0.0), points, strict=True)]
    assert clear_cells(robot, Grid(*axes)).shape == tuple(max(n - 1, 1) for n in points)
    assert clear_cells(robot, Grid(*axes)).all()
    axes[2] = axes[2] + 5.0  # out of reach
    assert not clear_cells(robot, Grid(*axes)).any()


def test_a_turn_is_the_shortest_of_those_that_end_alike():
    turn = np.random.default_rng(0).uniform(-9, 9, (4, 50))
    np.testing.assert_allclose(_wrapped(turn), np.angle(np.exp(1j * turn)), atol=1e-12)


def short(turn):
    return np.angle(np.exp(1j * turn))


def clear_by_hand(shape, able, branch, det, theta):
    """Cell by cell: corners, edges (one branch, one sign, a quarter turn at most), faces (no turn left on a round)."""
    wide = [axis for axis in range(3) if shape[axis] > 1]
    found = np.zeros([max(n - 1, 1) for n in shape], dtype=bool)
    steps = [(0, 1) if axis in wide else (0,) for axis in range(3)]
    for cell in np.ndindex(*found.shape):
        corners = [tuple(np.add(cell, step)) for step in itertools.product(*steps)]
        edges = [(p, q) for p in corners for q in corners if sum(np.abs(np.subtract(q, p))) == 1 and q > p]
        clear = all(able[p] for p in corners)
        for p, q in edges:
            clear &= branch[p] == branch[q] and det[p] * det[q] > 0.0
            clear &= bool((np.abs(short(theta[q] - theta[p])) < QUARTER).all())
        for p, one, other in itertools.product(corners, wide, wide):
            if one < other:
                e, f = np.eye(3, dtype=int)[[one, other]]
                loop = [p, tuple(p + e), tuple(p + e + f), tuple(p + f), p]
                if all(q in corners for q in loop):
                    left = sum(short(theta[b] - theta[a]) for a, b in itertools.pairwise(loop))
                    clear &= bool((np.abs(left) < QUARTER).all())
        found[cell] = clear
    return found


@pytest.mark.parametrize("shape", [(4, 3, 3), (6, 5, 1), (1, 4, 5), (7, 1, 1)])
@pytest.mark.parametrize("seed", range(4))
def test_a_cell_is_clear_by_its_corners_edges_and_faces(monkeypatch, shape, seed):
    """Joints, branches and det(J) made up: a vortex that turns a joint once around a line, and a few odd places."""
    rng = np.random.default_rng(seed)
    grid = Grid(*(np.arange(n) * 0.1 for n in shape))
    at = grid.points() - rng.uniform(0.0, 0.1 * np.array(shape))
    vortex = np.arctan2(at[..., seed % 3], at[..., (seed + 1) % 3])
    theta = np.stack([vortex, 5.0 * at.sum(axis=-1), 0.0 * vortex], axis=-1) + rng.uniform(-0.3, 0.3, (*shape, 3))
    branch = (rng.random(shape) < 0.06).astype(int)
    det = rng.uniform(0.5, 2.0, shape) * np.where(rng.random(shape) < 0.06, -1.0, 1.0)
    det.flat[0] = 1e-12
    reached = rng.random(shape) > 0.03
    theta[~reached] = np.nan
    robot = SimpleNamespace(n=3, chain=SimpleNamespace(prismatic=np.array([False, False, True])))
    theta[..., 2] += rng.uniform(-9, 9, shape)  # slides may go anywhere
    ik = SimpleNamespace(theta=theta, reached=reached, branch_index=branch)
    monkeypatch.setattr("robomill.workspace.clear.inverse_kinematics", lambda robot, poses: ik)
    monkeypatch.setattr("robomill.workspace.clear.determinant", lambda robot, angles: det[reached])
    monkeypatch.setattr("robomill.workspace.clear.near_singular", lambda robot, values: ~(np.abs(values) > 1e-6))
    able = reached & (np.abs(det) > 1e-6)
    expected = clear_by_hand(shape, able, branch, det, theta[..., :2])
    np.testing.assert_array_equal(clear_cells(robot, grid), expected)
    robot.n = 7  # one of many postures: its corners alone
    by_corners = clear_by_hand(shape, able, 0 * branch, 0 * det + 1.0, 0 * np.nan_to_num(theta))
    np.testing.assert_array_equal(clear_cells(robot, grid), by_corners)


def test_a_finer_grid_divides_every_step_in_three_and_knows_its_cells():
    grid = Grid([0.0, 1.0, 3.0, 6.0], [0.0, 2.0], [5.0])
    fine = _finer(grid, ReachBox(np.array([1.0, 0.0, 5.0]), np.array([6.0, 2.0, 5.0])))
    np.testing.assert_allclose(fine.x, [1, 5 / 3, 7 / 3, 3, 4, 5, 6])
    np.testing.assert_allclose(fine.y, [0, 2 / 3, 4 / 3, 2])
    np.testing.assert_array_equal(fine.z, [5.0])
    cells = np.array([[i, j, 0] for i in range(6) for j in range(3)])
    expected = np.array([[1 + i // 3, 0, 0] for i in range(6) for j in range(3)])
    np.testing.assert_array_equal(_cell_of(cells, fine, grid), expected)
