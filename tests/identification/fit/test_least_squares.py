"""Bounded, robust least squares against numpy, scipy's general solvers, closed forms and repeated drawing."""

from __future__ import annotations

import numpy as np
import pytest
from scipy import stats
from scipy.optimize import lsq_linear

from robomill.identification.fit.least_squares import robust_fit, solve_triangle, triangle


def problem(e=40, p=4, seed=0, noise=0.1):
    rng = np.random.default_rng(seed)
    A = rng.normal(size=(e, p)) * 10.0 ** rng.integers(-2, 3, p)
    x = rng.uniform(0.5, 2.0, p) / np.linalg.norm(A, axis=0)
    return A, A @ x + noise * rng.normal(size=e)


def fitted(A, b, signed=None, given=None):
    free = np.zeros(A.shape[1], dtype=bool) if signed is None else np.array(signed)
    return solve_triangle(triangle(A, b), len(b), free, given)


@pytest.mark.parametrize("e", [2, 5, 255, 256, 1023, 1024, 1025, 1300, 5000, 20000])
def test_the_triangle_has_the_same_normal_equations(e):
    A, b = problem(e)
    R = triangle(A, b)
    assert len(R) <= 1024
    assert e <= 1024 or len(R) == 5
    whole = np.column_stack([A, b])
    scale = np.linalg.norm(whole, axis=0)
    np.testing.assert_allclose(R.T @ R / np.outer(scale, scale), whole.T @ whole / np.outer(scale, scale), atol=1e-12)


def test_a_free_fit_is_that_of_the_textbook():
    A, b = problem()
    fit = fitted(A, b)
    x, rss, rank, _ = np.linalg.lstsq(A, b, rcond=None)
    np.testing.assert_allclose(fit.free, x, rtol=1e-9)
    assert np.array_equal(fit.x, fit.free), "no bound is active: the free one to the last bit"
    assert fit.dof == 40 - 4
    assert fit.sigma == pytest.approx(np.sqrt(rss[0] / 36))
    np.testing.assert_allclose(fit.covariance, rss[0] / 36 * np.linalg.inv(A.T @ A), rtol=1e-8)
    np.testing.assert_allclose(fit.stderr**2, np.diag(fit.covariance), rtol=1e-12)
    assert fit.seen.all()
    assert fit.null.shape == (0, 4)
    norms = np.linalg.norm(A, axis=0)
    np.testing.assert_allclose(fit.condition, [np.linalg.cond(A), np.linalg.cond(A / norms)], rtol=1e-9)
    np.testing.assert_allclose(fitted(A * 1e-7, b).condition, fit.condition, rtol=1e-6)


@pytest.mark.parametrize("seed", range(12))
def test_bounds_are_those_of_a_general_solver(seed):
    rng = np.random.default_rng(seed)
    A = rng.normal(size=(30, 6))
    b = A @ rng.normal(size=6) + 0.1 * rng.normal(size=30)
    signed = rng.random(6) < 0.3
    low = np.where(signed, -np.inf, 0.0)
    x = lsq_linear(A, b, bounds=(low, np.inf), method="bvls", tol=1e-14).x
    fit = fitted(A, b, signed)
    np.testing.assert_allclose(fit.x, x, atol=1e-9)
    assert (fit.x[~signed] >= 0).all()
    np.testing.assert_allclose(fit.free, np.linalg.lstsq(A, b, rcond=None)[0], atol=1e-9)


@pytest.mark.parametrize("seed", range(4))
def test_readings_that_a_bounded_solution_made_are_met_where_columns_all_but_make_up_for_one_another(seed):
    """A column that is the sum of two others to the eleventh digit, and one without a bound that is below zero."""
    rng = np.random.default_rng(seed)
    A = rng.normal(size=(8, 4))
    A[:, 1] = A[:, 0] + A[:, 3] + 1e-11 * rng.normal(size=8)
    b = A @ [3.0, 0.02, -2.0, 0.01]
    signed = np.array([False, False, True, False])
    fit = fitted(A, b, signed)
    np.testing.assert_allclose(A @ fit.x, b, atol=1e-9)
    assert fit.x[2] == pytest.approx(-2.0)
    assert (fit.x[~signed] >= 0.0).all()


def test_intervals_are_student_t_and_cut_at_zero():
    A, b = problem(e=12, noise=3.0)
    b = -b
    for signed in (np.zeros(4, dtype=bool), np.array([True, False, True, False])):
        fit = fitted(A, b, signed)
        for level in (0.5, 0.95):
            half = stats.t.ppf(0.5 + level / 2, 8) * fit.stderr
            low, high = fit.interval(signed, level).T
            denied = ~signed & (fit.free + half < 0)  # an empty interval: nothing is known then
            np.testing.assert_allclose(high, np.where(denied, np.inf, np.maximum(fit.free + half, fit.x)), rtol=1e-10)
            np.testing.assert_allclose(low[signed], np.minimum(fit.free - half, fit.x)[signed], rtol=1e-10)
            np.testing.assert_allclose(low[~signed], np.clip(np.minimum(fit.free - half, fit.x), 0, None)[~signed])
            assert ((low <= fit.x) & (fit.x <= high)).all()
    np.testing.assert_array_equal(fit.interval(signed), fit.interval(signed, 0.95))


def test_without_a_spare_equation_there_is_no_interval_unless_the_noise_is_given():
    A, b = problem(e=4)
    fit = fitted(A, b)
    assert (fit.dof, fit.sigma) == (0, 0.0)
    open_ended = fit.interval(np.array([True, False, True, False]))
    np.testing.assert_array_equal(open_ended, [[-np.inf, np.inf], [0, np.inf]] * 2)
    given = fitted(A, b, given=0.3)
    np.testing.assert_allclose(given.covariance, 0.09 * np.linalg.inv(A.T @ A), rtol=1e-7)
    more = np.vstack([A, A[:1]]), np.append(b, b[0] + 1.0)
    assert fitted(*more, given=0.3).sigma == pytest.approx(np.sqrt(0.5))  # one spare equation: estimated, not given
    assert fitted(*more).dof == 1
    one_spare = fitted(*more).interval(np.ones(4, dtype=bool))
    half = stats.t.ppf(0.975, 1) * fitted(*more).stderr
    np.testing.assert_allclose(np.ptp(one_spare, axis=1), 2 * half, rtol=1e-9)
    exact = fitted(np.vstack([A, A]), np.append(b, b))
    np.testing.assert_allclose(np.ptp(exact.interval(np.ones(4, dtype=bool)), axis=1), 0.0, atol=1e-9)


def test_columns_that_are_one_are_not_seen_and_share_the_shortest_solution():
    A, b = problem(p=3, seed=1)
    A = np.column_stack([A, 5.0 * A[:, 1], np.zeros(40)])
    fit = fitted(A, b)
    np.testing.assert_array_equal(fit.seen, [True, False, True, False, False])
    assert fit.dof == 37
    x = np.linalg.lstsq(A[:, :3], b, rcond=None)[0]
    np.testing.assert_allclose(fit.x, [x[0], x[1] / 2, x[2], x[1] / 10, 0.0], rtol=1e-9, atol=1e-15)
    np.testing.assert_array_equal(np.isnan(np.diag(fit.covariance)), ~fit.seen)
    assert np.isnan(fit.covariance[0, 1])
    assert np.isnan(fit.covariance[1, 0])
    np.testing.assert_array_equal(np.isinf(fit.stderr), ~fit.seen)
    seen = np.linalg.inv(A[:, :3].T @ A[:, :3])[0, 0] * fit.sigma**2
    assert fit.covariance[0, 0] == pytest.approx(seen)
    assert fit.condition == (np.inf, np.inf)
    np.testing.assert_allclose(A / np.maximum(np.linalg.norm(A, axis=0), 1e-300) @ fit.null.T, 0.0, atol=1e-8)
    assert len(fit.null) == 2
    nothing = fitted(np.zeros((6, 2)), np.ones(6))
    assert not nothing.seen.any()
    np.testing.assert_array_equal(nothing.x, [0, 0])


def test_columns_apart_by_eight_digits_are_still_seen():
    """Seen or not is asked of columns of length one, not of what unit they are in."""
    A, b = problem(p=3, seed=2)
    assert fitted(A * [1.0, 1e-8, 1e8], b).seen.sum() < 3  # a column of 1e-16 of another's length is nothing
    small = fitted(A / np.linalg.norm(A, axis=0) * [1.0, 3e-9, 1.0], b)
    assert small.seen.all()
    assert not fitted(A / np.linalg.norm(A, axis=0) * [1.0, 0.3e-9, 1.0], b).seen.all()
    turned = np.column_stack([A[:, 0], A[:, 0] + 1e-6 * A[:, 1]])
    assert fitted(turned, b).seen.all()


# ---- robust
def rho_slope(u):
    """Tukey's psi at 95 % efficiency."""
    return np.where(np.abs(u) < 4.685, u * (1 - (u / 4.685) ** 2) ** 2, 0.0)


@pytest.mark.parametrize("seed", range(4))
def test_a_robust_fit_solves_tukeys_equations(seed):
    A, b = problem(e=80, p=3, seed=seed)
    rng = np.random.default_rng(seed)
    b[rng.choice(80, 12, replace=False)] += 30.0
    found = robust_fit(A, b)
    spare = np.sqrt(80 / 77)
    assert found.scale == pytest.approx(np.median(np.abs(found.residual)) / stats.norm.ppf(0.75) * spare, rel=1e-9)
    u = found.residual / found.scale
    np.testing.assert_allclose(found.weights, np.clip(1 - (u / 4.685) ** 2, 0, None) ** 2, atol=1e-9)
    balance = (A / np.linalg.norm(A, axis=0)).T @ rho_slope(u)
    np.testing.assert_allclose(balance, 0.0, atol=5e-3)
    assert (found.weights[np.abs(u) > 5] == 0).all()
    assert (found.weights == 0).sum() >= 12
    # Huber's covariance factor, its slope by differences.
    h = 1e-6
    slope = (rho_slope(u + h) - rho_slope(u - h)) / (2 * h)
    mean = slope.mean()
    K = 1 + 3 / 80 * slope.var() / mean**2
    sigma = K * np.sqrt((rho_slope(u) ** 2).sum() / 77) / mean * found.scale
    assert found.sigma == pytest.approx(sigma, rel=1e-6)


@pytest.mark.parametrize(("given", "sigma"), [(None, 0.0), (2.0, 2.0)])
def test_readings_that_are_all_needed_scatter_as_it_is_stated_or_not_at_all(given, sigma):
    A, b = problem(e=3, p=3, seed=1)
    fit = solve_triangle(triangle(A, b), 3, np.ones(3, dtype=bool), given)
    assert (fit.dof, fit.sigma) == (0, sigma)
    S = A / np.linalg.norm(A, axis=0)
    scaled = fit.covariance * np.outer(*[np.linalg.norm(A, axis=0)] * 2)
    np.testing.assert_allclose(scaled, sigma**2 * np.linalg.inv(S.T @ S), rtol=1e-6)


def test_readings_that_are_all_needed_have_no_robust_scatter():
    """Three equations of three unknowns are met whatever they say."""
    found = robust_fit(*problem(e=3, p=3, seed=1))
    assert found.sigma == 0.0
    np.testing.assert_allclose(found.residual, 0.0, atol=1e-9)


def test_the_robust_scale_is_the_scatter_of_repeated_fits():
    A = np.random.default_rng(5).normal(size=(60, 3))
    rng = np.random.default_rng(6)
    drawn, sigmas = [], []
    for _ in range(400):
        b = rng.normal(size=60)
        found = robust_fit(A, b)
        w = found.weights[:, None]
        drawn.append(np.linalg.solve(A.T @ (w * A), A.T @ (w[:, 0] * b)))
        sigmas.append(found.sigma)
    scatter = np.std(drawn, axis=0) / np.sqrt(np.diag(np.linalg.inv(A.T @ A)))
    np.testing.assert_allclose(scatter, np.mean(sigmas), rtol=0.12)


def test_a_robust_fit_does_not_mind_units():
    A, b = problem(e=80, p=3, seed=3)
    b[:9] -= 20.0
    plain = robust_fit(A, b)
    other = robust_fit(A * [1e-14, 1.0, 1e14], b * 1e-7)
    np.testing.assert_allclose(other.weights, plain.weights, atol=1e-6)
    np.testing.assert_allclose(other.residual, plain.residual * 1e-7, rtol=1e-4, atol=1e-12)
    twice = robust_fit(np.column_stack([A, A[:, 0], np.zeros(80)]), b)
    np.testing.assert_allclose(twice.weights, plain.weights, atol=1e-3)


def test_exact_data_have_no_scale_to_speak_of():
    A, b = problem(e=30, p=3, noise=0.0)
    found = robust_fit(A, b)
    assert found.scale <= 1.1e-12 * np.abs(b).max()
    b[4] += 1.0
    found = robust_fit(A, b)
    assert found.weights[4] == 0
    assert np.abs(np.delete(found.residual, 4)).max() < 1e-9
    zero = robust_fit(A, np.zeros(30))
    assert (zero.scale, zero.sigma) == (0.0, 0.0)
    assert robust_fit(A[:3], b[:3]).sigma == 0.0
