"""Load tests made by calculation, of any model and with what no model says: what identification is to find again."""

from collections.abc import Mapping

import numpy as np

from robomill.arrays import FloatArray
from robomill.compliance.deflection import displacement
from robomill.errors import LoadTestError
from robomill.identification.fit.models import Model
from robomill.identification.load_test import LoadTests
from robomill.identification.synthesis import SYNTHETIC
from robomill.robot.model import Robot


def true_parameters(robot: Robot, model: Model, extra: Mapping[str, float] | None = None) -> FloatArray:
    """(p,) the robot's own joint compliances, and ``extra`` by label ("tool across": 1e-8, SI); the rest zero."""
    parameters = model.parameters(robot)
    labels = [parameter.label for parameter in parameters]
    values = np.zeros(len(labels))
    if model.has("joint"):
        values[: robot.n] = robot.C_theta
    for label, value in (extra or {}).items():
        if label not in labels:
            raise LoadTestError(f"Spring {label!r}: the model {model.name!r} has {', '.join(labels)}.")
        values[labels.index(label)] = value
    return values


def simulated_tests(
    robot: Robot,
    theta: FloatArray,
    F: FloatArray,
    *,
    noise: float = 0.0,
    seed: int | np.random.Generator = 0,
    model: Model | None = None,
    extra: Mapping[str, float] | None = None,
    resolution: float = 0.0,
    model_error: float = 0.0,
) -> LoadTests:
    """What gauges would read at theta (m, n) under forces F (m, 3) N in {M} at the tip.

    noise: standard deviation of a reading (m); resolution: readings are rounded to it (m); model_error: share by
    which each pose's compliance departs from every model here, in a random but symmetric way, the same for all
    loads of that pose; extra: compliances of bending or tool springs by label.
    """
    rng = np.random.default_rng(seed)
    choice = model or Model("joints")
    D = choice.tip_regressor(robot, theta, F)
    moved = D @ true_parameters(robot, choice, extra)
    tests = LoadTests(F, moved, theta=theta)
    if model_error > 0.0:
        pose = tests.pose_index()
        twist = np.eye(3) + 0.5 * model_error * rng.standard_normal((int(pose.max()) + 1, 3, 3))
        C = choice.compliance(robot, tests.theta, true_parameters(robot, choice, extra))  # type: ignore[arg-type]
        C = twist[pose] @ C @ np.swapaxes(twist[pose], -1, -2)
        moved = displacement(C, F)
    moved = moved + noise * rng.standard_normal(moved.shape)
    if resolution > 0.0:
        moved = np.round(moved / resolution) * resolution
    return LoadTests(F, moved, theta=theta, provenance=SYNTHETIC)
