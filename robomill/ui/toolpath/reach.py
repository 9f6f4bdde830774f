"""Whether the arm can follow a path, and where on the board it reaches: quick answers, kept by fingerprint."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from robomill.arrays import BoolArray, FloatArray
from robomill.kinematics.inverse import inverse_kinematics
from robomill.kinematics.transforms import translation
from robomill.robot.model import Robot
from robomill.simulation.run import configurations
from robomill.simulation.samples import sampled
from robomill.simulation.setup import SimulationSetup
from robomill.toolpath.path import Toolpath
from robomill.ui.cached import by_setup, shared
from robomill.units import from_si

MAX_SAMPLES = 400_000
BOARD_CELLS = (80, 80)
BOARD_HALF = 0.4


@dataclass(frozen=True, eq=False)
class PathReach:
    """The sampled path, which samples (m,) are reached, and the room (m,) rad or m to the nearest joint limit."""

    path: Toolpath
    reached: BoolArray
    room: FloatArray
    reason: str

    @property
    def missed(self) -> BoolArray:
        """(m,) samples at feed that cannot be reached."""
        return np.asarray(self.path.cutting & ~self.reached)


@shared(12, by_setup)
def path_reach(setup: SimulationSetup) -> PathReach:
    """The configurations of a run along the path; raises the refusal of reading it."""
    whole = setup.toolpath
    path = sampled(whole, max(setup.step, float(whole.s[-1]) / MAX_SAMPLES, 1e-6))
    ik = configurations(setup, path)
    limits = setup.robot.limits
    room = np.minimum(ik.theta - limits[:, 0], limits[:, 1] - ik.theta).min(axis=1)
    lost = np.flatnonzero(path.cutting & ~ik.reached)
    return PathReach(path, ik.reached, room, str(ik.reason(int(lost[0]))) if len(lost) else "")


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


@shared(24, lambda robot, *place: (robot.digest(), *place))
def _board_runs(robot: Robot, T_MW: FloatArray, low: float, high: float, z: float) -> list[list[int]]:
    nx, ny = BOARD_CELLS
    x = low + (np.arange(nx) + 0.5) * (high - low) / nx
    y = low + (np.arange(ny) + 0.5) * (high - low) / ny
    X, Y = np.meshgrid(x, y)
    T_WT = translation(np.stack([X, Y, np.full_like(X, z)], axis=-1))
    far = ~inverse_kinematics(robot, T_MW @ T_WT).reached
    edges = np.diff(np.pad(far.astype(np.int8), ((0, 0), (1, 1))), axis=1)
    rows, starts = np.nonzero(edges == 1)
    ends = np.nonzero(edges == -1)[1]
    return np.column_stack([rows, starts, ends]).tolist()
