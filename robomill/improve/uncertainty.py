"""How sure a predicted deviation is: the uncertainty of compliances, force and lengths carried to the tool tip.

Linear propagation. With delta = D C_theta + ..., D (3 x p) the regressor of eqs. (13)-(16),

    cov(delta) = D cov(C_theta) D^T + C cov(F) C^T + L cov(lengths) L^T

where L is the derivative of delta with respect to the D-H lengths a and d at fixed joint coordinates (the control
drives the joints by its nominal table, the true lengths are what is unsure). delta is exactly linear in C_theta and
in F apart; their product and the lengths are of second order, which ``monte_carlo`` measures.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import ArrayLike
from scipy.special import ndtri, stdtrit

from robomill.arrays import FloatArray, as_floats, frozen
from robomill.errors import RobomillError
from robomill.identification.models import Model
from robomill.identification.result import IdentificationResult
from robomill.kinematics.jacobian import geometric_jacobian
from robomill.robot.model import Robot
from robomill.units import format_si

STEP = 1e-6  # m, for the derivative with respect to a length
DRAWS = 4000


@dataclass(frozen=True, eq=False)
class Sources:
    """What is not known exactly.

    covariance (p, p) of the compliances (of the model's parameters); F (3, 3) N^2 covariance of the force, the same
    along the path; lengths (2 rows,) m standard deviations of a_1..a_k then d_1..d_k; dof of the fit that gave the
    covariance (None: known exactly, normal quantiles). What is None is taken as certain.
    """

    covariance: FloatArray | None = None
    F: FloatArray | None = None
    lengths: FloatArray | None = None
    dof: int | None = None

    @staticmethod
    def of(result: IdentificationResult, robot: Robot) -> Sources:
        """The compliances as uncertain as an identification found them, for ``result.applied_to(robot)``.

        A joint it did not see keeps the robot's own value there, and counts here as unsure by all of that value.
        """
        covariance = np.nan_to_num(result.covariance)
        unseen = np.flatnonzero(~np.isfinite(result.stderr))
        if result.model != "constant":
            covariance[unseen, unseen] = robot.C_theta[unseen] ** 2
        return Sources(covariance=covariance, dof=result.dof)

    @staticmethod
    def relative(robot: Robot, compliance: ArrayLike = 0.0, force: ArrayLike = 0.0, length: float = 0.0) -> Sources:
        """Independent uncertainties by hand: a share of each joint compliance, N of each force component, m."""
        C = np.diag((np.broadcast_to(compliance, (robot.n,)) * robot.C_theta) ** 2)
        F = np.diag(np.broadcast_to(np.asarray(force, dtype=np.float64), (3,)) ** 2)
        return Sources(C, F, np.full(2 * robot.rows, length))


@dataclass(frozen=True, eq=False)
class Uncertain:
    """A displacement with its uncertainty: delta (..., 3) m, covariance (..., 3, 3) m^2, and the part of each source.

    by_compliance, by_force, by_lengths (..., 3): standard deviations (m) each source alone would give.
    """

    delta: FloatArray
    covariance: FloatArray
    by_compliance: FloatArray
    by_force: FloatArray
    by_lengths: FloatArray
    dof: int | None = None

    @property
    def std(self) -> FloatArray:
        """(..., 3) m, one standard deviation of each component."""
        return np.sqrt(np.diagonal(self.covariance, axis1=-2, axis2=-1))

    def half_width(self, level: float = 0.95) -> FloatArray:
        """(..., 3) m: delta +- this holds the truth with that probability."""
        return quantile(level, self.dof) * self.std

    def along(self, direction: ArrayLike) -> tuple[FloatArray, FloatArray]:
        """Value and standard deviation (...) m of the component along unit vectors (..., 3), e.g. feed-normal."""
        u = np.asarray(direction, dtype=np.float64)
        value = np.einsum("...i,...i->...", self.delta, u)
        return value, np.sqrt(np.einsum("...i,...ij,...j->...", u, self.covariance, u))

    def magnitude(self) -> tuple[FloatArray, FloatArray]:
        """|delta| and its standard deviation (...) m; NaN where nothing moves and the direction is not defined."""
        size = np.linalg.norm(self.delta, axis=-1)
        with np.errstate(invalid="ignore", divide="ignore"):
            return size, self.along(self.delta / size[..., None])[1]


def quantile(level: float = 0.95, dof: int | None = None) -> float:
    """How many standard deviations a two-sided interval takes: Student's t with ``dof``, normal when None."""
    upper = 0.5 + 0.5 * level
    return float(ndtri(upper)) if dof is None else float(stdtrit(max(dof, 1), upper))


def deflection_uncertainty(
    robot: Robot,
    theta: ArrayLike,
    F: ArrayLike,
    sources: Sources,
    *,
    model: Model | None = None,
    parameters: ArrayLike | None = None,
) -> Uncertain:
    """delta = C F with its uncertainty, at theta (..., n) under F (..., 3) N in {M}. Eqs. (15), (16).

    The robot's C_theta unless a model and its parameters (p,) are given (bending, tool). NaN where theta is NaN.
    """
    theta = as_floats(theta, "theta", (robot.n,), error=RobomillError, finite=False)
    F = as_floats(F, "F", (3,), error=RobomillError, finite=False)
    choice = model or Model("joints")
    values = robot.C_theta if parameters is None else np.asarray(parameters, dtype=np.float64)
    D = choice.tip_regressor(robot, theta, F)
    delta = D @ values
    parts = [np.zeros((*delta.shape, 3)) for _ in range(3)]
    if sources.covariance is not None:
        cov = as_floats(sources.covariance, "covariance of the compliances", (len(values), len(values)))
        parts[0] = D @ cov @ np.swapaxes(D, -1, -2)
    if sources.F is not None:
        C = choice.compliance(robot, theta, values)
        parts[1] = C @ as_floats(sources.F, "covariance of the force", (3, 3)) @ np.swapaxes(C, -1, -2)
    if sources.lengths is not None and np.any(sources.lengths):
        L = length_derivative(robot, theta, F, choice, values) * np.asarray(sources.lengths)
        parts[2] = L @ np.swapaxes(L, -1, -2)
    spread = [np.sqrt(np.clip(np.diagonal(part, axis1=-2, axis2=-1), 0.0, None)) for part in parts]
    total = frozen(parts[0] + parts[1] + parts[2])
    return Uncertain(frozen(delta), total, frozen(spread[0]), frozen(spread[1]), frozen(spread[2]), sources.dof)


def identified_deflection(
    robot: Robot,
    result: IdentificationResult,
    theta: ArrayLike,
    F: ArrayLike,
    *,
    force: FloatArray | None = None,
    lengths: FloatArray | None = None,
) -> Uncertain:
    """What an identification predicts at theta (..., n) under F (..., 3), extra springs included, with its band.

    force (3, 3) N^2 and lengths (2 rows,) m as in Sources. A joint that was not seen keeps the robot's own value, taken
    as unsure by all of it.
    """
    parameters = np.array(result.parameters)
    if result.model != "constant":
        unseen = ~np.isfinite(result.stderr)
        parameters[: robot.n][unseen] = robot.C_theta[unseen]
    sources = replace(Sources.of(result, robot), F=force, lengths=lengths)
    return deflection_uncertainty(robot, theta, F, sources, model=result.choice, parameters=parameters)


def length_derivative(
    robot: Robot, theta: FloatArray, F: FloatArray, model: Model, parameters: FloatArray
) -> FloatArray:
    """(..., 3, 2 rows) m/m: change of delta with a_1..a_k, d_1..d_k, by central differences at fixed joints."""
    columns = []
    for name in ("a", "d"):
        for i in range(robot.rows):
            moved = []
            for step in (STEP, -STEP):
                lengths = np.array(getattr(robot, name))
                lengths[i] += step
                moved.append(model.tip_regressor(robot.replace(**{name: lengths}), theta, F) @ parameters)
            columns.append((moved[0] - moved[1]) / (2.0 * STEP))
    return np.stack(columns, axis=-1)


def compliance_uncertainty(robot: Robot, theta: ArrayLike, covariance: ArrayLike) -> FloatArray:
    """Standard deviation (..., 3, 3) m/N of every entry of C, for maps, from cov(C_theta) (n, n)."""
    cov = as_floats(covariance, "covariance of the compliances", (robot.n, robot.n))
    columns = Model("joints").columns(robot, np.asarray(theta, dtype=np.float64))[..., :3, :]
    basis = columns[..., :, None, :] * columns[..., None, :, :]
    return np.sqrt(np.clip(np.einsum("...ijk,kl,...ijl->...ij", basis, cov, basis), 0.0, None))


def monte_carlo(
    robot: Robot, theta: ArrayLike, F: ArrayLike, sources: Sources, draws: int = DRAWS, seed: int = 0
) -> FloatArray:
    """delta (draws, ..., 3) m of the joint model with everything unsure drawn at random: the check on the linear bands.

    Compliances are drawn from the normal distribution and not below zero.
    """
    rng = np.random.default_rng(seed)
    theta, F = np.asarray(theta, dtype=np.float64), np.asarray(F, dtype=np.float64)
    C_theta = np.broadcast_to(robot.C_theta, (draws, robot.n))
    if sources.covariance is not None:
        C_theta = np.clip(C_theta + _normal(rng, sources.covariance, draws), 0.0, None)
    push = np.zeros((draws, 3)) if sources.F is None else _normal(rng, sources.F, draws)
    lengths = np.zeros(2 * robot.rows) if sources.lengths is None else np.asarray(sources.lengths)
    drawn = np.empty((draws, *np.broadcast_shapes(theta.shape[:-1], F.shape[:-1]), 3))
    J_v = geometric_jacobian(robot, theta)[..., :3, :]
    for k in range(draws):
        if lengths.any():
            change = lengths * rng.standard_normal(2 * robot.rows)
            arm = robot.replace(a=robot.a + change[: robot.rows], d=robot.d + change[robot.rows :])
            J_v = geometric_jacobian(arm, theta)[..., :3, :]
        torque = np.einsum("...ij,...i->...j", J_v, F + push[k])
        drawn[k] = np.einsum("...ij,...j->...i", J_v, C_theta[k] * torque)
    return drawn


def with_band(value: float, half_width: float, unit: str = "mm", digits: int = 2) -> str:
    """A tile's text: ``with_band(2.3e-4, 2e-5) == "0.23 ± 0.02 mm"`` (SI in)."""
    number = format_si(value, unit, digits)
    label = format_si(value, unit, 0).split(" ", 1)[1]
    return f"{number.removesuffix(' ' + label)} ± {format_si(half_width, unit, digits)}"


def _normal(rng: np.random.Generator, covariance: FloatArray, draws: int) -> FloatArray:
    """(draws, k) from a covariance that may be singular."""
    values, vectors = np.linalg.eigh(np.asarray(covariance, dtype=np.float64))
    scaled = vectors * np.sqrt(np.clip(values, 0.0, None))
    return np.asarray(rng.standard_normal((draws, len(values))) @ scaled.T)
