"""The largest machining box that holds no singular configuration: at grid points, and between them.

A cell of a grid is clear where the arm stands in one configuration all over it: its corners are reached in the same
branch with det(J) of one sign and away from zero; no joint swings by more than a quarter turn along an edge; and none
comes back a whole turn away around a face, as it does around a singular line that passes through.
"""

from itertools import combinations

import numpy as np

from robomill.arrays import BoolArray, FloatArray, IntArray
from robomill.kinematics.dexterity import determinant, near_singular
from robomill.kinematics.inverse import inverse_kinematics
from robomill.kinematics.transforms import pose_from_world
from robomill.progress import checkpoint
from robomill.robot.model import Robot
from robomill.workspace.grid import Grid
from robomill.workspace.reach import ReachBox, largest_box

SWING = np.pi / 2  # rad along an edge
FINER = 3  # times finer is what a found box is looked through again with
ROUNDS = 30


def largest_clear_box(robot: Robot, grid: Grid, A: float = 0.0, B: float = 0.0) -> ReachBox | None:
    """The largest box of cells of ``grid`` without a singular configuration at the tilt A, B rad; None without one.

    Each box found is looked through on a finer grid; cells that hold what the coarse one missed are taken out, and the
    next largest is tried.
    """
    clear = clear_cells(robot, grid, A, B)
    for done in range(ROUNDS):
        checkpoint(done / ROUNDS, "Boxes without a singularity")
        box = _largest_box_cells(clear, grid)
        if box is None:
            return None
        fine = _finer(grid, box)
        bad = np.argwhere(~clear_cells(robot, fine, A, B))
        if len(bad) == 0:
            return box
        clear[tuple(_cell_of(bad, fine, grid).T)] = False
    return None


def clear_cells(robot: Robot, grid: Grid, A: float = 0.0, B: float = 0.0) -> BoolArray:
    """(max(nx - 1, 1), ...) True where a cell holds no singular configuration; an axis of one point has one layer."""
    points = grid.points()
    tilts = np.broadcast_to([A, B], (*grid.shape, 2))
    ik = inverse_kinematics(robot, pose_from_world(np.concatenate([points, tilts], axis=-1)))
    det = np.full(grid.shape, np.nan)
    det[ik.reached] = determinant(robot, ik.theta[ik.reached])
    able: BoolArray = ik.reached & ~near_singular(robot, det)
    wide = [axis for axis in range(3) if grid.shape[axis] > 1]
    if robot.n > 6:  # one of many postures, which is not carried on from point to point
        return _cells(able, wide)
    turns = ~robot.chain.prismatic
    theta = ik.theta[..., turns]
    steps = {axis: _wrapped(np.diff(theta, axis=axis)) for axis in wide}
    clear = _cells(able, wide)
    for axis in wide:
        first, second = _ends(axis)
        same = (ik.branch_index[first] == ik.branch_index[second]) & (det[first] * det[second] > 0.0)
        steady: BoolArray = same & (np.nan_to_num(np.abs(steps[axis]), nan=np.inf).max(axis=-1) < SWING)
        clear &= _cells(steady, [other for other in wide if other != axis])
    for one, other in combinations(wide, 2):
        first, second = _ends(other)
        across, along = _ends(one)
        round_trip = steps[one][first] + steps[other][along] - steps[one][second] - steps[other][across]
        closed: BoolArray = np.nan_to_num(np.abs(round_trip), nan=np.inf).max(axis=-1) < SWING
        clear &= _cells(closed, [third for third in wide if third not in (one, other)])
    return clear


def _wrapped(turn: FloatArray) -> FloatArray:
    """Angles to within half a turn of zero."""
    return np.asarray(turn - 2 * np.pi * np.rint(turn / (2 * np.pi)))


def _ends(axis: int) -> tuple[tuple[slice, ...], tuple[slice, ...]]:
    """Slices of the first and of the second ends of all edges along an axis."""
    whole = [slice(None)] * 3
    return (
        tuple(slice(None, -1) if i == axis else w for i, w in enumerate(whole)),
        tuple(slice(1, None) if i == axis else w for i, w in enumerate(whole)),
    )


def _cells(parts: BoolArray, axes: list[int]) -> BoolArray:
    """Cells all of whose corners, edges or faces are True, which still stand one too many along ``axes``."""
    for axis in axes:
        first, second = _ends(axis)
        parts = parts[first] & parts[second]
    return parts.copy()


def _largest_box_cells(clear: BoolArray, grid: Grid) -> ReachBox | None:
    """The box of most volume all of whose cells are clear."""
    x, y, z = grid.x, grid.y, grid.z
    near = (x[:-1] if len(x) > 1 else x, y[:-1] if len(y) > 1 else y, z[:-1] if len(z) > 1 else z)
    far = (x[1:] if len(x) > 1 else x, y[1:] if len(y) > 1 else y, z[1:] if len(z) > 1 else z)
    return largest_box(clear, near, far)


def _finer(grid: Grid, box: ReachBox) -> Grid:
    """The part of a grid within a box of its cells, ``FINER`` times as fine."""
    axes = []
    for axis, low, high in zip((grid.x, grid.y, grid.z), box.lower, box.upper, strict=True):
        inside = axis[(axis >= low) & (axis <= high)]
        places = np.arange((len(inside) - 1) * FINER + 1) / FINER
        axes.append(np.interp(places, np.arange(len(inside)), inside))
    return Grid(*axes)


def _cell_of(cells: IntArray, fine: Grid, grid: Grid) -> IntArray:
    """(k, 3) the cells of ``grid`` that hold cells (k, 3) of a finer one."""
    found = []
    for i, (small, large) in enumerate(zip((fine.x, fine.y, fine.z), (grid.x, grid.y, grid.z), strict=True)):
        middle = 0.5 * (small[:-1] + small[1:]) if len(small) > 1 else small
        found.append(np.maximum(np.searchsorted(large, middle[cells[:, i]]) - 1, 0))
    return np.column_stack(found)
