"""Which part of the workspace to look at: everything in reach, the largest machining box, or the paper's box."""

import numpy as np

from robomill.arrays import FloatArray, frozen
from robomill.kinematics.decoupled import decoupled
from robomill.kinematics.extent import drawn
from robomill.kinematics.forward import tool_pose
from robomill.robot.model import Robot
from robomill.workspace.clear import largest_clear_box
from robomill.workspace.grid import PAPER_BOX, Grid, box_grid
from robomill.workspace.reach import ReachBox, reach

FLAT = 1e-6  # m: an arm that spans less than this along an axis moves in a plane
SAMPLES = 20_000


def flat_axis(robot: Robot) -> int | None:
    """0, 1 or 2 where the tip never leaves a plane normal to X, Y or Z of {M} (a planar arm), else None."""
    span = np.ptp(_tips(robot), axis=0)
    return int(np.argmin(span)) if span.min() < FLAT else None


def coarse_cells(robot: Robot) -> int:
    """How many poses a first look may cost: arms without closed form are solved a thousand times slower."""
    return 9000 if decoupled(robot) is not None else 700


def reach_extent(robot: Robot, A: float = 0.0, B: float = 0.0) -> ReachBox | None:
    """The bounding box of what is in reach at the tilt A, B (rad), to a coarse cell; None where nothing is."""
    tips = _tips(robot)
    low, high = tips.min(axis=0), tips.max(axis=0)
    if robot.n < 5:
        return ReachBox(frozen(low), frozen(high))
    grid = coarse_grid(robot, low, high)
    found = np.argwhere(reach(robot, grid, ((A, B),)))
    if len(found) == 0:
        return None
    first, last = found.min(axis=0), found.max(axis=0)
    axes = (grid.x, grid.y, grid.z)
    lower = [axes[i][max(first[i] - 1, 0)] for i in range(3)]
    upper = [axes[i][min(last[i] + 1, len(axes[i]) - 1)] for i in range(3)]
    return ReachBox(frozen(lower), frozen(upper))


def coarse_grid(robot: Robot, lower: FloatArray, upper: FloatArray, cells: int | None = None) -> Grid:
    """A grid over lower .. upper (3,) m with about ``cells`` cells of equal edges."""
    span = np.asarray(upper, dtype=float) - lower
    wide = span > FLAT
    count = cells or coarse_cells(robot)
    if not wide.any():
        return box_grid(lower, lower, 1.0)
    step = float((np.prod(span[wide]) / count) ** (1.0 / wide.sum()))
    return Grid(*(_centred(lower[i], upper[i], step) if wide[i] else np.array([lower[i]]) for i in range(3)))


def holds_paper_box(robot: Robot) -> bool:
    """True where the paper's working box is in reach (but for a corner) with the tool vertical."""
    if robot.n < 5:
        return False
    return float(reach(robot, box_grid(*PAPER_BOX, 0.1)).mean()) >= 0.95


def largest_region(robot: Robot, A: float = 0.0, B: float = 0.0) -> ReachBox | None:
    """The largest machining box in reach that holds no singular configuration, on a coarse grid; None without one."""
    extent = reach_extent(robot, A, B)
    if extent is None:
        return None
    grid = coarse_grid(robot, extent.lower, extent.upper)
    return largest_clear_box(robot, grid, A, B)


def _tips(robot: Robot) -> FloatArray:
    """(m, 3) m: tips at random configurations within the limits, always the same ones."""
    return tool_pose(robot, drawn(robot, SAMPLES, seed=1))[..., :3, 3]


def _centred(low: float, high: float, step: float) -> FloatArray:
    count = max(round((high - low) / step), 1)
    return np.linspace(low, high, count + 1)
