"""How sure a fit is, by how the tests scatter: readings of one test err together, and a heavy one errs by more.

A load that is 2 % off moves all readings of its test by 2 %. Intervals by one noise for all readings, each by itself,
then hold the truth in as few as half of all cases. Here each test is one draw, whatever its readings have in common:
the bias-reduced cluster-robust variance with its own degrees of freedom (Bell and McCaffrey 2002, as in Imbens and
Kolesar 2016). Where readings do err alike and alone it is that of plain least squares, only less sure of itself.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from robomill.arrays import BoolArray, FloatArray, IntArray
from robomill.identification.fit.fitting import Fitted, columns, linear_readings

FEWEST = 2.0  # degrees of freedom: of a compliance that fewer tests than that see, the noise of all readings is told
SEEN = 0.5  # of the variance: as much must be left of it by what the tests say without themselves
OWN = 1e-8  # share of a reading that others say; below it the reading has a parameter to itself, and no residual


def by_tests(fitted: Fitted) -> Fitted:
    """The same fit, its covariance and the degrees of freedom of its intervals by the scatter of its tests."""
    fit, system = fitted.found.fit, fitted.small
    if fit.dof <= 0 or fit.sigma <= 0.0:
        return fitted
    wide = columns(system, fitted.found)
    root = np.ones(len(system.b)) if fitted.weights is None else np.sqrt(fitted.weights)
    seen = np.flatnonzero(fit.seen)
    left = (linear_readings(system, fitted.found, wide) - wide[:, seen] @ fit.free[seen]) / system.noise * root
    factor, spare = np.ones(len(fit.x)), np.full(len(fit.x), float(fit.dof))
    factor[seen], spare[seen] = _scatter(wide[:, seen] * (root / system.noise)[:, None], left, system.test)
    judged = spare >= FEWEST
    factor, spare = np.where(judged, factor, 1.0), np.where(judged, spare, float(fit.dof))
    fit = replace(fit, covariance=fit.covariance * np.outer(factor, factor), spare=spare)
    return replace(fitted, found=fitted.found._replace(fit=fit))


def _scatter(X: FloatArray, left: FloatArray, test: IntArray) -> tuple[FloatArray, FloatArray]:
    """(q,) by what the standard errors of the columns of X (e, q) grow where each ``test`` (e,) is one draw of the
    residuals ``left`` (e,), and (q,) their degrees of freedom, 0 where too few tests see one."""
    X = X / np.linalg.norm(X, axis=0)
    N = np.asarray(np.linalg.inv(X.T @ X), dtype=np.float64)
    plain = float(left @ left) / max(int((np.abs(X).sum(axis=1) > 0.0).sum()) - X.shape[1], 1) * np.diag(N)
    parts = [_tests_of_size(X[each], left[each], N) for each in _alike(test)]
    score, own, pull = (np.concatenate(some) for some in zip(*parts, strict=True))
    lessened = np.einsum("gqi,ij,gqj->gq", pull, N, pull)
    trace = (own - lessened).sum(axis=0)
    both = np.einsum("gqi,gqj->qij", pull, pull)
    squares = (own**2 - 2.0 * own * lessened).sum(axis=0) + np.einsum("qij,jk,qkl,li->q", both, N, both, N)
    judged: BoolArray = trace > SEEN * np.diag(N)
    spare = np.divide(trace**2, squares, out=np.zeros_like(trace), where=judged & (squares > 0.0))
    variance = (score**2).sum(axis=0) * np.diag(N) / np.where(judged, trace, 1.0)
    return np.sqrt(variance / plain), spare


def _alike(test: IntArray) -> list[IntArray]:
    """Tests with as many readings together: for each number s of readings their indices (g, s)."""
    order = np.argsort(test, kind="stable")
    _, start, count = np.unique(test[order], return_index=True, return_counts=True)
    return [order[start[count == s][:, None] + np.arange(s)] for s in np.unique(count)]


def _tests_of_size(X: FloatArray, left: FloatArray, N: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Of tests with equations X (g, s, q) and residuals ``left`` (g, s): what each adds to the parameters (g, q), the
    squared length of the weights (g, q) it does that by, and their products with its equations (g, q, q)."""
    values, vectors = np.linalg.eigh(np.eye(X.shape[1]) - X @ N @ np.swapaxes(X, -1, -2))
    own = np.where(values > OWN, 1.0 / np.sqrt(np.maximum(values, OWN)), 0.0)
    bend = (vectors * own[:, None, :]) @ np.swapaxes(vectors, -1, -2)
    weights = N @ np.swapaxes(X, -1, -2) @ bend
    return np.einsum("gqs,gs->gq", weights, left), (weights**2).sum(axis=-1), weights @ X
