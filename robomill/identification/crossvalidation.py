"""Cross-validation by pose: predict the poses that were left out. In-sample residuals flatter; these do not."""

from __future__ import annotations

import numpy as np

from robomill.arrays import FloatArray, IntArray
from robomill.identification.least_squares import solve_triangle
from robomill.identification.system import System

FOLDS = 10


def fold_of_pose(poses: int, folds: int = FOLDS) -> IntArray:
    """(poses,) fold of each pose: at most ``folds``, of equal size, spread by a fixed shuffle."""
    order = np.random.default_rng(2013).permutation(poses)
    fold = np.empty(poses, dtype=np.int64)
    fold[order] = np.arange(poses) % min(folds, poses)
    return fold


def cross_validate(system: System, weights: FloatArray | None = None, folds: int = FOLDS) -> FloatArray:
    """(poses,) |predicted - measured| / |measured| of each pose, predicted without its own fold.

    NaN where the rest cannot predict it (a joint seen in that fold only) or nothing moved.
    """
    poses = int(system.pose.max()) + 1
    if poses < 2:
        return np.full(poses, np.nan)
    fold = fold_of_pose(poses, folds)[system.pose]
    count = int(fold.max()) + 1
    factors = [system.factor(weights, fold == k) for k in range(count)]
    equations = [system.count(weights, fold == k) for k in range(count)]
    seen = solve_triangle(np.concatenate(factors), sum(equations), system.signed).seen
    missed = np.full(len(system.b), np.nan)
    for k in range(count):
        rest = np.concatenate([factor for j, factor in enumerate(factors) if j != k])
        fit = solve_triangle(rest, sum(equations) - equations[k], system.signed)
        inside = fold == k
        needed = np.abs(system.A[inside]) @ (seen & ~fit.seen) > 0
        missed[inside] = np.where(needed, np.nan, system.A[inside] @ fit.x - system.b[inside])
    return relative_by_pose(system, missed, weights)


def relative_by_pose(system: System, missed: FloatArray, weights: FloatArray | None = None) -> FloatArray:
    """(poses,) |missed| / |measured| from the errors (e,) of all equations; NaN where nothing moved.

    What robust weights have switched off as gross is not counted: it is no measure of the model.
    """
    poses = int(system.pose.max()) + 1
    linear = system.linear if weights is None else system.linear & (weights > 0.0)
    error = np.bincount(system.pose[linear], missed[linear] ** 2, minlength=poses)
    size = np.bincount(system.pose[linear], system.b[linear] ** 2, minlength=poses)
    with np.errstate(invalid="ignore", divide="ignore"):
        return np.where(size > 0, np.sqrt(error / size), np.nan)


def headline(errors: FloatArray) -> float:
    """The mean over the poses that could be predicted; NaN when none could."""
    known = errors[np.isfinite(errors)]
    return float(known.mean()) if len(known) else float("nan")
