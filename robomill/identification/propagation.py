"""How sure a predicted deflection is: the uncertainty of compliances, force and lengths carried to the tool tip.

Linear propagation. With delta = D C_theta + ..., D (3 x p) the regressor of eqs. (13)-(16),

    cov(delta) = D cov(C_theta) D^T + (floor^2 + per_N^2 |F|^2 + share^2 |delta|^2) I
                 + C cov(F) C^T + L cov(lengths) L^T

where floor, per_N and share are the model's own error as poses left out showed it (``model_error``; absent from a band
of noise only) and L is the derivative of delta with respect to the D-H lengths a and d at fixed joint coordinates (the
control drives the joints by its nominal table, the true lengths are what is unsure). delta is exactly linear in C_theta
and in F apart; their product and the lengths are of second order.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from robomill.arrays import FloatArray, as_floats, frozen
from robomill.compliance.deflection import displacement
from robomill.errors import RobomillError
from robomill.identification.fit.confidence import LEVEL, half_width
from robomill.identification.knowledge import Knowledge
from robomill.identification.measured_field import MeasuredField
from robomill.lazy import cached_property
from robomill.robot.model import Robot

SOURCES = ("compliances", "model", "force", "lengths")
"""What makes a deflection unsure, in the order of the terms above."""
STEP = 1e-6  # m, for the derivative with respect to a length


@dataclass(frozen=True, eq=False)
class Uncertain:
    """A displacement with its uncertainty: delta (..., 3) m, and the covariance that each of ``SOURCES`` alone would
    give it, parts (..., sources, 3, 3) m^2."""

    delta: FloatArray
    parts: FloatArray
    dof: int | None = None

    @cached_property
    def covariance(self) -> FloatArray:
        """(..., 3, 3) m^2, of all sources together."""
        return frozen(self.parts.sum(axis=-3))

    def by(self, source: str) -> FloatArray:
        """(..., 3) m, one standard deviation of each component by one of ``SOURCES`` alone."""
        return _spread(self.parts[..., SOURCES.index(source), :, :])

    @property
    def std(self) -> FloatArray:
        """(..., 3) m, one standard deviation of each component."""
        return _spread(self.covariance)

    def half_width(self, level: float = LEVEL) -> FloatArray:
        """(..., 3) m: delta +- this holds the truth with that probability."""
        return half_width(self.std, self.dof, level)

    def half_along(self, direction: ArrayLike, level: float = LEVEL) -> FloatArray:
        """(...) m: the same of the component along unit vectors (..., 3)."""
        return half_width(_along(self.covariance, direction), self.dof, level)

    def by_along(self, source: str, direction: ArrayLike) -> FloatArray:
        """(...) m, one standard deviation of the component along unit vectors (..., 3) by one of ``SOURCES`` alone."""
        return _along(self.parts[..., SOURCES.index(source), :, :], direction)


def uncertain_deflection(robot: Robot, theta: ArrayLike, F: ArrayLike, known: Knowledge) -> Uncertain:
    """delta = C F with its uncertainty, at theta (..., n) under F (..., 3) N in {M}. Eqs. (15), (16).

    By the model and parameters of ``known`` (joints, bending, tool). NaN where theta is NaN.
    """
    theta = as_floats(theta, "theta", (robot.n,), error=RobomillError, finite=False)
    F = as_floats(F, "F", (3,), error=RobomillError, finite=False)
    D = known.model.tip_regressor(robot, theta, F)
    delta = D @ known.parameters
    parts = [D @ known.covariance @ np.swapaxes(D, -1, -2), *(np.zeros((*delta.shape, 3)) for _ in range(3))]
    if known.error is not None:
        load = np.linalg.norm(F, axis=-1)
        missed = np.where(load != 0.0, known.error.variance(np.linalg.norm(delta, axis=-1), load), 0.0)
        parts[1] = missed[..., None, None] * np.eye(3)
    if known.F is not None:
        C = known.model.compliance(robot, theta, known.parameters)
        parts[2] = parts[2] + C @ known.F @ np.swapaxes(C, -1, -2)
    if known.lengths is not None and np.any(known.lengths):
        L = length_derivative(robot, theta, F, known) * known.lengths
        parts[3] = L @ np.swapaxes(L, -1, -2)
    return _uncertain(delta, parts, known.dof)


def uncertain_by_map(field: MeasuredField, p: ArrayLike, F: ArrayLike, force: FloatArray | None = None) -> Uncertain:
    """delta = C F by a measured map at p (..., 3) m under F (..., 3) N in {M}, with the map's own uncertainty.

    force: (3, 3) N^2 covariance of the force, None: certain. NaN where the map does not answer or knows no error.
    """
    C, F = field.compliance(p), as_floats(F, "F", (3,), error=RobomillError, finite=False)
    delta = displacement(C, F)
    parts = [field.covariance(p, F), *(np.zeros((*delta.shape, 3)) for _ in range(3))]
    if force is not None:
        parts[2] = parts[2] + C @ force @ np.swapaxes(C, -1, -2)
    return _uncertain(delta, parts, None)


def _uncertain(delta: FloatArray, parts: list[FloatArray], dof: int | None) -> Uncertain:
    """From the covariances by each of ``SOURCES``."""
    return Uncertain(frozen(delta), frozen(np.stack(parts, axis=-3)), dof)


def length_derivative(robot: Robot, theta: FloatArray, F: FloatArray, known: Knowledge) -> FloatArray:
    """(..., 3, 2 rows) m/m: change of delta with a_1..a_k, d_1..d_k, by central differences at fixed joints."""
    columns = []
    for name in ("a", "d"):
        for i in range(robot.rows):
            moved = []
            for step in (STEP, -STEP):
                lengths = np.array(getattr(robot, name))
                lengths[i] += step
                arm = robot.replace(**{name: lengths})
                moved.append(known.model.tip_regressor(arm, theta, F) @ known.parameters)
            columns.append((moved[0] - moved[1]) / (2.0 * STEP))
    return np.stack(columns, axis=-1)


def _along(covariance: FloatArray, direction: ArrayLike) -> FloatArray:
    """(...) standard deviation along unit vectors (..., 3)."""
    u = np.asarray(direction, dtype=np.float64)
    return np.asarray(np.sqrt(np.clip(np.einsum("...i,...ij,...j->...", u, covariance, u), 0.0, None)))


def _spread(covariance: FloatArray) -> FloatArray:
    return np.sqrt(np.clip(np.diagonal(covariance, axis1=-2, axis2=-1), 0.0, None))
