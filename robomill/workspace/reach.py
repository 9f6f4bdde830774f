"""Where the arm can work: reach at one or several tilts, and the largest machining box inside it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np

from robomill.arguments import asked
from robomill.arrays import BoolArray, FloatArray, frozen
from robomill.errors import WorkspaceError
from robomill.kinematics.forward import BLOCK
from robomill.kinematics.inverse import inverse_kinematics
from robomill.kinematics.transforms import pose_from_world
from robomill.progress import checkpoint
from robomill.robot.model import Robot, check_robot
from robomill.workspace.grid import PAPER_BOX, PAPER_BOX_SIZE, Grid

SLACK = 1e-6  # m
Axes = tuple[FloatArray, FloatArray, FloatArray]


@dataclass(frozen=True, eq=False)
class ReachBox:
    """An axis-aligned box in {M}, m."""

    lower: FloatArray
    upper: FloatArray

    @property
    def size(self) -> FloatArray:
        """(3,) m."""
        return self.upper - self.lower

    @property
    def volume(self) -> float:
        """m^3."""
        return float(np.prod(self.size))

    def holds(self, size: FloatArray) -> bool:
        """True where a box of ``size`` (3,) m fits inside without turning it."""
        return bool((self.size >= np.asarray(size) - 1e-9).all())


@asked
def reach(robot: Robot, grid: Grid, tilts: Sequence[tuple[float, float]] = ((0.0, 0.0),)) -> BoolArray:
    """Where the tool can be brought, eq. (10).

    Parameters
    ----------
    robot : Robot
        The arm.
    grid : Grid
        Points in {M}, m.
    tilts : sequence of (A, B)
        Tilts of the tool, rad, all of which must be reached.

    Returns
    -------
    ndarray of bool, (nx, ny, nz)
        True where every tilt is reached within the joint limits.

    Raises
    ------
    WorkspaceError
        Without a tilt, or where the grid needs more memory than the budget.

    Examples
    --------
    >>> import robomill as rm
    >>> rm.reach(rm.load_robot("slavkovic_5r"), rm.Grid(x_mm=[0, 9000], y_mm=-1300, z_mm=0)).ravel().tolist()
    [True, False]
    """
    check_robot(robot)
    grid.check_budget(8 * 3 + 1)
    if len(tilts) == 0:
        raise WorkspaceError("Reach: give at least one tool tilt (A, B).")
    points = grid.points().reshape(-1, 3)
    mask = np.ones(len(points), dtype=bool)
    for A, B in tilts:
        left = np.flatnonzero(mask)
        for start in range(0, len(left), BLOCK):
            checkpoint(start / len(left), "Reach")
            rows = left[start : start + BLOCK]
            x_M = np.concatenate([points[rows], np.broadcast_to([A, B], (len(rows), 2))], axis=1)
            mask[rows] = inverse_kinematics(robot, pose_from_world(x_M)).reached
    return mask.reshape(grid.shape)


def largest_box(mask: BoolArray, low: Axes, high: Axes) -> ReachBox | None:
    """The largest box of things that are all True in ``mask`` (nx, ny, nz); None without one.

    Along each axis a thing reaches from ``low`` to ``high``. Largest by volume, exactly; an axis without length counts
    as one unit. Every height in z and width in x is tried for all positions at once, and the longest run in y taken.
    """
    nx, ny, nz = mask.shape
    longest_x, longest_y = _extents(low[0], high[0], nx).max(), _extents(low[1], high[1], ny).max()
    best, corners = 0.0, None
    layers = np.ones((nz + 1, nx, ny), dtype=bool)
    stack = np.ascontiguousarray(mask.transpose(2, 0, 1))
    for h in range(1, nz + 1):
        layers = layers[:-1] & stack[h - 1 :]
        heights = _extents(low[2], high[2], h)
        if not layers.any():
            break
        if heights.max() * longest_x * longest_y <= best:
            continue
        slabs = np.ones((len(layers), nx + 1, ny), dtype=bool)
        for w in range(1, nx + 1):
            checkpoint((h - 1) / nz, "Boxes")
            slabs = slabs[:, :-1] & layers[:, w - 1 :]
            widths = _extents(low[0], high[0], w)
            if not slabs.any():
                break
            if heights.max() * widths.max() * longest_y <= best:
                continue
            volume, (k, i, j, j_end) = _longest_run(slabs, low[1], high[1], heights[:, None] * widths[None, :])
            if volume > best:
                best, corners = (
                    volume,
                    (
                        (low[0][i], low[1][j], low[2][k]),
                        (high[0][i + w - 1], high[1][j_end], high[2][k + h - 1]),
                    ),
                )
    return None if corners is None else ReachBox(frozen(corners[0]), frozen(corners[1]))


def against_paper(box: ReachBox) -> dict[str, float | bool]:
    """The box beside the paper's 1200 x 600 x 500 mm: whether that fits inside, and the ratio of the volumes."""
    return {"holds_paper_box": box.holds(PAPER_BOX_SIZE), "volume_ratio": box.volume / float(np.prod(PAPER_BOX_SIZE))}


def paper_box_in(box: ReachBox) -> Literal["inside", "outside", "turned", "larger"]:
    """Where the paper's box stands to this one: inside; partly outside, though it has room there; it has room turned by
    90 degrees about Z; or it is larger."""
    if (box.lower <= PAPER_BOX[0] + SLACK).all() and (PAPER_BOX[1] - SLACK <= box.upper).all():
        return "inside"
    if box.holds(PAPER_BOX_SIZE):
        return "outside"
    return "turned" if box.holds(PAPER_BOX_SIZE[[1, 0, 2]]) else "larger"


def _extents(low: FloatArray, high: FloatArray, count: int) -> FloatArray:
    """Length of every run of ``count`` consecutive things of an axis, m; 1 for an axis without any length."""
    if high[-1] == low[0]:
        return np.ones(1)
    return high[count - 1 :] - low[: len(low) - count + 1]


def _longest_run(
    slabs: BoolArray, low: FloatArray, high: FloatArray, section: FloatArray
) -> tuple[float, tuple[int, int, int, int]]:
    """(volume, (k, i, j, j_end)): the best run along y in slabs (nk, ni, ny), times ``section`` (nk, ni) m^2."""
    places = np.arange(len(low))
    last_gap = np.maximum.accumulate(np.where(slabs, -1, places), axis=-1)
    first = np.minimum(last_gap + 1, places)
    length = np.where(slabs, high[places] - low[first] if high[-1] > low[0] else 1.0, 0.0)
    volume = length * section[..., None]
    k, i, j_end = np.unravel_index(int(np.argmax(volume)), volume.shape)
    return float(volume[k, i, j_end]), (int(k), int(i), int(first[k, i, j_end]), int(j_end))
