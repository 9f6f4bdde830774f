"""A virtual laboratory: a robot whose compliances are hidden, a noisy dial gauge and a budget of measurements.

Students choose poses and forces, fit, and are scored against the truth. The laboratory is a value: measuring gives
a new one with less budget and more readings, and the same seed and choices give the same readings again.
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from typing import Literal

import numpy as np
from numpy.typing import ArrayLike

from robomill.arrays import FloatArray, as_floats
from robomill.errors import LoadTestError
from robomill.identification.fit.estimate import identify
from robomill.identification.load_test import LoadTests
from robomill.identification.result import IdentificationResult
from robomill.identification.synthesis import simulated_tests
from robomill.kinematics.inverse import inverse_kinematics
from robomill.kinematics.transforms import pose_from_world
from robomill.robot.model import Robot
from robomill.units import format_percent, format_si

SPREAD = 0.35  # standard deviation of the logarithm of a hidden compliance against the robot's own
MAX_LOAD = 400.0  # N a student can hang on
GOOD, FAIR = 80.0, 50.0  # points, of 100


@dataclass(frozen=True, eq=False)
class Score:
    """How near the fit came. error (n,): |estimate - truth| / truth, NaN where a joint was not seen; covered (n,):
    the 95 % interval holds the truth; points 0 to 100; sentence for the class."""

    error: FloatArray
    covered: FloatArray
    points: float
    sentence: str

    @property
    def grade(self) -> Literal["good", "fair", "poor"]:
        """What so many points are."""
        return "good" if self.points >= GOOD else "fair" if self.points >= FAIR else "poor"


@dataclass(frozen=True, eq=False)
class Laboratory:
    """A hidden robot to be measured. noise and resolution of the gauge in m; budget: single tests left."""

    robot: Robot
    seed: int = 0
    noise: float = 5e-6
    resolution: float = 1e-6
    budget: int = 12
    tests: LoadTests | None = None
    _truth: Robot | None = field(default=None, repr=False)

    def __post_init__(self) -> None:
        if self.budget < 0 or self.noise < 0 or self.resolution < 0:
            raise LoadTestError("Laboratory: budget, noise and resolution cannot be negative.")
        if self._truth is None:
            rng = np.random.default_rng(self.seed)
            hidden = self.robot.C_theta * np.exp(SPREAD * rng.standard_normal(self.robot.n))
            object.__setattr__(self, "_truth", self.robot.replace(C_theta=hidden))

    def measure(self, theta: ArrayLike, F: ArrayLike, gauges: str = "xyz") -> Laboratory:
        """The laboratory after the tests at theta (k, n) or (n,) under F (k, 3) or (3,) N in {M}.

        gauges: the axes of {M} along which a dial gauge stands, e.g. "y" for a single one.

        Raises LoadTestError when the budget, a joint limit or the greatest load does not allow them.
        """
        assert self._truth is not None
        theta = np.atleast_2d(as_floats(theta, "theta", (self.robot.n,), error=LoadTestError))
        F = np.atleast_2d(as_floats(F, "F", (3,), error=LoadTestError))
        m = max(len(theta), len(F))
        theta, F = np.broadcast_to(theta, (m, self.robot.n)), np.broadcast_to(F, (m, 3))
        if m > self.budget:
            raise LoadTestError(f"Laboratory: {m} tests asked for, {self.budget} left in the budget.")
        heaviest = float(np.linalg.norm(F, axis=1).max())
        if heaviest > MAX_LOAD * (1 + 1e-12):
            limit, asked = format_si(MAX_LOAD, "N", 0), format_si(heaviest, "N", 0)
            raise LoadTestError(f"Laboratory: a force of {asked} is more than the {limit} that can be hung on.")
        done = 0 if self.tests is None else len(self.tests)
        rng = np.random.default_rng([self.seed, 1, done])
        new = simulated_tests(self._truth, theta, F, noise=self.noise, resolution=self.resolution, seed=rng)
        read = np.where([axis in gauges for axis in "xyz"], new.displacement[:, :3], np.nan)
        new = replace(new, displacement=read).with_joints(self.robot)
        tests = new if self.tests is None else self.tests.joined(new)
        return replace(self, tests=tests, budget=self.budget - m)

    def measure_at(self, x_M: ArrayLike, F: ArrayLike, gauges: str = "xyz") -> Laboratory:
        """The same at world coordinates X, Y, Z, A, B (k, 5) or (5,) m, rad."""
        x_M = as_floats(x_M, "x_M", (5,), error=LoadTestError)
        solved = inverse_kinematics(self.robot, pose_from_world(x_M))
        if not solved.reached.all():
            index = tuple(int(i) for i in np.argwhere(~solved.reached)[0])
            raise LoadTestError(f"Laboratory: that pose is not reached ({solved.reason(index)}).")
        return self.measure(solved.theta, F, gauges)

    def fit(self) -> IdentificationResult:
        """What the readings so far say."""
        if self.tests is None:
            raise LoadTestError("Laboratory: nothing measured yet; choose a pose and a force first.")
        return identify(self.robot, self.tests)

    def score(self, C_theta: ArrayLike | IdentificationResult) -> Score:
        """Score an estimate (n,) or a result: a joint earns up to 100 / n, half of it at 10 % off, none from 40 %."""
        assert self._truth is not None
        truth = self._truth.C_theta
        result = C_theta if isinstance(C_theta, IdentificationResult) else None
        given = result.C_theta if result is not None else C_theta
        found = as_floats(given, "C_theta", (self.robot.n,), error=LoadTestError, finite=False)  # type: ignore[arg-type]
        error = np.abs(found - truth) / truth
        covered = np.full(self.robot.n, np.nan)
        if result is not None:
            covered = ((result.ci95[:, 0] <= truth) & (truth <= result.ci95[:, 1])).astype(float)
            covered[~np.isfinite(result.stderr)] = np.nan
        marks = np.interp(np.nan_to_num(error, nan=np.inf), [0.0, 0.1, 0.4], [1.0, 0.5, 0.0])
        points = 100.0 * float(marks.mean())
        worst = int(np.argmax(np.nan_to_num(error, nan=np.inf)))
        off = "was not seen" if np.isnan(error[worst]) else f"is {format_percent(error[worst])} off"
        text = f"{points:.0f} of 100 points: joint {self.robot.joint_numbers[worst]} {off}."
        return Score(error, covered, points, text)

    def reveal(self) -> FloatArray:
        """(n,) the hidden compliances, for when the exercise is over."""
        assert self._truth is not None
        return self._truth.C_theta
