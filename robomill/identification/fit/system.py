"""From tests to equations: one linear row for each measured number, with its noise, test and pose."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from robomill.arrays import BoolArray, FloatArray, IntArray
from robomill.errors import LoadTestError
from robomill.identification.fit.least_squares import Fit, triangle
from robomill.identification.fit.models import Model, Parameter
from robomill.identification.load_test import JointTests, LoadTests
from robomill.identification.pull.points import Factored, Point, PointFit, at_shift
from robomill.robot.model import Robot

KIND_ROUNDS = 6
SMALLEST = 0.1  # of the median displacement: what moved less does not count for more in weights by size


@dataclass(frozen=True, eq=False)
class System:
    """Equations A x = b, unweighted. ``noise`` (e,) is the relative standard deviation each is divided by.

    test (e,) index of the test, component (e,) 0-2 displacement, 3-5 rotation; pose (e,) group left out together
    in cross-validation; signed (p,) bool; stated: every noise was given in the file.
    freed: points that are fitted too; terms (e, k, p): A as a sum over products of their shifts (``points``), A being
    that at ``shift`` (s,) m; None where no point is free.
    """

    A: FloatArray
    b: FloatArray
    noise: FloatArray
    test: IntArray
    component: IntArray
    pose: IntArray
    parameters: tuple[Parameter, ...]
    stated: bool
    freed: tuple[Point, ...] = ()
    terms: FloatArray | None = None

    @property
    def signed(self) -> BoolArray:
        return np.array([parameter.signed for parameter in self.parameters])

    @property
    def linear(self) -> BoolArray:
        """(e,) displacements rather than rotations."""
        return self.component < 3

    def fit(self) -> Fit:
        """Bounded fit with the points as they are."""
        return replace(self, freed=(), terms=None).fit_points().fit

    def fit_points(self, weights: FloatArray | None = None, starts: Sequence[FloatArray] = ()) -> PointFit:
        """The same with the freed points fitted too."""
        return self.factored(self.factor(weights), self.count(weights)).fit(starts)

    def factored(self, R: FloatArray, equations: int) -> Factored:
        """What a fit needs, from the factor of some of the equations (or several such, stacked)."""
        return Factored(R, equations, self.signed, self.freed, self.given)

    def factor(self, weights: FloatArray | None = None, chosen: BoolArray | None = None) -> FloatArray:
        """The triangular factor of the weighted equations and their terms."""
        w = 1.0 / self.noise if weights is None else np.sqrt(weights) / self.noise
        A, b = self.every_term.reshape(len(self.b), -1) * w[:, None], self.b * w
        return triangle(A, b) if chosen is None else triangle(A[chosen], b[chosen])

    @property
    def given(self) -> float | None:
        """Standard deviation of a weighted equation when there is nothing left to estimate it from."""
        return 1.0 if self.stated else None

    @property
    def every_term(self) -> FloatArray:
        """(e, k, p)."""
        return self.A[:, None, :] if self.terms is None else self.terms

    def at(self, shift: FloatArray) -> System:
        """The same with A at a shift (s,) m of the freed points."""
        return replace(self, A=at_shift(self.every_term, shift, self.freed)) if self.freed else self

    def of(self, columns: IntArray) -> System:
        """The same with these of its parameters only."""
        terms = None if self.terms is None else self.terms[:, :, columns]
        names = tuple(self.parameters[k] for k in columns)
        return replace(self, A=self.A[:, columns], terms=terms, parameters=names)

    def count(self, weights: FloatArray | None = None, chosen: BoolArray | None = None) -> int:
        """Equations that count (robust weights may switch some off)."""
        live = np.ones(len(self.b), dtype=bool) if weights is None else weights > 1e-3
        return int((live if chosen is None else live & chosen).sum())


def build_system(
    robot: Robot, tests: LoadTests | JointTests, model: Model, freed: tuple[Point, ...] = (), by_size: bool = False
) -> System:
    """The equations of ``tests`` under ``model``. Raises LoadTestError where they cannot say anything.

    freed: points to be fitted too; by_size: every test counts by its relative error, as if its noise grew with it.
    """
    if tests.single:
        return _joint_system(robot, tests, model, freed)
    tests = tests.with_joints(robot)
    parameters = model.parameters(robot)
    terms, measured = measured_terms(robot, tests, model, freed)
    if not measured.any():
        raise LoadTestError("Load tests: nothing measured that this model predicts; give displacements.")
    test, component = np.nonzero(measured)
    pose = tests.pose_index()
    noise, stated = _noise(tests.noise)
    if by_size:
        noise, stated = noise * _sizes(tests), False
    system = System(
        terms[:, 0],
        tests.displacement[measured],
        noise[test],
        test,
        component,
        pose[test],
        parameters,
        stated,
        freed,
        terms if freed else None,
    )
    _refuse_too_few(system, len(np.unique(pose)), model, len(tests))
    return system if system.linear.all() else _balance_kinds(system)


def measured_terms(
    robot: Robot, tests: LoadTests, model: Model, freed: tuple[Point, ...] = ()
) -> tuple[FloatArray, BoolArray]:
    """(e, k, p) terms of the readings that were taken and the model predicts, and which (m, 6) these are."""
    D = model.terms(robot, tests, freed)
    if tests.gauges is not None:
        D = np.concatenate([np.einsum("mgc,mckp->mgkp", tests.gauges, D[:, :3]), D[:, 3:]], axis=1)
    measured = np.isfinite(tests.displacement) & np.isfinite(D[:, :, 0, 0])
    return D[measured], np.asarray(measured)


def _sizes(tests: LoadTests) -> FloatArray:
    """(m,) size of each test's displacement over the median one; no smaller than ``SMALLEST``."""
    moved = np.where(np.isnan(tests.displacement[:, :3]).all(axis=1, keepdims=True), 0.0, tests.displacement[:, :3])
    size = np.sqrt(np.nanmean(moved**2, axis=1))
    middle = float(np.median(size))
    return np.maximum(size / middle, SMALLEST) if middle > 0 else np.ones_like(size)


def _joint_system(robot: Robot, tests: JointTests, model: Model, freed: tuple[Point, ...]) -> System:
    if freed:
        raise LoadTestError("Tests of one joint at a time have no load or gauge point on the tool to be fitted.")
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
    equations, unknowns = len(system.b), system.A.shape[1] + 3 * len(system.freed)
    if equations < unknowns:
        what = "unknown compliances and points" if system.freed else "unknown compliances"
        raise LoadTestError(
            f"Load tests: {equations} measured numbers for {unknowns} {what} (model {model.name!r}); "
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
        current = replace(system, noise=noise)
        found = current.fit_points()
        residual = (system.at(found.shift).A @ found.fit.x[: system.A.shape[1]] - system.b) / noise
        size = [float(np.sqrt(np.mean(residual[kind] ** 2))) for kind in kinds]
        if min(size) <= 1e-12 * max(max(size), 1e-300):
            break
        for kind, rms in zip(kinds, size, strict=True):
            noise[kind] *= rms
    return replace(system, noise=noise, stated=False)
