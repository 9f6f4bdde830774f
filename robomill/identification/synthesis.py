"""Load tests made by calculation, for planning, teaching and checks. They say that they are synthetic."""

import numpy as np

from robomill.arrays import FloatArray
from robomill.compliance.cartesian import cartesian_compliance
from robomill.compliance.deflection import displacement
from robomill.identification.configurations import sliding_joints
from robomill.identification.load_test import LoadTests
from robomill.provenance import Provenance
from robomill.robot.model import Robot

SYNTHETIC = Provenance("synthetic", "calculated, with noise by chance")


def three_directions(theta: FloatArray, load: float) -> tuple[FloatArray, FloatArray]:
    """Every pose (k, n) loaded by ``load`` N along +X, +Y and +Z of {M}: theta (3k, n), F (3k, 3)."""
    theta = np.asarray(theta, dtype=np.float64)
    return np.repeat(theta, 3, axis=0), np.tile(np.eye(3) * load, (len(theta), 1))


def simulated_tests(
    robot: Robot,
    theta: FloatArray,
    F: FloatArray,
    *,
    noise: float = 0.0,
    resolution: float = 0.0,
    seed: int | np.random.Generator = 0,
) -> LoadTests:
    """What gauges would read at theta (m, n) under forces F (m, 3) N in {M} at the tip.

    noise: standard deviation of a reading (m); resolution: readings are rounded to it (m).
    """
    moved = displacement(cartesian_compliance(robot, theta), F)
    moved = moved + noise * np.random.default_rng(seed).standard_normal(moved.shape)
    if resolution > 0.0:
        moved = np.round(moved / resolution) * resolution
    return LoadTests(F, moved, theta=theta, sliding=sliding_joints(robot), provenance=SYNTHETIC)
