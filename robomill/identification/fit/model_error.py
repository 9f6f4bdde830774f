"""How far a model's predictions miss what it has not seen: what a band needs besides the noise of the fit.

The errors on poses left out are larger than the fit's own covariance says wherever the model is not the arm. Each is
taken as drawn with variance

    D cov D^T + reading^2 + k^2 (floor^2 + per_newton^2 |F|^2 + share^2 |delta|^2),

parts that grow with the displacement, with the force (an elastic arm that is not the model's errs by its load) and a
part that does not (play, noise that is not stated); tests under one load (within ``ALIKE``) cannot tell the last two
apart, and count as the second. The parts are fitted to the squared errors; k is then the smallest number with which the
95 % bands hold 95 % of the errors left out (split conformal prediction: no normal distribution is asked for).

``reading`` is the noise that the reading left out states: it is the gauge's and no error of the model. Of readings that
state none it cannot be told from one, and bands then hold the true displacement more often than they say.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from robomill.arrays import BoolArray, FloatArray, IntArray
from robomill.identification.fit.confidence import LEVEL, quantile
from robomill.identification.fit.least_squares import triangle
from robomill.units import format_si

ROUNDS = 8
CLIP = 9.0  # squared errors beyond this many variances count as this many: a gross row is no measure of the model
MOST = 5000  # errors that are looked at, evenly spread over more
ALIKE = 0.1  # of the largest: loads that differ by less are one, and do not tell what grows with them from what stays
FEWEST = 4  # poses from which errors on poses left out can be judged


@dataclass(frozen=True)
class ModelError:
    """Standard deviation of a prediction beyond the fit's noise: ``share`` of the displacement, m/N, ``floor`` m."""

    share: float
    per_newton: float
    floor: float

    def variance(self, size: FloatArray, load: FloatArray) -> FloatArray:
        """(...) m^2 of each component of a displacement of that size (...) m under a force of that size (...) N."""
        return np.asarray(self.floor**2 + (self.per_newton * load) ** 2 + (self.share * size) ** 2)

    def words(self) -> str:
        """Its parts that are not nothing, e.g. "4.1 % of the deviation, 0.02 um/N"."""
        parts = (
            (self.share, f"{format_si(self.share, '%', 1)} of the deviation"),
            (self.per_newton, f"{format_si(self.per_newton, 'um/N', 3)} of force"),
            (self.floor, format_si(self.floor, "um", 1)),
        )
        return ", ".join(text for value, text in parts if value > 0.0) or "none found"

    def beside_noise(self) -> str:
        """What a band is made of that holds it; and why it may hold more than 95 % of what is true."""
        found = f"noise of the fit and error of the model ({self.words()})"
        unstated = "noise of readings that state none counts as such, so the true deviation lies within more often"
        return f"{found}; {unstated}" if self.variance(np.array(1.0), np.array(1.0)) > 0.0 else found


@dataclass(frozen=True, eq=False)
class Errors:
    """Errors on what was left out (e,) m, the variance (e,) m^2 that the fit gave each with that of the reading's own
    noise where it is stated, the size (e,) m of the displacement predicted there, the load (e,) N it was under, and the
    fold (e,) each was left out with."""

    error: FloatArray
    variance: FloatArray
    size: FloatArray
    load: FloatArray
    fold: IntArray

    def chosen(self, which: IntArray | BoolArray) -> Errors:
        """Some of them."""
        return Errors(self.error[which], self.variance[which], self.size[which], self.load[which], self.fold[which])

    def thinned(self) -> Errors:
        """Those that are known, at most ``MOST`` of them."""
        known = np.flatnonzero(np.isfinite(self.error))
        return self.chosen(known[:: max(-(-len(known) // MOST), 1)])


def model_error(errors: Errors, dof: int) -> ModelError | None:
    """The error that the bands need; None where too little was left out to judge it."""
    errors = errors.thinned()
    if len(np.unique(errors.fold)) < FEWEST or dof <= 0:
        return None
    t = quantile(dof)
    e2, v = errors.error**2, errors.variance
    one_load = errors.load.min() > (1.0 - ALIKE) * errors.load.max()
    stays = np.zeros_like(e2) if one_load else np.ones_like(e2)
    parts = _spread(e2, v, np.stack([errors.size**2, errors.load**2, stays], axis=1))
    beyond = ModelError(*np.sqrt(parts)).variance(errors.size, errors.load)
    if not (beyond > 0).all():
        return ModelError(0.0, 0.0, 0.0)
    needed = np.sort(np.clip(e2 / t**2 - v, 0.0, None) / beyond)
    rank = min(int(np.ceil(LEVEL * (len(needed) + 1))), len(needed)) - 1
    k = float(np.sqrt(needed[rank]))
    return ModelError(*(k * float(part) for part in np.sqrt(parts)))


def _spread(e2: FloatArray, v: FloatArray, columns: FloatArray) -> FloatArray:
    """(3,) squares of the parts by weighted non-negative least squares of squared errors on their columns (e, 3)."""
    from scipy.optimize import nnls

    typical = columns.mean(axis=0)
    typical[typical == 0.0] = 1.0
    A = columns / typical
    guess = np.full(len(e2), float(np.median(e2)) / 0.455)  # the median of a squared standard normal
    found = np.zeros(3)
    for _ in range(ROUNDS):
        weight = 1.0 / np.maximum(guess, 1e-6 * float(guess.max(initial=0.0)) or 1.0)
        target = np.minimum(e2, CLIP * guess) - v
        R = triangle(A * weight[:, None], target * weight)
        found = nnls(R[:, :3], R[:, 3])[0]
        guess = v + A @ found
    return np.asarray(found / typical)


def held(errors: Errors, dof: int) -> float:
    """Share of the errors left out that 95 % bands hold, each fold's band made from the errors of the others alone."""
    errors = errors.thinned()
    inside = np.zeros(len(errors.error), dtype=bool)
    for k in np.unique(errors.fold):
        here = errors.fold == k
        spread = model_error(errors.chosen(~here), dof)
        if spread is None:
            return float("nan")
        t = quantile(dof)
        half = t * np.sqrt(errors.variance[here] + spread.variance(errors.size[here], errors.load[here]))
        inside[here] = np.abs(errors.error[here]) <= half
    return float(inside.mean()) if len(inside) else float("nan")
