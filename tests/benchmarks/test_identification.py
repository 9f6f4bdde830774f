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
