"""How sure a fit is where loads err: readings of one test are then off together, and by more the more they move.

A load that is 2 % off moves all readings of its test by 2 %. Intervals by one noise for all readings, each by itself,
then hold the truth in as few as half of all cases. Such loads are known by what the fit leaves: it lies along what the
tests moved, and little across. Where that is beyond chance each test is one draw, whatever its readings have in common:
the bias-reduced cluster-robust variance with its own degrees of freedom (Bell and McCaffrey 2002, as in Imbens and
Kolesar 2016).
"""

from __future__ import annotations

from dataclasses import replace
from typing import NamedTuple

import numpy as np

from robomill.arrays import BoolArray, FloatArray, IntArray
from robomill.identification.fit.balance import each_once
from robomill.identification.fit.fitting import Fitted, columns, linear_readings
from robomill.provenance import Finding
from robomill.units import format_si

CHANCE = 0.05  # of sets without such loads, in which they are suspected
FEWEST = 2.0  # degrees of freedom: of a compliance that fewer tests than that see, the noise of all readings is told
SEEN = 0.5  # of the variance: as much must be left of it by what the tests say without themselves
OWN = 1e-8  # share of a reading that others say; below it the reading has a parameter to itself, and no residual


class Equations(NamedTuple):
    """Weighted equations of what a fit sees: X (e, q) linear about it, the ``left`` residuals (e,), the displacements
    ``moved`` (e,) it predicts, and the ``test`` (e,) of each."""

    X: FloatArray
    left: FloatArray
    moved: FloatArray
    test: IntArray

    @classmethod
    def of(cls, fitted: Fitted) -> Equations:
        """Those of a fit that leaves something, each once: a copy is no second draw."""
        fit, system = fitted.found.fit, fitted.small
        wide = columns(system, fitted.found)
        weight = (np.ones(len(system.b)) if fitted.weights is None else np.sqrt(fitted.weights)) / system.noise
        X = wide[:, fit.seen] * weight[:, None]
        left = linear_readings(system, fitted.found, wide) * weight - X @ fit.free[fit.seen]
        moved = (system.A @ fit.x[: system.A.shape[1]]) * weight
        once = each_once(system, system.component)
        return cls(X[once], left[once], moved[once], system.test[once])

    @property
    def inverse(self) -> FloatArray:
        """(q, q) of X^T X, by the factor of X."""
        root = np.linalg.inv(np.linalg.qr(self.X, mode="r"))
        return np.asarray(root @ root.T, dtype=np.float64)


def by_tests(fitted: Fitted) -> tuple[Fitted, tuple[Finding, ...]]:
    """The same fit, the covariance of its compliances and the degrees of freedom of their intervals by the scatter of
    its tests where their loads seem to err, and that it is said. Points of the tool stay as sure as they were: what a
    model lacks looks like such loads, too, and is known by points that disagree."""
    fit = fitted.found.fit
    if fit.dof <= 0 or fit.sigma <= 0.0 or not fit.seen.any():
        return fitted, ()
    equations = Equations.of(fitted)
    off = off_by(equations)
    if off is None:
        return fitted, ()
    factor, spare = np.ones(len(fit.x)), np.full(len(fit.x), float(fit.dof))
    factor[fit.seen], spare[fit.seen] = scatter(equations)
    judged = (spare >= FEWEST) & (np.arange(len(spare)) < fitted.small.A.shape[1])
    factor, spare = np.where(judged, factor, 1.0), np.where(judged, spare, float(fit.dof))
    fit = replace(fit, covariance=fit.covariance * np.outer(factor, factor), spare=spare)
    text = (
        f"what the fit leaves lies along what the tool moved, as if loads were off by about {format_si(off, '%', 1)} "
        "(or the model lacked something that grows with them): each test counts as one draw, which makes the intervals "
        "wider; calibrate what measures the load."
    )
    told = (Finding("info", text, code="loads-err"),)
    return replace(fitted, found=fitted.found._replace(fit=fit)), told


def off_by(equations: Equations) -> float | None:
    """The share by which loads seem to be off (one standard deviation): residuals along what a test moved beside those
    across it. None where chance alone makes as much of them, or there are none across.

    By the ratio of both mean squares, each over the degrees of freedom that its readings have left.
    """
    from scipy.special import fdtrc

    X, left, moved, test = equations
    count = int(test.max()) + 1
    size = np.sqrt(np.bincount(test, moved**2, minlength=count))
    way = np.divide(moved, size[test], out=np.zeros_like(moved), where=size[test] > 0.0)
    along = np.bincount(test, way * left, minlength=count)
    pulled = np.stack([np.bincount(test, way * column, minlength=count) for column in X.T], axis=1)
    spare = float((size > 0.0).sum() - np.einsum("gq,qk,gk->", pulled, equations.inverse, pulled))
    rest = int((np.abs(X).sum(axis=1) > 0.0).sum()) - X.shape[1] - spare
    if spare < 1.0 or rest < 1.0:
        return None
    noise = float(left @ left - along @ along) / rest
    more = float(along @ along) / spare
    if noise <= 0.0 or fdtrc(spare, rest, more / noise) > CHANCE:
        return None
    return float(np.sqrt((more - noise) * (size > 0.0).sum() / (size @ size)))


def scatter(equations: Equations) -> tuple[FloatArray, FloatArray]:
    """(q,) by what the standard errors grow where each test is one draw, and (q,) their degrees of freedom, 0 where too
    few tests see one."""
    X, left, _, test = equations = equations._replace(X=equations.X / np.linalg.norm(equations.X, axis=0))
    N = equations.inverse
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
