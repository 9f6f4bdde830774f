"""From load tests to compliances: eqs. (16), (17) solved by non-negative linear least squares (paper, Sec. 5.1).

The problem is linear in the compliances, so no iteration and no starting guess are needed. Use differences
between loaded and preloaded readings: gravity, dead weight and the gauge's zero cancel in them.
"""

from dataclasses import replace
from typing import Any

import numpy as np

from robomill.arrays import FloatArray, frozen
from robomill.errors import LoadTestError
from robomill.identification import diagnostics
from robomill.identification.fit.balance import balanced
from robomill.identification.fit.causes import Inquiry
from robomill.identification.fit.crossvalidation import Folded, Missed, good, headline, leave_out, relative_by_pose
from robomill.identification.fit.doubts import bending_offer, model_findings
from robomill.identification.fit.fitting import Fitted, fit_system
from robomill.identification.fit.folds import folds_of
from robomill.identification.fit.model_error import Errors, held, model_error
from robomill.identification.fit.models import Model
from robomill.identification.fit.scatter import by_tests
from robomill.identification.fit.selection import Candidates
from robomill.identification.fit.suspects import UNASKED
from robomill.identification.fit.system import System, build_system
from robomill.identification.fit.treatment import AUTO, BENDING_JOINTS, STANDARD, Treatment
from robomill.identification.load_test import JointTests, LoadTests
from robomill.identification.other_senses import CODE as SENSE
from robomill.identification.pull.found_points import found_points, point_findings
from robomill.identification.pull.lines_of_pull import lines_of_pull
from robomill.identification.pull.offer import offer_of
from robomill.identification.pull.points import Point, at_shift
from robomill.identification.result import Band, Condition, IdentificationResult
from robomill.identification.slips import outlier_findings, with_slips
from robomill.identification.suspicion import suspicions
from robomill.robot.model import Robot

AIMS = 5  # rounds in which cables are aimed from the load point found
AIMED = 1e-4  # m: a shift below this turns no cable


def identify(
    robot: Robot,
    tests: LoadTests | JointTests,
    model: str = "joints",
    treatment: Treatment = STANDARD,
    **choices: Any,
) -> IdentificationResult:
    """Joint compliances (and those of extra springs) from load tests, with how sure they are.

    model: ``joints``, ``joints+bending``, ``joints+tool``, ``joints+bending+tool`` or ``constant``; treatment, or its
    fields as ``choices``: bending, fit_points, robust, exclude, weights, leave_out (see ``Treatment``).
    Raises LoadTestError where the tests cannot answer: too few equations, one pose only, poses outside the limits.
    """
    treatment = replace(treatment, **choices)
    if treatment.exclude:
        tests = _without(tests, treatment.exclude)
    bending = BENDING_JOINTS if treatment.bending == AUTO else treatment.bending
    if tests.single:
        return _of_joints(robot, tests, Model(model, bending), treatment)
    tests = tests.with_joints(robot)
    stated, fold = tests, folds_of(treatment.leave_out, tests.pose_index(), tests.theta)
    for _ in range(AIMS):
        starts = pull_starts(robot, tests, treatment.freed)
        candidates = Candidates(robot, tests, Model(model, bending), treatment, fold, starts)
        choice, fitted = candidates.best()
        if "force" not in treatment.freed or not tests.aimed.any() or _aimed_well(fitted):
            break
        tests = tests.moved(robot, fitted.found.shift[:3])  # cables aimed from the point found: a law linear about it
    fitted, told = by_tests(fitted)
    missed = candidates.missed()
    result = _result(robot, tests, choice, fitted)
    error = headline(relative_by_pose(fitted.system, missed.error, fitted.weights))
    inquest = UNASKED
    turned_round = any(finding.code == SENSE for finding in result.findings)  # no spring and no point explains that
    if choice.has("joint") and not turned_round:
        inquest = Inquiry.of(robot, tests, result, treatment, fitted).inquest()
    offer = offer_of(robot, tests, choice, treatment, inquest)
    bends = bending_offer(candidates, model, inquest, error)
    points = found_points(robot, stated, treatment.freed, fitted.found, tests.force_point - stated.force_point)
    return replace(
        result,
        findings=(
            *result.findings,
            *told,
            *model_findings(robot, inquest),
            *point_findings(points),
            *(each.finding() for each in (offer, bends) if each is not None),
        ),
        offer=offer,
        bends=bends,
        inquest=inquest,
        cv_relative_error=error,
        points=points,
        band=_band(_errors(robot, tests, choice, fitted, missed), result.dof),
        votes=tuple(map(tuple, candidates.votes())) if treatment.bending == AUTO else (),
        treatment=treatment,
    )


def _aimed_well(fitted: Fitted) -> bool:
    return bool(np.linalg.norm(fitted.found.shift[:3]) < AIMED)


def pull_starts(robot: Robot, tests: LoadTests, freed: tuple[Point, ...]) -> tuple[FloatArray, ...]:
    """Another shift to search the points from: the load point by the lines of pull, which know no displacement."""
    if "force" not in freed:
        return ()
    shift = lines_of_pull(robot, tests).shift
    return () if shift is None else (np.concatenate([shift, np.zeros(3 * (len(freed) - 1))]),)


def _of_joints(robot: Robot, tests: JointTests, choice: Model, treatment: Treatment) -> IdentificationResult:
    """Single joints: no pose, no points, and nothing that says how the tool moves."""
    system = build_system(robot, tests, choice, treatment.freed)
    fitted = fit_system(balanced(system, np.unique(tests.joint, return_inverse=True)[1]), treatment.robust)
    fold = folds_of("pose", fitted.system.pose, None)
    folded = Folded(fitted.small, fold, fitted.weights)
    missed = leave_out(folded.count, lambda left: folded)
    error = headline(relative_by_pose(fitted.system, missed.error, fitted.weights))
    return replace(_result(robot, tests, choice, fitted), cv_relative_error=error, treatment=treatment)


def _errors(robot: Robot, tests: LoadTests, choice: Model, fitted: Fitted, missed: Missed) -> Errors:
    """The displacements left out, with the size of the whole displacement predicted at each test."""
    system, freed, x = fitted.system, fitted.system.freed, fitted.fit.x
    if tests.gauges is None and np.isfinite(tests.displacement[:, :3]).all():
        size2 = np.bincount(system.test[system.linear], (system.A @ x)[system.linear] ** 2, minlength=len(tests))
    else:
        size2 = ((at_shift(choice.terms(robot, tests, freed)[:, :3], fitted.found.shift, freed) @ x) ** 2).sum(axis=1)
    size = np.sqrt(size2)[system.test]
    counted = system.linear & good(system, fitted.weights)
    load = np.linalg.norm(tests.wrench[:, :3], axis=1)[system.test]
    reading = np.nan_to_num(tests.noise)[system.test] ** 2  # what is stated is no error of the model
    return Errors(missed.error, missed.variance + reading, size, load, missed.fold).chosen(counted)


def _band(errors: Errors, dof: int) -> Band | None:
    spread = model_error(errors, dof)
    return None if spread is None else Band(spread, held(errors, dof), int(np.isfinite(errors.error).sum()))


def _result(robot: Robot, tests: LoadTests | JointTests, choice: Model, fitted: Fitted) -> IdentificationResult:
    system, fit, weights, lumped = fitted.system, fitted.fit, fitted.weights, fitted.lumped
    share = diagnostics.shares(system, fit.x)
    residual = _residuals(system, fit.x, len(tests), len(tests.components))
    negative = (fit.x == 0.0) & (fit.free * np.linalg.norm(system.A, axis=0) < -1e-9 * np.linalg.norm(system.b))
    active = tuple(p.label for k, p in enumerate(system.parameters) if negative[k] and fit.seen[k] and not p.signed)
    found = diagnostics.fit_findings(system, fit, active, lumped)
    interval = fit.interval(system.signed)
    odd = with_slips(robot, tests, choice, fitted, diagnostics.outliers(system, tests.row))
    unjudged = fit.dof <= 0 and not system.stated
    denied = np.isinf(interval[:, 1]) & (fit.free < 0.0)
    return IdentificationResult(
        choice=choice,
        labels=system.parameters,
        parameters=frozen(fit.x),
        covariance=frozen(fit.covariance),
        parameter_stderr=frozen(np.where(denied | unjudged, np.inf, fit.stderr)),
        parameter_ci95=frozen(interval),
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
        components=tests.components,
        kind=tests.provenance.kind,
        share=frozen(share),
        outliers=odd,
        unseen_joints=diagnostics.unseen_joints(fit, system.parameters, share),
        active_bounds=active,
        explanations=tuple(diagnostics.sentence(fit, system.parameters, share, k) for k in range(len(fit.x))),
        lumped=lumped,
        findings=(*tests.findings, *suspicions(tests, robot), *found, *outlier_findings(odd, len(tests))),
    )


def _without(tests: LoadTests | JointTests, rows: tuple[int, ...]) -> LoadTests | JointTests:
    unknown = sorted(set(rows) - set(tests.row.tolist()))
    if unknown:
        raise LoadTestError(f"Exclude row {unknown[0]}: the tests have no such row.")
    if set(tests.row.tolist()) <= set(rows):
        raise LoadTestError("Exclude: this leaves no test at all.")
    return tests.without(rows)


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
