"""From load tests to compliances: eqs. (16), (17) solved by non-negative linear least squares (paper, Sec. 5.1).

The problem is linear in the compliances, so no iteration and no starting guess are needed. Use differences
between loaded and preloaded readings: gravity, dead weight and the gauge's zero cancel in them.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from robomill.arrays import FloatArray, frozen
from robomill.errors import LoadTestError
from robomill.identification import diagnostics
from robomill.identification.crossvalidation import cross_validate, headline, relative_by_pose
from robomill.identification.least_squares import Fit, RobustFit, robust_fit
from robomill.identification.load_test import JointTests, LoadTests
from robomill.identification.models import Model
from robomill.identification.result import Condition, IdentificationResult
from robomill.identification.suspicion import suspicions
from robomill.identification.system import System, build_system
from robomill.robot.model import Robot

BENDING_JOINTS = (2, 3)


def identify(
    robot: Robot,
    tests: LoadTests | JointTests,
    model: str = "joints",
    *,
    bending_joints: Iterable[int] = BENDING_JOINTS,
    robust: bool = False,
    exclude: Iterable[int] = (),
) -> IdentificationResult:
    """Joint compliances (and those of extra springs) from load tests, with how sure they are.

    model: ``joints``, ``joints+bending``, ``joints+tool``, ``joints+bending+tool`` or ``constant``;
    robust: weigh down tests that do not fit (Tukey's bisquare); exclude: rows left out, e.g. the flagged outliers.
    Raises LoadTestError where the tests cannot answer: too few equations, one pose only, poses outside the limits.
    """
    left_out = tuple(sorted(set(exclude)))
    if left_out:
        tests = _without(tests, left_out)
    if isinstance(tests, LoadTests):
        tests = tests.with_joints(robot)
    choice = Model(model, tuple(bending_joints))
    fitted = _fitted(build_system(robot, tests, choice), robust)
    return replace(
        _result(robot, tests, choice, fitted),
        cv_relative_error=headline(cross_validate(fitted.system, fitted.weights)),
        excluded=left_out,
    )


class _Fitted(NamedTuple):
    """Equations, their fit, the robust weights (None: all one), and the springs that are counted with another."""

    system: System
    fit: Fit
    weights: FloatArray | None
    lumped: dict[str, str]


def _fitted(system: System, robust: bool) -> _Fitted:
    twins = diagnostics.twins(system)
    system = _lump(system, twins)
    lumped = {system.parameters[k].label: system.parameters[j].label for k, j in twins.items()}
    if not robust:
        return _Fitted(system, _fit(system, None, list(twins)), None, lumped)
    gross = robust_fit(system.A / system.noise[:, None], system.b / system.noise)
    fit, plain = (_fit(system, weights, list(twins)) for weights in (gross.weights, None))
    return _Fitted(system, _robust_covariance(fit, plain, gross), gross.weights, lumped)


def _result(robot: Robot, tests: LoadTests | JointTests, choice: Model, fitted: _Fitted) -> IdentificationResult:
    system, fit, weights, lumped = fitted
    share = diagnostics.shares(system, fit.x)
    residual = _residuals(system, fit.x, len(tests), 1 if isinstance(tests, JointTests) else 3)
    negative = (fit.x == 0.0) & (fit.free * np.linalg.norm(system.A, axis=0) < -1e-9 * np.linalg.norm(system.b))
    active = tuple(p.label for k, p in enumerate(system.parameters) if negative[k] and fit.seen[k] and not p.signed)
    found = diagnostics.fit_findings(system, fit, active, lumped)
    return IdentificationResult(
        choice=choice,
        labels=system.parameters,
        parameters=frozen(fit.x),
        covariance=frozen(fit.covariance),
        parameter_stderr=frozen(fit.stderr),
        parameter_ci95=frozen(fit.interval(system.signed)),
        correlation=frozen(diagnostics.correlation(fit.covariance)),
        n=robot.n,
        condition=Condition(*fit.condition),
        residual=frozen(residual),
        residual_share=frozen(_relative(system, residual, len(tests))),
        residual_rms=float(np.sqrt(np.nanmean(residual**2))),
        noise=fit.sigma * float(np.median(system.noise[system.linear])) if fit.dof > 0 or system.stated else np.nan,
        equations=len(system.b),
        dof=fit.dof,
        in_sample_by_pose=frozen(relative_by_pose(system, system.A @ fit.x - system.b, weights)),
        row=tests.row,
        share=frozen(share),
        outliers=diagnostics.outliers(system, tests.row),
        unseen_joints=diagnostics.unseen_joints(fit, system.parameters, share),
        active_bounds=active,
        explanations=tuple(diagnostics.sentence(fit, system.parameters, share, k) for k in range(len(fit.x))),
        lumped=lumped,
        findings=(*tests.findings, *suspicions(tests, robot), *found),
        robust=weights is not None,
    )


def _without(tests: LoadTests | JointTests, rows: tuple[int, ...]) -> LoadTests | JointTests:
    unknown = sorted(set(rows) - set(tests.row.tolist()))
    if unknown:
        raise LoadTestError(f"Exclude row {unknown[0]}: the tests have no such row.")
    if set(tests.row.tolist()) <= set(rows):
        raise LoadTestError("Exclude: this leaves no test at all.")
    return tests.without(rows)


def _lump(system: System, twins: dict[int, int]) -> System:
    """Columns that repeat an earlier one are emptied: their spring is counted with the earlier one."""
    if not twins:
        return system
    A = system.A.copy()
    A[:, list(twins)] = 0.0
    return replace(system, A=A)


def _fit(system: System, weights: FloatArray | None, lumped: list[int]) -> Fit:
    """The fit without the lumped columns, set back in place: a lumped spring is zero, not unknown."""
    if not lumped:
        return system.fit(weights)
    p = system.A.shape[1]
    kept = np.setdiff1d(np.arange(p), lumped)
    small = replace(system, A=system.A[:, kept], parameters=tuple(system.parameters[k] for k in kept))
    fit = small.fit(weights)
    x, free, covariance = np.zeros(p), np.zeros(p), np.zeros((p, p))
    x[kept], free[kept] = fit.x, fit.free
    covariance[np.ix_(kept, kept)] = fit.covariance
    seen = np.ones(p, dtype=bool)
    seen[kept] = fit.seen
    null = np.zeros((len(fit.null), p))
    null[:, kept] = fit.null
    return replace(fit, x=x, free=free, covariance=covariance, seen=seen, null=null)


def _robust_covariance(fit: Fit, plain: Fit, gross: RobustFit) -> Fit:
    """Weights that were estimated: the covariance is that of an M-estimate, not of a fit with known weights."""
    if plain.sigma == 0.0 or gross.sigma == 0.0:
        return fit
    return replace(fit, covariance=plain.covariance * (gross.sigma / plain.sigma) ** 2, sigma=gross.sigma)


def _residuals(system: System, x: FloatArray, tests: int, width: int) -> FloatArray:
    """(tests, width) measured minus predicted, NaN where nothing was measured."""
    residual = np.full((tests, width), np.nan)
    linear = system.linear
    residual[system.test[linear], system.component[linear]] = system.b[linear] - system.A[linear] @ x
    return residual


def _relative(system: System, residual: FloatArray, tests: int) -> FloatArray:
    """(tests,) |residual| / |measured|; NaN where nothing moved."""
    linear = system.linear
    size = np.bincount(system.test[linear], system.b[linear] ** 2, minlength=tests)
    missed = np.nansum(residual**2, axis=1)
    with np.errstate(invalid="ignore", divide="ignore"):
        return np.where(size > 0, np.sqrt(missed / size), np.nan)
