"""Where on the board the arm reaches, for the pad, and whether it can follow a path: both kept by fingerprint."""

from typing import Any

import numpy as np

from robomill.arrays import FloatArray, stretches
from robomill.robot.model import Robot
from robomill.simulation import reach
from robomill.simulation.setup import SimulationSetup
from robomill.ui.work.cached import by_setup, shared
from robomill.units import from_si

BOARD_CELLS = (80, 80)
BOARD_HALF = 0.4

path_reach = shared(by_setup, "Following the path")(reach.path_reach)


def board_reach(setup: SimulationSetup, z: float, unit: str) -> dict[str, Any] | None:
    """Cells of the board (the plane z m in {W}, around the part zero) that the tool cannot reach, for the pad."""
    low, high = -BOARD_HALF, BOARD_HALF
    source = getattr(setup.source, "sketch", None)
    if source is not None and source.elements:
        points = np.vstack([e.outline() for e in source.elements])
        extent = float(np.abs(points).max())
        # A board that grows in steps, so that drawing does not move the grid.
        low, high = (
            side * BOARD_HALF * 2.0 ** max(0.0, np.ceil(np.log2(3.0 * extent / BOARD_HALF))) for side in (-1.0, 1.0)
        )
    runs = _board_runs(setup.robot, setup.T_MW, low, high, round(z, 6))
    nx, ny = BOARD_CELLS
    return {
        "x": float(from_si(low, unit)),
        "y": float(from_si(low, unit)),
        "dx": float(from_si((high - low) / nx, unit)),
        "dy": float(from_si((high - low) / ny, unit)),
        "runs": runs,
    }


@shared(lambda robot, *place: (robot.digest(), *place), "What the arm reaches of the board")
def _board_runs(robot: Robot, T_MW: FloatArray, low: float, high: float, z: float) -> list[list[int]]:
    nx, ny = BOARD_CELLS
    x = low + (np.arange(nx) + 0.5) * (high - low) / nx
    y = low + (np.arange(ny) + 0.5) * (high - low) / ny
    far = ~reach.plane_reach(robot, T_MW, x, y, z)
    return [[row, *run] for row, cells in enumerate(far) for run in stretches(cells).tolist()]
