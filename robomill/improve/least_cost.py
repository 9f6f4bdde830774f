"""The cheapest stiffening that keeps errors small, as a convex program.

Errors are linear in the compliance of each joint, x times what it is: error = fixed + given x. The cost of a joint is
its weight times the binary logarithm of how much stiffer it becomes, -log2(x): convex. So the least cost is found for
certain, and the solver's residuals say how certain.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from robomill.arrays import BoolArray, FloatArray
from robomill.errors import SetupError

FIRST, MORE, MOST = 64, 64, 40  # errors held at once at first, added at a time, and how often
SLACK = 1e-9  # of a bound
ON_BOUND = 1e-6  # of it
FULL, SETTLED = 0.25, 1e-9  # Newton decrements: below the first a whole step is taken, below the second none


Program = tuple[FloatArray, FloatArray, FloatArray, FloatArray, list[Any]]
"""Curvature (v,) and slope (v,) of what is minimised, rows A, b of what is not to be negative, b - A v, and the cones
of the first of them."""


@dataclass(frozen=True, eq=False)
class Errors:
    """fixed (q, d) + given (q, d, n) x, each of a size of at most ``bound`` (q,)."""

    fixed: FloatArray
    given: FloatArray
    bound: FloatArray

    def at(self, x: FloatArray) -> FloatArray:
        """(q, d)."""
        return np.asarray(self.fixed + self.given @ x)

    def shares(self, x: FloatArray) -> FloatArray:
        """(q,) of the bounds."""
        return np.asarray(np.linalg.norm(self.at(x), axis=1) / self.bound)

    def only(self, keep: BoolArray) -> Errors:
        return Errors(self.fixed[keep], self.given[keep], self.bound[keep])


@dataclass(frozen=True, eq=False)
class Least:
    """x (n,), what the solver minimised there, and its largest residual: primal, dual and the gap between them."""

    x: FloatArray
    value: float
    residual: float


def least_cost(errors: Errors, weight: FloatArray, low: FloatArray, high: FloatArray) -> Least | None:
    """The x in [low, high] (n,) with the least sum of weight (n,) times -log2(x), all errors within their bounds; None
    where there is none. Newton's steps, each a quadratic program, damped as the logarithm asks for."""
    if (errors.shares(high) <= 1.0).all():
        return Least(high, float(-weight @ np.log2(high)), 0.0)
    start = least_share(errors, low, high)
    if start.value > 1.0 + SLACK:
        return None
    x, scale = start.x, weight / np.log(2.0)
    for _ in range(MOST):
        step = _minimised(errors, scale / x**2, -2.0 * scale / x, low, high).x - x
        decrement = float(np.sqrt(np.sum(scale * (step / x) ** 2)))
        x = x + step / (1.0 + decrement if decrement > FULL else 1.0)
        if decrement < SETTLED:
            break
    # No x within the bounds costs less than by what is left along the slope of a convex cost.
    slope = -scale / x
    best = _minimised(errors, np.zeros(len(x)), slope, low, high)
    gap = max(float(slope @ (x - best.x)), 0.0)
    x = np.where(np.abs(x - high) < ON_BOUND * high, high, x)
    return Least(x, float(-weight @ np.log2(x)), max(gap, best.residual))


def _minimised(errors: Errors, curve: FloatArray, slope: FloatArray, low: FloatArray, high: FloatArray) -> Least:
    """The x with the least 1/2 curve x^2 + slope x, all errors within their bounds."""
    n = len(low)

    def program(some: Errors) -> Program:
        A, b, cones = _rows(some, n, 0)
        return curve, slope, np.vstack([A, _between(n, n)]), np.concatenate([b, high, -low]), cones

    return _generated(errors, program, low, high, 1.0)


def least_share(errors: Errors, low: FloatArray, high: FloatArray) -> Least:
    """The x in [low, high] (n,) whose largest error takes the least share of its bound; ``value`` is that share."""
    n = len(low)

    def program(some: Errors) -> Program:
        """Variables x and the share s."""
        A, b, cones = _rows(some, n, 1)
        A, b = np.vstack([A, _between(n, n + 1)]), np.concatenate([b, high, -low])
        return np.zeros(n + 1), np.append(np.zeros(n), 1.0), A, b, cones

    return _generated(errors, program, low, high, None)


def _between(n: int, columns: int) -> FloatArray:
    """Rows of x <= high and -x <= -low."""
    rows = np.zeros((2 * n, columns))
    rows[:n, :n], rows[n:, :n] = np.eye(n), -np.eye(n)
    return rows


def _rows(some: Errors, n: int, share: int) -> tuple[FloatArray, FloatArray, list[Any]]:
    """Rows A, b and cones of |error| <= bound (times the variable behind x where ``share`` is 1), in bounds."""
    import clarabel

    q, d = some.fixed.shape
    given, fixed = some.given / some.bound[:, None, None], some.fixed / some.bound[:, None]
    A, b = np.zeros((q, d + 1, n + share)), np.zeros((q, d + 1))
    A[:, 0, n:], b[:, 0] = -1.0, 0.0 if share else 1.0
    A[:, 1:, :n], b[:, 1:] = -given, fixed
    if d == 1:  # two rows are quicker than a cone
        A[:, 0, :n], b[:, 0] = given[:, 0], b[:, 0] - fixed[:, 0]
        A[:, 1, n:], b[:, 1] = -1.0 if share else 0.0, (0.0 if share else 1.0) + fixed[:, 0]
        cones = [clarabel.NonnegativeConeT(2 * q)] if q else []
    else:
        cones = [clarabel.SecondOrderConeT(d + 1)] * q
    return A.reshape(-1, n + share), b.ravel(), cones


def _generated(errors: Errors, program: Any, low: FloatArray, high: FloatArray, bound: float | None) -> Least:
    """Solved with some of the errors, the largest ones first, then with those that this leaves too large, until none
    is: thousands are on a path, a handful decide."""
    held = np.zeros(len(errors.bound), dtype=bool)
    for x in (low, high):
        held[np.argsort(-errors.shares(x), kind="stable")[:FIRST]] = True
    for _ in range(MOST):
        found = _solved(program(errors.only(held)), len(low))
        shares = errors.shares(np.clip(found.x, low, high))
        over = shares > (found.value if bound is None else bound) + 1e-7
        if not (over & ~held).any():
            break
        held[np.argsort(np.where(over & ~held, -shares, np.inf), kind="stable")[:MORE]] = True
    return Least(np.clip(found.x, low, high), found.value, found.residual)


def _solved(program: Program, n: int) -> Least:
    """By its first n variables; the rows behind those of its cones are of numbers that are not negative."""
    import clarabel
    from scipy.sparse import csc_matrix, diags_array

    curve, slope, A, b, cones = program
    every = [*cones, clarabel.NonnegativeConeT(2 * n)]
    settings = clarabel.DefaultSettings()
    settings.verbose = False
    found = clarabel.DefaultSolver(csc_matrix(diags_array(curve)), slope, csc_matrix(A), b, every, settings).solve()
    if found.status not in (clarabel.SolverStatus.Solved, clarabel.SolverStatus.AlmostSolved):
        raise SetupError(f"The stiffening was not found: the solver stopped with {found.status}; change the bounds.")
    gap = abs(found.obj_val - found.obj_val_dual) / max(1.0, abs(found.obj_val))
    residual = float(max(found.r_prim, found.r_dual, gap))
    return Least(np.array(found.x[:n]), float(found.obj_val), residual)
