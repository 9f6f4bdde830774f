"""Linear least squares with parameters that cannot be negative: scaling, robust weights, covariance, intervals.

Every fit works on the triangular factor R of [A b], a p x p matter however many tests there are; factors of
parts are stacked to fit a whole (cross-validation leaves parts out that way).

Intervals. The estimate is the bounded one; its covariance and 95 % intervals come from the *free* fit (Student's t
with e - p degrees of freedom, or as ``scatter`` finds them) and are then cut at zero. Cutting an interval to where the
truth must lie cannot lose the truth, so the coverage stays 95 % for every parameter, on the bound or off it; the
covariance of a fit with the active bounds taken as known would be too sure of itself.
"""

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from robomill.arrays import BoolArray, FloatArray
from robomill.identification.fit.confidence import BISQUARE, LEVEL, MAD, bisquare, half_width
from robomill.progress import checkpoint

NULL = 1e-9  # singular values below this share of the largest (columns scaled) count as zero
ROUNDS = 30
BLOCK = 256  # equations factored at a time; well above the number of parameters


@dataclass(frozen=True, eq=False)
class Fit:
    """A bounded fit of A x = b.

    x (p,) bounded estimate, NaN never (an unseen parameter takes its share of the shortest solution);
    covariance (p, p) of the free fit, NaN rows for what is not seen; sigma: standard deviation of one (weighted)
    equation; seen (p,) bool; null (k, p) scaled directions that no equation sees; free (p,) the unbounded
    estimate; condition before and after column scaling. ``spare`` (p,): the degrees of freedom of each interval, where
    they are not ``dof``.
    """

    x: FloatArray
    covariance: FloatArray
    sigma: float
    dof: int
    seen: BoolArray
    null: FloatArray
    free: FloatArray
    condition: tuple[float, float]
    spare: FloatArray | None = None

    @property
    def stderr(self) -> FloatArray:
        """(p,) standard errors; infinite for what is not seen."""
        return np.where(self.seen, np.sqrt(np.clip(np.diag(np.nan_to_num(self.covariance)), 0.0, None)), np.inf)

    def interval(self, signed: BoolArray, level: float = LEVEL) -> FloatArray:
        """(p, 2) intervals; cut at zero unless ``signed``; they always hold the estimate.

        Open where the readings ask for less than zero by more than chance: then nothing is known of that parameter.
        """
        half = half_width(self.stderr, self.dof if self.spare is None else self.spare, level)
        denied = ~signed & (self.free + half < 0.0)
        low, high = np.minimum(self.free - half, self.x), np.maximum(self.free + half, self.x)
        high = np.where(denied, np.inf, high)
        return np.stack([np.where(signed, low, np.maximum(low, 0.0)), high], axis=-1)


def triangle(A: FloatArray, b: FloatArray) -> FloatArray:
    """(k, p + 1) triangular factor of [A b], k <= p + 1: same normal equations, a handful of rows.

    Blocks that stay in the cache are factored first and their factors stacked: several times quicker on long columns.
    """
    whole = np.concatenate([A, b[:, None]], axis=1)
    while len(whole) > 4 * BLOCK:
        count = len(whole) // BLOCK
        blocks = whole[: count * BLOCK].reshape(count, BLOCK, -1)
        factors = np.asarray(np.linalg.qr(blocks, mode="r"))
        whole = np.concatenate([factors.reshape(-1, whole.shape[1]), whole[count * BLOCK :]])
    return np.asarray(np.linalg.qr(whole, mode="r"))


def solve_triangle(R: FloatArray, equations: int, signed: BoolArray, given_sigma: float | None = None) -> Fit:
    """Bounded least squares from the factor of [A b] with ``equations`` rows behind it."""
    p = R.shape[1] - 1
    if len(R) > p + 1:  # stacked factors
        R = np.asarray(np.linalg.qr(R, mode="r"))
    A, b = R[:, :p], R[:, p]
    scale = column_scale(A)
    S = A / scale
    _, values, Vt = np.linalg.svd(S, full_matrices=True)
    values = np.pad(values, (0, p - len(values)))
    keep = values > NULL * max(values.max(initial=0.0), 1e-300)
    null = Vt[~keep]
    seen = np.linalg.norm(null, axis=0) < 1e-6
    inverse = (Vt[keep].T / np.where(keep, values, 1.0)[keep] ** 2) @ Vt[keep]
    free = _free(S, b, keep)
    bounded = _bounded(S, b, free, signed)
    residual = S @ free - b
    dof = equations - int(keep.sum())
    sigma = float(np.sqrt(residual @ residual / dof)) if dof > 0 else 0.0
    if dof <= 0 and given_sigma is not None:
        sigma = given_sigma
    covariance = sigma**2 * inverse / np.outer(scale, scale)
    covariance[~seen] = covariance[:, ~seen] = np.nan
    condition = (_condition(np.linalg.svd(A, compute_uv=False)), _condition(values))
    return Fit(bounded / scale, covariance, sigma, dof, seen, null, free / scale, condition)


def bounded_solution(A: FloatArray, b: FloatArray, signed: BoolArray) -> FloatArray:
    """(p,) the bounded estimate alone, of equations in full or of their factor."""
    scale = column_scale(A)
    S = A / scale
    return _bounded(S, b, np.asarray(np.linalg.lstsq(S, b, rcond=NULL)[0]), signed) / scale


def bounded_normal(N: FloatArray, y: FloatArray, signed: BoolArray) -> FloatArray:
    """(p,) the same from the normal equations N x = y: half the digits, and quick."""
    size = np.sqrt(np.diag(N))
    scale = np.where(size > NULL * size.max(initial=0.0), size, np.inf)
    values, vectors = np.linalg.eigh(N / np.outer(scale, scale))
    keep = values > 1e-12 * max(float(values[-1]), 1e-300)
    root, turned = np.sqrt(values[keep]), vectors[:, keep]
    b = (turned.T @ (y / scale)) / root
    free = turned @ (b / root)
    return _bounded((turned * root).T, b, free, signed) / scale


def column_scale(A: FloatArray) -> FloatArray:
    """(p,) lengths of the columns; infinite for those that are zero beside the longest."""
    norms = np.linalg.norm(A, axis=0)
    top = norms.max(initial=0.0)
    return np.where(norms > NULL * top, norms, np.inf if top > 0 else 1.0)


def _free(S: FloatArray, b: FloatArray, keep: BoolArray) -> FloatArray:
    from scipy.linalg import solve_triangular

    if keep.all():
        Q, R = np.linalg.qr(S)
        return np.asarray(solve_triangular(R, Q.T @ b))
    return np.asarray(np.linalg.lstsq(S, b, rcond=NULL)[0])


def _bounded(S: FloatArray, b: FloatArray, free: FloatArray, signed: BoolArray) -> FloatArray:
    """The bounded solution; where no bound is active it is the free one, to the last bit."""
    from scipy.optimize import nnls

    if ((free >= 0) | signed).all():
        return free
    split = np.concatenate([S, -S[:, signed]], axis=1)  # a signed parameter is the difference of two positive ones
    x = np.asarray(nnls(split, b)[0])
    x[np.flatnonzero(signed)] -= x[S.shape[1] :]
    x = x[: S.shape[1]]
    inside = signed | (x > 1e-12 * np.abs(x).max(initial=0.0))
    polished = np.zeros_like(x)
    if inside.any():
        polished[inside] = np.linalg.lstsq(S[:, inside], b, rcond=NULL)[0]
    return polished if (polished[~signed] >= 0).all() else x


def _condition(values: NDArray[Any]) -> float:
    low = float(values.min(initial=np.inf))
    high = float(values.max(initial=0.0))
    return high / low if low > NULL * 1e-3 * high else np.inf


@dataclass(frozen=True, eq=False)
class RobustFit:
    """Tukey's bisquare: weights (e,), residuals (e,) of all equations, and the scale of the good ones.

    sigma: the standard deviation with which (A^T A)^-1 gives the covariance of this M-estimate (Huber, Robust
    Statistics, ch. 7).
    """

    weights: FloatArray
    residual: FloatArray
    scale: float
    sigma: float = 0.0


def robust_fit(A: FloatArray, b: FloatArray) -> RobustFit:
    """Weights that leave gross equations out.

    Works in an orthonormal basis of the columns, where the small normal equations are well conditioned.
    """
    norms = np.linalg.norm(A, axis=0)
    scaled = A / np.where(norms > 0, norms, 1.0)
    _, values, Vt = np.linalg.svd(triangle(scaled, b)[:, :-1], full_matrices=False)
    keep = values > NULL * max(float(values.max(initial=0.0)), 1e-300)
    B = scaled @ (Vt[keep].T / values[keep])
    spare = np.sqrt(len(b) / max(len(b) - B.shape[1], 1))
    tiny = 1e-12 * float(np.abs(b).max(initial=0.0))
    weights, scale, residual = np.ones(len(b)), 0.0, b
    for _ in range(ROUNDS):
        checkpoint()
        weighted = B * weights[:, None]
        residual = b - B @ np.linalg.lstsq(weighted.T @ B, weighted.T @ b, rcond=None)[0]
        size = np.abs(residual)
        scale = max(float(np.median(size)) / MAD * spare, tiny)
        if scale == 0.0:
            break
        last, weights = weights, bisquare(size / scale)
        if float(np.sqrt(np.mean((weights - last) ** 2))) < 1e-4:
            break
    return RobustFit(weights, residual, scale, _robust_sigma(residual, scale, B.shape[1]))


def _robust_sigma(residual: FloatArray, scale: float, p: int) -> float:
    e = len(residual)
    if scale == 0.0 or e <= p:
        return 0.0
    v = np.minimum((residual / (BISQUARE * scale)) ** 2, 1.0)
    psi = residual * (1.0 - v) ** 2
    slope = (1.0 - v) * (1.0 - 5.0 * v)
    mean = float(slope.mean())
    correction = 1.0 + p / e * float(slope.var()) / mean**2
    return correction * float(np.sqrt((psi**2).sum() / (e - p))) / mean
