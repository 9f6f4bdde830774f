"""The convex program against another solver and against its own optimality conditions, taken from the numbers alone."""

from types import SimpleNamespace
from typing import Any

import clarabel
import numpy as np
import pytest
from scipy.optimize import linprog, minimize, nnls

from robomill.improve import least_cost as module
from robomill.improve.least_cost import Errors, Least, least_cost, least_share


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


@pytest.mark.parametrize(
    ("primal", "dual", "r", "residual"),
    [
        (4.0, 3.0, (0.0, 0.0), 0.25),
        (-8.0, -7.0, (0.0, 0.0), 0.125),
        (0.5, 0.375, (0.0, 0.0), 0.125),
        (1.5, 1.875, (0.0, 0.0), 0.25),
        (4.0, 3.0, (0.5, 0.0), 0.5),
        (4.0, 3.0, (0.3, 0.5), 0.5),
    ],
)
def test_the_residual_is_the_largest_and_the_gap_is_one_of_what_is_large_and_of_one_where_that_is_small(
    monkeypatch: pytest.MonkeyPatch, primal: float, dual: float, r: tuple[float, float], residual: float
) -> None:
    status = clarabel.SolverStatus.Solved
    told = SimpleNamespace(status=status, obj_val=primal, obj_val_dual=dual, r_prim=r[0], r_dual=r[1], x=[2.0, 3.0])
    monkeypatch.setattr(clarabel, "DefaultSolver", lambda *_: SimpleNamespace(solve=lambda: told))
    found = module._solved((np.ones(2), np.ones(2), np.ones((2, 2)), np.ones(2), []), 1)
    assert (found.x.tolist(), found.value, found.residual) == ([2.0], primal, residual)


@pytest.mark.parametrize("beyond", [2.0, 1.0])
def test_errors_are_left_out_that_are_small_at_both_ends_until_one_is_too_large(
    monkeypatch: pytest.MonkeyPatch, beyond: float
) -> None:
    """Of x + y 70 sizes, the 64 largest of which are held at first; of x - y, nothing at both ends, one that is too
    large where the first solution lies, of 200."""
    size = np.concatenate([np.linspace(0.1, 0.8, 70), np.full(199, 0.5), [beyond]])
    given = size[:, None, None] * np.where(np.arange(270) < 70, 1.0, [[1.0], [-1.0]]).T[:, None]
    errors, asked = Errors(np.zeros((270, 1)), given, np.ones(270)), []

    def solved(some: Errors, n: int) -> Least:
        asked.append(some.given[:, 0])
        return Least(np.array([0.9, 0.0] if len(asked) == 1 else [0.25, 0.2]), 1.0, 0.5)

    monkeypatch.setattr(module, "_solved", solved)
    program: Any = lambda some: some  # noqa: E731
    found = module._generated(errors, program, np.full(2, 0.1), np.ones(2), 1.0)
    assert len(asked) == (2 if beyond > 1.0 else 1)
    np.testing.assert_allclose(np.sort(asked[0][:, 0]), np.sort(size[6:70]))
    assert (asked[0][:, 1] > 0.0).all()
    if beyond > 1.0:
        assert [-beyond] in asked[1][asked[1][:, 1] < 0.0][:, 1:].tolist()
    np.testing.assert_allclose(found.x, [0.25, 0.2] if beyond > 1.0 else [0.9, 0.1])  # kept within the bounds
