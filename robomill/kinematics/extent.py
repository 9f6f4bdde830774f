"""How far an arm goes: its links in a row, and configurations drawn within its limits."""

import numpy as np

from robomill.arrays import FloatArray
from robomill.robot.model import Robot


def stretch(robot: Robot) -> float:
    """m: no tip lies farther from the base: all links in a row, those that slide drawn out."""
    chain = robot.chain
    travel = np.abs(robot.limits).max(axis=1) + np.abs(chain.offset)
    return float(np.linalg.norm(chain.E[:, :3, 3], axis=1).sum() + travel[chain.prismatic].sum())


def drawn(robot: Robot, count: int, seed: int = 0) -> FloatArray:
    """(count, n): random configurations within the limits, of one seed always the same ones."""
    low, high = robot.limits.T
    return np.random.default_rng(seed).uniform(low, high, (count, robot.n))
