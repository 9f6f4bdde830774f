"""Cross-validation: predict the poses that were left out. In-sample residuals flatter; these do not.

All that is chosen by looking at the readings is chosen inside every fold: compliances, the points that are fitted, and
where there is more than one candidate also the model, by a cross-validation of its own among the other folds.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field

import numpy as np

from robomill.arrays import BoolArray, FloatArray, IntArray
from robomill.identification.fit.system import System
from robomill.identification.pull.points import Normal, PointFit, at_shift, slopes
from robomill.lazy import cached_property
from robomill.progress import checkpoint

Choose = Callable[["frozenset[int]"], "Folded"]


@dataclass(frozen=True, eq=False)
class Missed:
    """What leaving folds out gave, equation by equation: error (e,) predicted - measured, NaN where the rest cannot
    predict it; variance (e,) of the prediction as its own fit says; fold (e,)."""

    error: FloatArray
    variance: FloatArray
    fold: IntArray


@dataclass(frozen=True, eq=False)
class Folded:
    """Equations cut into folds (e,), each folded into its triangular factor, so that any of them can be left out.

    starts: shifts (s,) from which points are sought besides the stated ones.
    """

    system: System
    fold: IntArray
    weights: FloatArray | None = None
    starts: tuple[FloatArray, ...] = ()
    kept: dict[frozenset[int], PointFit] = field(default_factory=dict, repr=False)
    rough: dict[frozenset[int], FloatArray] = field(default_factory=dict, repr=False)

    @property
    def count(self) -> int:
        return int(self.fold.max()) + 1

    @cached_property
    def factors(self) -> list[FloatArray]:
        """One factor a fold."""
        return [self.system.factor(self.weights, self.fold == k) for k in range(self.count)]

    @cached_property
    def squares(self) -> list[FloatArray]:
        """The normal equations of each fold."""
        return [R.T @ R for R in self.factors]

    @cached_property
    def equations(self) -> list[int]:
        """How many equations count in each fold."""
        return [self.system.count(self.weights, self.fold == k) for k in range(self.count)]

    def without(self, left: frozenset[int]) -> PointFit:
        """The fit of all folds but these."""
        if left not in self.kept:
            rest = [k for k in range(self.count) if k not in left]
            R = np.concatenate([self.factors[k] for k in rest])
            self.kept[left] = self.system.factored(R, sum(self.equations[k] for k in rest)).fit(self.starts)
        return self.kept[left]

    def roughly(self, left: frozenset[int]) -> FloatArray:
        """(p + s,) the same to the digits that a choice between models needs."""
        if left not in self.rough:
            M = sum(square for k, square in enumerate(self.squares) if k not in left)
            normal = Normal(np.asarray(M), self.system.signed, self.system.freed)
            shift = self.without(frozenset()).shift  # near by: the fit without these comes to rest where it would
            _, shift, x = normal.descend(shift)
            self.rough[left] = np.concatenate([x, shift])
        return self.rough[left]

    @cached_property
    def seen(self) -> BoolArray:
        """(p + s,) what all the folds together see."""
        return self.without(frozenset()).fit.seen

    def predict(self, k: int, left: frozenset[int]) -> tuple[FloatArray, FloatArray]:
        """Errors of fold ``k``'s equations, predicted without the folds ``left``, and the prediction's variance."""
        system, inside = self.system, self.fold == k
        fit, shift = self.without(left)
        terms = system.every_term[inside]
        A = at_shift(terms, shift, system.freed)
        x = fit.x[: A.shape[1]]
        columns = np.concatenate([A, slopes(terms, x, shift, system.freed)], axis=1)
        lost = np.abs(columns) @ (self.seen & ~fit.seen) > 0
        variance = ((columns @ np.nan_to_num(fit.covariance)) * columns).sum(axis=1)
        return np.where(lost, np.nan, A @ x - system.b[inside]), variance

    def score(self, left: frozenset[int]) -> float:
        """Mean relative error over the poses of all folds but these, each fold predicted without itself as well."""
        missed = np.full(len(self.system.b), np.nan)
        for k in set(range(self.count)) - left:
            checkpoint()
            x, inside = self.roughly(left | {k}), self.fold == k
            p = len(self.system.signed)
            A = at_shift(self.system.every_term[inside], x[p:], self.system.freed)
            missed[inside] = A @ x[:p] - self.system.b[inside]
        return headline(relative_by_pose(self.system, missed, self.weights))


def leave_out(folds: int, choose: Choose) -> Missed:
    """Every fold predicted by what ``choose`` takes and fits without it."""
    whole = choose(frozenset())
    e = len(whole.system.b)
    missed, variance = np.full(e, np.nan), np.full(e, np.nan)
    for k in range(folds) if folds > 1 else ():
        checkpoint(k / folds, "What was left out")
        left = frozenset({k})
        inside = whole.fold == k
        missed[inside], variance[inside] = choose(left).predict(k, left)
    return Missed(missed, variance, whole.fold)


def relative_by_pose(system: System, missed: FloatArray, weights: FloatArray | None = None) -> FloatArray:
    """(poses,) |missed| / |measured| from the errors (e,) of all equations; NaN where nothing moved or is not known.

    Rows that robust weights have switched off as gross are not counted (``good``): they are no measure of the model.
    """
    poses = int(system.pose.max()) + 1
    linear = system.linear & good(system, weights)
    error = np.bincount(system.pose[linear], missed[linear] ** 2, minlength=poses)
    size = np.bincount(system.pose[linear], system.b[linear] ** 2, minlength=poses)
    with np.errstate(invalid="ignore", divide="ignore"):
        return np.where(size > 0, np.sqrt(error / size), np.nan)


def good(system: System, weights: FloatArray | None) -> BoolArray:
    """(e,) equations of tests none of whose readings robust weights have switched off as gross.

    A row of which one reading is gross is wrong as a whole: what is left of it fits by chance, and a share of a small
    remainder would be any number.
    """
    if weights is None:
        return np.ones(len(system.b), dtype=bool)
    return np.asarray(np.bincount(system.test, weights <= 0.0)[system.test] == 0)


def headline(errors: Sequence[float] | FloatArray) -> float:
    """The mean over the poses that could be predicted; NaN when none could."""
    errors = np.asarray(errors)
    known = errors[np.isfinite(errors)]
    return float(known.mean()) if len(known) else float("nan")
