"""From tests to equations: one linear row for each measured number, with its noise, test and pose."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from robomill.arrays import BoolArray, FloatArray, IntArray
from robomill.errors import LoadTestError
from robomill.identification.least_squares import Fit, solve_triangle, triangle
from robomill.identification.load_test import JointTests, LoadTests
from robomill.identification.models import Model, Parameter
from robomill.robot.model import Robot

KIND_ROUNDS = 6


@dataclass(frozen=True, eq=False)
class System:
    """Equations A x = b, unweighted. ``noise`` (e,) is the relative standard deviation each is divided by.

    test (e,) index of the test, component (e,) 0-2 displacement, 3-5 rotation; pose (e,) group left out together
    in cross-validation; signed (p,) bool; stated: every noise was given in the file.
    """

    A: FloatArray
    b: FloatArray
    noise: FloatArray
    test: IntArray
    component: IntArray
    pose: IntArray
    parameters: tuple[Parameter, ...]
    stated: bool

    @property
    def signed(self) -> BoolArray:
        return np.array([parameter.signed for parameter in self.parameters])

    @property
    def linear(self) -> BoolArray:
        """(e,) displacements rather than rotations."""
        return self.component < 3

    def fit(self, weights: FloatArray | None = None, chosen: BoolArray | None = None) -> Fit:
        """Weighted bounded fit, of all equations or of those chosen."""
        return solve_triangle(self.factor(weights, chosen), self.count(weights, chosen), self.signed, self.given)

    def factor(self, weights: FloatArray | None = None, chosen: BoolArray | None = None) -> FloatArray:
        """The triangular factor of the weighted equations."""
        w = 1.0 / self.noise if weights is None else np.sqrt(weights) / self.noise
        A, b = self.A * w[:, None], self.b * w
        return triangle(A, b) if chosen is None else triangle(A[chosen], b[chosen])

    def count(self, weights: FloatArray | None = None, chosen: BoolArray | None = None) -> int:
        """Equations that count (robust weights may switch some off)."""
        live = np.ones(len(self.b), dtype=bool) if weights is None else weights > 1e-3
        return int((live if chosen is None else live & chosen).sum())

    @property
    def given(self) -> float | None:
        """Standard deviation of a weighted equation when there is nothing left to estimate it from."""
        return 1.0 if self.stated else None


def build_system(robot: Robot, tests: LoadTests | JointTests, model: Model) -> System:
    """The equations of ``tests`` under ``model``. Raises LoadTestError where they cannot say anything."""
    if isinstance(tests, JointTests):
        return _joint_system(robot, tests, model)
    tests = tests.with_joints(robot)
    parameters = model.parameters(robot)
    D = model.regressor(robot, tests)
    measured = np.isfinite(tests.displacement) & np.isfinite(D[:, :, 0])
    if not measured.any():
        raise LoadTestError("Load tests: nothing measured that this model predicts; give displacements.")
    test, component = np.nonzero(measured)
    pose = tests.pose_index()
    noise, stated = _noise(tests.noise)
    system = System(
        D[measured], tests.displacement[measured], noise[test], test, component, pose[test], parameters, stated
    )
    _refuse_too_few(system, len(np.unique(pose)), model, len(tests))
    return system if system.linear.all() else _balance_kinds(system)


def _joint_system(robot: Robot, tests: JointTests, model: Model) -> System:
    if model.name != "joints":
        raise LoadTestError(f"Model {model.name!r}: tests of one joint at a time can fit the model 'joints' only.")
    same = tests.joint[:, None] == np.array(robot.joint_numbers)
    if not same.any(axis=1).all():
        k = int(np.argmin(same.any(axis=1)))
        numbers = ", ".join(map(str, robot.joint_numbers))
        raise LoadTestError(f"Row {tests.row[k]}, joint: found {tests.joint[k]}, expected a free joint ({numbers}).")
    A = np.where(same, tests.torque[:, None], 0.0)
    noise, stated = _noise(tests.noise)
    index = np.arange(len(tests))
    return System(A, tests.angle, noise, index, np.zeros_like(index), index, model.parameters(robot), stated)


def _noise(noise: FloatArray) -> tuple[FloatArray, bool]:
    """Relative noise: as stated; tests that do not state theirs take the median of those that do."""
    known = np.isfinite(noise)
    if not known.any():
        return np.ones_like(noise), False
    if (noise[known] <= 0).any():
        raise LoadTestError("Noise: expected standard deviations above zero.")
    return np.where(known, noise, np.median(noise[known])), bool(known.all())


def _refuse_too_few(system: System, poses: int, model: Model, tests: int) -> None:
    equations, unknowns = system.A.shape
    if equations < unknowns:
        raise LoadTestError(
            f"Load tests: {equations} measured numbers for {unknowns} unknown compliances (model {model.name!r}); "
            "measure at more poses or in more directions, or choose a smaller model."
        )
    if poses == 1 and model.has("joint"):
        raise LoadTestError(
            f"Load tests: all {tests} tests are at one pose, and one pose can neither tell the joints apart nor check "
            "the fit; measure at three or more poses that differ in reach and in tool tilt."
        )


def _balance_kinds(system: System) -> System:
    """Displacements (m) and rotations (rad) weighed by what is left of each: noise estimated kind by kind."""
    noise = system.noise.copy()
    kinds = [system.linear, ~system.linear]
    for kind in kinds:
        noise[kind] *= max(float(np.sqrt(np.mean(system.b[kind] ** 2))), 1e-300) if not system.stated else 1.0
    for _ in range(KIND_ROUNDS):
        current = System(**{**system.__dict__, "noise": noise})
        residual = (system.A @ current.fit().x - system.b) / noise
        size = [float(np.sqrt(np.mean(residual[kind] ** 2))) for kind in kinds]
        if min(size) <= 1e-12 * max(max(size), 1e-300):
            break
        for kind, rms in zip(kinds, size, strict=True):
            noise[kind] *= rms
    return System(**{**system.__dict__, "noise": noise, "stated": False})
