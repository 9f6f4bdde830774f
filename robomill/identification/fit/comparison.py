"""Models side by side: which springs the measurements support. The cross-validated error is the judge.

A richer model always fits its own data better; predicting poses that were left out, it does so only if its extra
springs are there. The gap between the two errors is the over-fitting.
"""

from collections.abc import Iterable
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from robomill.errors import LoadTestError
from robomill.identification.fit.estimate import identify
from robomill.identification.fit.models import MODELS, Model
from robomill.identification.fit.treatment import BENDING_JOINTS, STANDARD, Treatment
from robomill.identification.load_test import LoadTests
from robomill.identification.result import IdentificationResult
from robomill.robot.model import Robot

OVERFIT = 1.3  # cross-validated over in-sample error from which a model is said to over-fit


@dataclass(frozen=True, eq=False)
class Comparison:
    """Results by model, best cross-validated error first, and the models that could not be fitted with the reason."""

    results: tuple[IdentificationResult, ...]
    refused: dict[str, str]

    @property
    def best(self) -> IdentificationResult:
        """The model that predicts left-out poses best."""
        return self.results[0]

    @property
    def simplest_good(self) -> IdentificationResult:
        """The model with the fewest parameters whose cross-validated error is within 5 % of the best one's."""
        limit = 1.05 * self.best.cv_relative_error
        good = [r for r in self.results if r.cv_relative_error <= limit or r is self.best]
        return min(good, key=lambda r: len(r.labels) - len(r.lumped))

    def rows(self) -> list[dict[str, object]]:
        """A table: model, parameters, in-sample and cross-validated relative error, residual rms (m), remark."""
        table: list[dict[str, object]] = []
        for result in self.results:
            remark = []
            if result is self.best:
                remark.append("predicts best")
            if result is self.simplest_good:
                remark.append("simplest that predicts as well")
            if result.cv_relative_error > OVERFIT * result.in_sample:
                remark.append("over-fits: far better on its own data than on poses left out")
            if result.active_bounds:
                remark.append(f"held at zero: {', '.join(result.active_bounds)}")
            table.append(
                {
                    "model": result.model,
                    "parameters": len(result.labels) - len(result.lumped),
                    "in_sample": result.in_sample,
                    "cross_validated": result.cv_relative_error,
                    "residual_rms": result.residual_rms,
                    "remark": "; ".join(remark),
                }
            )
        return table

    def absorbed(self) -> str:
        """What joint-only values mean when a richer model predicts better; empty when they stand as they are."""
        joints = next((r for r in self.results if r.model == "joints"), None)
        richer = self.simplest_good
        if joints is None or richer is joints or not richer.has_joints:
            return ""
        with np.errstate(invalid="ignore", divide="ignore"):
            grown = joints.C_theta / richer.C_theta - 1.0
        most = np.argsort(-np.nan_to_num(np.abs(grown)).round(9), kind="stable")
        order = [int(k) for k in most if np.isfinite(grown[k])][:2]
        changes = " and ".join(f"joint {joints.labels[k].joint} by {grown[k]:+.0%}" for k in order)
        return (
            f"The joint-only values have absorbed what is not in the joints ({changes} against the model "
            f"{richer.model}): they predict well only near the measured poses, and say little of the joints themselves."
        )


def compare_models(
    robot: Robot,
    tests: LoadTests,
    models: Iterable[str] = MODELS,
    treatment: Treatment = STANDARD,
    **choices: Any,
) -> Comparison:
    """Fit every model to the same tests, treated alike. Raises LoadTestError where none can be fitted.

    Points are fitted in those models that have a tool to fit them to.
    """
    tests = tests.with_joints(robot)
    treatment = replace(treatment, **choices)
    results, refused = [], {}
    for name in models:
        try:
            whole = Model(name).has("joint")
            own = treatment if whole else replace(treatment, fit_points="none", bending=BENDING_JOINTS)
            results.append(identify(robot, tests, name, own))
        except LoadTestError as exc:
            refused[name] = str(exc)
    if not results:
        raise LoadTestError(next(iter(refused.values()), "Comparison: no model was named."))
    results.sort(key=_rank)
    return Comparison(tuple(results), refused)


def _rank(result: IdentificationResult) -> tuple[float, int]:
    """By the error on tests left out; of errors equal to nine digits the model with fewer parameters comes first."""
    error = float(np.nan_to_num(result.cv_relative_error, nan=np.inf))
    return float(f"{error:.9g}"), len(result.labels)
