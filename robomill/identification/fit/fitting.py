"""One system of equations fitted: springs that repeat another set aside, gross readings weighed down, points found."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from robomill.arrays import FloatArray, IntArray
from robomill.identification import diagnostics
from robomill.identification.fit.least_squares import Fit, RobustFit, robust_fit
from robomill.identification.fit.system import System
from robomill.identification.pull.points import PointFit, slopes
from robomill.progress import checkpoint

ROUNDS = 12
SETTLED = 1e-6  # m, change of the points from one round of weights to the next


@dataclass(frozen=True, eq=False)
class Fitted:
    """A system with its fit.

    small: the equations of the parameters that are told apart, ``kept`` (q,) their places among all; found: their fit
    and the points'; weights: the robust ones, None where all count alike; lumped: springs counted with another one.
    """

    system: System
    small: System
    kept: IntArray
    found: PointFit
    weights: FloatArray | None
    lumped: dict[str, str]

    @property
    def fit(self) -> Fit:
        """The fit of all compliances: a lumped spring is zero, not unknown."""
        p, kept, fit = self.system.A.shape[1], self.kept, self.found.compliances()
        if len(kept) == p:
            return fit
        x, free, covariance = np.zeros(p), np.zeros(p), np.zeros((p, p))
        x[kept], free[kept] = fit.x, fit.free
        covariance[np.ix_(kept, kept)] = fit.covariance
        seen = np.ones(p, dtype=bool)
        seen[kept] = fit.seen
        null = np.zeros((len(fit.null), p))
        null[:, kept] = fit.null
        spare = None if fit.spare is None else np.full(p, float(fit.dof))
        if spare is not None:
            spare[kept] = fit.spare
        return replace(fit, x=x, free=free, covariance=covariance, seen=seen, null=null, spare=spare)


def fit_system(system: System, robust: bool = False, starts: Sequence[FloatArray] = ()) -> Fitted:
    """Fit compliances and the freed points; ``starts`` are shifts (s,) from which the points are sought too."""
    twins = diagnostics.twins(system)
    lumped = {system.parameters[k].label: system.parameters[j].label for k, j in twins.items()}
    kept = np.setdiff1d(np.arange(system.A.shape[1]), list(twins))
    small = system.of(kept) if twins else system
    found, weights = small.fit_points(starts=starts), None
    if robust:
        found, weights = _robust(small, found)
    system, small = system.at(found.shift), small.at(found.shift)
    if twins:
        A = system.A.copy()
        A[:, list(twins)] = 0.0
        system = replace(system, A=A)
    return Fitted(system, small, kept, found, weights, lumped)


def columns(system: System, found: PointFit) -> FloatArray:
    """(e, p + s) change of each reading with each compliance and each coordinate of the points, at the fit."""
    x = found.fit.x[: system.A.shape[1]]
    return np.concatenate([system.A, slopes(system.every_term, x, found.shift, system.freed)], axis=1)


def _robust(system: System, plain: PointFit) -> tuple[PointFit, FloatArray]:
    """The fit in which gross readings weigh nothing, and the weights (e,)."""
    found = plain
    for _ in range(ROUNDS):
        checkpoint()
        now = system.at(found.shift)
        wide = columns(now, found)
        gross = robust_fit(wide / now.noise[:, None], linear_readings(now, found, wide) / now.noise)
        last, found = found, system.fit_points(gross.weights, [found.shift])
        if float(np.abs(found.shift - last.shift).max(initial=0.0)) < SETTLED:
            break
    return found._replace(fit=_robust_covariance(found.fit, plain.fit, gross)), gross.weights


def linear_readings(system: System, found: PointFit, wide: FloatArray) -> FloatArray:
    """(e,) readings of the equations that are linear about the points found, with their ``columns``."""
    return system.b + wide[:, system.A.shape[1] :] @ found.shift


def _robust_covariance(fit: Fit, plain: Fit, gross: RobustFit) -> Fit:
    """Weights that were estimated: the covariance is that of an M-estimate, not of a fit with known weights."""
    if plain.sigma == 0.0 or gross.sigma == 0.0:
        return fit
    return replace(fit, covariance=plain.covariance * (gross.sigma / plain.sigma) ** 2, sigma=gross.sigma)
