"""Speed of the linear estimate against a general curve fit (scipy's trust-region twin of the paper's lsqcurvefit)."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.optimize import curve_fit

import robomill as rm
from robomill.identification.fit.models import Model
from robomill.identification.fit.system import build_system
from robomill.io.samples import samples_dir
from tests.benchmarks.clock import fastest

pytestmark = pytest.mark.benchmark


def test_linear_least_squares_is_quicker_than_a_general_curve_fit():
    robot = rm.load_robot("slavkovic_5r")
    tests = rm.read_load_tests(samples_dir() / "load_tests" / "grid_45x6.csv", robot)
    system = build_system(robot, tests, Model())
    model = lambda A, *c: A @ (np.array(c) * 1e-7)  # noqa: E731
    ours = fastest(system.fit)
    theirs = fastest(lambda: curve_fit(model, system.A, system.b, p0=np.full(5, 10.0), bounds=(0, np.inf)))
    print(f"identification of {len(system.b)} equations: {ours * 1e3:.2f} ms, curve_fit {theirs * 1e3:.2f} ms")
    assert ours < 0.5 * theirs


def test_a_hundred_thousand_load_tests_take_little_longer_than_a_general_curve_fit_of_them():
    """With all that is said of them: intervals, outliers, what was left out, causes; the curve fit has the numbers."""
    robot = rm.load_robot("slavkovic_5r")
    rng = np.random.default_rng(1)
    low, high = np.array(robot.limits).T
    theta = rng.uniform(0.8 * low + 0.2 * high, 0.2 * low + 0.8 * high, (100_000, robot.n))
    force = rng.normal(size=(len(theta), 3)) * 100.0
    moved = np.einsum("mij,mj->mi", rm.cartesian_compliance(robot, theta)[:, :3, :3], force)
    moved += rng.normal(size=moved.shape) * 1e-5
    nothing = np.zeros_like(force)
    tests = rm.LoadTests(np.hstack([force, nothing]), np.hstack([moved, nothing + np.nan]), theta=theta)
    system = build_system(robot, tests, Model())
    model = lambda A, *c: A @ (np.array(c) * 1e-7)  # noqa: E731
    ours = fastest(lambda: rm.identify(robot, tests), 3)
    theirs = fastest(lambda: curve_fit(model, system.A, system.b, p0=np.full(5, 10.0), bounds=(0, np.inf)), 3)
    print(f"identification of {len(system.b)} equations: {ours:.2f} s, curve_fit {theirs:.2f} s")
    assert ours < 8 * theirs
