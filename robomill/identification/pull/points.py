"""The load point and the gauge point, fitted beside the compliances: three numbers each, the same for every test.

A spring's motion at a point is affine in that point, ``u x (p + R s - o)``, so a reading is linear in the compliances
and bilinear in the two shifts: A(s) = sum_k x_k(s) T_k with x = (1, s_F) (x) (1, s_G). The terms T_k are built once;
their triangular factor holds all that a fit needs, and factors of parts are stacked as for the linear fit.
Gauss-Newton on compliances and shifts together gives the covariance of both, each with the other free; the way there
goes by the normal equations, whose parts are added, the last steps and the covariance by the factor.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Literal, NamedTuple

import numpy as np

from robomill.arrays import BoolArray, FloatArray
from robomill.identification.fit.least_squares import Fit, bounded_normal, bounded_solution, solve_triangle

Point = Literal["force", "gauge"]
FREED: dict[str, tuple[Point, ...]] = {
    "none": (),
    "force": ("force",),
    "gauge": ("gauge",),
    "both": ("force", "gauge"),
}
POINTS: tuple[Point, ...] = ("force", "gauge")
ROUNDS = 40
SETTLED = 1e-8  # m
POLISH = 3
LONGEST = 0.3  # m, step of one round
FARTHEST = 5.0  # m from the stated point; where a fit runs away further, nothing holds it


class PointFit(NamedTuple):
    """A fit (``x``: p compliances, then the s coordinates of the shifts) and the shift (s,) m in {T} alone."""

    fit: Fit
    shift: FloatArray

    def compliances(self) -> Fit:
        """The fit of the compliances alone, the shifts being free: the marginal covariance."""
        p = len(self.fit.x) - len(self.shift)
        fit = self.fit
        cov, null = fit.covariance[:p, :p], fit.null[:, :p]
        null = null[np.linalg.norm(null, axis=1) > 1e-6]
        spare = None if fit.spare is None else fit.spare[:p]
        return replace(fit, x=fit.x[:p], covariance=cov, seen=fit.seen[:p], null=null, free=fit.free[:p], spare=spare)


def monomials(shift: FloatArray, freed: Sequence[Point]) -> tuple[FloatArray, FloatArray]:
    """x (k,) of the terms at a shift (s,) m, and their derivatives (k, s)."""
    s = len(shift)
    parts: list[tuple[FloatArray, FloatArray]] = []
    for point in POINTS:
        if point in freed:
            at = 3 * list(freed).index(point)
            slope = np.zeros((4, s))
            slope[1:, at : at + 3] = np.eye(3)
            parts.append((np.concatenate([[1.0], shift[at : at + 3]]), slope))
        else:
            parts.append((np.ones(1), np.zeros((1, s))))
    (f, df), (g, dg) = parts
    change = df[:, None, :] * g[None, :, None] + f[:, None, None] * dg[None, :, :]
    return np.outer(f, g).ravel(), change.reshape(len(f) * len(g), s)


def at_shift(terms: FloatArray, shift: FloatArray, freed: Sequence[Point]) -> FloatArray:
    """(..., p) equations at a shift, from their terms (..., k, p)."""
    return np.einsum("...kp,k->...p", terms, monomials(shift, freed)[0])


def slopes(terms: FloatArray, x: FloatArray, shift: FloatArray, freed: Sequence[Point]) -> FloatArray:
    """(..., s): change of A(shift) x with each coordinate of the shift."""
    return np.einsum("...kp,p,ks->...s", terms, x, monomials(shift, freed)[1])


class Normal(NamedTuple):
    """Normal equations of terms and readings: M (k p + 1, k p + 1) = [T b]^T [T b], parts of which are simply added.

    The search for the shift goes by these, at a cost that no longer depends on the number of readings.
    """

    M: FloatArray
    signed: BoolArray
    freed: tuple[Point, ...]

    def descend(self, shift: FloatArray) -> tuple[float, FloatArray, FloatArray]:
        """Squared residual, shift (s,) and compliances (p,) where Gauss-Newton with halved steps comes to rest."""
        cost, x = self.cost(shift)
        for _ in range(ROUNDS):
            step = self.step(shift, x)
            size = float(np.linalg.norm(step))
            if size < SETTLED:
                break
            step = step * min(1.0, LONGEST / size)
            for _ in range(12):
                trial, other = self.cost(shift + step)
                if trial <= cost:
                    break
                step = step / 2.0
            else:
                break
            gained, cost, x, shift = cost - trial, trial, other, shift + step
            if np.linalg.norm(shift) > FARTHEST or gained <= 1e-12 * cost:
                break
        return cost, shift, x

    def cost(self, shift: FloatArray) -> tuple[float, FloatArray]:
        """Squared residual and compliances (p,) of the bounded fit with the points there."""
        N, y = self._small(_columns(monomials(shift, self.freed)[0], len(self.signed)))
        x = bounded_normal(N, y, self.signed)
        return float(self.M[-1, -1] - 2.0 * x @ y + x @ N @ x), x

    def step(self, shift: FloatArray, x: FloatArray) -> FloatArray:
        """(s,) Gauss-Newton step of the shift, the compliances following it."""
        value, change = monomials(shift, self.freed)
        p = len(self.signed)
        inside = self.signed | (x > 0.0)
        A = _columns(value, p)[:, inside]
        turned = (change[:, None, :] * x[None, :, None]).reshape(len(A), len(shift))
        N, y = self._small(np.concatenate([A, turned], axis=1))
        size = np.sqrt(np.diag(N))
        size[size == 0.0] = 1.0
        return np.asarray(np.linalg.lstsq(N / np.outer(size, size), y / size, rcond=1e-12)[0] / size)[A.shape[1] :]

    def _small(self, V: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Normal matrix and right side of the columns T V."""
        MV = self.M[:, :-1] @ V
        return V.T @ MV[:-1], MV[-1]


def _columns(value: FloatArray, p: int) -> FloatArray:
    """(k p, p) by which terms (..., k p) become equations (..., p): the value (k,) of each monomial for each of p."""
    return np.asarray(value[:, None, None] * np.eye(p)).reshape(-1, p)


@dataclass(frozen=True, eq=False)
class Factored:
    """What fits need: the factor R (r, k p + 1) of terms and readings, the equations behind it, which may be negative.

    given: standard deviation of a weighted equation where nothing is left to estimate it from.
    """

    R: FloatArray
    equations: int
    signed: BoolArray
    freed: tuple[Point, ...] = ()
    given: float | None = None

    def fit(self, starts: Sequence[FloatArray] = ()) -> PointFit:
        """The best fit from the stated points and from any other ``starts`` (s,)."""
        if not self.freed:
            return PointFit(solve_triangle(self.R, self.equations, self.signed, self.given), np.zeros(0))
        normal = Normal(self.R.T @ self.R, self.signed, self.freed)
        found = [normal.descend(start) for start in (np.zeros(3 * len(self.freed)), *starts)]
        shift = min(found, key=lambda each: each[0])[1]
        for _ in range(POLISH):  # by orthogonal factors, to the last digit
            step = self._around(shift, shift * 0.0).x[len(self.signed) :]
            if not SETTLED < float(np.linalg.norm(step)) < LONGEST:
                break
            shift = shift + step
        return PointFit(self._around(shift, shift), shift)

    def _around(self, shift: FloatArray, origin: FloatArray) -> Fit:
        """The fit of compliances and of the shift counted from ``origin``, the equations made linear at ``shift``."""
        terms = self.R[:, :-1].reshape(len(self.R), -1, len(self.signed))
        A, b = at_shift(terms, shift, self.freed), self.R[:, -1]
        G = slopes(terms, bounded_solution(A, b, self.signed), shift, self.freed)
        largest = float(np.linalg.norm(G))
        unit = np.ones(A.shape[1] + len(shift))  # columns of like size, so that none is taken for zero
        unit[A.shape[1] :] = float(np.linalg.norm(A)) / largest if largest > 0 else 1.0
        whole = np.concatenate([np.concatenate([A, G], axis=1) * unit, (b + G @ origin)[:, None]], axis=1)
        signed = np.concatenate([self.signed, np.ones(len(shift), dtype=bool)])
        fit = solve_triangle(whole, self.equations, signed, self.given)
        return replace(fit, x=fit.x * unit, free=fit.free * unit, covariance=fit.covariance * np.outer(unit, unit))
