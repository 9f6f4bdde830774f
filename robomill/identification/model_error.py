"""How far a model's predictions miss what it has not seen: what a band needs besides the noise of the fit.

The errors on poses left out are larger than the fit's own covariance says wherever the model is not the arm. Each is
taken as drawn with variance

    D cov D^T + k^2 (floor^2 + share^2 |delta|^2),

a part that grows with the displacement and a part that does not (the gauge's noise, play). floor and share are fitted
to the squared errors; k is then the smallest number with which the 95 % bands hold 95 % of the errors left out (split
conformal prediction: no normal distribution is asked for).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.optimize import nnls
from scipy.special import stdtrit

from robomill.arrays import BoolArray, FloatArray, IntArray
from robomill.identification.least_squares import triangle

LEVEL = 0.95
ROUNDS = 8
CLIP = 9.0  # squared errors beyond this many variances count as this many: a gross row is no measure of the model
MOST = 5000  # errors that are looked at, evenly spread over more
FEWEST = 4  # poses from which errors on poses left out can be judged


@dataclass(frozen=True)
class ModelError:
    """Standard deviation of a prediction beyond the fit's noise: ``share`` of the displacement, and ``floor`` m."""

    share: float
    floor: float

    def variance(self, size: FloatArray) -> FloatArray:
        """(...) m^2 of each component of a displacement of that size (...) m."""
        return np.asarray(self.floor**2 + (self.share * size) ** 2)


@dataclass(frozen=True, eq=False)
class Errors:
    """Errors on what was left out (e,) m, the variance (e,) m^2 that the fit gave each, the size (e,) m of the
    displacement predicted there, and the fold (e,) each was left out with."""

    error: FloatArray
    variance: FloatArray
    size: FloatArray
    fold: IntArray

    def chosen(self, which: IntArray | BoolArray) -> Errors:
        """Some of them."""
        return Errors(self.error[which], self.variance[which], self.size[which], self.fold[which])

    def thinned(self) -> Errors:
        """Those that are known, at most about ``MOST`` of them."""
        known = np.flatnonzero(np.isfinite(self.error))
        return self.chosen(known[:: max(len(known) // MOST, 1)])


def model_error(errors: Errors, dof: int) -> ModelError | None:
    """The error that the bands need; None where too little was left out to judge it."""
    errors = errors.thinned()
    if len(np.unique(errors.fold)) < FEWEST or dof <= 0:
        return None
    t = float(stdtrit(dof, 0.5 + LEVEL / 2.0))
    e2, v, size2 = errors.error**2, errors.variance, errors.size**2
    share2, floor2 = _spread(e2, v, size2)
    beyond = floor2 + share2 * size2
    if not (beyond > 0).all():
        return ModelError(0.0, 0.0)
    needed = np.sort(np.clip(e2 / t**2 - v, 0.0, None) / beyond)
    rank = min(int(np.ceil(LEVEL * (len(needed) + 1))), len(needed)) - 1
    k = float(np.sqrt(needed[rank]))
    return ModelError(k * float(np.sqrt(share2)), k * float(np.sqrt(floor2)))


def _spread(e2: FloatArray, v: FloatArray, size2: FloatArray) -> tuple[float, float]:
    """share^2 and floor^2 (m^2) by weighted non-negative least squares of the squared errors."""
    typical = float(np.mean(size2))
    if typical == 0.0:
        return 0.0, float(np.mean(e2))
    columns = np.stack([size2 / typical, np.ones_like(size2)], axis=1)
    guess = np.full(len(e2), float(np.median(e2)) / 0.455)  # the median of a squared standard normal
    found = np.zeros(2)
    for _ in range(ROUNDS):
        weight = 1.0 / np.maximum(guess, 1e-6 * float(guess.max(initial=0.0)) or 1.0)
        target = np.minimum(e2, CLIP * guess) - v
        R = triangle(columns * weight[:, None], target * weight)
        found = nnls(R[:, :2], R[:, 2])[0]
        guess = v + columns @ found
        if not guess.any():
            break
    return float(found[0] / typical), float(found[1])


def held(errors: Errors, dof: int) -> float:
    """Share of the errors left out that 95 % bands hold, each fold's band made from the errors of the others alone."""
    errors = errors.thinned()
    inside = np.zeros(len(errors.error), dtype=bool)
    for k in np.unique(errors.fold):
        here = errors.fold == k
        spread = model_error(errors.chosen(~here), dof)
        if spread is None:
            return float("nan")
        t = float(stdtrit(dof, 0.5 + LEVEL / 2.0))
        half = t * np.sqrt(errors.variance[here] + spread.variance(errors.size[here]))
        inside[here] = np.abs(errors.error[here]) <= half
    return float(inside.mean()) if len(inside) else float("nan")
