"""Intervals, bounds and weights of the estimate: coverage counted over draws, scipy's fit above zero, closed forms."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from scipy.optimize import nnls

from robomill.errors import LoadTestError
from robomill.identification.fit.estimate import identify
from robomill.identification.fit.least_squares import solve_triangle, triangle
from robomill.identification.fit.models import Model
from robomill.identification.fit.system import build_system
from robomill.identification.load_test import LoadTests
from robomill.identification.synthesis import three_directions
from tests.identification.fit.arms import ROBOT, nine_points, poses
from tests.identification.synthetic import simulated_tests


@pytest.mark.parametrize("noise", [1e-6, 4e-6, 5e-5])
def test_intervals_cover_the_truth(noise):
    """1000 repetitions of the 81-equation test; at the highest noise joint 4 is on its bound half of the time."""
    system = build_system(ROBOT, simulated_tests(ROBOT, *three_directions(nine_points(), 250.0)), Model())
    rng = np.random.default_rng(11)
    exact, hits = system.A @ ROBOT.C_theta, np.zeros(5)
    for _ in range(1000):
        fit = replace(system, b=exact + noise * rng.standard_normal(len(exact))).fit()
        low, high = fit.interval(system.signed).T
        hits += (low <= ROBOT.C_theta) & (ROBOT.C_theta <= high)
        assert (low <= fit.x).all()
        assert (fit.x <= high).all()
    assert ((hits >= 930) & (hits <= 970)).all(), hits


@pytest.mark.slow
@pytest.mark.parametrize("option", [{}, {"robust": True}])
def test_intervals_cover_the_truth_through_identify(option):
    """The same through the public function, with rows of unequal, stated noise, plain and robust."""
    theta, F = three_directions(poses(ROBOT, 15, 2), 250.0)
    rng = np.random.default_rng(5)
    sigma = np.repeat(rng.uniform(2e-6, 20e-6, 15), 3)
    exact = simulated_tests(ROBOT, theta, F).displacement[:, :3]
    hits = np.zeros(5)
    for _ in range(150):
        tests = LoadTests(F, exact + sigma[:, None] * rng.standard_normal(exact.shape), theta=theta, noise=sigma)
        low, high = identify(ROBOT, tests, **option).ci95.T
        hits += (low <= ROBOT.C_theta) & (ROBOT.C_theta <= high)
    assert ((hits >= 135) & (hits <= 149)).all(), hits  # 142.5 are expected, 2.7 is their standard deviation


def test_stated_noise_is_used_as_weight():
    theta, F = three_directions(poses(ROBOT, 15, 2), 250.0)
    sigma = np.where(np.arange(45) % 2 == 0, 1e-6, 1e-4)
    exact = simulated_tests(ROBOT, theta, F).displacement[:, :3]
    rng = np.random.default_rng(0)
    noisy = exact + sigma[:, None] * rng.standard_normal(exact.shape)
    weighted = identify(ROBOT, LoadTests(F, noisy, theta=theta, noise=sigma))
    plain = identify(ROBOT, LoadTests(F, noisy, theta=theta))
    assert (weighted.stderr < 0.2 * plain.stderr).all()
    assert np.abs(weighted.C_theta / ROBOT.C_theta - 1).max() < np.abs(plain.C_theta / ROBOT.C_theta - 1).max()


def test_rotations_are_weighed_by_their_own_noise():
    rng = np.random.default_rng(1)
    theta = poses(ROBOT, 30)
    wrench = np.concatenate([rng.normal(size=(30, 3)) * 100, rng.normal(size=(30, 3)) * 20], axis=1)
    exact = Model().terms(ROBOT, LoadTests(wrench, np.ones((30, 6)), theta=theta))[:, :, 0] @ ROBOT.C_theta
    noisy = exact + rng.standard_normal(exact.shape) * np.array([20e-6] * 3 + [1e-6] * 3)
    both = identify(ROBOT, LoadTests(wrench, noisy, theta=theta))
    linear = identify(ROBOT, LoadTests(wrench, noisy[:, :3], theta=theta))
    assert (both.stderr < 0.5 * linear.stderr).all()
    assert (np.abs(both.C_theta - ROBOT.C_theta) < 4 * both.stderr).all()
    assert both.noise == pytest.approx(20e-6, rel=0.3)


def test_bounded_fit_is_that_of_nnls_and_says_what_is_on_the_bound():
    rng = np.random.default_rng(8)
    for _ in range(50):
        A = rng.normal(size=(30, 6)) * 10.0 ** rng.integers(-3, 3, 6)
        b = A @ (rng.normal(size=6) / np.linalg.norm(A, axis=0)) + 0.01 * rng.normal(size=30)
        fit = solve_triangle(triangle(A, b), 30, np.zeros(6, dtype=bool))
        scale = np.linalg.norm(A, axis=0)
        np.testing.assert_allclose(fit.x * scale, nnls(A / scale, b)[0], atol=1e-10 * np.abs(fit.x * scale).max())
    tests = simulated_tests(ROBOT, *three_directions(poses(ROBOT, 10), 250.0))
    result = identify(ROBOT, LoadTests(tests.wrench, -tests.displacement, theta=tests.theta))
    assert np.isnan(result.C_theta).all()  # less than zero by more than chance: nothing is known, least of all that
    np.testing.assert_array_equal(result.ci95, [[0.0, np.inf]] * 5)  # all are rigid
    assert len(result.active_bounds) == 5
    with pytest.raises(LoadTestError, match="No joint gives way"):
        result.applied_to(ROBOT)
    assert any("sign" in f.message for f in result.findings)


@pytest.mark.parametrize("turned", [(), (2,), (0, 4)])
def test_those_and_only_those_on_the_bound_are_told(turned):
    tests = simulated_tests(ROBOT, *three_directions(poses(ROBOT, 10), 250.0))
    A = build_system(ROBOT, tests, Model()).A
    C_theta = ROBOT.C_theta.copy()
    C_theta[list(turned)] *= -0.1  # hardly seen against the others, so that none of them is pushed to zero too
    b = (A @ C_theta).reshape(len(tests), 3)
    result = identify(ROBOT, LoadTests(tests.wrench, b, theta=tests.theta))
    assert result.active_bounds == tuple(f"joint {i + 1}" for i in turned)
    np.testing.assert_array_equal(np.flatnonzero(~(result.C_theta > 0)), turned)


@pytest.mark.parametrize("times", [1e-4, 1.0, 1e4])
def test_what_is_held_at_zero_is_the_same_under_any_load(times):
    """An arm that yields in proportion: loads and displacements so many times as large have the same compliances."""
    tests = simulated_tests(ROBOT, *three_directions(poses(ROBOT, 10), 250.0))
    C_theta = ROBOT.C_theta * np.where(np.arange(5) == 2, -0.1, 1.0)
    b = (build_system(ROBOT, tests, Model()).A @ C_theta).reshape(len(tests), 3)
    result = identify(ROBOT, LoadTests(times * tests.wrench, times * b, theta=tests.theta))
    assert result.active_bounds == ("joint 3",)


def test_column_scaling_shows_in_the_condition_number_only():
    theta, F = three_directions(nine_points(), 250.0)
    result = identify(ROBOT, simulated_tests(ROBOT, theta, F, noise=1e-6))
    A = build_system(ROBOT, simulated_tests(ROBOT, theta, F), Model()).A
    assert result.condition.before == pytest.approx(np.linalg.cond(A), rel=1e-6)
    assert result.condition.after == pytest.approx(np.linalg.cond(A / np.linalg.norm(A, axis=0)), rel=1e-6)
    assert result.condition.after < result.condition.before


def test_what_is_held_at_zero_is_what_both_fits_say():
    """Named are parameters that scipy's fit above zero leaves at zero and a free fit makes negative."""
    seen = set()
    for seed in range(16):
        theta = np.random.default_rng(seed).uniform(ROBOT.limits[:, 0], ROBOT.limits[:, 1], (3, 5))
        tests = simulated_tests(ROBOT, *three_directions(theta, 250.0), noise=3e-3, seed=seed)
        D, b = Model().terms(ROBOT, tests)[:, :3, 0].reshape(-1, 5), tests.displacement[:, :3].ravel()
        size = np.abs(D).max(axis=0)
        at_zero = nnls(D / size, b)[0] == 0.0
        below = np.linalg.lstsq(D / size, b, rcond=None)[0] < 0.0
        assert identify(ROBOT, tests).active_bounds == tuple(
            f"joint {j}" for j in range(1, 6) if (at_zero & below)[j - 1]
        ), seed
        seen |= {*zip(at_zero.tolist(), below.tolist())}
    assert len(seen) == 4, "every combination comes up"
