"""The convex program against another solver and against its own optimality conditions, taken from the numbers alone."""

import numpy as np
import pytest
from scipy.optimize import linprog, minimize, nnls

from robomill.improve.least_cost import Errors, least_cost, least_share


def drawn(seed: int, d: int, q: int = 300, n: int = 5) -> Errors:
    rng = np.random.default_rng(seed)
    return Errors(0.1 * rng.normal(size=(q, d)), rng.normal(size=(q, d, n)), np.full(q, 0.9 * (1.2 + d / 2)))


@pytest.mark.parametrize("d", [1, 3])
@pytest.mark.parametrize("seed", [0, 1, 2])
def test_it_costs_what_another_solver_finds(seed: int, d: int) -> None:
    errors, weight = drawn(seed, d), np.array([1.0, 2.0, 0.5, 1.0, 3.0])
    low, high = np.full(5, 0.05), np.ones(5)
    found = least_cost(errors, weight, low, high)
    assert found is not None
    assert errors.shares(found.x).max() <= 1.0 + 1e-7
    other = minimize(
        lambda x: -weight @ np.log2(x),
        least_share(errors, low, high).x,
        constraints=[{"type": "ineq", "fun": lambda x: 1.0 - errors.shares(x) ** 2}],
        bounds=[(0.05, 1.0)] * 5,
        method="SLSQP",
        options={"maxiter": 1000, "ftol": 1e-13},
    )
    assert found.value == pytest.approx(float(-weight @ np.log2(found.x)), rel=1e-9)
    assert found.value == pytest.approx(other.fun, rel=1e-5)
    assert found.residual < 1e-5


@pytest.mark.parametrize("seed", range(5))
def test_the_slope_of_the_cost_is_held_by_the_errors_that_bind(seed: int) -> None:
    """Karush, Kuhn, Tucker: minus the slope is a sum, with positive weights, of the slopes of what is at its bound."""
    errors, weight = drawn(seed, 1), np.ones(5)
    found = least_cost(errors, weight, np.full(5, 0.05), np.ones(5))
    assert found is not None
    x, at = found.x, errors.at(found.x)[:, 0]
    binding = np.abs(np.abs(at) / errors.bound - 1.0) < 1e-6
    outward = np.sign(at[binding])[:, None] * errors.given[binding, 0]
    normals = np.vstack([outward, np.eye(5)[x > 1.0 - 1e-6], -np.eye(5)[x < 0.05 * (1.0 + 1e-6)]])
    slope = -weight / np.log(2.0) / x
    assert nnls(normals.T, -slope)[1] < 1e-3 * np.linalg.norm(slope)


@pytest.mark.parametrize("seed", range(4))
def test_how_much_cheaper_any_other_could_be_is_what_the_slope_leaves_of_a_linear_program(
    seed: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Left after its first step, where much is: by another solver."""
    monkeypatch.setattr("robomill.improve.least_cost.SETTLED", 10.0)
    errors, weight, low, high = drawn(seed, 1), np.array([1.0, 2.0, 0.5, 1.0, 3.0]), np.full(5, 0.05), np.ones(5)
    found = least_cost(errors, weight, low, high)
    assert found is not None
    slope = -weight / np.log(2.0) / found.x
    rows = np.vstack([errors.given[:, 0], -errors.given[:, 0]])
    bound = np.concatenate([errors.bound - errors.fixed[:, 0], errors.bound + errors.fixed[:, 0]])
    cheapest = linprog(slope, A_ub=rows, b_ub=bound, bounds=list(zip(low, high, strict=True))).fun
    assert found.residual == pytest.approx(slope @ found.x - cheapest, abs=1e-5)
    assert found.residual > 1e-3


def test_what_keeps_its_bounds_costs_nothing_and_what_cannot_is_none() -> None:
    one = Errors(np.zeros((1, 1)), np.ones((1, 1, 2)), np.array([2.5]))
    low, high = np.full(2, 0.1), np.ones(2)
    kept = least_cost(one, np.ones(2), low, high)
    assert kept is not None
    assert kept.value == 0.0
    softer = least_cost(one, np.array([1.0, 3.0]), low, np.array([1.25, 0.5]))
    assert softer is not None
    assert softer.value == pytest.approx(3.0 - np.log2(1.25))
    assert least_cost(Errors(np.full((1, 1), 3.0), np.zeros((1, 1, 2)), np.ones(1)), np.ones(2), low, high) is None


def test_one_error_of_two_joints_by_hand() -> None:
    """a x + b y = t with the least -log x - log y: each gives half of t, unless a bound stops it."""
    errors = Errors(np.zeros((1, 1)), np.array([[[3.0, 1.0]]]), np.ones(1))
    found = least_cost(errors, np.ones(2), np.full(2, 0.01), np.ones(2))
    assert found is not None
    np.testing.assert_allclose(found.x, [1.0 / 6.0, 0.5], rtol=1e-6)
    assert found.value == pytest.approx(np.log2(12.0), rel=1e-9)


def test_the_least_share_is_that_of_a_linear_program() -> None:
    """Two errors that pull against each other: x + y and x - y, y cannot be less than 0.1."""
    errors = Errors(np.zeros((2, 1)), np.array([[[1.0, 1.0]], [[1.0, -1.0]]]), np.ones(2))
    found = least_share(errors, np.full(2, 0.1), np.ones(2))
    np.testing.assert_allclose(found.x, [0.1, 0.1], atol=1e-6)
    assert found.value == pytest.approx(0.2, abs=1e-6)
